//! EXT_mesh_gpu_instancing: one node for all things of a chunk with the same mesh, in accessors instead of nodes
//! (<https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/EXT_mesh_gpu_instancing>).
//!
//! A reader without the extension would draw one thing of each node, at the origin, so the extension is required. A hull has
//! a node of its own beside that of the visual mesh: what is below a node with instances is not repeated.

use std::collections::BTreeMap;

use gltf_json::accessor::Type;
use gltf_json::{Index, Node};
use serde_json::json;

use super::copies::transform;
use super::layout::Layout;
use super::payload::Payload;
use crate::error::ExportError;
use crate::scene::{Instance, Scene};

pub(super) const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// The number of each thing of a scene by its id: its place in `instances.json`, from 0.
pub(super) fn numbers(scene: &Scene) -> Result<BTreeMap<u64, u32>, ExportError> {
    let mut numbers = BTreeMap::new();
    for index in 0..scene.chunks.len() {
        for thing in scene.instances(index)? {
            let number = numbers.len() as u32;
            numbers.insert(thing.id, number);
        }
    }
    Ok(numbers)
}

impl Layout {
    /// Adds a node for each shared mesh of the things of a chunk: `meshes` give the names of those that a thing shows.
    pub(super) fn add_instances(
        &mut self,
        chunk: &str,
        things: &[Instance],
        meshes: &[fn(&Instance) -> String],
        numbers: &BTreeMap<u64, u32>,
        payload: &mut Payload,
    ) -> Vec<Index<Node>> {
        self.require_extension(EXTENSION);
        let mut alike: BTreeMap<String, Vec<&Instance>> = BTreeMap::new();
        for thing in things {
            for mesh in meshes {
                alike.entry(mesh(thing)).or_default().push(thing);
            }
        }
        let node = |(mesh, things): (String, Vec<&Instance>)| {
            let mut node =
                Node { mesh: Some(self.shared[&mesh]), name: Some(format!("{mesh}_{chunk}")), ..Node::default() };
            let mut rows = |shape: Type, row: fn(&Instance) -> Vec<f32>| {
                let rows: Vec<Vec<f32>> = things.iter().map(|thing| row(thing)).collect();
                self.rows(bytes(&rows), shape, payload)
            };
            let [translation, rotation, scale] = [
                rows(Type::Vec3, |thing| transform(thing).0.into()),
                rows(Type::Vec4, |thing| transform(thing).1.into()),
                rows(Type::Vec3, |thing| transform(thing).2.into()),
            ];
            // Exact for 16 million things.
            let of_scene: Vec<Vec<f32>> = things.iter().map(|thing| vec![numbers[&thing.id] as f32]).collect();
            let number = self.rows(bytes(&of_scene), Type::Scalar, payload);
            let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale, "_ID": number });
            let others = &mut node.extensions.get_or_insert_default().others;
            others.insert(EXTENSION.to_owned(), json!({ "attributes": attributes }));
            self.document.nodes.push(node)
        };
        alike.into_iter().map(node).collect()
    }
}

fn bytes(rows: &[Vec<f32>]) -> Vec<u8> {
    rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect()
}
