//! The coarse surface on a lattice of the world, from which it is interpolated.
//!
//! Values are interpolated to third order, from values and gradients of the eight nodes around a point; gradients linearly.
//! Nodes are functions of their position alone, so the result is a function of the point alone as well.

use super::Columns;
use crate::material::{BLOCK, CHANNELS, CoarseBlock, JETS, OVERSHOOT};
use crate::noise::{Ints, Lanes, dispatched, inlined};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Index of a node, or of the cell between it and the next ones along each axis.
type Index = [i32; 3];
/// Numbers at a node.
type Record = [f32; CHANNELS];

/// Nodes evaluated so far.
#[derive(Debug)]
pub(super) struct Lattice {
    step_m: f32,
    slots: FxHashMap<Index, u32>,
    records: Vec<Record>,
    numbers: FxHashMap<Index, u32>,
    cells: Vec<Cell>,
}

/// A cell whose nodes have been evaluated.
#[derive(Clone, Copy, Debug)]
struct Cell {
    index: Index,
    /// Its nodes; x varies fastest.
    slots: [u32; 8],
}

/// Consecutive points in one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Run {
    /// Number of the cell in the lattice.
    cell: u32,
    /// The first point.
    pub start: u32,
    /// The number of points.
    pub len: u32,
}

impl Run {
    pub fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }
}

impl Lattice {
    /// An empty lattice for texels of this size: as coarse as what it holds allows.
    pub fn new(texel_m: f32) -> Self {
        /// Spacing of nodes in metres, a power of two so that their positions are exact. Tuned: at most a fifth of the
        /// shortest wavelength, and finer textures show what is lost.
        const STEPS_M: [f32; 2] = [1.0 / 16.0, 1.0 / 8.0];
        Self {
            step_m: STEPS_M[usize::from(texel_m > 0.02)],
            slots: FxHashMap::default(),
            records: vec![],
            numbers: FxHashMap::default(),
            cells: vec![],
        }
    }

    /// Runs of consecutive points in the same cell. `evaluate` appends the records at some positions near each other; it is
    /// asked for the nodes around these cells that have not been evaluated yet.
    pub fn runs(&mut self, points: Columns, evaluate: impl FnMut(&[[f32; 3]], &mut Vec<Record>)) -> Vec<Run> {
        let per_m = 1.0 / self.step_m;
        let [x, y, z] = points.map(|column| dispatched!(simd => floors(simd, column, per_m)));
        let known = self.cells.len();
        let mut runs: Vec<Run> = vec![];
        let mut last = [i32::MIN; 3];
        for (start, ((x, y), z)) in (0..).zip(x.into_iter().zip(y).zip(z)) {
            if let Some(run) = runs.last_mut()
                && last == [x, y, z]
            {
                run.len += 1;
                continue;
            }
            last = [x, y, z];
            runs.push(Run { cell: self.number(last), start, len: 1 });
        }
        self.evaluate(known, evaluate);
        runs
    }

    /// The number of a cell, which is new if it has none.
    fn number(&mut self, index: Index) -> u32 {
        *self.numbers.entry(index).or_insert_with(|| {
            self.cells.push(Cell { index, slots: [0; 8] });
            self.cells.len() as u32 - 1
        })
    }

    /// Evaluates the nodes of the cells from number `known` on.
    fn evaluate(&mut self, known: usize, mut evaluate: impl FnMut(&[[f32; 3]], &mut Vec<Record>)) {
        let mut missing: Vec<Index> = vec![];
        for node in self.cells[known..].iter().flat_map(|cell| corners(cell.index)) {
            self.slots.entry(node).or_insert_with(|| {
                missing.push(node);
                0
            });
        }
        missing.sort_unstable_by_key(|node| (node.map(|c| c >> 6), node.map(|c| c >> 2), *node));
        for together in missing.chunk_by(|a, b| a.map(|c| c >> 6) == b.map(|c| c >> 6)) {
            for (slot, node) in (self.records.len() as u32..).zip(together) {
                self.slots.insert(*node, slot);
            }
            let positions: Vec<[f32; 3]> = together.iter().map(|node| node.map(|c| c as f32 * self.step_m)).collect();
            evaluate(&positions, &mut self.records);
        }
        for cell in &mut self.cells[known..] {
            cell.slots = corners(cell.index).map(|node| self.slots[&node]);
        }
    }

    fn around(&self, cell: u32) -> (Index, [&Record; 8]) {
        let Cell { index, slots } = self.cells[cell as usize];
        (index, slots.map(|slot| &self.records[slot as usize]))
    }

    /// The coarse field and its gradient at each of the points, which are in these runs.
    pub fn fields(&self, runs: &[Run], points: Columns) -> [Vec<f32>; 4] {
        // Vectors read and write beyond the end of a run.
        let points = points.map(|column| [column, &[0.0; OVERSHOOT]].concat());
        let mut fields = [(); 4].map(|()| vec![0.0; points[0].len()]);
        dispatched!(simd => fields_in(simd, self, runs, &points, &mut fields));
        fields
    }

    /// Fills the block with the coarse surface at its points, which are in these runs.
    pub fn fill(&self, runs: &[Run], block: &mut CoarseBlock) {
        dispatched!(simd => fill(simd, self, runs, block));
    }
}

/// The largest multiples of `1 / per_m` that are not above the coordinates.
#[inline(always)]
fn floors<S: Simd>(simd: S, coordinates: &[f32], per_m: f32) -> Vec<i32> {
    let len = Lanes::<S>::LEN;
    let mut floors = vec![0; coordinates.len().next_multiple_of(len)];
    for (from, to) in coordinates.chunks(len).zip(floors.chunks_exact_mut(len)) {
        let lanes = Lanes::<S>::from_fn(simd, |lane| from[lane.min(from.len() - 1)]);
        (lanes * per_m).floor().to_int::<Ints<S>>().store_slice(to);
    }
    floors.truncate(coordinates.len());
    floors
}

/// Splits runs into blocks of [`BLOCK`] points: the points of each block in the order of the runs. Successive runs in one cell
/// become one.
pub(super) fn blocks(runs: &[Run]) -> Vec<Vec<Run>> {
    let mut blocks: Vec<Vec<Run>> = vec![];
    let mut filled = BLOCK as u32;
    for run in runs {
        let mut rest = *run;
        while rest.len > 0 {
            if filled == BLOCK as u32 {
                blocks.push(vec![]);
                filled = 0;
            }
            let len = rest.len.min(BLOCK as u32 - filled);
            let block = blocks.last_mut().expect("there is a block");
            match block.last_mut() {
                Some(last) if last.cell == rest.cell => last.len += len,
                _ => block.push(Run { start: filled, len, ..rest }),
            }
            (rest.start, rest.len, filled) = (rest.start + len, rest.len - len, filled + len);
        }
    }
    blocks
}

/// The nodes around a cell; x varies fastest.
fn corners(cell: Index) -> [Index; 8] {
    std::array::from_fn(|corner| std::array::from_fn(|axis| cell[axis] + (corner >> axis & 1) as i32))
}

/// Points of one vector in a cell: their distances from its lower and upper nodes along each axis, and the weight of each node.
struct Place<S: Simd> {
    off_m: [[Lanes<S>; 2]; 3],
    weights: [Lanes<S>; 8],
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn of(simd: S, cell: Index, step_m: f32, point: [Lanes<S>; 3]) -> Self {
        let off = inlined!(|axis: usize| {
            let low = Lanes::<S>::splat(simd, cell[axis] as f32 * step_m);
            let above = point[axis] - low;
            [above, above - step_m]
        });
        let off_m = [off(0), off(1), off(2)];
        let part = inlined!(|axis: usize| {
            let t = off_m[axis][0] * (1.0 / step_m);
            [-t + 1.0, t]
        });
        let [x, y, z] = [part(0), part(1), part(2)];
        let flat = [x[0] * y[0], x[1] * y[0], x[0] * y[1], x[1] * y[1]];
        let weight = inlined!(|corner: usize| flat[corner & 3] * z[corner >> 2]);
        let weights = [weight(0), weight(1), weight(2), weight(3), weight(4), weight(5), weight(6), weight(7)];
        Self { off_m, weights }
    }

    #[inline(always)]
    fn sum(&self, nodes: &[&Record; 8], channel: usize, corners: [usize; 4]) -> Lanes<S> {
        let term = inlined!(|n: usize| self.weights[corners[n]] * nodes[corners[n]][channel]);
        (term(0) + term(1)) + (term(2) + term(3))
    }

    #[inline(always)]
    fn scalar(&self, nodes: &[&Record; 8], channel: usize) -> Lanes<S> {
        self.sum(nodes, channel, [0, 1, 2, 3]) + self.sum(nodes, channel, [4, 5, 6, 7])
    }

    /// Value and gradient of the quantity whose value is in `channel`.
    #[inline(always)]
    fn jet(&self, nodes: &[&Record; 8], channel: usize) -> [Lanes<S>; 4] {
        /// Corners on the lower and on the upper side of each axis.
        const SIDES: [[[usize; 4]; 2]; 3] =
            [[[0, 2, 4, 6], [1, 3, 5, 7]], [[0, 1, 4, 5], [2, 3, 6, 7]], [[0, 1, 2, 3], [4, 5, 6, 7]]];
        let along = inlined!(|axis: usize| {
            let side = inlined!(|n: usize| self.sum(nodes, channel + 1 + axis, SIDES[axis][n]));
            let sides = [side(0), side(1)];
            let rise = sides[0] * self.off_m[axis][0] + sides[1] * self.off_m[axis][1];
            (sides[0] + sides[1], rise)
        });
        let [x, y, z] = [along(0), along(1), along(2)];
        [self.scalar(nodes, channel) + (x.1 + y.1 + z.1) * 0.5, x.0, y.0, z.0]
    }
}

#[inline(always)]
fn fields_in<S: Simd>(simd: S, lattice: &Lattice, runs: &[Run], points: &[Vec<f32>; 3], out: &mut [Vec<f32>; 4]) {
    let len = Lanes::<S>::LEN;
    for run in runs {
        let (cell, nodes) = lattice.around(run.cell);
        // Vectors overshoot a run; the next one overwrites that.
        for at in run.range().step_by(len) {
            let axis = inlined!(|k: usize| Lanes::<S>::from_slice(simd, &points[k][at..at + len]));
            let place = Place::of(simd, cell, lattice.step_m, [axis(0), axis(1), axis(2)]);
            for (lanes, out) in place.jet(&nodes, 0).into_iter().zip(&mut *out) {
                lanes.store_slice(&mut out[at..at + len]);
            }
        }
    }
}

#[inline(always)]
fn fill<S: Simd>(simd: S, lattice: &Lattice, runs: &[Run], block: &mut CoarseBlock) {
    let len = Lanes::<S>::LEN;
    for run in runs {
        let (cell, nodes) = lattice.around(run.cell);
        // Vectors overshoot a run; the next one or the padding overwrites that.
        for at in run.range().step_by(len) {
            let axis = inlined!(|k: usize| Lanes::<S>::from_slice(simd, &block.point[k][at..at + len]));
            let place = Place::of(simd, cell, lattice.step_m, [axis(0), axis(1), axis(2)]);
            for n in 0..JETS {
                for (channel, lanes) in (4 * n..).zip(place.jet(&nodes, 4 * n)) {
                    block.put::<S>(channel, at, lanes);
                }
            }
            for channel in 4 * JETS..CHANNELS {
                block.put::<S>(channel, at, place.scalar(&nodes, channel));
            }
        }
    }
    block.pad();
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::material::Ground;
    use crate::noise::Source;

    /// A quadratic of its position in every channel, with its gradient where the channel is a jet.
    fn record([x, y, z]: [f32; 3]) -> Record {
        let jet = [x * x + y * z - z, 2.0 * x, z, y - 1.0];
        std::array::from_fn(|channel| if channel < 4 * JETS { jet[channel % 4] } else { x - y + 0.5 * z })
    }

    fn sampled() -> (Lattice, Vec<Run>, CoarseBlock) {
        let mut lattice = Lattice::new(0.01);
        let columns: [Vec<f32>; 3] = [0.013, -0.007, 0.005].map(|step| (0..50).map(|n| n as f32 * step).collect());
        let points = columns.each_ref().map(Vec::as_slice);
        let runs = lattice.runs(points, |positions, records| records.extend(positions.iter().copied().map(record)));
        let mut block = CoarseBlock::new(Ground { roughness_m: 0.1, natural: 1.0 }, Source::new(1));
        block.place(points);
        (lattice, runs, block)
    }

    #[test]
    fn quadratics_are_interpolated_exactly() {
        let (lattice, runs, mut block) = sampled();
        lattice.fill(&runs, &mut block);
        for lane in 0..block.count {
            let exact = record(block.point.map(|column| column[lane]));
            for (channel, (found, exact)) in block.record(lane).into_iter().zip(exact).enumerate() {
                assert!((found - exact).abs() < 1e-5, "channel {channel}: {found} instead of {exact}");
            }
        }
    }

    #[test]
    fn interpolation_is_the_same_on_every_width() {
        let (lattice, runs, block) = sampled();
        let level = fearless_simd::Level::new();
        let filled = |fill: &dyn Fn(&mut CoarseBlock)| {
            let mut block = block.clone();
            fill(&mut block);
            (0..block.count).map(|lane| block.record(lane).map(f32::to_bits)).collect::<Vec<_>>()
        };
        let narrow = filled(&|block| fill(level.as_sse2().expect("part of every x86-64"), &lattice, &runs, block));
        if let Some(avx2) = level.as_avx2() {
            assert!(narrow == filled(&|block| fill(avx2, &lattice, &runs, block)));
        }
        if let Some(avx512) = level.as_avx512() {
            assert!(narrow == filled(&|block| fill(avx512, &lattice, &runs, block)));
        }
    }
}
