//! Chunk meshes and images in the cave folder.

use std::fs::File;
use std::io::BufReader;

use super::ply::PlyMesh;
use super::{CaveFolder, FileRecord, StoreError};
use crate::field::Surface;
use crate::mesh::{Mesh, QUANTA_PER_M};
use crate::texture::{self, ImageFormat, Maps, TextureError, TextureSettings, Textured};

/// The images of a chunk, in the order they are written.
pub const IMAGES: [&str; 4] = ["base_color", "normal", "orm", "roughness"];

/// Path of the unwrapped mesh of a chunk.
pub fn textured_path(name: &str) -> String {
    format!("textures/{name}.ply")
}

/// Path of an image of a chunk.
pub fn image_path(name: &str, image: &str, format: ImageFormat) -> String {
    format!("textures/{name}_{image}.{}", format.extension())
}

/// Writes a mesh without texture coordinates.
///
/// # Errors
/// When the disk refuses.
pub fn write_mesh(folder: &CaveFolder, path: &str, mesh: &Mesh) -> Result<FileRecord, StoreError> {
    let ply = PlyMesh {
        positions: (0..mesh.positions.len() as u32).map(|v| mesh.position_m(v)).collect(),
        normals: mesh.normals.clone(),
        border: mesh.border.clone(),
        triangles: mesh.triangles.clone(),
        ..PlyMesh::default()
    };
    folder.write(path, |out| ply.write(out))
}

/// Reads the wall of a chunk back, bit for bit.
///
/// # Errors
/// When it is missing or damaged.
pub fn read_mesh(folder: &CaveFolder, name: &str) -> Result<Mesh, StoreError> {
    let ply = read_ply(folder, &format!("chunks/{name}.ply"))?;
    let quantum = |x: f32| (x * QUANTA_PER_M as f32) as i32;
    Ok(Mesh {
        positions: ply.positions.iter().map(|p| p.map(quantum)).collect(),
        normals: ply.normals,
        border: ply.border,
        triangles: ply.triangles,
    })
}

/// Reads a mesh file of the folder.
///
/// # Errors
/// When it is missing or damaged.
pub fn read_ply(folder: &CaveFolder, path: &str) -> Result<PlyMesh, StoreError> {
    let path = folder.root().join(path);
    let file = File::open(&path).map_err(|e| StoreError::io(&path, e))?;
    let damaged = |e: std::io::Error| StoreError::Damaged { path: path.clone(), message: e.to_string() };
    PlyMesh::read(&mut BufReader::new(file)).map_err(damaged)
}

/// Unwraps a chunk, bakes `surface` over it, and writes the unwrapped mesh and its images as they come.
///
/// # Errors
/// When the disk refuses or the charts do not fit.
pub fn write_textured(
    folder: &CaveFolder,
    name: &str,
    mesh: &Mesh,
    surface: &dyn Surface,
    settings: &TextureSettings,
) -> Result<(Vec<FileRecord>, Textured), ChunkError> {
    let sink = |image: &str| folder.create(&image_path(name, image, settings.format));
    let [mut base_color, mut normal, mut orm, mut roughness] =
        [sink(IMAGES[0])?, sink(IMAGES[1])?, sink(IMAGES[2])?, sink(IMAGES[3])?];
    let sinks = Maps { base_color: &mut base_color, normal: &mut normal, orm: &mut orm, roughness: &mut roughness };
    let textured = texture::texture(mesh, surface, settings, sinks).map_err(|error| match error {
        TextureError::Write(source) => StoreError::io(&folder.root().join("textures").join(name), source).into(),
        source => ChunkError::Texture { chunk: name.to_owned(), source },
    })?;
    let ply = PlyMesh {
        positions: textured.positions.clone(),
        normals: textured.normals.clone(),
        uvs: textured.uvs.clone(),
        tangents: textured.tangents.clone(),
        border: Vec::new(),
        triangles: textured.triangles.clone(),
    };
    let mut files = vec![folder.write(&textured_path(name), |out| ply.write(out))?];
    for sink in [base_color, normal, orm, roughness] {
        files.push(sink.finish()?);
    }
    Ok((files, textured))
}

/// Why a chunk was not textured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// The disk.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The charts or a map.
    #[error("{chunk}: {source}")]
    Texture {
        /// Which chunk.
        chunk: String,
        /// What went wrong.
        source: TextureError,
    },
}
