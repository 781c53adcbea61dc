//! Euclidean distance to the surface, at the centres of the cells of a grid.

use super::blocks::{Block, Blocks, SIDE};
use super::columns::Gap;
use super::vector::{cross, dot, minus};
use super::voxels::heights;

/// More than rounding to single precision, by which the order of triangles could make a difference, in metres.
const SLACK_M: f32 = 1e-5;

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
        let [xs, ys, zs] = place.map(|n| centres_m(n, cell_m));
        let off =
            |centres_m: [f64; SIDE], axis: usize| centres_m.map(|along_m| (along_m - triangle.middle[axis]) as f32);
        let [off_x, off_y, off_z] = [off(xs, 0), off(ys, 1), off(zs, 2)];
        let around_m = triangle.radius_m as f32 + SLACK_M;
        let within_m = reach_m as f32 + around_m;
        let is_away = |off: [f32; SIDE]| off.iter().all(|off| off.abs() > within_m);
        if is_away(off_x) || is_away(off_y) || is_away(off_z) {
            return;
        }
        let rows = distances_m.entry(place).as_chunks_mut::<SIDE>().0;
        for (n, row) in rows.iter_mut().enumerate() {
            let (i, j) = (n / SIDE, n % SIDE);
            let from_axis = off_x[i] * off_x[i] + off_y[j] * off_y[j];
            if from_axis > within_m * within_m {
                continue;
            }
            // Most are no nearer to the ball around the triangle than to another one. A loop without branches is told so for
            // several at once.
            let mut may_be_nearer = [false; SIDE];
            for k in 0..SIDE {
                let most_m = row[k].min(reach_m as f32) + around_m;
                may_be_nearer[k] = from_axis + off_z[k] * off_z[k] < most_m * most_m;
            }
            for k in (0..SIDE).filter(|k| may_be_nearer[*k]) {
                let point = [xs[i], ys[j], zs[k]];
                if triangle.may_be_nearer(point, reach_m.min(f64::from(row[k]))) {
                    let square = triangle.square_from(point);
                    if square <= reach_m * reach_m {
                        row[k] = row[k].min(square.sqrt() as f32);
                    }
                }
            }
        }
    }

    /// Adds what triangles elsewhere made of a block of the same grid.
    pub(super) fn join(&mut self, place: [i32; 3], distances_m: impl Iterator<Item = f32>) {
        self.distances_m.join(place, distances_m, f32::min);
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

/// Centres of the cells of a block along an axis.
fn centres_m(place: i32, cell_m: f64) -> [f64; SIDE] {
    std::array::from_fn(|n| (f64::from(place) * SIDE as f64 + n as f64 + 0.5) * cell_m)
}

/// A triangle, and what its distance from many points needs.
struct Triangle {
    corners: [[f64; 3]; 3],
    edges: [[f64; 3]; 3],
    /// Unit normal; zero if the corners are on a line.
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
        let across = cross(edges[0], edges[1]);
        let doubled_area = dot(across, across).sqrt();
        let normal = if doubled_area > 0.0 { across.map(|part| part / doubled_area) } else { across };
        let middle = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let square = |corner| dot(minus(corner, middle), minus(corner, middle));
        let radius_m = corners.map(square).into_iter().fold(0.0, f64::max).sqrt();
        Self { corners, edges, normal, inwards: edges.map(|edge| cross(normal, edge)), middle, radius_m }
    }

    /// Whether a point may be nearer than this: the triangle is in a disk in its plane.
    fn may_be_nearer(&self, point: [f64; 3], than_m: f64) -> bool {
        let off = minus(point, self.middle);
        let height = dot(off, self.normal);
        let most_m = than_m + f64::from(SLACK_M);
        let left = most_m * most_m - height * height;
        left > 0.0 && {
            let along_m = self.radius_m + left.sqrt();
            dot(off, off) - height * height < along_m * along_m
        }
    }

    /// The square of the distance from a point.
    fn square_from(&self, point: [f64; 3]) -> f64 {
        let from = self.corners.map(|corner| minus(point, corner));
        let has_area = self.normal != [0.0; 3];
        if has_area && from.iter().zip(self.inwards).all(|(from, inwards)| dot(*from, inwards) >= 0.0) {
            let height = dot(from[0], self.normal);
            return height * height;
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
