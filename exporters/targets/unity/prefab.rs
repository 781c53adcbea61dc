//! A prefab: that of the scene, with levels of detail, colliders, instances of things, start poses and lights, or that of a thing.
//!
//! Its game objects are in memory until it is written. Of instances, which are many times more, only the ids are.

use std::io::{self, Write};

use minijinja::context;
use minijinja::value::Serde;
use nalgebra::Isometry3;
use serde::Serialize;

use super::identity::{self, Guid};
use super::lod::Extent;
use super::nested::{Nested, Nesting};
use crate::format::fbx;
use crate::frame::{micro, unity_from_scene, unity_pose_from_scene};
use crate::scene::{Chunk, Instance, Landmark, Light, Mesh, Prototype};
use crate::{names, template};

/// Static flags: occluder, occludee, navigation and reflection probes. Not batching, which would copy all meshes into one,
/// and not baked light, which would need a second UV unwrapping.
const STATIC: u32 = 2 | 8 | 16 | 64;

/// Class numbers (<https://docs.unity3d.com/Manual/ClassIDReference.html>).
mod class {
    pub(super) const GAME_OBJECT: u32 = 1;
    pub(super) const TRANSFORM: u32 = 4;
    pub(super) const MESH_RENDERER: u32 = 23;
    pub(super) const MESH_FILTER: u32 = 33;
    pub(super) const RIGIDBODY: u32 = 54;
    pub(super) const MESH_COLLIDER: u32 = 64;
    pub(super) const LIGHT: u32 = 108;
    pub(super) const LOD_GROUP: u32 = 205;
}

/// A prefab of a thing, with the ids of what instances override.
#[derive(Clone, Copy, Serialize)]
pub struct Source {
    /// The prefab.
    pub guid: Guid,
    /// Its root.
    pub object: i64,
    /// The transform of its root.
    pub transform: i64,
    /// Its body, if it moves.
    pub body: Option<i64>,
}

/// Meshes and material of a chunk or a prototype.
#[derive(Clone, Copy)]
pub struct Model {
    /// The FBX.
    pub guid: Guid,
    /// The material.
    pub material: Guid,
}

/// A collider of a chunk.
pub struct Collider<'a> {
    /// Its mesh in the FBX.
    pub mesh: &'a str,
    /// Whether the mesh is convex.
    pub convex: bool,
    /// Its friction.
    pub friction: Guid,
}

impl Collider<'_> {
    fn of(&self, model: Model) -> Content {
        Content::Collider {
            mesh: identity::mesh(self.mesh),
            model: model.guid,
            convex: u8::from(self.convex),
            friction: self.friction,
        }
    }
}

/// A game object and its components for the template.
#[derive(Serialize)]
struct Node {
    #[serde(skip)]
    path: String,
    name: String,
    object: i64,
    transform: i64,
    father: i64,
    order: usize,
    children: Vec<i64>,
    flags: u32,
    position: [String; 3],
    rotation: [String; 4],
    parts: Vec<Part>,
}

/// A component in addition to the transform.
#[derive(Serialize)]
struct Part {
    id: i64,
    #[serde(flatten)]
    content: Content,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Content {
    LodGroup { middle: [String; 3], size: String, levels: Vec<Level> },
    Filter { mesh: i64, model: Guid },
    Renderer { material: Guid },
    Collider { mesh: i64, model: Guid, convex: u8, friction: Guid },
    Body { mass: String },
    Light { color: [String; 3], intensity: String, range: String },
}

#[derive(Serialize)]
struct Level {
    height: String,
    renderer: i64,
}

/// A prefab being built. Its game objects form a tree; the first is the root.
pub struct Prefab {
    nodes: Vec<Node>,
}

const ROOT: usize = 0;

/// How every asset in Unity's YAML begins.
const HEAD: &str = "%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n";

/// Number of objects that are filled into the template at once, which takes many times the memory of their text.
const BATCH: usize = 128;

impl Prefab {
    /// A prefab with only the root.
    pub fn new(name: &str) -> Self {
        let mut prefab = Self { nodes: Vec::new() };
        prefab.push(Node::new(name.to_owned(), name, 0));
        prefab
    }

    /// The prefab called `name` of a thing in the size of its prototype, with the levels of the prototype from its own on.
    pub fn of_thing(name: &str, prototype: &Prototype, thing: &Instance, collider: &Collider, model: Model) -> Self {
        let mut prefab = Self::new(name);
        prefab.nodes[ROOT].flags = if thing.movable { 0 } else { STATIC };
        let levels = prototype.levels.iter().enumerate().skip(thing.level);
        let levels: Vec<_> =
            levels.map(|(number, level)| (names::level(&prototype.name, number), level.error_m)).collect();
        prefab.attach_levels(ROOT, &prototype.levels[thing.level].mesh, &levels, model);
        prefab.nodes[ROOT].attach(class::MESH_COLLIDER, collider.of(model));
        if thing.movable {
            let mass_kg = thing.mass_kg / (thing.scale * thing.scale * thing.scale);
            prefab.nodes[ROOT].attach(class::RIGIDBODY, Content::Body { mass: micro(mass_kg) });
        }
        prefab
    }

    /// What instances of this prefab refer to, which is the asset `guid`.
    pub fn source(&self, guid: Guid) -> Source {
        let Node { object, transform, ref parts, .. } = self.nodes[ROOT];
        let body = parts.iter().find(|part| matches!(part.content, Content::Body { .. })).map(|part| part.id);
        Source { guid, object, transform, body }
    }

    /// Adds a chunk with its levels, full detail first; returns its game object.
    pub fn add_chunk(&mut self, chunk: &Chunk, levels: &[fbx::Level], model: Model) -> usize {
        let group = self.add(ROOT, &chunk.name);
        self.nodes[group].flags = STATIC;
        let levels: Vec<_> = levels.iter().map(|level| (level.name.clone(), level.error_m)).collect();
        self.attach_levels(group, &chunk.visual, &levels, model);
        group
    }

    /// Adds an empty game object for things; returns it.
    pub fn add_group(&mut self, name: &str) -> usize {
        self.add(ROOT, name)
    }

    /// Adds an instance of the prefab of a thing. Its text is [written](Prefab::write_things) later.
    pub fn add_thing(&mut self, group: usize, thing: &Instance, source: &Source) {
        let father = &mut self.nodes[group];
        father.children.push(Nesting::new(&father.path, thing, source).transform);
    }

    /// Adds children for levels of detail, given by the names of their meshes and their errors in metres, and what switches
    /// between them.
    fn attach_levels(&mut self, group: usize, full: &Mesh, levels: &[(String, f32)], model: Model) {
        let extent = Extent::new(full);
        let heights = extent.heights(levels.iter().skip(1).map(|(_, error_m)| *error_m));
        let levels = levels.iter().zip(heights).map(|((name, _), height)| {
            let renderer = self.add_level(group, name, model);
            Level { height: micro(height), renderer }
        });
        let levels = levels.collect();
        let middle = unity_from_scene(extent.middle).map(micro);
        let content = Content::LodGroup { middle, size: micro(extent.size), levels };
        self.nodes[group].attach(class::LOD_GROUP, content);
    }

    fn add_level(&mut self, group: usize, name: &str, model: Model) -> i64 {
        let level = self.add(group, name);
        let node = &mut self.nodes[level];
        node.attach(class::MESH_FILTER, Content::Filter { mesh: identity::mesh(name), model: model.guid });
        node.attach(class::MESH_RENDERER, Content::Renderer { material: model.material })
    }

    /// Adds a child called `name` with colliders to the game object of a chunk.
    pub fn add_colliders(&mut self, chunk: usize, name: &str, colliders: &[Collider], model: Model) {
        let index = self.add(chunk, name);
        for collider in colliders {
            self.nodes[index].attach(class::MESH_COLLIDER, collider.of(model));
        }
    }

    /// Adds an empty game object for each start pose.
    pub fn add_spawns(&mut self, spawns: &[Isometry3<f64>]) {
        let group = self.add(ROOT, "spawns");
        for (number, pose) in spawns.iter().enumerate() {
            let spawn = self.add(group, &format!("spawn_{number}"));
            let (position, rotation) = unity_pose_from_scene(pose);
            self.nodes[spawn].position = position.map(micro);
            self.nodes[spawn].rotation = rotation.map(micro);
        }
    }

    /// Adds an empty game object for each surveyed station, if there are any.
    pub fn add_stations(&mut self, landmarks: &[Landmark]) {
        if landmarks.is_empty() {
            return;
        }
        let group = self.add(ROOT, "stations");
        for landmark in landmarks {
            let station = self.add(group, &landmark.frame);
            self.nodes[station].position = unity_from_scene::<f64>(landmark.position.into()).map(micro);
        }
    }

    /// Adds lights; `per_candela` is Unity's intensity per candela.
    pub fn add_lights(&mut self, lights: &[Light], per_candela: f64) {
        let group = self.add(ROOT, "lights");
        for light in lights {
            let index = self.add(group, &light.name);
            self.nodes[index].position = unity_from_scene::<f64>(light.position.into()).map(micro);
            let content = Content::Light {
                color: light.color.map(srgb_from_linear).map(micro),
                intensity: micro(light.intensity_cd * per_candela),
                range: micro(light.range_m),
            };
            self.nodes[index].attach(class::LIGHT, content);
        }
    }

    /// Writes its game objects. If it has things, [these](Prefab::write_things) come next.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write(&self, file: &mut dyn Write) -> io::Result<()> {
        file.write_all(HEAD.as_bytes())?;
        self.nodes.chunks(BATCH).try_for_each(|nodes| write_objects(nodes, &[], file))
    }

    /// Writes the things below a game object, in the order in which they were added, each with the prefab of which it is an
    /// instance.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write_things(&self, group: usize, things: &[(&Instance, Source)], file: &mut dyn Write) -> io::Result<()> {
        let Node { path, transform, .. } = &self.nodes[group];
        let things = things.iter().enumerate();
        let nested: Vec<_> =
            things.map(|(order, (thing, source))| Nested::new(path, *transform, order, thing, *source)).collect();
        nested.chunks(BATCH).try_for_each(|things| write_objects(&[], things, file))
    }

    fn add(&mut self, father: usize, name: &str) -> usize {
        let above = &mut self.nodes[father];
        let node = Node::new(format!("{}/{name}", above.path), name, above.transform);
        let node = Node { flags: above.flags, order: above.children.len(), ..node };
        above.children.push(node.transform);
        self.push(node)
    }

    fn push(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }
}

fn write_objects(nodes: &[Node], things: &[Nested], file: &mut dyn Write) -> io::Result<()> {
    let values = context! { nodes => Serde(nodes), things => Serde(things) };
    let text = template::fill("objects", include_str!("../../templates/unity/objects.jinja"), &values);
    file.write_all(text.as_bytes())
}

impl Node {
    fn new(path: String, name: &str, father: i64) -> Self {
        Self {
            name: name.to_owned(),
            object: identity::object(&path, class::GAME_OBJECT),
            transform: identity::object(&path, class::TRANSFORM),
            father,
            order: 0,
            children: Vec::new(),
            flags: 0,
            position: [0.0; 3].map(micro),
            rotation: [0.0, 0.0, 0.0, 1.0].map(micro),
            parts: Vec::new(),
            path,
        }
    }

    /// Adds a component; returns its id.
    fn attach(&mut self, class: u32, content: Content) -> i64 {
        let id = identity::object(&format!("{}#{}", self.path, self.parts.len()), class);
        self.parts.push(Part { id, content });
        id
    }
}

/// A colour component as stored by Unity (IEC 61966-2-1).
fn srgb_from_linear(part: f64) -> f64 {
    match part {
        part if part <= 0.003_130_8 => 12.92 * part,
        part => 1.055 * libm::pow(part, 1.0 / 2.4) - 0.055,
    }
}
