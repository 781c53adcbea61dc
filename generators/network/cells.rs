//! A spatial hash of items in cubic cells.

use std::ops::RangeInclusive;

use nalgebra::{Point3, Vector3};
use rustc_hash::FxHashMap;

/// The items of each cell; an item is in all cells that its box touches. Cells above one another form a column: a cave has
/// few of them, and one look-up finds them all.
pub(crate) struct Cells<T> {
    side_m: f64,
    columns: FxHashMap<(i32, i32), Column<T>>,
}

/// Items with the height of their cell, from the bottom up; within a cell, in the order in which they were added.
struct Column<T>(Vec<(i32, T)>);

impl<T: Copy + PartialEq> Cells<T> {
    pub(crate) fn new(side_m: f64) -> Self {
        Self { side_m, columns: FxHashMap::default() }
    }

    /// Adds an item with the bounding box of two points.
    pub(crate) fn add(&mut self, thing: T, ends: [&Point3<f64>; 2]) {
        let touched = self.within(ends, 0.0);
        for plan in touched.plan() {
            self.columns.entry(plan).or_insert_with(|| Column(Vec::new())).add(thing, touched.heights());
        }
    }

    /// Removes an item added with these points.
    pub(crate) fn remove(&mut self, thing: T, ends: [&Point3<f64>; 2]) {
        for plan in self.within(ends, 0.0).plan() {
            if let Some(column) = self.columns.get_mut(&plan) {
                column.0.retain(|&(_, other)| other != thing);
            }
        }
    }

    /// Items that may be within `reach_m` of the bounding box of two points; some appear more than once.
    pub(crate) fn near(&self, ends: [&Point3<f64>; 2], reach_m: f64) -> impl Iterator<Item = T> + use<'_, T> {
        let near = self.within(ends, reach_m);
        near.plan().filter_map(|plan| self.columns.get(&plan)).flat_map(move |column| column.between(near.heights()))
    }

    /// The cells within range of a box.
    fn within(&self, [a, b]: [&Point3<f64>; 2], reach_m: f64) -> Block {
        let cell = |corner: Point3<f64>, off: f64| corner.coords.map(|x| ((x + off) / self.side_m).floor() as i32);
        Block { low: cell(a.inf(b), -reach_m), high: cell(a.sup(b), reach_m) }
    }
}

/// Cells between two, inclusive.
#[derive(Clone, Copy)]
struct Block {
    low: Vector3<i32>,
    high: Vector3<i32>,
}

impl Block {
    fn plan(self) -> impl Iterator<Item = (i32, i32)> {
        let Self { low, high } = self;
        (low.x..=high.x).flat_map(move |x| (low.y..=high.y).map(move |y| (x, y)))
    }

    fn heights(self) -> RangeInclusive<i32> {
        self.low.z..=self.high.z
    }
}

impl<T: Copy> Column<T> {
    fn add(&mut self, thing: T, heights: RangeInclusive<i32>) {
        for height in heights {
            let place = self.0.partition_point(|&(other, _)| other <= height);
            self.0.insert(place, (height, thing));
        }
    }

    fn between(&self, heights: RangeInclusive<i32>) -> impl Iterator<Item = T> {
        let first = self.0.partition_point(|(height, _)| height < heights.start());
        let end = *heights.end();
        self.0[first..].iter().take_while(move |&&(height, _)| height <= end).map(|&(_, thing)| thing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::rng::Rng;

    #[test]
    fn near_items_are_found_until_they_are_removed() {
        let mut rng = Rng::new(plume_graph::seed::stream(1, "test", 0));
        let mut point = || Point3::from([40.0, 40.0, 20.0].map(|side: f64| rng.between(-side, side)));
        let boxes: Vec<[Point3<f64>; 2]> =
            (0..200).map(|_| point()).map(|at| [at, at + Vector3::new(3.0, -9.0, 7.0)]).collect();
        let mut cells = Cells::new(6.0);
        boxes.iter().enumerate().for_each(|(thing, [a, b])| cells.add(thing, [a, b]));
        boxes.iter().enumerate().step_by(2).for_each(|(thing, [a, b])| cells.remove(thing, [a, b]));
        for at in (0..50).map(|_| point()) {
            let found: Vec<usize> = cells.near([&at; 2], 10.0).collect();
            assert!(found.iter().all(|thing| thing % 2 == 1), "{found:?}");
            for (thing, [a, b]) in boxes.iter().enumerate().skip(1).step_by(2) {
                let apart = (a.inf(b) - at).sup(&(at - a.sup(b))).max();
                assert!(apart > 10.0 || found.contains(&thing), "{thing} is {apart} m away");
            }
        }
    }
}
