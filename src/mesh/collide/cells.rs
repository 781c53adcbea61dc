//! Nearest-triangle queries for points close to a surface, with precomputed lists per cube of space.

use rustc_hash::FxHashMap;

use super::super::nearest::{Ball, Found, Nearest, Point, Triangle, squared_distance};

/// Side of a cube, in units of the reach. Tuned.
const SIDE: f64 = 2.0;

/// A surface, indexed by cubes of space near it.
pub(super) struct Cells {
    /// The lists serve points up to this distance from the surface.
    reach: f64,
    /// The triangles near some point of a cube, by their distance from its centre.
    lists: FxHashMap<[i32; 3], Vec<Entry>>,
    surface: Vec<Triangle>,
    balls: Vec<Ball>,
    /// The fallback for points further away.
    tree: Nearest,
}

/// A triangle in the list of a cube.
struct Entry {
    /// Distance from the centre of the cube.
    from_centre: f64,
    index: u32,
}

impl Cells {
    /// Indexes a surface of at least one triangle.
    pub(super) fn new(surface: Vec<Triangle>, reach: f64) -> Self {
        let balls = surface.iter().map(Ball::around).collect();
        let mut cells = Self { reach, lists: FxHashMap::default(), balls, tree: Nearest::new(&surface), surface };
        for index in 0..cells.surface.len() {
            cells.enter(index);
        }
        let order = |a: &Entry, b: &Entry| a.from_centre.total_cmp(&b.from_centre).then(a.index.cmp(&b.index));
        cells.lists.values_mut().for_each(|list| list.sort_unstable_by(order));
        cells
    }

    fn enter(&mut self, index: usize) {
        let side = SIDE * self.reach;
        let triangle = self.surface[index];
        let [a, b, c] = triangle;
        let low = self.cube(a.inf(&b).inf(&c).add_scalar(-self.reach));
        let high = self.cube(a.sup(&b).sup(&c).add_scalar(self.reach));
        let far = self.reach + side * 0.75f64.sqrt();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let squared = squared_distance(self.centre([x, y, z]), triangle);
                    if squared <= far * far {
                        let entry = Entry { from_centre: squared.sqrt(), index: index as u32 };
                        self.lists.entry([x, y, z]).or_default().push(entry);
                    }
                }
            }
        }
    }

    fn list(&self, cube: [i32; 3]) -> &[Entry] {
        self.lists.get(&cube).map(Vec::as_slice).unwrap_or_default()
    }

    /// A superset of the triangles near a point.
    pub(super) fn near(&self, point: Point) -> impl Iterator<Item = u32> {
        self.list(self.cube(point)).iter().map(|entry| entry.index)
    }

    /// The squared distance of a point to a triangle.
    pub(super) fn squared_distance(&self, point: Point, index: u32) -> f64 {
        squared_distance(point, self.surface[index as usize])
    }

    /// The triangle nearest to a point.
    pub(super) fn nearest(&self, point: Point) -> Found {
        let cube = self.cube(point);
        let off_centre = (point - self.centre(cube)).norm();
        let (mut best, mut squared, mut distance) = (0, f64::INFINITY, f64::INFINITY);
        for &Entry { from_centre, index } in self.list(cube) {
            // So is the rest of the list.
            if from_centre - off_centre > distance {
                break;
            }
            if self.balls[index as usize].is_beyond(point, distance) {
                continue;
            }
            let other = self.squared_distance(point, index);
            if other < squared || (other == squared && index < best) {
                (best, squared, distance) = (index, other, other.sqrt());
            }
        }
        if squared > self.reach * self.reach {
            // The best of the list is in the tree, too.
            return self.tree.nearer(point, squared.next_up()).expect("there is a triangle");
        }
        Found { triangle: self.surface[best as usize], index: best, squared }
    }

    fn centre(&self, cube: [i32; 3]) -> Point {
        Point::from(cube.map(f64::from)).add_scalar(0.5) * (SIDE * self.reach)
    }

    fn cube(&self, point: Point) -> [i32; 3] {
        (point / (SIDE * self.reach)).map(|c| c.floor() as i32).into()
    }
}
