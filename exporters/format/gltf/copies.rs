//! Things: nodes that share the meshes of prototypes.

use gltf_json::mesh::Primitive;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Index, Mesh, Node};

use super::geometry::VERTEX;
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
}

impl Copies {
    /// Those of a scene, with their convex hulls or without.
    ///
    /// # Errors
    /// As [`Scene::prototypes`].
    pub fn of(scene: &Scene, hulls: bool) -> Result<Self, ExportError> {
        Ok(Self { prototypes: scene.prototypes()?, hulls })
    }
}

impl Layout {
    /// Adds a node with a child node for each thing of a chunk; those with the same prototype share its mesh. The buffer of
    /// the chunk has the meshes that no chunk before it has used, and may be empty.
    ///
    /// # Errors
    /// If a prototype is missing, or the size of an image cannot be read.
    pub fn add_things<'a>(
        &mut self,
        chunk: &'a Chunk,
        things: &[Instance],
        copies: &Copies,
    ) -> Result<(Placed, Payload<'a>), ExportError> {
        let mut payload = Payload::default();
        let mut opened = false;
        let mut children = Vec::new();
        let mut open = |layout: &mut Self| {
            if !std::mem::replace(&mut opened, true) {
                layout.open_buffer(&chunk.name);
            }
        };
        if !self.materials.contains_key(&chunk.material.name) {
            open(self);
        }
        let material = self.material(&chunk.material, &mut payload)?;
        for thing in things {
            let prototype = thing.prototype_in(&copies.prototypes)?;
            let visual = format!("{}_level{}", prototype.name, thing.level);
            if !self.shared.contains_key(&visual) {
                open(self);
                let primitive = self.primitive(&prototype.levels[thing.level].mesh, &VERTEX, &mut payload);
                self.share(&visual, Primitive { material: Some(material), ..primitive });
            }
            let hull = names::convex_piece(&prototype.name, 0);
            if copies.hulls && !self.shared.contains_key(&hull) {
                open(self);
                let primitive = self.primitive(&prototype.hull, &VERTEX[..1], &mut payload);
                self.share(&hull, primitive);
            }
            let name = names::thing(thing);
            let hull = copies.hulls.then(|| Node {
                mesh: Some(self.shared[&hull]),
                name: Some(names::convex_piece(&name, 0)),
                ..Node::default()
            });
            let hull = hull.map(|node| vec![self.root.push(node)]);
            let node = Node { mesh: Some(self.shared[&visual]), children: hull, name: Some(name), ..moved(thing) };
            children.push(self.root.push(node));
        }
        let node = Node { name: Some(chunk.name.clone()), children: Some(children), ..Node::default() };
        let node = self.add_node(node);
        Ok((Placed { node, material }, payload))
    }

    fn share(&mut self, name: &str, primitive: Primitive) -> Index<Mesh> {
        let mesh = self.mesh(name.to_owned(), primitive);
        self.shared.insert(name.to_owned(), mesh);
        mesh
    }
}

/// A node at the place of a thing.
fn moved(thing: &Instance) -> Node {
    let single = |number: f64| number as f32;
    let position = frame::gltf_from_scene(<[f64; 3]>::from(thing.pose.translation.vector));
    Node {
        translation: Some(position.map(single)),
        rotation: Some(UnitQuaternion(frame::gltf_rotation_from_scene(&thing.pose.rotation).map(single))),
        scale: Some([single(thing.scale); 3]),
        ..Node::default()
    }
}
