//! Distance between meshes.

use std::collections::HashMap;

use nalgebra::Vector3;
use plume::mesh::{Mesh, QUANTA_PER_M};

type Point = Vector3<f64>;

/// Distances from points spread over one mesh to the nearest triangle of another, in metres.
pub struct Distances(Vec<f64>);

impl Distances {
    /// From points about `spacing_m` apart on `from`, none further than `reach_m` (such are found at `reach_m`).
    pub fn between(from: &Mesh, to: &Mesh, spacing_m: f64, reach_m: f64) -> Self {
        let near = Near::new(to, reach_m);
        let points = from.triangles.iter().flat_map(|&t| spread(corners(from, t), spacing_m));
        let mut distances: Vec<f64> = points.map(|point| near.distance(point)).collect();
        distances.sort_by(f64::total_cmp);
        Self(distances)
    }

    /// The largest distance.
    pub fn greatest(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }

    /// The distance that this fraction of all points does not exceed.
    pub fn quantile(&self, share: f64) -> f64 {
        self.0[((self.0.len() - 1) as f64 * share) as usize]
    }
}

/// Least side in metres of the cubes by which triangles are found: with smaller ones each triangle is in hundreds.
const LEAST_SIDE_M: f64 = 0.1;

/// The triangles of a mesh by the cubes of space they touch, for distances up to a reach.
pub struct Near {
    triangles: Vec<[Point; 3]>,
    /// Lowest and highest coordinates of each.
    bounds: Vec<[Point; 2]>,
    cubes: HashMap<[i64; 3], Vec<usize>>,
    side: f64,
    reach: f64,
}

impl Near {
    /// Of a mesh, with a reach in metres.
    pub fn new(mesh: &Mesh, reach: f64) -> Self {
        let side = reach.max(LEAST_SIDE_M);
        let triangles: Vec<_> = mesh.triangles.iter().map(|&t| corners(mesh, t)).collect();
        let bounds: Vec<_> = triangles.iter().map(|[a, b, c]| [a.inf(b).inf(c), a.sup(b).sup(c)]).collect();
        let mut cubes: HashMap<_, Vec<usize>> = HashMap::new();
        for (index, [low, high]) in bounds.iter().enumerate() {
            let first = low.map(|c| ((c - reach) / side).floor() as i64);
            let last = high.map(|c| ((c + reach) / side).floor() as i64);
            for x in first.x..=last.x {
                for y in first.y..=last.y {
                    for z in first.z..=last.z {
                        cubes.entry([x, y, z]).or_default().push(index);
                    }
                }
            }
        }
        Self { triangles, bounds, cubes, side, reach }
    }

    /// The distance of a point in metres; the reach, if it is further.
    pub fn distance(&self, point: Point) -> f64 {
        let cube = std::array::from_fn(|i| (point[i] / self.side).floor() as i64);
        let near = self.cubes.get(&cube).map(Vec::as_slice).unwrap_or_default();
        near.iter().fold(self.reach, |least, &index| {
            if distance_to_box(point, self.bounds[index]) >= least {
                return least;
            }
            least.min(distance_to_triangle(point, self.triangles[index]))
        })
    }
}

fn distance_to_box(point: Point, [low, high]: [Point; 2]) -> f64 {
    (low - point).sup(&(point - high)).sup(&Point::zeros()).norm()
}

/// The corners of a triangle in metres.
pub fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [Point; 3] {
    triangle.map(|corner| Point::from(mesh.positions[corner as usize].map(f64::from)) / f64::from(QUANTA_PER_M))
}

/// Points of a triangle, its corners among them, no further apart than `spacing` along its sides.
pub fn spread([a, b, c]: [Point; 3], spacing: f64) -> impl Iterator<Item = Point> {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    let n = (longest / spacing).ceil().max(1.0) as usize;
    (0..=n).flat_map(move |i| {
        (0..=n - i).map(move |j| {
            let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
            a + (b - a) * u + (c - a) * v
        })
    })
}

/// Ericson, *Real-Time Collision Detection* (2005), 5.1.5: inside the prism over the triangle, or to an edge.
fn distance_to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (to - from).cross(&(p - from)).dot(&normal) >= 0.0);
    if inside {
        return (p - a).dot(&normal).abs() / normal.norm();
    }
    [(a, b), (b, c), (c, a)].iter().map(|&(a, b)| distance_to_edge(p, a, b)).fold(f64::MAX, f64::min)
}

fn distance_to_edge(p: Point, a: Point, b: Point) -> f64 {
    let along = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
    (p - a - (b - a) * along).norm()
}
