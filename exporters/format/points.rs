//! Points of clouds, and the rows that PLY and PCD have of them.

use std::io::{self, Read, Write};

/// A point on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is, in metres.
    pub position: [f32; 3],
    /// Unit normal of the surface.
    pub normal: [f32; 3],
    /// Label of what the surface belongs to.
    pub label: u32,
    /// Number of the chunk.
    pub chunk: u32,
    /// Number of the thing, from 1; 0 on the wall.
    pub thing: u32,
}

/// Bytes of a row.
pub const ROW: usize = 36;

/// The properties of a row in PLY.
pub const PLY: [&str; 9] =
    ["float x", "float y", "float z", "float nx", "float ny", "float nz", "uint label", "uint chunk", "uint thing"];

impl Point {
    /// Writes the row of a point, little-endian.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write(&self, file: &mut dyn Write) -> io::Result<()> {
        let numbers = self.position.iter().chain(&self.normal).map(|number| number.to_le_bytes());
        let codes = [self.label, self.chunk, self.thing].map(u32::to_le_bytes);
        let mut row = [0; ROW];
        row.as_chunks_mut::<4>().0.iter_mut().zip(numbers.chain(codes)).for_each(|(place, bytes)| *place = bytes);
        file.write_all(&row)
    }

    /// Reads a row.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn read(file: &mut dyn Read) -> io::Result<Self> {
        let mut row = [0; ROW];
        file.read_exact(&mut row)?;
        let word = |n: usize| row.as_chunks::<4>().0[n];
        let vector = |first: usize| [0, 1, 2].map(|axis| f32::from_le_bytes(word(first + axis)));
        let [label, chunk, thing] = [6, 7, 8].map(|n| u32::from_le_bytes(word(n)));
        Ok(Self { position: vector(0), normal: vector(3), label, chunk, thing })
    }
}
