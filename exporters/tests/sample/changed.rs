//! The chamber with its chunks changed.

use std::io;

use plume_exporters::scene::{Chunk, Chunks, Piece};

use crate::sample::Chamber;

/// The chunks of the chamber, each as `change` makes it of its number and of what it was.
pub struct Changed<'a, F> {
    /// What they were.
    pub inner: &'a Chamber,
    /// What becomes of them.
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
