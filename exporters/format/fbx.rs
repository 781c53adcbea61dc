//! Binary FBX 7.4: metres, right-handed, normals and tangents by vertex, UV origin at the lower left.
//!
//! There is no specification. The output is what ufbx, Blender, assimp and three.js read. Nodes of chunks are at the origin
//! and not rotated, so the vertices are those of the scene to the last bit; those of things share geometries. The bytes depend only on the scene: the time is always
//! the same, objects are numbered in order, and arrays are compressed by Rust code.
//!
//! Memory: one part. The number of objects precedes them, so the header is written twice, the second time when they have
//! been counted.

use crate::error::ExportError;
use crate::frame::Up;
use crate::names;
use crate::package::Package;
use crate::scene::{Chunk, Mesh, Piece};
pub use document::Document;
pub use things::Things;

mod document;
mod geometry;
mod head;
mod material;
mod node;
mod pose;
mod things;
mod window;

/// Metadata of a file.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// The program that writes.
    pub generator: &'a str,
    /// Which axis points up.
    pub up: Up,
}

/// Files of a material, relative to the FBX, with forward slashes.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Base colour.
    pub base_color: String,
    /// Tangent-space normals.
    pub normal: String,
    /// Roughness alone. FBX has no slot for it: it is linked as shininess, where Blender looks for it. Unreal would take it
    /// for metalness.
    pub roughness: Option<String>,
    /// Occlusion, roughness and metalness in red, green and blue. Readers only use the occlusion.
    pub occlusion_roughness_metalness: Option<String>,
}

/// A level of detail.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// Name of its node.
    pub name: String,
    /// Triangles with every attribute.
    pub mesh: &'a Mesh,
    /// Upper bound of its distance from the full detail, in metres.
    pub error_m: f32,
}

/// A collision mesh.
#[derive(Clone, Debug)]
pub struct Collider<'a> {
    /// Name of its node.
    pub name: String,
    /// Positions and triangles.
    pub mesh: &'a Mesh,
}

/// The levels of detail of a chunk, with the names that engines expect.
pub fn levels(chunk: &Chunk) -> impl Iterator<Item = Level<'_>> {
    let levels = chunk.levels().enumerate();
    levels.map(|(number, (mesh, error_m))| Level { name: names::level(&chunk.name, number), mesh, error_m })
}

/// Convex pieces of the mesh called `mesh`, with the names that Unreal expects.
pub fn convex_pieces<'a>(mesh: &str, pieces: &'a [Piece]) -> Vec<Collider<'a>> {
    let collider =
        |(number, piece): (usize, &'a Piece)| Collider { name: names::convex_piece(mesh, number), mesh: &piece.mesh };
    pieces.iter().enumerate().map(collider).collect()
}

/// A part of the world with one material.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Name of the group of levels, if there are several.
    pub name: &'a str,
    /// Full detail first; several are put into a group (`LodGroup`). Without any, there is no material either.
    pub levels: Vec<Level<'a>>,
    /// Collision meshes, which have no material.
    pub colliders: Vec<Collider<'a>>,
    /// Name of the material.
    pub material: &'a str,
    /// Its files.
    pub maps: &'a Maps,
}

/// Writes the file `path` of a package: `fill` adds the parts, one at a time, and may write other files in between.
///
/// # Errors
/// As [`write`](../../package/trait.Package.html#method.write); [`ExportError::TooLarge`] beyond 4 GiB, the limit of this
/// version of FBX; and the errors of `fill`.
pub fn write(
    out: &mut dyn Package,
    path: &str,
    head: &Head,
    fill: impl FnOnce(&mut Document, &mut dyn Package) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let scratch = out.scratch()?;
    let gathered = scratch.path().join("gathered.fbx");
    let mut document = Document::create(&gathered, path, head)?;
    fill(&mut document, out)?;
    document.finish()?;
    out.copy(path, &gathered)
}
