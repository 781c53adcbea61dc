//! The bytes of a GLB: header, JSON chunk, binary chunk, all little-endian and padded to four bytes.

use std::io::{self, Write};

use gltf_json::Root;

use super::payload::padding;
use crate::error::ExportError;

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

/// Writes everything before the payload, which is the first buffer of the document: a multiple of four bytes.
///
/// # Errors
/// [`ExportError::TooLarge`] beyond 4 GiB, and those of `file`.
pub fn write_head(file: &mut dyn Write, path: &str, root: &Root) -> Result<(), ExportError> {
    let payload_bytes = root.buffers.first().map_or(0, |buffer| buffer.byte_length.0);
    let mut json = root.to_vec().map_err(io::Error::from)?;
    json.resize(json.len() + padding(json.len() as u64) as usize, b' ');
    let bytes = HEADER_BYTES + 2 * CHUNK_HEADER_BYTES + json.len() as u64 + payload_bytes;
    let too_large = |_| ExportError::TooLarge { path: path.to_owned(), format: "GLB", bytes };
    let length = u32::try_from(bytes).map_err(too_large)?;

    file.write_all(b"glTF")?;
    write_words(file, &[2, length, json.len() as u32])?;
    file.write_all(b"JSON")?;
    file.write_all(&json)?;
    // Both fit because their sum does.
    write_words(file, &[payload_bytes as u32])?;
    Ok(file.write_all(b"BIN\0")?)
}

fn write_words(file: &mut dyn Write, words: &[u32]) -> io::Result<()> {
    words.iter().try_for_each(|word| file.write_all(&word.to_le_bytes()))
}
