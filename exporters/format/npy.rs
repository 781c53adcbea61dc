//! NumPy arrays, and archives of them: what `numpy.load` opens.
//!
//! Follows <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>, version 1.0: a header as a Python
//! dictionary, then the numbers, little-endian, the last axis fastest. Archives are compressed and have no time.
//!
//! Nothing of an array is held in memory.
//!
//! ```
//! use std::io::Cursor;
//!
//! use plume_exporters::format::npy::Archive;
//!
//! let mut file = Cursor::new(Vec::new());
//! let mut archive = Archive::new(&mut file);
//! archive.add("cells", &[2, 2], [0_i32, 1, 2, 3])?;
//! archive.add("height", &[], [0.5_f32])?;
//! archive.finish()?;
//! assert!(file.into_inner().starts_with(b"PK"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Read, Seek, Write};

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

/// Bytes that are compressed at a time.
const AT_ONCE: usize = 1 << 14;
/// Bytes of an array beyond which its entry has the longer form of ZIP64, well before it must.
const MOST_BYTES: usize = 1 << 31;

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

/// An `.npz` being written.
pub struct Archive<W: Write + Seek>(ZipWriter<W>);

impl<W: Write + Seek> Archive<W> {
    /// An archive without arrays in an empty file.
    pub fn new(file: W) -> Self {
        Self(ZipWriter::new(file))
    }

    /// Adds an array of this shape; one without axes is a number.
    ///
    /// # Errors
    /// If the name is taken; those of the file.
    pub fn add<N: Number>(
        &mut self,
        name: &str,
        shape: &[usize],
        numbers: impl IntoIterator<Item = N>,
    ) -> io::Result<()> {
        self.start::<N>(name, shape)?;
        let mut bytes = Vec::new();
        for number in numbers {
            number.push(&mut bytes);
            if bytes.len() >= AT_ONCE {
                self.0.write_all(&bytes)?;
                bytes.clear();
            }
        }
        self.0.write_all(&bytes)
    }

    /// Adds an array whose numbers are there as their bytes, little-endian.
    ///
    /// # Errors
    /// If the name is taken; those of the file and of `bytes`.
    pub fn add_bytes<N: Number>(&mut self, name: &str, shape: &[usize], bytes: &mut dyn Read) -> io::Result<()> {
        self.start::<N>(name, shape)?;
        io::copy(bytes, &mut self.0).map(drop)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(self) -> io::Result<()> {
        Ok(self.0.finish().map(drop)?)
    }

    fn start<N: Number>(&mut self, name: &str, shape: &[usize]) -> io::Result<()> {
        let bytes = shape.iter().product::<usize>() * size_of::<N>();
        let options = zip_entry::options().large_file(bytes > MOST_BYTES);
        self.0.start_file(format!("{name}.npy"), options)?;
        write_head::<N>(&mut self.0, shape)
    }
}
