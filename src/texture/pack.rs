//! Packs charts into a square by their shapes.
//!
//! First fit, largest first, on a coarse grid: a chart takes the lowest, then leftmost place where its cells are free. Chart
//! shapes are rows of runs, and a run that hits an occupied cell moves the chart past it in one step.

use std::ops::Range;

use super::chart::{Chart, Scale};
use super::raster::{self, SUBTEXELS};
use crate::mesh::Mesh;

/// Minimum number of texels between two charts at a density, in both directions, excluding all texels touched by either of
/// them: an eighth of a metre, so that mip levels of eight texels a metre and more mix hardly any of another chart. Coarse
/// atlases have at least what bilinear lookups need.
pub fn gutter_px(texels_per_m: f32) -> u32 {
    2 * ((texels_per_m / 16.0).round() as u32).clamp(2, 8)
}

/// Cells along the side of the grid; larger atlases get larger cells. Tuned: finer packs hardly better and slower.
const GRID: u32 = 1024;

/// The lower left texel of each chart in a square of `size_px`, or `None` if they do not fit.
pub(super) fn pack(mesh: &Mesh, charts: &[Chart], scale: Scale, size_px: u32) -> Option<Vec<[u32; 2]>> {
    let cell_px = size_px.div_ceil(GRID);
    let gutter = gutter_px(scale.texels_per_m()).div_ceil(cell_px);
    let grid_size = size_px / cell_px;
    let stamps: Vec<Stamp> = charts.iter().map(|chart| Stamp::new(mesh, chart, scale, cell_px, gutter)).collect();
    if stamps.iter().map(|stamp| stamp.area).sum::<u64>() > u64::from(grid_size).pow(2) {
        return None;
    }
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by_key(|&k| (std::cmp::Reverse((stamps[k].height(), stamps[k].width)), k));
    let mut grid = Grid::new(grid_size);
    let mut origins = vec![[0; 2]; charts.len()];
    for k in order {
        let [x, y] = grid.find(&stamps[k])?;
        grid.press(&stamps[k], x, y);
        // Half a gutter at the left and lower border; a stamp has a whole one on its right and above.
        origins[k] = [x, y].map(|cells| cells * cell_px + gutter * cell_px / 2);
    }
    Some(origins)
}

/// A chart as cells, including its gutter on the right and above.
struct Stamp {
    width: u32,
    rows: Vec<Vec<Range<u32>>>,
    area: u64,
}

impl Stamp {
    fn new(mesh: &Mesh, chart: &Chart, scale: Scale, cell_px: u32, gutter: u32) -> Self {
        let side = SUBTEXELS * cell_px as i32;
        let [width, height] = chart.size(scale).map(|steps| (steps / side) as u32 + 1 + gutter);
        let mut bits = Bits::new(width, height);
        for &t in &chart.triangles {
            raster::touched(&chart.corners(mesh, t, scale), side, |row, columns| {
                let columns = columns.start.max(0) as u32..(columns.end as u32 + gutter).min(width);
                bits.set(row as u32, columns);
            });
        }
        bits.smear_up(gutter);
        let rows: Vec<_> = (0..height).map(|y| bits.runs(y)).collect();
        let area = rows.iter().flatten().map(|run| u64::from(run.end - run.start)).sum();
        Self { width, rows, area }
    }

    fn height(&self) -> u32 {
        self.rows.len() as u32
    }
}

/// The square to fill.
struct Grid {
    size: u32,
    taken: Bits,
}

impl Grid {
    fn new(size: u32) -> Self {
        Self { size, taken: Bits::new(size, size) }
    }

    fn find(&self, stamp: &Stamp) -> Option<[u32; 2]> {
        let last_row = self.size.checked_sub(stamp.height())?;
        let last_column = self.size.checked_sub(stamp.width)?;
        (0..=last_row).find_map(|y| Some([self.find_in_row(stamp, y, last_column)?, y]))
    }

    fn find_in_row(&self, stamp: &Stamp, y: u32, last_column: u32) -> Option<u32> {
        let (mut x, mut free_rows, mut row) = (0, 0, 0);
        while free_rows < stamp.rows.len() {
            match self.step_past(&stamp.rows[row], x, y + row as u32) {
                // The row that blocked is the most likely to block again, so continue with it.
                Some(next) if next > last_column => return None,
                Some(next) => (x, free_rows) = (next, 0),
                None => {
                    free_rows += 1;
                    row = (row + 1) % stamp.rows.len();
                }
            }
        }
        Some(x)
    }

    /// The smallest shift past the obstacle of one of `runs`, `None` if all are free.
    fn step_past(&self, runs: &[Range<u32>], x: u32, y: u32) -> Option<u32> {
        runs.iter().find_map(|run| {
            let blocker = self.taken.last_in(y, x + run.start..x + run.end)?;
            Some(blocker + 1 - run.start)
        })
    }

    fn press(&mut self, stamp: &Stamp, x: u32, y: u32) {
        for (row, runs) in stamp.rows.iter().enumerate() {
            for run in runs {
                self.taken.set(y + row as u32, x + run.start..x + run.end);
            }
        }
    }
}

/// A bitmap.
struct Bits {
    words_per_row: usize,
    width: u32,
    words: Vec<u64>,
}

impl Bits {
    fn new(width: u32, height: u32) -> Self {
        let words_per_row = width.div_ceil(64) as usize;
        Self { words_per_row, width, words: vec![0; words_per_row * height as usize] }
    }

    fn row(&self, y: u32) -> &[u64] {
        &self.words[y as usize * self.words_per_row..][..self.words_per_row]
    }

    /// Sets the (not empty) range in row `y`.
    fn set(&mut self, y: u32, range: Range<u32>) {
        let row = &mut self.words[y as usize * self.words_per_row..][..self.words_per_row];
        for (word, mask) in masks(range) {
            row[word] |= mask;
        }
    }

    /// The last set bit of row `y` within the (not empty) range.
    fn last_in(&self, y: u32, range: Range<u32>) -> Option<u32> {
        let row = self.row(y);
        masks(range).rev().find_map(|(word, mask)| {
            let hit = row[word] & mask;
            (hit != 0).then(|| word as u32 * 64 + 63 - hit.leading_zeros())
        })
    }

    /// Also sets the `rows` bits above every set bit.
    fn smear_up(&mut self, rows: u32) {
        let step = self.words_per_row;
        for _ in 0..rows {
            for k in (step..self.words.len()).rev() {
                self.words[k] |= self.words[k - step];
            }
        }
    }

    fn runs(&self, y: u32) -> Vec<Range<u32>> {
        let row = self.row(y);
        let is_set = |x: u32| row[x as usize / 64] >> (x % 64) & 1 == 1;
        let mut runs: Vec<Range<u32>> = vec![];
        for x in (0..self.width).filter(|&x| is_set(x)) {
            match runs.last_mut() {
                Some(run) if run.end == x => run.end += 1,
                _ => runs.push(x..x + 1),
            }
        }
        runs
    }
}

/// The words of a (not empty) range of bits, each with its mask.
fn masks(range: Range<u32>) -> impl DoubleEndedIterator<Item = (usize, u64)> {
    let (first, last) = (range.start as usize / 64, (range.end - 1) as usize / 64);
    (first..=last).map(move |word| {
        let low = if word == first { u64::MAX << (range.start % 64) } else { u64::MAX };
        let high = if word == last { u64::MAX >> (63 - (range.end - 1) % 64) } else { u64::MAX };
        (word, low & high)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(rows: &[&[[u32; 2]]]) -> Stamp {
        let runs = |row: &&[[u32; 2]]| row.iter().map(|&[start, end]| start..end).collect();
        let rows: Vec<Vec<_>> = rows.iter().map(runs).collect();
        let width = rows.iter().flatten().map(|run| run.end).max().unwrap();
        Stamp { width, rows, area: 0 }
    }

    #[test]
    fn a_stamp_goes_to_the_lowest_free_place_even_inside_another() {
        let mut grid = Grid::new(80);
        let ring = stamp(&[&[[0, 70]], &[[0, 3], [66, 70]], &[[0, 70]]]);
        let at = grid.find(&ring).unwrap();
        grid.press(&ring, at[0], at[1]);
        assert_eq!(at, [0, 0]);
        assert_eq!(grid.find(&stamp(&[&[[0, 63]]])), Some([3, 1]));
        assert_eq!(grid.find(&stamp(&[&[[0, 64]]])), Some([0, 3]));
        assert_eq!(grid.find(&stamp(&[&[[0, 81]]])), None);
    }
}
