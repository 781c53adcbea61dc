//! MuJoCo's binary mesh: counts, then positions, normals, texture coordinates and triangles, all of them 32 bits wide.
//!
//! Lossless. Always little-endian, like all machines on which MuJoCo runs.

use std::io::{self, Write};

use crate::frame;
use crate::scene::Mesh;

/// Writes a visual mesh. MuJoCo has the UV origin at the upper left.
///
/// # Errors
/// Those of `file`.
pub fn write_visual(file: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    let vertices = mesh.positions.len() as u32;
    for count in [vertices, vertices, vertices, mesh.triangles() as u32] {
        file.write_all(&count.to_le_bytes())?;
    }
    for part in mesh.positions.iter().chain(&mesh.normals).flatten() {
        file.write_all(&part.to_le_bytes())?;
    }
    for part in mesh.uvs.iter().copied().flat_map(frame::upper_left_uv) {
        file.write_all(&part.to_le_bytes())?;
    }
    for vertex in &mesh.indices {
        file.write_all(&vertex.to_le_bytes())?;
    }
    Ok(())
}
