//! The bytes of a GLB: header, JSON chunk, binary chunk, all little-endian and padded to four bytes.

use std::fs::File;
use std::io::{self, Read, Write};

use gltf_json::Root;

use crate::error::{ExportError, at};
use crate::frame;
use crate::scene::{Chunk, Image, Mesh, Piece};

use super::layout::{images, index_bytes, padding};

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

/// Writes everything before the binary payload, which will have `payload_bytes`, a multiple of four.
///
/// # Errors
/// [`ExportError::TooLarge`] past 4 GiB, and those of `file`.
pub fn write_head(file: &mut dyn Write, path: &str, root: &Root, payload_bytes: u64) -> Result<(), ExportError> {
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

/// Writes the payload of a chunk in the order of [`super::layout::Layout::add_chunk`].
///
/// # Errors
/// Those of `file`, and when an image cannot be read or has changed since the plan.
pub fn write_chunk(file: &mut dyn Write, chunk: &Chunk, pieces: &[Piece]) -> Result<(), ExportError> {
    let mesh = &chunk.visual;
    write_positions(file, mesh)?;
    write_floats(file, mesh.normals.iter().map(|&normal| frame::gltf_from_scene(normal)))?;
    write_floats(file, mesh.tangents.iter().map(|&tangent| frame::gltf_tangent_from_scene(tangent)))?;
    write_floats(file, mesh.uvs.iter().map(|&uv| frame::upper_left_uv(uv)))?;
    write_indices(file, &mesh.indices, index_bytes(mesh))?;
    for (_, image) in images(&chunk.material) {
        write_image(file, image)?;
    }
    for Piece { mesh, .. } in pieces {
        write_positions(file, mesh)?;
        write_indices(file, &mesh.indices, index_bytes(mesh))?;
    }
    Ok(())
}

fn write_positions(file: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    write_floats(file, mesh.positions.iter().map(|&point| frame::gltf_from_scene(point)))
}

fn write_floats<const N: usize>(file: &mut dyn Write, vectors: impl Iterator<Item = [f32; N]>) -> io::Result<()> {
    for number in vectors.flatten() {
        file.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}

fn write_indices(file: &mut dyn Write, indices: &[u32], bytes_each: u64) -> io::Result<()> {
    for index in indices {
        file.write_all(&index.to_le_bytes()[..bytes_each as usize])?;
    }
    pad(file, indices.len() as u64 * bytes_each)
}

fn write_image(file: &mut dyn Write, image: &Image) -> Result<(), ExportError> {
    let named = |error| at(image.path.display(), &error);
    let source = File::open(&image.path).map_err(named)?;
    let planned = source.metadata().map_err(named)?.len();
    let copied = io::copy(&mut source.take(planned), file)?;
    if copied != planned {
        return Err(named(io::ErrorKind::UnexpectedEof.into()).into());
    }
    Ok(pad(file, copied)?)
}

fn write_words(file: &mut dyn Write, words: &[u32]) -> io::Result<()> {
    words.iter().try_for_each(|word| file.write_all(&word.to_le_bytes()))
}

fn pad(file: &mut dyn Write, bytes: u64) -> io::Result<()> {
    file.write_all(&[0; 3][..padding(bytes) as usize])
}
