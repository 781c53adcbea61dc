//! Voxels and distances of a world that is larger than memory.
//!
//! Every part of the world is turned into what it contributes to each square of the map, which goes to a file at once. In the end
//! squares are made one after the other. A label is the largest, a distance the least, and the air follows from all crossings of a
//! column: so it makes no difference how the world is divided, or in which order its parts are added.
//!
//! In memory are one part or one square, and 72 bytes for each square that a part reaches.

use std::io::{self, Read, Seek, SeekFrom, Write};

use super::blocks::{Block, CELLS, SIDE};
use super::columns::{Columns, Crossing};
use super::distances::Distances;
use super::voxels::Voxels;

/// What is told of the cells of a cubic grid.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    /// Side of a cell in metres.
    pub cell_m: f64,
    /// Whether their states are, as by [`Voxels`].
    pub has_states: bool,
    /// How far from the surface distances are, as by [`Distances`], in metres; `None` if they are not.
    pub reach_m: Option<f64>,
}

/// The cells of a grid, made part by part with the help of a file.
pub struct Grid<F> {
    told: Told,
    file: F,
    /// Bytes of the file.
    end: u64,
    pieces: Vec<Piece>,
}

/// The blocks over a square of the map, from below.
pub struct Stack {
    /// The states of cells; none if they are not told.
    pub states: Vec<Block<u8>>,
    /// Their distances; none if they are not told.
    pub distances_m: Vec<Block<f32>>,
}

/// What a part of the world contributes to a square of the map, in the file.
struct Piece {
    square: [i32; 2],
    kind: Kind,
    at: u64,
    bytes: u32,
}

#[derive(Clone, Copy)]
enum Kind {
    Crossings,
    States,
    Distances,
}

impl<F: Read + Write + Seek> Grid<F> {
    /// An empty grid, with an empty file.
    pub fn new(told: Told, file: F) -> Self {
        Self { told, file, end: 0, pieces: Vec::new() }
    }

    /// Adds a part: corners in metres, three indices a triangle, and a label each if states are told. Together all parts are as
    /// [`Columns::add`] takes them.
    ///
    /// # Errors
    /// Those of the file.
    ///
    /// # Panics
    /// As [`Voxels::add`].
    pub fn add(&mut self, corners: &[[f32; 3]], indices: &[u32], labels: &[u8]) -> io::Result<()> {
        let Told { cell_m, has_states, reach_m } = self.told;
        let mut columns = Columns::new(cell_m);
        columns.add(corners, indices);
        self.keep_crossings(columns)?;
        if has_states {
            let mut voxels = Voxels::new(cell_m);
            voxels.add(corners, indices, labels);
            self.keep_blocks(Kind::States, &voxels.into_blocks(), |state, bytes| bytes.push(state))?;
        }
        if let Some(reach_m) = reach_m {
            let mut distances = Distances::new(cell_m, reach_m);
            distances.add(corners, indices);
            let write = |distance_m: f32, bytes: &mut Vec<u8>| bytes.extend(distance_m.to_le_bytes());
            self.keep_blocks(Kind::Distances, &distances.into_blocks(), write)?;
        }
        Ok(())
    }

    /// Passes on the blocks over each square, by place, once all parts are there.
    ///
    /// # Errors
    /// Those of the file and of `each`.
    pub fn finish<E: From<io::Error>>(mut self, mut each: impl FnMut(Stack) -> Result<(), E>) -> Result<(), E> {
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.sort_unstable_by_key(|piece| (piece.square, piece.at));
        pieces.chunk_by(|a, b| a.square == b.square).try_for_each(|of| each(self.stack(of)?))
    }

    fn keep_crossings(&mut self, columns: Columns) -> io::Result<()> {
        let mut crossings = columns.into_crossings();
        crossings.sort_unstable_by_key(|crossing| square_of(crossing.cell));
        for of in crossings.chunk_by(|a, b| square_of(a.cell) == square_of(b.cell)) {
            let mut bytes = Vec::new();
            of.iter().for_each(|crossing| write_crossing(crossing, &mut bytes));
            self.keep(square_of(of[0].cell), Kind::Crossings, &bytes)?;
        }
        Ok(())
    }

    fn keep_blocks<T: Copy>(
        &mut self,
        kind: Kind,
        blocks: &[Block<T>],
        write: impl Fn(T, &mut Vec<u8>),
    ) -> io::Result<()> {
        for of in blocks.chunk_by(|a, b| a.place[..2] == b.place[..2]) {
            let mut bytes = Vec::new();
            for Block { place, cells } in of {
                bytes.extend(place[2].to_le_bytes());
                cells.iter().for_each(|cell| write(*cell, &mut bytes));
            }
            let [i, j, _] = of[0].place;
            self.keep([i, j], kind, &bytes)?;
        }
        Ok(())
    }

    fn keep(&mut self, square: [i32; 2], kind: Kind, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.pieces.push(Piece { square, kind, at: self.end, bytes: bytes.len() as u32 });
        self.end += bytes.len() as u64;
        Ok(())
    }

    /// Joins the pieces of a square.
    fn stack(&mut self, pieces: &[Piece]) -> io::Result<Stack> {
        let Told { cell_m, has_states, reach_m } = self.told;
        let mut columns = Columns::new(cell_m);
        let (mut voxels, mut distances) = (Voxels::new(cell_m), Distances::new(cell_m, reach_m.unwrap_or_default()));
        for piece in pieces {
            let (square, bytes) = (piece.square, self.read(piece)?);
            match piece.kind {
                Kind::Crossings => columns.join(crossings(square, &bytes)),
                Kind::States => blocks::<1>(square, &bytes)
                    .for_each(|(place, cells)| voxels.join(place, cells.iter().map(|[state]| *state))),
                Kind::Distances => blocks::<4>(square, &bytes).for_each(|(place, cells)| {
                    distances.join(place, cells.iter().map(|bytes| f32::from_le_bytes(*bytes)));
                }),
            }
        }
        let air = columns.into_gaps();
        if has_states {
            voxels.fill(&air);
        }
        if reach_m.is_some() {
            distances.sign(&air);
        }
        Ok(Stack { states: voxels.into_blocks(), distances_m: distances.into_blocks() })
    }

    fn read(&mut self, piece: &Piece) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; piece.bytes as usize];
        self.file.seek(SeekFrom::Start(piece.at))?;
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

/// The square of the map under the blocks that hold a cell.
fn square_of(cell: [i32; 2]) -> [i32; 2] {
    cell.map(|n| n.div_euclid(SIDE as i32))
}

/// Bytes of a crossing: its cell within the square and whether it is an entry, and its height.
const OF_CROSSING: usize = 5;

fn write_crossing(crossing: &Crossing, bytes: &mut Vec<u8>) {
    let [i, j] = crossing.cell.map(|n| n.rem_euclid(SIDE as i32) as u8);
    bytes.push((i * SIDE as u8 + j) << 1 | u8::from(crossing.is_entry));
    bytes.extend(crossing.z_m.to_le_bytes());
}

/// The crossings over a square.
fn crossings(square: [i32; 2], bytes: &[u8]) -> impl Iterator<Item = Crossing> {
    bytes.as_chunks::<OF_CROSSING>().0.iter().map(move |&[code, a, b, c, d]| {
        let within = [i32::from(code >> 1) / SIDE as i32, i32::from(code >> 1) % SIDE as i32];
        let cell = [0, 1].map(|axis| square[axis] * SIDE as i32 + within[axis]);
        Crossing { cell, z_m: f32::from_le_bytes([a, b, c, d]), is_entry: code & 1 == 1 }
    })
}

/// The blocks over a square: their places, and the bytes of their cells, so many each.
fn blocks<const OF_CELL: usize>(square: [i32; 2], bytes: &[u8]) -> impl Iterator<Item = ([i32; 3], &[[u8; OF_CELL]])> {
    bytes.chunks_exact(size_of::<i32>() + CELLS * OF_CELL).map(move |block| {
        let (&[a, b, c, d], cells) = block.split_first_chunk().unwrap_or((&[0; 4], &[]));
        ([square[0], square[1], i32::from_le_bytes([a, b, c, d])], cells.as_chunks::<OF_CELL>().0)
    })
}
