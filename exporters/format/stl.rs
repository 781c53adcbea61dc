//! Binary STL: a header of 80 bytes, the number of triangles, and 50 bytes for each, little-endian.
//!
//! Follows <https://www.fabbers.com/tech/STL_Format>. It has no units and no shared vertices.
//!
//! ```
//! use plume_exporters::format::stl;
//! use plume_exporters::scene::Mesh;
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = Mesh { positions, indices: vec![0, 1, 2], ..Mesh::default() };
//! let mut file = Vec::new();
//! stl::write_head(&mut file, "metres, Z up", 1)?;
//! stl::write_triangles(&mut file, &mesh)?;
//! assert_eq!(file.len(), 84 + 50);
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

use crate::scene::Mesh;
use crate::slope;

const HEADER_BYTES: usize = 80;

/// Writes the header. `comment` is truncated if it is too long; it must not begin with `solid`, which marks text files.
///
/// # Errors
/// Those of `file`.
pub fn write_head(file: &mut dyn Write, comment: &str, triangles: u32) -> io::Result<()> {
    let mut header = [b' '; HEADER_BYTES];
    let kept = comment.len().min(HEADER_BYTES);
    header[..kept].copy_from_slice(&comment.as_bytes()[..kept]);
    file.write_all(&header)?;
    file.write_all(&triangles.to_le_bytes())
}

/// Writes triangles with their normals, which are zero for triangles without area.
///
/// # Errors
/// Those of `file`.
pub fn write_triangles(file: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    for (corners, normal) in mesh.indices.chunks_exact(3).zip(slope::face_normals(mesh)) {
        let normal = if normal.iter().all(|part| part.is_finite()) { normal } else { [0.0; 3] };
        let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[corners[k] as usize]);
        let mut record = [0; 50];
        for (bytes, number) in record.chunks_exact_mut(4).zip([normal, a, b, c].as_flattened()) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        file.write_all(&record)?;
    }
    Ok(())
}
