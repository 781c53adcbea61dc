//! What is told of the cells of a grid, on the disk.

use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::marker::PhantomData;
use std::path::Path;

use plume_truth::{Block, CELLS, SIDE};

use crate::chunk_files::{Stem, TempFile};
use crate::error::ExportError;
use crate::format::npy::{Archive, Number};
use crate::package::Package;

/// Blocks of cells, by place. Only their places are in memory.
pub struct Layer<N> {
    places: Vec<[i32; 3]>,
    /// The cells of all, as little-endian numbers.
    cells: TempFile,
    of: PhantomData<N>,
}

impl<N: Number> Layer<N> {
    /// No blocks; its file has this name in a scratch folder.
    pub fn new(name: &str, scratch: &Path) -> Result<Self, ExportError> {
        Ok(Self { places: Vec::new(), cells: Stem::new(name, scratch).grow(".cells")?, of: PhantomData })
    }

    /// Adds blocks.
    pub fn add(&mut self, blocks: &[Block<N>]) -> io::Result<()> {
        let mut bytes = Vec::new();
        for Block { place, cells } in blocks {
            self.places.push(*place);
            cells.iter().for_each(|cell| cell.push(&mut bytes));
        }
        self.cells.write_all(&bytes)
    }

    /// The places of its blocks.
    pub fn places(&self) -> &[[i32; 3]] {
        &self.places
    }

    /// Writes its arrays: side of a cell in metres, places of blocks, and under this name what is told.
    pub fn write(
        &mut self,
        scratch: &Path,
        path: &str,
        cell_m: f64,
        name: &str,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let (count, mut cells) = (self.places.len(), self.cells.reader()?);
        out.write_by(scratch, path, |file| {
            let mut archive = Archive::new(file);
            archive.add("cell_m", &[], [cell_m])?;
            archive.add("block", &[count, 3], self.places.as_flattened().iter().copied())?;
            archive.add_bytes::<N>(name, &[count, SIDE, SIDE, SIDE], &mut cells)?;
            Ok(archive.finish()?)
        })
    }
}

impl Layer<u8> {
    /// Reads the cells of blocks by their numbers.
    pub fn cells(&mut self) -> io::Result<impl FnMut(usize) -> io::Result<[u8; CELLS]> + use<>> {
        let mut file = self.cells.reader().map(BufReader::into_inner)?;
        Ok(move |number| {
            let mut cells = [0; CELLS];
            file.seek(SeekFrom::Start((number * CELLS) as u64))?;
            file.read_exact(&mut cells)?;
            Ok(cells)
        })
    }
}
