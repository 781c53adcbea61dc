//! Binary FBX 7.4: metres, right-handed, normals and tangents by vertex, UV origin at the lower left.
//!
//! There is no specification. What is written is what readers read: ufbx, Blender, assimp and three.js were asked. Nodes
//! stand at the origin and are not turned, so the vertices are those of the scene to the last bit. The bytes depend on the
//! scene alone: the time is always the same, objects are numbered in order, and arrays are compressed by Rust code.
//!
//! Memory: one part. How many objects there are stands before them, so the head is written twice, the second time when
//! they are counted.

use crate::error::ExportError;
use crate::frame::Up;
use crate::names;
use crate::package::Package;
use crate::scene::{Chunk, Mesh, Piece};
pub use document::Document;

mod document;
mod geometry;
mod head;
mod material;
mod node;
mod window;

/// What a file says of itself.
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
    /// Roughness alone. FBX has no slot for it: it is put in place of shininess, where Blender looks for it. Unreal would
    /// take it for metalness.
    pub roughness: Option<String>,
    /// Occlusion, roughness and metalness in red, green and blue. Of these, readers see occlusion.
    pub occlusion_roughness_metalness: Option<String>,
}

/// A level of detail.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// Name of its node.
    pub name: String,
    /// Triangles with every attribute.
    pub mesh: &'a Mesh,
    /// How far it lies from the full detail at most, in metres.
    pub error_m: f32,
}

/// Triangles to touch, not to see.
#[derive(Clone, Debug)]
pub struct Collider<'a> {
    /// Name of its node.
    pub name: String,
    /// Positions and triangles.
    pub mesh: &'a Mesh,
}

/// The levels of detail of a chunk, under the names by which engines know them.
pub fn levels(chunk: &Chunk) -> impl Iterator<Item = Level<'_>> {
    let levels = chunk.levels().enumerate();
    levels.map(|(number, (mesh, error_m))| Level { name: names::level(&chunk.name, number), mesh, error_m })
}

/// Convex pieces of the mesh called `mesh`, under the names by which Unreal knows them.
pub fn convex_pieces<'a>(mesh: &str, pieces: &'a [Piece]) -> Vec<Collider<'a>> {
    let collider =
        |(number, piece): (usize, &'a Piece)| Collider { name: names::convex_piece(mesh, number), mesh: &piece.mesh };
    pieces.iter().enumerate().map(collider).collect()
}

/// A part of the world with one material.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Name of the group of levels, where there are several.
    pub name: &'a str,
    /// Full detail first; several are put into a group (`LodGroup`). Without any, there is no material either.
    pub levels: Vec<Level<'a>>,
    /// What robots touch; these have no material.
    pub colliders: Vec<Collider<'a>>,
    /// Name of the material.
    pub material: &'a str,
    /// Its files.
    pub maps: &'a Maps,
}

/// Writes the file `path` of a package: `fill` adds the parts, one at a time, and may write other files meanwhile.
///
/// # Errors
/// As [`write`](../../package/trait.Package.html#method.write); [`ExportError::TooLarge`] past 4 GiB, which is all that this
/// version of FBX can hold; and the errors of `fill`.
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
