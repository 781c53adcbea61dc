//! Target `gltf`: binary glTF 2.0 with everything embedded, Y up, metres.
//!
//! Written after the Khronos specification 2.0 (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>) and clean
//! under its validator.
//!
//! glTF has no place for collision meshes yet, but importers of games go by names. With `collision = "pieces"` the node of
//! a chunk has a child `UCX_<chunk>_<NN>` for each convex piece. Unreal takes it as collision of the mesh `<chunk>` and does
//! not draw it ("Import Collisions According to Mesh Names"); any other viewer draws it. Not seen in Unreal itself, which
//! no test can open.
//!
//! Memory: one chunk. A GLB starts with its own length and a JSON that knows every size, so a file of several chunks
//! loads each chunk twice: once to plan, once to write.

use gltf_json::Root;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::error::ExportError;
use crate::format::gltf::{Layout, bounds, glb};
use crate::frame::Axes;
use crate::package::Package;
use crate::scene::{Chunk, Piece, Scene};
use crate::{Build, Summary, Target, TargetRow, frame, settings};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "gltf",
    summary: "binary glTF 2.0 with embedded PBR textures, and scene.json with spawn poses",
    opened_by: "Blender, three.js, Unity, Unreal, Godot, any glTF viewer",
    bundles: &[],
    settings: || schemars::schema_for!(GltfSettings),
    build: Build::Plain(|table| Ok(Box::new(Gltf(settings("gltf", table)?)))),
};

/// Settings of target `gltf`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GltfSettings {
    /// One file per chunk, for streaming or past the 4 GiB that one file can hold, instead of a single file.
    pub per_chunk: bool,
    /// Whether a single file carries the lights (extension KHR_lights_punctual).
    pub lights: bool,
    /// What robots touch.
    pub collision: NamedCollision,
}

/// Collision meshes that an importer knows by their names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedCollision {
    /// None: every mesh is one to see.
    #[default]
    None,
    /// Convex pieces of the rock behind the wall, named `UCX_<mesh>_<NN>` as Unreal wants them.
    Pieces,
}

impl Default for GltfSettings {
    fn default() -> Self {
        Self { per_chunk: false, lights: true, collision: NamedCollision::None }
    }
}

/// The target.
pub struct Gltf(
    /// Its settings.
    pub GltfSettings,
);

impl Target for Gltf {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (entries, open) = match self.0.per_chunk {
            true => (self.write_chunks(scene, out)?, "open the files of chunks/ together".to_owned()),
            false => (self.write_single(scene, out)?, format!("open {}.glb", scene.name)),
        };
        let visual_triangles = entries.iter().map(|entry| entry.triangles).sum();
        let collision_triangles = entries.iter().map(|entry| entry.collision_triangles).sum();
        write_index(scene, &entries, out)?;
        Ok(Summary { visual_triangles, collision_triangles, open })
    }

    fn axes(&self) -> Axes {
        Axes::GLTF
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == NamedCollision::Pieces
    }
}

impl Gltf {
    fn load(&self, scene: &Scene, index: usize) -> Result<(Chunk, Vec<Piece>), ExportError> {
        let pieces = if self.wants_pieces() { scene.pieces(index)? } else { Vec::new() };
        Ok((scene.chunk(index)?, pieces))
    }

    fn write_single(&self, scene: &Scene, out: &mut dyn Package) -> Result<Vec<Entry>, ExportError> {
        let path = format!("{}.glb", scene.name);
        let mut layout = Layout::new(scene);
        let mut entries = Vec::new();
        for index in 0..scene.chunks.len() {
            let (chunk, pieces) = self.load(scene, index)?;
            layout.add_chunk(&chunk, &pieces)?;
            entries.push(Entry::new(&path, &chunk, &pieces));
        }
        if self.0.lights {
            layout.add_lights(&scene.lights);
        }
        let (root, bytes) = layout.finish();
        out.write(&path, |file| {
            glb::write_head(file, &path, &root, bytes)?;
            for index in 0..scene.chunks.len() {
                let (chunk, pieces) = self.load(scene, index)?;
                glb::write_chunk(file, &chunk, &pieces)?;
            }
            Ok(())
        })?;
        Ok(entries)
    }

    fn write_chunks(&self, scene: &Scene, out: &mut dyn Package) -> Result<Vec<Entry>, ExportError> {
        let mut entries = Vec::new();
        for index in 0..scene.chunks.len() {
            let (chunk, pieces) = self.load(scene, index)?;
            let path = format!("chunks/{}.glb", chunk.name);
            let mut layout = Layout::new(scene);
            layout.add_chunk(&chunk, &pieces)?;
            let (root, bytes): (Root, u64) = layout.finish();
            out.write(&path, |file| {
                glb::write_head(file, &path, &root, bytes)?;
                glb::write_chunk(file, &chunk, &pieces)
            })?;
            entries.push(Entry::new(&path, &chunk, &pieces));
        }
        Ok(entries)
    }
}

/// A chunk as `scene.json` tells of it.
#[derive(Serialize)]
struct Entry {
    name: String,
    file: String,
    triangles: u64,
    min: [f32; 3],
    max: [f32; 3],
    convex_pieces: usize,
    #[serde(skip)]
    collision_triangles: u64,
}

impl Entry {
    fn new(file: &str, chunk: &Chunk, pieces: &[Piece]) -> Self {
        let [min, max] = bounds(&chunk.visual.positions);
        Self {
            name: chunk.name.clone(),
            file: file.to_owned(),
            triangles: chunk.visual.triangles(),
            min,
            max,
            convex_pieces: pieces.len(),
            collision_triangles: pieces.iter().map(|piece| piece.mesh.triangles()).sum(),
        }
    }
}

/// `scene.json`: what glTF has no words for, in the frame of the GLB.
fn write_index(scene: &Scene, entries: &[Entry], out: &mut dyn Package) -> Result<(), ExportError> {
    let index = json!({
        "name": scene.name,
        "description": scene.description,
        "generator": scene.generator,
        "frame": "right-handed, Y up, metres; rotations are x, y, z, w and turn +X forward, +Z up",
        "chunks": entries,
        "spawns": scene.spawns.iter().map(spawn).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
    });
    let mut text = serde_json::to_string_pretty(&index).map_err(std::io::Error::from)?;
    text.push('\n');
    out.text("scene.json", &text)
}

fn spawn(pose: &nalgebra::Isometry3<f64>) -> Value {
    let (position, rotation) = frame::gltf_pose_from_scene(pose);
    json!({ "position": position, "rotation": rotation })
}

fn light(light: &crate::scene::Light) -> Value {
    json!({
        "name": light.name,
        "position": frame::gltf_from_scene::<f64>(light.position.into()),
        "color": light.color,
        "intensity_cd": light.intensity_cd,
        "range_m": light.range_m,
    })
}
