//! The bytes of a GLB: header, JSON chunk, binary chunk, all little-endian and padded to four bytes.

use std::io::{self, Write};

use super::Document;
use super::payload::padding;
use crate::error::ExportError;

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

/// Writes everything before the payload, which is the first buffer of the document: a multiple of four bytes. The JSON is
/// printed twice, because its length comes first and it may be longer than memory.
///
/// # Errors
/// [`ExportError::TooLarge`] beyond 4 GiB, and those of `file`.
pub fn write_head(file: &mut dyn Write, path: &str, document: &Document) -> Result<(), ExportError> {
    let payload_bytes = document.payload_bytes();
    let mut json = Length(0);
    serde_json::to_writer(&mut json, document).map_err(io::Error::from)?;
    let spaces = padding(json.0);
    let json_bytes = json.0 + spaces;
    let bytes = HEADER_BYTES + 2 * CHUNK_HEADER_BYTES + json_bytes + payload_bytes;
    let too_large = |_| ExportError::TooLarge { path: path.to_owned(), format: "GLB", bytes };
    let length = u32::try_from(bytes).map_err(too_large)?;

    file.write_all(b"glTF")?;
    write_words(file, &[2, length, json_bytes as u32])?;
    file.write_all(b"JSON")?;
    serde_json::to_writer(&mut *file, document).map_err(io::Error::from)?;
    file.write_all(&b"   "[..spaces as usize])?;
    // Both fit because their sum does.
    write_words(file, &[payload_bytes as u32])?;
    Ok(file.write_all(b"BIN\0")?)
}

fn write_words(file: &mut dyn Write, words: &[u32]) -> io::Result<()> {
    words.iter().try_for_each(|word| file.write_all(&word.to_le_bytes()))
}

/// Counts what is written.
struct Length(u64);

impl Write for Length {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.0 += buffer.len() as u64;
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
