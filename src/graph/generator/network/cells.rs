//! Things by cubic cell of space, for questions about neighbours.

use nalgebra::Point3;
use rustc_hash::FxHashMap;

/// What lies in each cell; a thing lies in all cells that its box touches.
pub(in crate::graph::generator) struct Cells<T> {
    side_m: f64,
    cells: FxHashMap<[i32; 3], Vec<T>>,
}

impl<T: Copy + PartialEq> Cells<T> {
    pub(in crate::graph::generator) fn new(side_m: f64) -> Self {
        Self { side_m, cells: FxHashMap::default() }
    }

    /// Adds a thing that lies in the box round two points.
    pub(in crate::graph::generator) fn add(&mut self, thing: T, ends: [&Point3<f64>; 2]) {
        for key in self.keys(ends, 0.0) {
            self.cells.entry(key).or_default().push(thing);
        }
    }

    /// Removes what was added with these points.
    pub(in crate::graph::generator) fn remove(&mut self, thing: T, ends: [&Point3<f64>; 2]) {
        for key in self.keys(ends, 0.0) {
            if let Some(cell) = self.cells.get_mut(&key) {
                cell.retain(|&other| other != thing);
            }
        }
    }

    /// Things that may lie within `reach_m` of the box round two points; some come more than once.
    pub(in crate::graph::generator) fn near(&self, ends: [&Point3<f64>; 2], reach_m: f64) -> impl Iterator<Item = T> {
        let cells = self.keys(ends, reach_m).filter_map(|key| self.cells.get(&key));
        cells.flat_map(|cell| cell.iter().copied())
    }

    fn keys(&self, [a, b]: [&Point3<f64>; 2], reach_m: f64) -> impl Iterator<Item = [i32; 3]> + use<T> {
        let key = |corner: Point3<f64>, off: f64| corner.coords.map(|x| ((x + off) / self.side_m).floor() as i32);
        let (low, high) = (key(a.inf(b), -reach_m), key(a.sup(b), reach_m));
        (low.x..=high.x).flat_map(move |x| (low.y..=high.y).flat_map(move |y| (low.z..=high.z).map(move |z| [x, y, z])))
    }
}
