//! Nearest-triangle queries for points close to a surface, with precomputed lists per cube of space.

use rustc_hash::FxHashMap;

use super::super::nearest::{Ball, Found, Nearest, Point, Triangle, squared_distance};

/// Side of a cube, in units of the reach. Tuned.
const SIDE: f64 = 2.0;

/// A surface, indexed by cubes of space near it.
pub(super) struct Cells {
    /// The lists serve points up to this distance from the surface.
    reach: f64,
    /// The triangles near some point of a cube.
    lists: FxHashMap<[i32; 3], Vec<u32>>,
    surface: Vec<Triangle>,
    balls: Vec<Ball>,
    /// The fallback for points further away.
    tree: Nearest,
}

impl Cells {
    /// Indexes a surface of at least one triangle.
    pub(super) fn new(surface: Vec<Triangle>, reach: f64) -> Self {
        let balls = surface.iter().map(Ball::around).collect();
        let mut cells = Self { reach, lists: FxHashMap::default(), balls, tree: Nearest::new(&surface), surface };
        for index in 0..cells.surface.len() {
            cells.list(index);
        }
        cells
    }

    fn list(&mut self, index: usize) {
        let side = SIDE * self.reach;
        let triangle = self.surface[index];
        let [a, b, c] = triangle;
        let low = self.cube(a.inf(&b).inf(&c).add_scalar(-self.reach));
        let high = self.cube(a.sup(&b).sup(&c).add_scalar(self.reach));
        let far = self.reach + side * 0.75f64.sqrt();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let centre = Point::new(x.into(), y.into(), z.into()).add_scalar(0.5) * side;
                    if squared_distance(centre, triangle) <= far * far {
                        self.lists.entry([x, y, z]).or_default().push(index as u32);
                    }
                }
            }
        }
    }

    /// A superset of the triangles near a point.
    pub(super) fn near(&self, point: Point) -> &[u32] {
        self.lists.get(&self.cube(point)).map(Vec::as_slice).unwrap_or_default()
    }

    /// The squared distance of a point to a triangle.
    pub(super) fn squared_distance(&self, point: Point, index: u32) -> f64 {
        squared_distance(point, self.surface[index as usize])
    }

    /// The triangle nearest to a point.
    pub(super) fn nearest(&self, point: Point) -> Found {
        let list = self.near(point);
        let (mut best, mut squared, mut distance) = (0, f64::INFINITY, f64::INFINITY);
        for &index in list {
            if self.balls[index as usize].is_beyond(point, distance) {
                continue;
            }
            let other = self.squared_distance(point, index);
            if other < squared {
                (best, squared, distance) = (index, other, other.sqrt());
            }
        }
        if squared > self.reach * self.reach {
            return self.tree.nearest(point);
        }
        Found { triangle: self.surface[best as usize], index: best, squared }
    }

    fn cube(&self, point: Point) -> [i32; 3] {
        (point / (SIDE * self.reach)).map(|c| c.floor() as i32).into()
    }
}
