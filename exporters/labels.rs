//! Labels of what a surface belongs to: the zones of the wall, and the classes of things.

use std::collections::BTreeMap;

use crate::error::ExportError;
use crate::scene::{Chunk, Content, Instance, Mesh, Prototype, Scene, Zone};
use crate::slope;

/// The label of the first class of things; the zones have those before.
const FIRST_CLASS: usize = 4;

/// The class of gravel.
const GRAVEL: &str = "gravel";

/// The labels of a scene.
pub struct Labels {
    /// The classes of things in the order of their labels, which is that of the alphabet.
    classes: Vec<Class>,
    prototypes: Vec<Prototype>,
}

/// A class of things.
struct Class {
    name: String,
    /// The zone by which they have their friction; gravel, with which nothing collides, has none.
    zone: Option<Zone>,
}

/// A label.
pub struct Label<'a> {
    /// Its number; 0 would be unlabelled.
    pub number: u8,
    /// The zone or class that it stands for.
    pub name: &'a str,
    /// The zone by which that has its friction, if anything collides with it.
    pub zone: Option<Zone>,
}

/// Labels of the vertices and of the faces of a mesh.
pub type OfMesh = (Vec<u8>, Vec<u8>);

impl Labels {
    /// Those of a scene.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if a byte cannot tell the classes apart; [`ExportError::Load`] if the things cannot be read.
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        let (prototypes, mut classes) = (scene.prototypes()?, BTreeMap::new());
        for index in 0..scene.chunks.len() {
            for thing in scene.instances(index)? {
                let zone = thing.prototype_in(&prototypes)?.zone;
                classes.entry(thing.class).or_insert(Some(zone));
            }
            if !scene.gravel(index)?.stones.is_empty() {
                classes.entry(GRAVEL.to_owned()).or_insert(None);
            }
        }
        if FIRST_CLASS + classes.len() > usize::from(u8::MAX) {
            let fault = format!("it has {} classes of things, more than labels can tell apart", classes.len());
            return Err(ExportError::BadScene { scene: scene.name.clone(), fault });
        }
        let classes = classes.into_iter().map(|(name, zone)| Class { name, zone }).collect();
        Ok(Self { classes, prototypes })
    }

    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = Label<'_>> {
        let zones = Zone::ALL.map(|zone| Label { number: of_zone(zone), name: zone.name(), zone: Some(zone) });
        let classes = self.classes.iter().zip(FIRST_CLASS..);
        let classes = classes.map(|(Class { name, zone }, number)| Label { number: number as u8, name, zone: *zone });
        zones.into_iter().chain(classes)
    }

    /// Each label with its name, from small to large.
    pub fn names(&self) -> Vec<(u8, &str)> {
        self.all().map(|label| (label.number, label.name)).collect()
    }

    /// Each label with its name, as in `1 floor`.
    pub fn texts(&self) -> Vec<String> {
        self.all().map(|label| format!("{} {}", label.number, label.name)).collect()
    }

    /// Those of the visual mesh of a chunk.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if the mesh is not that of its things, one after the other.
    pub fn of_chunk(&self, scene: &Scene, index: usize, chunk: &Chunk) -> Result<OfMesh, ExportError> {
        match chunk.content {
            Content::Wall => Ok(of_wall(&chunk.visual)),
            Content::Things { .. } => self.of_things(scene, index, chunk),
            Content::Gravel { .. } => {
                let label = self.label(GRAVEL);
                Ok((vec![label; chunk.visual.positions.len()], vec![label; chunk.visual.triangles() as usize]))
            }
        }
    }

    /// The label of a class.
    fn label(&self, class: &str) -> u8 {
        (self.classes.partition_point(|known| &*known.name < class) + FIRST_CLASS) as u8
    }

    fn of_things(&self, scene: &Scene, index: usize, chunk: &Chunk) -> Result<OfMesh, ExportError> {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for thing in scene.instances(index)? {
            let shown = self.shown(&thing)?;
            let label = self.label(&thing.class);
            vertices.resize(vertices.len() + shown.positions.len(), label);
            faces.resize(faces.len() + shown.indices.len() / 3, label);
        }
        let counted = (vertices.len(), faces.len());
        if counted != (chunk.visual.positions.len(), chunk.visual.indices.len() / 3) {
            let fault = format!("the visual mesh of chunk `{}` is not that of its things", chunk.name);
            return Err(ExportError::BadScene { scene: scene.name.clone(), fault });
        }
        Ok((vertices, faces))
    }

    /// The number of triangles of each thing of a chunk, in the order of its visual mesh.
    ///
    /// # Errors
    /// If the things cannot be read.
    pub fn triangles_of_things(&self, scene: &Scene, index: usize) -> Result<Vec<usize>, ExportError> {
        scene.instances(index)?.iter().map(|thing| Ok(self.shown(thing)?.indices.len() / 3)).collect()
    }

    /// The mesh of which a thing is a copy.
    fn shown(&self, thing: &Instance) -> Result<&Mesh, ExportError> {
        Ok(&thing.prototype_in(&self.prototypes)?.levels[thing.level].mesh)
    }
}

/// The label of a zone.
pub fn of_zone(zone: Zone) -> u8 {
    match zone {
        Zone::Floor => 1,
        Zone::Wall => 2,
        Zone::Ceiling => 3,
    }
}

fn of_wall(mesh: &Mesh) -> OfMesh {
    let label = |normal: [f32; 3]| of_zone(slope::zone(normal));
    let vertices = mesh.normals.iter().map(|&normal| label(normal)).collect();
    (vertices, slope::face_normals(mesh).into_iter().map(label).collect())
}
