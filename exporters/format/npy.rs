//! NumPy arrays, and archives of them: what `numpy.load` opens.
//!
//! Follows <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>, version 1.0: a header as a Python
//! dictionary, then the numbers, little-endian, the last axis fastest. Archives are compressed and have no time.
//!
//! ```
//! use plume_exporters::format::npy::{self, Archive};
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
use zip::write::SimpleFileOptions;

/// A number in an array.
pub trait Number: Copy {
    /// Its type as NumPy writes it.
    const TYPE: &'static str;

    /// Writes it, little-endian.
    ///
    /// # Errors
    /// Those of `file`.
    fn write(self, file: &mut dyn Write) -> io::Result<()>;
}

macro_rules! numbers {
    ($($number:ty: $name:literal),*) => {$(
        impl Number for $number {
            const TYPE: &'static str = $name;

            fn write(self, file: &mut dyn Write) -> io::Result<()> {
                file.write_all(&self.to_le_bytes())
            }
        }
    )*};
}

numbers!(i16: "<i2", i32: "<i4", f32: "<f4", f64: "<f8");

/// Writes an array of this shape.
///
/// # Errors
/// Those of `file`.
pub fn write<N: Number>(file: &mut dyn Write, shape: &[usize], numbers: &[N]) -> io::Result<()> {
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
    file.write_all(header.as_bytes())?;
    numbers.iter().try_for_each(|number| number.write(file))
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
        let options = SimpleFileOptions::default().last_modified_time(zip::DateTime::default()).unix_permissions(0o644);
        self.0.start_file(format!("{name}.npy"), options)?;
        write(&mut self.0, shape, numbers)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// If an array was too large.
    pub fn finish(self) -> io::Result<Vec<u8>> {
        Ok(self.0.finish()?.into_inner())
    }
}
