//! What a package says of itself: [`MANIFEST`](crate::package::MANIFEST).
//!
//! Where it comes from (recipe, seed), what is where in it (chunks, start poses), in which frame, and every file with its
//! size and SHA-256. No time and no place: the same scene gives the same text. It ends with a seal, the SHA-256 of all that
//! stands before it, so that a slip in the manifest shows as one in a file does. A seal is no signature: it holds off accidents,
//! not forgers.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use nalgebra::Isometry3;
use plume_disk::sealed;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::{Files, Package};
use crate::scene::{Image, Scene};
use crate::target::Target;

use self::recorder::ChunkFacts;

pub(crate) mod recorder;

/// Version of the shape of a manifest. The first was a plain list of files, the second had no fingerprint.
pub const FORMAT: u32 = 3;

/// A manifest, but for its seal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`FORMAT`].
    pub format: u32,
    /// What made the package, e.g. `plume 0.1.0`.
    pub generator: String,
    /// The target that it is for.
    pub target: String,
    /// Name of the scene.
    pub name: String,
    /// One sentence for a human.
    pub description: String,
    /// The seed of the recipe.
    pub seed: u64,
    /// The text that alone makes the scene again, if there is one.
    pub recipe: String,
    /// SHA-256 of all that the package follows from: two packages with the same fingerprint have the same bytes.
    pub fingerprint: String,
    /// Units of all numbers here.
    pub units: Units,
    /// Frames.
    pub axes: Frames,
    /// The box round all chunks.
    pub bounds: Bounds,
    /// Where a robot may start.
    pub spawns: Vec<Spawn>,
    /// The chunks, in their order.
    pub chunks: Vec<ChunkEntry>,
    /// Every file but this one.
    pub files: Files,
}

/// Units of the numbers of a manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// Of bounds, positions and errors.
    pub length: String,
    /// Of file sizes.
    pub size: String,
}

/// The frames of a package.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// Of the files.
    pub files: Axes,
    /// Of the numbers of the manifest: that of the scene.
    pub manifest: Axes,
}

/// The least and the greatest corner of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Metres.
    pub min: [f32; 3],
    /// Metres.
    pub max: [f32; 3],
}

/// A start pose: +X looks along the passage, +Z is up, the origin is on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spawn {
    /// Metres.
    pub position: [f64; 3],
    /// Unit quaternion w, x, y, z.
    pub orientation_wxyz: [f64; 4],
}

/// A chunk, as the scene has it: a target may leave levels, collision or images out, of which its README tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChunkEntry {
    /// Unique in the package.
    pub name: String,
    /// The box round its visual mesh.
    pub bounds: Bounds,
    /// Names of the chunks next to it.
    pub neighbors: Vec<String>,
    /// Triangles of the visual mesh in full detail.
    pub triangles: u64,
    /// Coarser levels of the visual mesh, finest first.
    pub lods: Vec<LodEntry>,
    /// Triangles of the collision mesh.
    pub collision_triangles: u64,
    /// Number of convex pieces, if the target took them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub convex_pieces: Option<u64>,
    /// The images by role, where they lie in the package as files of their own and unchanged.
    pub textures: BTreeMap<String, String>,
}

/// A coarser level of a visual mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LodEntry {
    /// Its triangles.
    pub triangles: u64,
    /// How far it lies from the full detail at most, in metres.
    pub error_m: f32,
}

/// What every version of a manifest has, so that one of a later version is known for what it is.
#[derive(Deserialize)]
pub(crate) struct Head {
    pub format: u32,
    pub generator: String,
    #[serde(rename = "target")]
    _target: String,
    files: Files,
}

impl Manifest {
    /// Of the package that `out` holds by now.
    pub(crate) fn new(
        target_name: &str,
        target: &dyn Target,
        scene: &Scene,
        facts: &[ChunkFacts],
        out: &mut dyn Package,
    ) -> Self {
        let files = out.files().clone();
        let chunks: Vec<ChunkEntry> = facts.iter().map(|chunk| entry(chunk, facts, &files)).collect();
        Self {
            format: FORMAT,
            generator: scene.generator.clone(),
            target: target_name.to_owned(),
            name: scene.name.clone(),
            description: scene.description.clone(),
            seed: scene.seed,
            recipe: scene.recipe.clone(),
            fingerprint: scene.fingerprint.clone(),
            units: Units { length: "metre".to_owned(), size: "byte".to_owned() },
            axes: Frames { files: target.axes(), manifest: Axes::SCENE },
            bounds: around(&chunks),
            spawns: scene.spawns.iter().map(spawn).collect(),
            chunks,
            files,
        }
    }

    /// The text of the file, sealed.
    ///
    /// # Errors
    /// None that a manifest of numbers and texts can cause.
    pub fn to_text(&self) -> Result<String, ExportError> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::from)?;
        Ok(sealed::seal(&text))
    }

    /// Reads the text of the file.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn from_text(text: &[u8]) -> Result<Self, String> {
        let bare = sealed::unseal(text).ok_or("is not as it was written: its seal does not fit")?;
        serde_json::from_slice(&bare).map_err(|error| format!("is not a manifest: {error}"))
    }
}

/// Whether a text is a manifest of ours, of this version, an earlier or a later one.
pub(crate) fn is_ours(text: &[u8]) -> bool {
    serde_json::from_slice::<Head>(text).is_ok() || is_of_first_format(text)
}

/// The files that a manifest of ours names, of this version, an earlier or a later one.
pub(crate) fn files_of(text: &[u8]) -> Option<Files> {
    let head = serde_json::from_slice::<Head>(text).map(|head| head.files);
    head.or_else(|_| serde_json::from_slice(text)).ok()
}

/// Whether a text is the plain list of files that once was the manifest.
pub(crate) fn is_of_first_format(text: &[u8]) -> bool {
    serde_json::from_slice::<Files>(text).is_ok()
}

fn entry(chunk: &ChunkFacts, all: &[ChunkFacts], files: &Files) -> ChunkEntry {
    let [min, max] = chunk.bounds;
    let material = &chunk.material;
    let height = material.height.as_ref().map(|height| ("height", &height.image));
    let images = [
        ("base_color", &material.base_color),
        ("normal", &material.normal),
        ("orm", &material.orm),
        ("roughness", &material.roughness),
    ];
    let placed = |(role, image): (&str, &Image)| Some((role.to_owned(), copy_of(&image.path, files)?));
    ChunkEntry {
        name: chunk.name.clone(),
        bounds: Bounds { min, max },
        neighbors: chunk.neighbors.iter().map(|&index| all[index].name.clone()).collect(),
        triangles: chunk.triangles,
        lods: chunk.lods.clone(),
        collision_triangles: chunk.collision_triangles,
        convex_pieces: chunk.pieces,
        textures: images.into_iter().chain(height).filter_map(placed).collect(),
    }
}

/// The path in the package of the copy of a file.
fn copy_of(source: &Path, files: &Files) -> Option<String> {
    let copy = files.0.iter().find(|(_, entry)| entry.source.as_deref() == Some(source));
    copy.map(|(path, _)| path.clone())
}

fn around(chunks: &[ChunkEntry]) -> Bounds {
    let corners = chunks.iter().flat_map(|chunk| [chunk.bounds.min, chunk.bounds.max]);
    let [min, max] = crate::scene::bounds(corners);
    Bounds { min, max }
}

fn spawn(pose: &Isometry3<f64>) -> Spawn {
    let turn = pose.rotation.quaternion();
    Spawn { position: pose.translation.vector.into(), orientation_wxyz: [turn.w, turn.i, turn.j, turn.k] }
}
