//! Binary PLY, little-endian: vertices with normals, colours and texture coordinates, labels of vertices and faces.
//!
//! Follows <https://paulbourke.net/dataformats/ply/>. Property names are those of MeshLab and Blender. The crate that writes
//! the meshes of cave folders looks up each property of each row by name, which takes twice as long; here it serves as an
//! independent reader in tests.
//!
//! ```
//! use plume_exporters::format::ply;
//!
//! let mut file = Vec::new();
//! ply::write_head(&mut file, &["metres, Z up".to_owned()], &ply::mesh(3, 1))?;
//! assert!(file.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

use crate::scene::Mesh;

/// A kind of rows.
pub struct Element<'a> {
    /// Such as `vertex`.
    pub name: &'static str,
    /// Number of rows.
    pub count: u64,
    /// Type and name of each property, in the order of their bytes.
    pub properties: &'a [&'a str],
}

/// The properties of a mesh.
const VERTEX: [&str; 12] = [
    "float x",
    "float y",
    "float z",
    "float nx",
    "float ny",
    "float nz",
    "uchar red",
    "uchar green",
    "uchar blue",
    "float s",
    "float t",
    "uchar label",
];
const FACE: [&str; 2] = ["list uchar int vertex_indices", "uchar label"];

/// The elements of a mesh.
pub fn mesh(vertices: u64, faces: u64) -> [Element<'static>; 2] {
    let vertices = Element { name: "vertex", count: vertices, properties: &VERTEX };
    [vertices, Element { name: "face", count: faces, properties: &FACE }]
}

/// Writes everything before the rows. A comment is one line.
///
/// # Errors
/// Those of `file`.
pub fn write_head(file: &mut dyn Write, comments: &[String], elements: &[Element]) -> io::Result<()> {
    writeln!(file, "ply\nformat binary_little_endian 1.0")?;
    for comment in comments {
        writeln!(file, "comment {comment}")?;
    }
    for Element { name, count, properties } in elements {
        writeln!(file, "element {name} {count}")?;
        for property in *properties {
            writeln!(file, "property {property}")?;
        }
    }
    writeln!(file, "end_header")
}

/// Writes the vertices of a visual mesh, with as many sRGB colours and labels as it has vertices.
///
/// # Errors
/// Those of `file`.
pub fn write_vertices(file: &mut dyn Write, mesh: &Mesh, colors: &[[u8; 3]], labels: &[u8]) -> io::Result<()> {
    let mut row = Vec::new();
    for (vertex, position) in mesh.positions.iter().enumerate() {
        row.clear();
        push(&mut row, position);
        push(&mut row, &mesh.normals[vertex]);
        row.extend(colors[vertex]);
        push(&mut row, &mesh.uvs[vertex]);
        row.push(labels[vertex]);
        file.write_all(&row)?;
    }
    Ok(())
}

/// Writes the triangles of a mesh with a label for each; `before` is the number of vertices already in the file.
///
/// # Errors
/// Those of `file`.
pub fn write_faces(file: &mut dyn Write, mesh: &Mesh, labels: &[u8], before: u32) -> io::Result<()> {
    for (corners, label) in mesh.indices.chunks_exact(3).zip(labels) {
        let mut row = [3; 14];
        for (bytes, corner) in row[1..13].chunks_exact_mut(4).zip(corners) {
            bytes.copy_from_slice(&(corner + before).to_le_bytes());
        }
        row[13] = *label;
        file.write_all(&row)?;
    }
    Ok(())
}

fn push(row: &mut Vec<u8>, numbers: &[f32]) {
    row.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}
