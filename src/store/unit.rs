//! Units of work, the files that each may write, and their names.
//!
//! Manifest and journal of an untrusted folder may say anything. A unit is accepted only if it could have been written by its
//! stage, so that its paths can only lead to that stage's own files.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::facts::Facts;
use super::file::FileRecord;
use super::{GRAPH, IMAGES, PLAN, PROFILE, RECIPE};
use crate::mesh::ChunkIndex;
use crate::texture::{MapFormats, OwnMap};
use crate::things::KEPT;
use plume_exporters::ImageFormat;
use plume_graph::echo::shown;

/// The name of units that are made once for the whole cave.
pub const WHOLE_CAVE: &str = "cave";
/// The name of meshes and images of the prototypes of things.
pub const PROTOTYPES: &str = "things";
/// Maximum number of levels.
const MOST_LODS: usize = 99;

/// A stage of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stage {
    /// Stations and passages.
    Graph,
    /// Plan and profile.
    Preview,
    /// Triangles.
    Mesh,
    /// Stones and dripstone.
    Things,
    /// Images.
    Texture,
    /// Convex pieces, made if a target needs them.
    Pieces,
}

impl Stage {
    /// Its name; except for `preview`, that of the command that makes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Graph => "graph",
            Self::Preview => "preview",
            Self::Mesh => "mesh",
            Self::Things => "things",
            Self::Texture => "texture",
            Self::Pieces => "pieces",
        }
    }

    /// Whether a unit of this stage may have this name.
    fn has_unit(self, name: &str) -> bool {
        match self {
            Self::Graph | Self::Preview => name == WHOLE_CAVE,
            Self::Things => name == WHOLE_CAVE || is_chunk_name(name),
            Self::Mesh | Self::Texture | Self::Pieces => is_chunk_name(name),
        }
    }

    /// Whether a unit of this stage with this name may write the file at `path`.
    fn writes(self, name: &str, path: &str) -> bool {
        match self {
            Self::Graph => [RECIPE, GRAPH].contains(&path) || is_copy_path(path),
            Self::Preview => [PLAN, PROFILE].contains(&path),
            Self::Mesh => [wall_path(name), collision_path(name)].iter().any(|own| own == path),
            Self::Things if name == WHOLE_CAVE => is_texture_path(PROTOTYPES, path),
            Self::Things => path == things_path(name),
            Self::Texture => is_texture_path(name, path),
            Self::Pieces => path == pieces_path(name),
        }
    }
}

/// A finished piece of work: one stage of one chunk (or of the whole cave).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Unit {
    /// The stage.
    pub stage: Stage,
    /// Chunk name, or `cave`.
    pub name: String,
    /// Hash of everything the unit follows from.
    pub fingerprint: String,
    /// The written files.
    pub files: Vec<FileRecord>,
    /// Statistics: triangles, areas, texels.
    pub facts: Facts,
}

/// A unit as stored in a file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    stage: Stage,
    name: String,
    fingerprint: String,
    files: Vec<FileRecord>,
    facts: Value,
}

impl TryFrom<Unchecked> for Unit {
    type Error = String;

    fn try_from(unit: Unchecked) -> Result<Self, String> {
        let Unchecked { stage, name, fingerprint, files, facts } = unit;
        if !stage.has_unit(&name) {
            return Err(format!("the stage {} has no unit named {}", stage.name(), shown(&name)));
        }
        match files.iter().find(|file| !stage.writes(&name, &file.path)) {
            Some(file) => Err(format!("{} of {name} does not write {}", stage.name(), shown(&file.path))),
            None => Ok(Self { stage, name, fingerprint, files, facts: Facts::read(stage, facts) }),
        }
    }
}

/// Name of a chunk: its index in the grid.
pub fn chunk_name(ChunkIndex([x, y, z]): ChunkIndex) -> String {
    format!("chunk_{x}_{y}_{z}")
}

/// The inverse of [`chunk_name`].
pub fn chunk_index(name: &str) -> Option<ChunkIndex> {
    let numbers: Vec<i32> = name.strip_prefix("chunk_")?.split('_').map(str::parse).collect::<Result<_, _>>().ok()?;
    let index = ChunkIndex(numbers.try_into().ok()?);
    (chunk_name(index) == name).then_some(index)
}

fn is_chunk_name(name: &str) -> bool {
    chunk_index(name).is_some()
}

/// Whether two chunks are neighbours, including diagonally, by their names.
pub fn adjacent(one: &str, other: &str) -> bool {
    let (Some(ChunkIndex(a)), Some(ChunkIndex(b))) = (chunk_index(one), chunk_index(other)) else { return false };
    a != b && a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1)
}

/// Path of the wall of a chunk.
pub fn wall_path(name: &str) -> String {
    format!("chunks/{name}.ply")
}

/// Path of the collision mesh of a chunk.
pub fn collision_path(name: &str) -> String {
    format!("collision/{name}.ply")
}

/// Path of the unwrapped mesh of a chunk.
pub fn textured_path(name: &str) -> String {
    format!("textures/{name}.ply")
}

/// Path of a coarser level of a chunk; 1 is the finest of them.
pub fn lod_path(name: &str, level: usize) -> String {
    format!("textures/{name}_lod{level}.ply")
}

/// Path of an image of a chunk.
pub fn image_path(name: &str, image: &str, format: ImageFormat) -> String {
    format!("textures/{name}_{image}.{}", format.extension())
}

/// Path of the things of a chunk.
pub fn things_path(name: &str) -> String {
    format!("things/{name}.json")
}

/// Path of the convex pieces of a chunk.
pub fn pieces_path(name: &str) -> String {
    format!("pieces/{name}.ply")
}

/// Whether this may be the copy of a file that the recipe names.
pub fn is_copy_path(path: &str) -> bool {
    is_model_path(path) || OwnMap::is_kept_at(path)
}

/// Whether this may be a file of a model: below a folder of its own, by names that lead nowhere else.
fn is_model_path(path: &str) -> bool {
    let Some(below) = path.strip_prefix(KEPT).and_then(|path| path.strip_prefix('/')) else { return false };
    below.contains('/') && below.split('/').all(is_plain_name)
}

/// Whether this names a file or a folder on every system.
pub fn is_plain_name(name: &str) -> bool {
    let is_odd = |c: char| c.is_control() || r#"\/:*?"<>|"#.contains(c);
    !name.is_empty() && !name.ends_with(['.', ' ']) && !name.contains(is_odd) && !plume_disk::is_device_name(name)
}

fn is_texture_path(name: &str, path: &str) -> bool {
    let images = MapFormats::ALL.into_iter().flat_map(|formats| IMAGES.zip(formats.each()));
    path == textured_path(name)
        || (1..=MOST_LODS).any(|level| lod_path(name, level) == path)
        || images.into_iter().any(|(image, format)| image_path(name, image, format) == path)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn refusal(stage: &str, name: &str, path: &str) -> Option<String> {
        let file = json!({"path": path, "bytes": 1, "sha256": ""});
        let unit = json!({"stage": stage, "name": name, "fingerprint": "", "files": [file], "facts": {}});
        serde_json::from_value::<Unit>(unit).err().map(|error| error.to_string())
    }

    #[test]
    fn a_stage_writes_its_own_files() {
        for (stage, name, path) in [
            ("graph", "cave", "cave.toml"),
            ("graph", "cave", "models/crate/Crate (1).glb"),
            ("graph", "cave", "models/crate/textures/wood.png"),
            ("graph", "cave", "maps/base_color.png"),
            ("preview", "cave", "profile.png"),
            ("mesh", "chunk_0_-1_12", "collision/chunk_0_-1_12.ply"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_0_lod3.ply"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_0_base_color.webp"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_0_height.png"),
            ("pieces", "chunk_0_0_0", "pieces/chunk_0_0_0.ply"),
            ("things", "chunk_0_0_0", "things/chunk_0_0_0.json"),
            ("things", "cave", "textures/things_orm.png"),
            ("things", "cave", "textures/things_lod1.ply"),
        ] {
            assert_eq!(refusal(stage, name, path), None);
        }
    }

    #[test]
    fn other_files_are_refused() {
        for (stage, name, path) in [
            ("texture", "chunk_9_9_9", "/abs/victim"),
            ("texture", "chunk_9_9_9", "../victim"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_0_height.jpg"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_1.ply"),
            ("texture", "chunk_0_0_0", "textures/../textures/chunk_0_0_0.ply"),
            ("texture", "chunk_0_0_0", "textures/chunk_0_0_0_lod01.ply"),
            ("things", "cave", "things/cave.json"),
            ("things", "chunk_0_0_0", "textures/things.ply"),
            ("things", "chunk_0_0_0", "things/chunk_0_0_1.json"),
            ("things", "../victim", "things/../victim.json"),
            ("mesh", "../../out/x", "chunks/../../out/x.ply"),
            ("mesh", "chunk_0_0_00", "chunks/chunk_0_0_00.ply"),
            ("mesh", "chunk_0_0", "chunks/chunk_0_0.ply"),
            ("mesh", "cave", "cave.toml"),
            ("graph", "cave", "manifest.json"),
            ("graph", "cave", "models/crate.glb"),
            ("graph", "cave", "models/../cave.glb"),
            ("graph", "cave", "models/crate/../../victim"),
            ("graph", "cave", "models//victim"),
            ("graph", "cave", "models/crate/..\\victim"),
            ("graph", "cave", "models/c:/victim"),
            ("graph", "cave", "maps/height.png"),
            ("graph", "cave", "maps/../normal.png"),
            ("texture", "chunk_0_0_0", "maps/normal.png"),
            ("things", "cave", "models/crate/crate.glb"),
            ("graph", "chunk_0_0_0", "cave.toml"),
        ] {
            assert!(refusal(stage, name, path).is_some(), "{stage} {name} {path}");
        }
    }

    #[test]
    fn neighbours_share_at_least_a_corner() {
        assert!(adjacent("chunk_0_0_0", "chunk_1_-1_0"));
        assert!(!adjacent("chunk_0_0_0", "chunk_0_0_0"));
        assert!(!adjacent("chunk_0_0_0", "chunk_2_0_0"));
        assert!(!adjacent("chunk_-2147483648_0_0", "chunk_2147483647_0_0"));
    }
}
