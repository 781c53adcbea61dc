//! NumPy arrays, and archives of them: what `numpy.load` opens.
//!
//! Follows <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>, version 1.0: a header as a Python
//! dictionary, then the numbers, little-endian, the last axis fastest. Archives are compressed and have no time.
//!
//! ```
//! use plume_exporters::format::npy::Archive;
//!
//! let mut archive = Archive::default();
//! archive.add("cells", &[2, 2], &[0_i32, 1, 2, 3])?;
//! archive.add("height", &[], &[0.5_f32])?;
//! let bytes = archive.finish()?;
//! assert!(bytes.starts_with(b"PK"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Cursor, Write};

use zip::ZipWriter;

use crate::zip_entry;

/// A number in an array.
pub trait Number: Copy {
    /// Its type as NumPy writes it.
    const TYPE: &'static str;

    /// Appends its bytes, little-endian.
    fn push(self, bytes: &mut Vec<u8>);
}

macro_rules! numbers {
    ($($number:ty: $name:literal),*) => {$(
        impl Number for $number {
            const TYPE: &'static str = $name;

            fn push(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}

numbers!(u8: "|u1", i16: "<i2", i32: "<i4", f32: "<f4", f64: "<f8");

/// Numbers that are turned into bytes at a time.
const AT_ONCE: usize = 1 << 12;

/// Writes what is before the numbers of an array of this shape.
fn write_head<N: Number>(file: &mut dyn Write, shape: &[usize]) -> io::Result<()> {
    /// Magic, version and length of the header.
    const PREFIX: usize = 10;
    /// What the length of prefix and header is a multiple of.
    const ALIGNMENT: usize = 64;
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({shape}), }}", N::TYPE);
    let padding = ALIGNMENT - 1 - (PREFIX + header.len()) % ALIGNMENT;
    header.extend(std::iter::repeat_n(' ', padding).chain(['\n']));
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&(header.len() as u16).to_le_bytes())?;
    file.write_all(header.as_bytes())
}

/// An `.npz` being written, in memory.
pub struct Archive(ZipWriter<Cursor<Vec<u8>>>);

impl Default for Archive {
    fn default() -> Self {
        Self(ZipWriter::new(Cursor::default()))
    }
}

impl Archive {
    /// Adds an array of this shape; one without axes is a number.
    ///
    /// # Errors
    /// If the name is taken.
    pub fn add<N: Number>(&mut self, name: &str, shape: &[usize], numbers: &[N]) -> io::Result<()> {
        self.add_parts(name, shape, std::iter::once(numbers))
    }

    /// Adds an array whose numbers are in several places.
    ///
    /// # Errors
    /// If the name is taken.
    pub fn add_parts<'a, N: Number + 'a>(
        &mut self,
        name: &str,
        shape: &[usize],
        parts: impl Iterator<Item = &'a [N]>,
    ) -> io::Result<()> {
        self.0.start_file(format!("{name}.npy"), zip_entry::options())?;
        write_head::<N>(&mut self.0, shape)?;
        let mut bytes = Vec::new();
        for part in parts.flat_map(|part| part.chunks(AT_ONCE)) {
            bytes.clear();
            part.iter().for_each(|number| number.push(&mut bytes));
            self.0.write_all(&bytes)?;
        }
        Ok(())
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// If an array was too large.
    pub fn finish(self) -> io::Result<Vec<u8>> {
        Ok(self.0.finish()?.into_inner())
    }
}
