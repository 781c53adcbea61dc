//! Euclidean distance to the surface, at the centres of the cells of a grid.

use super::blocks::{Block, Blocks, SIDE};
use super::columns::Gap;
use super::vector::{cross, dot, minus};
use super::voxels::heights;

/// Distances from the centres of the cells of a cubic grid, the same as that of [`Voxels`](super::Voxels), to the nearest point of
/// any triangle; infinite beyond a reach.
///
/// Computed from the corners in double precision and rounded to single; so the error is far below a micrometre per metre.
pub struct Distances {
    cell_m: f64,
    reach_m: f64,
    distances_m: Blocks<f32>,
}

impl Distances {
    /// A grid of cells with this side, and how far from the surface distances are computed, in metres.
    pub fn new(cell_m: f64, reach_m: f64) -> Self {
        Self { cell_m, reach_m, distances_m: Blocks::new(f32::INFINITY) }
    }

    /// Adds triangles: corners in metres, and three indices a triangle.
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32]) {
        for triangle in indices.as_chunks::<3>().0 {
            self.add_triangle(&Triangle::new(triangle.map(|corner| corners[corner as usize].map(f64::from))));
        }
    }

    fn add_triangle(&mut self, triangle: &Triangle) {
        let block_m = SIDE as f64 * self.cell_m;
        let within = triangle.radius_m + self.reach_m;
        let block_of = |along_m: f64| (along_m / block_m).floor() as i32;
        let [[i0, i1], [j0, j1], [k0, k1]] =
            triangle.middle.map(|along_m| [block_of(along_m - within), block_of(along_m + within)]);
        for i in i0..=i1 {
            for j in j0..=j1 {
                for k in k0..=k1 {
                    self.add_to_block(triangle, [i, j, k]);
                }
            }
        }
    }

    fn add_to_block(&mut self, triangle: &Triangle, place: [i32; 3]) {
        let Self { cell_m, reach_m, ref mut distances_m } = *self;
        // The cells along an axis of which the centre is within reach of the ball around the triangle.
        let within = triangle.radius_m + reach_m;
        let cells = |axis: usize| {
            let first = f64::from(place[axis]) * SIDE as f64 + 0.5;
            let low = ((triangle.middle[axis] - within) / cell_m - first).ceil().max(0.0);
            let high = ((triangle.middle[axis] + within) / cell_m - first).floor().min(SIDE as f64 - 1.0);
            (low as usize..(high + 1.0) as usize, first)
        };
        let [(xs, x0), (ys, y0), (zs, z0)] = [cells(0), cells(1), cells(2)];
        if xs.is_empty() || ys.is_empty() || zs.is_empty() {
            return;
        }
        let at = |first: f64, n: usize| (first + n as f64) * cell_m;
        let block = distances_m.entry(place);
        for i in xs {
            for j in ys.clone() {
                let row = (i * SIDE + j) * SIDE;
                let away = [at(x0, i) - triangle.middle[0], at(y0, j) - triangle.middle[1]];
                let from_axis = away[0] * away[0] + away[1] * away[1];
                for k in zs.clone() {
                    let known_m = &mut block[row + k];
                    let point = [at(x0, i), at(y0, j), at(z0, k)];
                    let up = point[2] - triangle.middle[2];
                    if triangle.may_be_nearer(from_axis + up * up, reach_m.min(f64::from(*known_m))) {
                        let square = triangle.square_from(point);
                        if square <= reach_m * reach_m {
                            *known_m = known_m.min(square.sqrt() as f32);
                        }
                    }
                }
            }
        }
    }

    /// Makes the distances in the air negative, given the air in the columns of the same grid, once all triangles are there. All the
    /// air gets blocks: minus infinity is air beyond the reach, and infinity is rock.
    pub fn sign(&mut self, air: &[Gap]) {
        for gap in air {
            for k in heights(gap, self.cell_m) {
                let distance_m = self.distances_m.cell_mut([gap.cell[0], gap.cell[1], k]);
                *distance_m = -*distance_m;
            }
        }
    }

    /// The distances, in blocks by place.
    pub fn into_blocks(self) -> Vec<Block<f32>> {
        self.distances_m.into_sorted()
    }
}

/// A triangle, and what its distance from many points needs.
struct Triangle {
    corners: [[f64; 3]; 3],
    edges: [[f64; 3]; 3],
    /// Perpendicular to the triangle; zero if its corners are on a line.
    normal: [f64; 3],
    /// Perpendicular to each edge in the plane of the triangle, inwards.
    inwards: [[f64; 3]; 3],
    /// A ball around it.
    middle: [f64; 3],
    radius_m: f64,
}

impl Triangle {
    fn new(corners: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [minus(b, a), minus(c, b), minus(a, c)];
        let normal = cross(edges[0], edges[1]);
        let middle = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let square = |corner| dot(minus(corner, middle), minus(corner, middle));
        let radius_m = corners.map(square).into_iter().fold(0.0, f64::max).sqrt();
        Self { corners, edges, normal, inwards: edges.map(|edge| cross(normal, edge)), middle, radius_m }
    }

    /// Whether a point may be nearer than this, given the square of its distance from the middle.
    fn may_be_nearer(&self, square: f64, than_m: f64) -> bool {
        /// More than rounding to single precision, so that the order of triangles makes no difference.
        const SLACK_M: f64 = 1e-5;
        let most_m = than_m + self.radius_m + SLACK_M;
        square < most_m * most_m
    }

    /// The square of the distance from a point.
    fn square_from(&self, point: [f64; 3]) -> f64 {
        let from = self.corners.map(|corner| minus(point, corner));
        let steepness = dot(self.normal, self.normal);
        if steepness > 0.0 && from.iter().zip(self.inwards).all(|(from, inwards)| dot(*from, inwards) >= 0.0) {
            let height = dot(from[0], self.normal);
            return height * height / steepness;
        }
        let square_from_edge = |(from, edge): (&[f64; 3], &[f64; 3])| {
            let length = dot(*edge, *edge);
            let along = if length > 0.0 { (dot(*from, *edge) / length).clamp(0.0, 1.0) } else { 0.0 };
            let off = minus(*from, edge.map(|part| part * along));
            dot(off, off)
        };
        from.iter().zip(&self.edges).map(square_from_edge).fold(f64::INFINITY, f64::min)
    }
}
