//! Things: nodes that share the meshes of prototypes.

use std::collections::BTreeMap;

use gltf_json::mesh::Primitive;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Index, Mesh, Node};

use super::geometry::VERTEX;
use super::instancing;
use super::layout::{Layout, Placed};
use super::payload::Payload;
use crate::error::ExportError;
use crate::scene::{Chunk, Instance, Prototype, Scene};
use crate::{frame, names};

/// The things of a scene.
pub struct Copies {
    prototypes: Vec<Prototype>,
    /// Whether things have their convex hulls.
    hulls: bool,
    /// The number of each thing in the scene by its id, if those with the same mesh are one node.
    numbers: Option<BTreeMap<u64, u32>>,
}

impl Copies {
    /// Those of a scene, with their convex hulls or without; `instancing` puts those with the same mesh into one node.
    ///
    /// # Errors
    /// As [`Scene::prototypes`] and [`Scene::instances`].
    pub fn of(scene: &Scene, hulls: bool, instancing: bool) -> Result<Self, ExportError> {
        let numbers = if instancing { Some(instancing::numbers(scene)?) } else { None };
        Ok(Self { prototypes: scene.prototypes()?, hulls, numbers })
    }
}

impl Layout {
    /// Adds a node with a child node for each thing of a chunk; those with the same prototype share its mesh. The buffer of
    /// the chunk has the meshes that no chunk before it has used, and may be empty.
    ///
    /// # Errors
    /// If a prototype is missing, or the size of an image cannot be read, and those of files in `scratch`.
    pub fn add_things<'a>(
        &mut self,
        chunk: &'a Chunk,
        things: &[Instance],
        copies: &Copies,
    ) -> Result<(Placed, Payload<'a>), ExportError> {
        self.document.settle(&self.scratch)?;
        let mut payload = Payload::default();
        let mut opened = false;
        let mut open = |layout: &mut Self| {
            if !std::mem::replace(&mut opened, true) {
                layout.open_buffer(&chunk.name);
            }
        };
        if copies.numbers.is_some() || !self.materials.contains_key(&chunk.material.name) {
            open(self);
        }
        let material = self.material(&chunk.material, &mut payload)?;
        for thing in things {
            let prototype = thing.prototype_in(&copies.prototypes)?;
            let (visual, hull) = (visual(thing), hull(thing));
            if !self.shared.contains_key(&visual) {
                open(self);
                let primitive = self.primitive(&prototype.levels[thing.level].mesh, &VERTEX, &mut payload);
                self.share(&visual, Primitive { material: Some(material), ..primitive });
            }
            if copies.hulls && !self.shared.contains_key(&hull) {
                open(self);
                let primitive = self.primitive(&prototype.hull, &VERTEX[..1], &mut payload);
                self.share(&hull, primitive);
            }
        }
        let children = match &copies.numbers {
            None => things.iter().map(|thing| self.add_copy(thing, copies.hulls)).collect(),
            Some(numbers) => {
                let meshes = [Some(visual as fn(&Instance) -> String), copies.hulls.then_some(hull as _)];
                let meshes: Vec<_> = meshes.into_iter().flatten().collect();
                self.add_instances(&chunk.name, things, &meshes, numbers, &mut payload)
            }
        };
        let node = Node { name: Some(chunk.name.clone()), children: Some(children), ..Node::default() };
        let node = self.add_node(node);
        Ok((Placed { node, material }, payload))
    }

    fn share(&mut self, name: &str, primitive: Primitive) -> Index<Mesh> {
        let mesh = self.mesh(name.to_owned(), primitive);
        self.shared.insert(name.to_owned(), mesh);
        mesh
    }

    /// Adds the node of a thing, with its hull as a child if there are hulls.
    fn add_copy(&mut self, thing: &Instance, hulls: bool) -> Index<Node> {
        let name = names::thing(thing);
        let below = hulls.then(|| Node {
            mesh: Some(self.shared[&hull(thing)]),
            name: Some(names::convex_piece(&name, 0)),
            ..Node::default()
        });
        let children = below.map(|node| vec![self.document.nodes.push(node)]);
        let mesh = Some(self.shared[&visual(thing)]);
        self.document.nodes.push(Node { mesh, children, name: Some(name), ..moved(thing) })
    }
}

/// Name of the visual mesh of a thing.
fn visual(thing: &Instance) -> String {
    format!("{}_level{}", thing.prototype, thing.level)
}

/// Name of its hull.
fn hull(thing: &Instance) -> String {
    names::convex_piece(&thing.prototype, 0)
}

/// A node at the place of a thing.
fn moved(thing: &Instance) -> Node {
    let (translation, rotation, scale) = transform(thing);
    Node {
        translation: Some(translation),
        rotation: Some(UnitQuaternion(rotation)),
        scale: Some(scale),
        ..Node::default()
    }
}

/// Translation, rotation (x, y, z, w) and scale of a thing, in the frame of glTF.
pub(super) fn transform(thing: &Instance) -> ([f32; 3], [f32; 4], [f32; 3]) {
    let single = |number: f64| number as f32;
    let position = frame::gltf_from_scene(<[f64; 3]>::from(thing.pose.translation.vector));
    let rotation = frame::gltf_rotation_from_scene(&thing.pose.rotation);
    (position.map(single), rotation.map(single), [single(thing.scale); 3])
}
