//! `scene.json`: what glTF cannot express, in its frame.

use serde::Serialize;
use serde_json::{Value, json};

use super::geometry::bounds;
use crate::error::ExportError;
use crate::package::Package;
use crate::scene::{Chunk, Landmark, Light, Piece, Scene};
use crate::{frame, names};

/// A chunk in the index.
#[derive(Serialize)]
pub struct Entry {
    name: String,
    file: String,
    triangles: u64,
    min: [f32; 3],
    max: [f32; 3],
    lods: Vec<Level>,
    convex_pieces: usize,
    #[serde(skip)]
    collision_triangles: u64,
}

/// A coarser level of detail in the index.
#[derive(Serialize)]
pub struct Level {
    node: String,
    triangles: u64,
    error_m: f32,
}

impl Entry {
    /// The entry of a chunk in `file`, without coarser levels.
    pub fn new(file: &str, chunk: &Chunk, pieces: &[Piece]) -> Self {
        let [min, max] = bounds(&chunk.visual.positions);
        Self {
            name: chunk.name.clone(),
            file: file.to_owned(),
            triangles: chunk.visual.triangles(),
            min,
            max,
            lods: Vec::new(),
            convex_pieces: pieces.len(),
            collision_triangles: pieces.iter().map(|piece| piece.mesh.triangles()).sum(),
        }
    }

    /// The same with the coarser levels of the chunk.
    pub fn with_levels(self, chunk: &Chunk) -> Self {
        let levels = (1..).zip(&chunk.lods).map(|(number, lod)| Level {
            node: names::level(&chunk.name, number),
            triangles: lod.mesh.triangles(),
            error_m: lod.error_m,
        });
        Self { lods: levels.collect(), ..self }
    }
}

/// Visual triangles in full detail, and triangles of convex pieces.
pub fn triangles(entries: &[Entry]) -> [u64; 2] {
    let sum = |of: fn(&Entry) -> u64| entries.iter().map(of).sum();
    [sum(|entry| entry.triangles), sum(|entry| entry.collision_triangles)]
}

/// Writes `scene.json`.
///
/// # Errors
/// Those of the package.
pub fn write(scene: &Scene, entries: &[Entry], out: &mut dyn Package) -> Result<(), ExportError> {
    let mut index = json!({
        "name": scene.name,
        "description": scene.description,
        "generator": scene.generator,
        "frame": "right-handed, Y up, metres; rotations are x, y, z, w and turn +X forward, +Z up",
        "chunks": entries,
        "spawns": scene.spawns.iter().map(spawn).collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
    });
    let landmarks = scene.network.landmarks();
    if !landmarks.is_empty() {
        index["stations"] = landmarks.iter().map(station).collect();
    }
    out.json("scene.json", &index)
}

fn station(landmark: &Landmark) -> Value {
    let position = frame::gltf_from_scene::<f64>(landmark.position.into());
    json!({ "frame": landmark.frame, "name": landmark.label, "position": position })
}

fn spawn(pose: &nalgebra::Isometry3<f64>) -> Value {
    let (position, rotation) = frame::gltf_pose_from_scene(pose);
    json!({ "position": position, "rotation": rotation })
}

fn light(light: &Light) -> Value {
    json!({
        "name": light.name,
        "position": frame::gltf_from_scene::<f64>(light.position.into()),
        "color": light.color,
        "intensity_cd": light.intensity_cd,
        "range_m": light.range_m,
    })
}
