//! Chunk meshes and textures in the cave folder.

use super::ply::PlyMesh;
use super::{CaveFolder, FileRecord, StoreError, image_path, lod_path, textured_path, wall_path};
use crate::field::Surface;
use crate::mesh::{Mesh, QUANTA_PER_M};
use crate::texture::{self, Level, LodSettings, Maps, TextureError, TextureSettings, Textured};

/// The images of a chunk.
pub const IMAGES: Maps<&str> =
    Maps { base_color: "base_color", normal: "normal", orm: "orm", roughness: "roughness", height: Some("height") };

/// Writes a mesh without texture coordinates.
///
/// # Errors
/// If the disk fails.
pub fn write_mesh(folder: &CaveFolder, path: &str, mesh: &Mesh) -> Result<FileRecord, StoreError> {
    let ply = PlyMesh {
        positions: mesh.positions_m(),
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
/// If it is missing or damaged.
pub fn read_mesh(folder: &CaveFolder, name: &str) -> Result<Mesh, StoreError> {
    let ply = read_ply(folder, &wall_path(name))?;
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
/// If it is missing or damaged.
pub fn read_ply(folder: &CaveFolder, path: &str) -> Result<PlyMesh, StoreError> {
    let content = folder.read(path)?;
    PlyMesh::read(&mut content.as_slice()).map_err(|error| StoreError::damaged(&folder.root().join(path), error))
}

/// A written textured chunk.
pub struct Written {
    /// The unwrapped mesh, its coarser levels and its images.
    pub files: Vec<FileRecord>,
    /// The unwrapped mesh.
    pub textured: Textured,
    /// The coarser levels.
    pub levels: Vec<Level>,
}

/// Unwraps a chunk, bakes `surface` onto it, and writes its images while baking, the unwrapped mesh and its coarser
/// levels.
///
/// # Errors
/// If the charts do not fit or the disk fails.
pub fn write_textured(
    folder: &CaveFolder,
    name: &str,
    mesh: &Mesh,
    surface: &dyn Surface,
    settings: &TextureSettings,
    lod: &LodSettings,
) -> Result<Written, ChunkError> {
    let create = |(image, format)| folder.create(&image_path(name, image, format));
    let mut sinks = IMAGES.zip(settings.formats()).try_map(create)?;
    let textured = texture::texture(mesh, surface, settings, sinks.as_mut()).map_err(|error| match error {
        TextureError::Write(source) => StoreError::io(&folder.root().join("textures").join(name), source).into(),
        source => ChunkError::Texture { chunk: name.to_owned(), source },
    })?;
    let write = |path: String, triangles: &[[u32; 3]]| {
        let ply = textured_ply(&textured, triangles);
        folder.write(&path, |out| ply.write(out))
    };
    let mut files = vec![write(textured_path(name), &textured.triangles)?];
    for sink in sinks {
        files.push(sink.finish()?);
    }
    let levels = texture::levels(mesh, &textured, lod);
    for (before, level) in levels.iter().enumerate() {
        files.push(write(lod_path(name, before + 1), &level.triangles)?);
    }
    Ok(Written { files, textured, levels })
}

/// Some triangles of a textured chunk with the vertices that they use, in their original order.
fn textured_ply(textured: &Textured, triangles: &[[u32; 3]]) -> PlyMesh {
    let mut names = vec![None; textured.positions.len()];
    triangles.iter().flatten().for_each(|&vertex| names[vertex as usize] = Some(0));
    let used: Vec<usize> = (0..names.len()).filter(|&vertex| names[vertex].is_some()).collect();
    for (name, &vertex) in used.iter().enumerate() {
        names[vertex] = Some(name as u32);
    }
    let name = |vertex: u32| names[vertex as usize].expect("a triangle uses it");
    PlyMesh {
        positions: used.iter().map(|&vertex| textured.positions[vertex]).collect(),
        normals: used.iter().map(|&vertex| textured.normals[vertex]).collect(),
        uvs: used.iter().map(|&vertex| textured.uvs[vertex]).collect(),
        tangents: used.iter().map(|&vertex| textured.tangents[vertex]).collect(),
        border: Vec::new(),
        triangles: triangles.iter().map(|triangle| triangle.map(name)).collect(),
    }
}

/// Why a chunk was not textured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChunkError {
    /// The disk failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The charts do not fit, or a map could not be written.
    #[error("{chunk}: {source}")]
    Texture {
        /// The chunk.
        chunk: String,
        /// What went wrong.
        source: TextureError,
    },
}
