//! A sparse grid of cubic cells, in blocks of 8 × 8 × 8.

use rustc_hash::FxHashMap;

/// Cells along a side of a block.
pub const SIDE: usize = 8;

/// Cells of a block.
pub const CELLS: usize = SIDE * SIDE * SIDE;

/// A block of cells.
pub struct Block<T> {
    /// Which it is along x, y and z: its first cell has eight times these numbers.
    pub place: [i32; 3],
    /// Its cells, those along z next to each other, then those along y.
    pub cells: Box<[T; CELLS]>,
}

/// Blocks by place. Cells without a block are empty.
pub(super) struct Blocks<T> {
    empty: T,
    numbers: FxHashMap<[i32; 3], usize>,
    blocks: Vec<Block<T>>,
}

impl<T: Copy> Blocks<T> {
    pub fn new(empty: T) -> Self {
        Self { empty, numbers: FxHashMap::default(), blocks: Vec::new() }
    }

    /// The cells of a block, made if it is not there.
    pub fn entry(&mut self, place: [i32; 3]) -> &mut [T; CELLS] {
        let number = *self.numbers.entry(place).or_insert_with(|| {
            self.blocks.push(Block { place, cells: Box::new([self.empty; CELLS]) });
            self.blocks.len() - 1
        });
        &mut self.blocks[number].cells
    }

    /// A cell, whose block is made if it is not there.
    pub fn cell_mut(&mut self, cell: [i32; 3]) -> &mut T {
        let [i, j, k] = cell.map(|n| n.rem_euclid(SIDE as i32) as usize);
        &mut self.entry(cell.map(|n| n.div_euclid(SIDE as i32)))[(i * SIDE + j) * SIDE + k]
    }

    /// Combines the cells of a block with those of another one at its place.
    pub fn join(&mut self, place: [i32; 3], cells: impl Iterator<Item = T>, combine: fn(T, T) -> T) {
        self.entry(place).iter_mut().zip(cells).for_each(|(own, other)| *own = combine(*own, other));
    }

    /// All blocks, by place.
    pub fn into_sorted(mut self) -> Vec<Block<T>> {
        self.blocks.sort_unstable_by_key(|block| block.place);
        self.blocks
    }
}
