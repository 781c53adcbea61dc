//! The chamber with changed chunks.

use std::io;

use plume_exporters::scene::{Chunk, Chunks, Piece};

use crate::sample::Chamber;

/// The chunks of the chamber, each modified by `change`.
pub struct Changed<'a, F> {
    /// The original chunks.
    pub inner: &'a Chamber,
    /// The modification, given the index and the loaded chunk.
    pub change: F,
}

impl<F: Fn(usize, Chunk) -> io::Result<Chunk> + Sync> Chunks for Changed<'_, F> {
    fn len(&self) -> usize {
        self.inner.len()
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        (self.change)(index, self.inner.load(index)?)
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        self.inner.neighbors(index)
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        self.inner.pieces(index)
    }
}
