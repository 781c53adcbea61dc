//! The manifest of a package: [`MANIFEST`](crate::package::MANIFEST).
//!
//! Its origin (recipe, seed), its content (chunks, start poses), frames, and every file with its size and SHA-256. No times
//! and no absolute paths: the same scene gives the same text. It ends with a seal, the SHA-256 of everything before it, so
//! that damage to the manifest is detected like damage to a file. A seal is not a signature: it detects accidents, not
//! forgery.
//!
//! ```
//! use plume_exporters::manifest::Manifest;
//!
//! let fault = Manifest::from_text(b"{}").unwrap_err();
//! assert!(fault.contains("seal"), "{fault}");
//! ```

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use nalgebra::Isometry3;
use plume_disk::sealed;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::{Files, Package};
use crate::scene::{Image, Landmark, Scene};
use crate::target::Target;

use self::recorder::ChunkFacts;
pub(crate) use self::things::Count;
pub use self::things::ThingsEntry;

pub(crate) mod recorder;
mod things;

/// Version of the manifest format. The first was a plain list of files, the second had no fingerprint.
pub const FORMAT: u32 = 3;

/// A manifest without its seal.
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
    /// The text from which alone the scene can be made again, if there is one.
    pub recipe: String,
    /// SHA-256 of everything that the package follows from: packages with the same fingerprint have the same bytes.
    pub fingerprint: String,
    /// Units of all numbers here.
    pub units: Units,
    /// Frames.
    pub axes: Frames,
    /// Bounds of all chunks.
    pub bounds: Bounds,
    /// Where the origin lies in the coordinates of a survey, if the scene was made from one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub georeference: Option<GeoreferenceEntry>,
    /// The stations that the survey names and that are frames, not more than [`MOST_FRAMES`](crate::scene::MOST_FRAMES);
    /// `stations.csv` has all of them.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub stations: Vec<StationEntry>,
    /// Start poses.
    pub spawns: Vec<Spawn>,
    /// The chunks, in their order.
    pub chunks: Vec<ChunkEntry>,
    /// The things, if there are any; `instances.json` lists them one by one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub things: Option<ThingsEntry>,
    /// Every file except this one.
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

/// Minimum and maximum corner of a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Metres.
    pub min: [f32; 3],
    /// Metres.
    pub max: [f32; 3],
}

/// The origin of a scene in the coordinates of a survey.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeoreferenceEntry {
    /// Place of the origin in metres: east, north, up. Add it to positions here to get those of the survey.
    pub origin_m: [f64; 3],
    /// The coordinate system as the survey names it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub system: Option<String>,
}

/// A surveyed station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StationEntry {
    /// What the survey calls it; not necessarily unique.
    pub name: String,
    /// Its name as a frame: `[a-z][a-z0-9_]*`, unique in the package.
    pub frame: String,
    /// Metres, on the axis of the passage.
    pub position: [f64; 3],
}

/// A start pose: +X points along the passage, +Z is up, the origin is on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spawn {
    /// Metres.
    pub position: [f64; 3],
    /// Unit quaternion w, x, y, z.
    pub orientation_wxyz: [f64; 4],
}

/// A chunk of the scene: a target may omit levels, collision or images, as described in its README.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChunkEntry {
    /// Unique in the package.
    pub name: String,
    /// Bounds of its visual mesh.
    pub bounds: Bounds,
    /// Names of the chunks next to it.
    pub neighbors: Vec<String>,
    /// Triangles of the visual mesh in full detail.
    pub triangles: u64,
    /// Coarser levels of the visual mesh, finest first.
    pub lods: Vec<LodEntry>,
    /// Triangles of the collision mesh.
    pub collision_triangles: u64,
    /// Number of convex pieces, if the target uses them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub convex_pieces: Option<u64>,
    /// Number of stones, if it is gravel, which is only drawn.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub gravel: Option<u64>,
    /// The images by role, if they are in the package as separate, unchanged files.
    pub textures: BTreeMap<String, String>,
}

/// A coarser level of a visual mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LodEntry {
    /// Its triangles.
    pub triangles: u64,
    /// Upper bound of its distance from the full detail, in metres.
    pub error_m: f32,
}

/// The common part of all versions, by which a later version is recognised.
#[derive(Deserialize)]
pub(crate) struct Head {
    pub format: u32,
    pub generator: String,
    #[serde(rename = "target")]
    _target: String,
    files: Files,
}

impl Manifest {
    /// The manifest of the files written to `out` so far.
    pub(crate) fn new(
        target_name: &str,
        target: &dyn Target,
        scene: &Scene,
        facts: &[ChunkFacts],
        things: Option<ThingsEntry>,
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
            georeference: scene
                .georeference
                .as_ref()
                .map(|known| GeoreferenceEntry { origin_m: known.origin_m, system: known.system.clone() }),
            stations: scene.network.landmarks().into_iter().map(station).collect(),
            spawns: scene.spawns.iter().map(spawn).collect(),
            chunks,
            things,
            files,
        }
    }

    /// The text of the file, sealed.
    ///
    /// # Errors
    /// None for a manifest of numbers and strings.
    pub fn to_text(&self) -> Result<String, ExportError> {
        let text = serde_json::to_string_pretty(self).map_err(io::Error::from)?;
        Ok(sealed::seal(&text))
    }

    /// Reads the text of the file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn from_text(text: &[u8]) -> Result<Self, String> {
        let bare = sealed::unseal(text).ok_or("was changed since it was written: its seal does not match")?;
        serde_json::from_slice(&bare).map_err(|error| format!("is not a manifest: {error}"))
    }
}

/// Whether a text is a manifest of ours, of this version, an earlier or a later one.
pub(crate) fn is_ours(text: &[u8]) -> bool {
    serde_json::from_slice::<Head>(text).is_ok() || is_of_first_format(text)
}

/// The files listed in a manifest of ours, of this version, an earlier or a later one.
pub(crate) fn files_of(text: &[u8]) -> Option<Files> {
    let head = serde_json::from_slice::<Head>(text).map(|head| head.files);
    head.or_else(|_| serde_json::from_slice(text)).ok()
}

/// Whether a text is the plain list of files of the first manifest version.
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
        gravel: chunk.gravel,
        textures: images.into_iter().chain(height).filter_map(placed).collect(),
    }
}

/// The path of the copy of a file in the package.
fn copy_of(source: &Path, files: &Files) -> Option<String> {
    let copy = files.0.iter().find(|(_, entry)| entry.source.as_deref() == Some(source));
    copy.map(|(path, _)| path.clone())
}

fn around(chunks: &[ChunkEntry]) -> Bounds {
    let corners = chunks.iter().flat_map(|chunk| [chunk.bounds.min, chunk.bounds.max]);
    let [min, max] = crate::scene::bounds(corners);
    Bounds { min, max }
}

fn station(landmark: Landmark) -> StationEntry {
    let Landmark { frame, label, position, .. } = landmark;
    StationEntry { name: label.to_owned(), frame, position: position.coords.into() }
}

fn spawn(pose: &Isometry3<f64>) -> Spawn {
    let turn = pose.rotation.quaternion();
    Spawn { position: pose.translation.vector.into(), orientation_wxyz: [turn.w, turn.i, turn.j, turn.k] }
}
