//! A spatial hash of stations and passages in square cells of the plan.

use nalgebra::Point3;
use rustc_hash::FxHashMap;

/// Size of a cell in metres.
const CELL_M: f64 = 8.0;

/// Cell index, west to east and south to north; a tuple, because arrays are hashed like slices, which takes longer.
type Key = (i32, i32);

/// The content of each cell.
#[derive(Default)]
pub(super) struct Grid {
    cells: FxHashMap<Key, Cell>,
}

#[derive(Default)]
struct Cell {
    stations: Vec<usize>,
    passages: Vec<[usize; 2]>,
}

impl Grid {
    pub(super) fn add_station(&mut self, station: usize, at: &Point3<f64>) {
        let cell = self.cells.entry(key(at.x, at.y)).or_default();
        cell.stations.push(station);
    }

    pub(super) fn remove_station(&mut self, station: usize, at: &Point3<f64>) {
        if let Some(cell) = self.cells.get_mut(&key(at.x, at.y)) {
            cell.stations.retain(|&other| other != station);
        }
    }

    pub(super) fn add_passage(&mut self, passage: [usize; 2], ends: [&Point3<f64>; 2]) {
        for key in keys(ends, 0.0) {
            self.cells.entry(key).or_default().passages.push(passage);
        }
    }

    pub(super) fn remove_passage(&mut self, passage: [usize; 2], ends: [&Point3<f64>; 2]) {
        for key in keys(ends, 0.0) {
            if let Some(cell) = self.cells.get_mut(&key) {
                cell.passages.retain(|&other| other != passage);
            }
        }
    }

    /// Stations that may be within `reach` of `at` in the plan.
    pub(super) fn stations_near(&self, at: &Point3<f64>, reach: f64) -> impl Iterator<Item = usize> {
        let cells = keys([at, at], reach).filter_map(|key| self.cells.get(&key));
        cells.flat_map(|cell| cell.stations.iter().copied())
    }

    /// Passages that may be within `reach` of the passage between `ends` in the plan; some appear twice.
    pub(super) fn passages_near(&self, ends: [&Point3<f64>; 2], reach: f64) -> impl Iterator<Item = [usize; 2]> {
        let cells = keys(ends, reach).filter_map(|key| self.cells.get(&key));
        cells.flat_map(|cell| cell.passages.iter().copied())
    }
}

fn key(x: f64, y: f64) -> Key {
    ((x / CELL_M).floor() as i32, (y / CELL_M).floor() as i32)
}

fn keys([a, b]: [&Point3<f64>; 2], reach: f64) -> impl Iterator<Item = Key> + use<> {
    let low = key(a.x.min(b.x) - reach, a.y.min(b.y) - reach);
    let high = key(a.x.max(b.x) + reach, a.y.max(b.y) + reach);
    (low.0..=high.0).flat_map(move |x| (low.1..=high.1).map(move |y| (x, y)))
}
