//! Labels of surfaces: of the zones of the wall, and of the classes of things.
//!
//! A face of the wall that faces up or down within 45° is floor or ceiling, the others are wall; the label of a vertex follows from
//! its normal. Classes of things follow in the order of the alphabet.

use std::collections::BTreeSet;

use crate::error::ExportError;
use crate::format::ply;
use crate::scene::{Chunk, Content, Instance, Mesh, Prototype, Scene, Zone};
use crate::slope;

/// The label of the first class of things; the zones have those before.
const FIRST_CLASS: usize = 4;

/// The class of gravel.
const GRAVEL: &str = "gravel";

/// The labels of a scene.
pub struct Labels {
    /// The classes of things in the order of their labels, which is that of the alphabet.
    classes: Vec<String>,
    prototypes: Vec<Prototype>,
}

/// Labels of the vertices and of the faces of a mesh.
pub type OfMesh = (Vec<u8>, Vec<u8>);

impl Labels {
    /// Those of a scene.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if a byte cannot tell the classes apart; [`ExportError::Load`] if the things cannot be read.
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        let mut classes = BTreeSet::new();
        for index in 0..scene.chunks.len() {
            classes.extend(scene.instances(index)?.into_iter().map(|thing| thing.class));
            classes.extend((!scene.gravel(index)?.stones.is_empty()).then(|| GRAVEL.to_owned()));
        }
        if FIRST_CLASS + classes.len() > usize::from(u8::MAX) {
            let fault = format!("it has {} classes of things, more than PLY labels can tell apart", classes.len());
            return Err(ExportError::BadScene { scene: scene.name.clone(), fault });
        }
        Ok(Self { classes: classes.into_iter().collect(), prototypes: scene.prototypes()? })
    }

    /// Each label with its name, from small to large.
    pub fn names(&self) -> Vec<(u8, &str)> {
        let zones = Zone::ALL.map(|zone| (ply::label(zone), zone.name()));
        let classes = self.classes.iter().map(|class| (self.label(class), class.as_str()));
        zones.into_iter().chain(classes).collect()
    }

    /// Each label with its name, as in `1 floor`.
    pub fn texts(&self) -> Vec<String> {
        self.names().into_iter().map(|(label, name)| format!("{label} {name}")).collect()
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

    /// Number of faces of a thing in the visual mesh of its chunk.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if its prototype is missing.
    pub fn faces_of(&self, thing: &Instance) -> Result<usize, ExportError> {
        Ok(thing.prototype_in(&self.prototypes)?.levels[thing.level].mesh.indices.len() / 3)
    }

    /// The label of a class.
    fn label(&self, class: &str) -> u8 {
        (self.classes.partition_point(|known| &**known < class) + FIRST_CLASS) as u8
    }

    fn of_things(&self, scene: &Scene, index: usize, chunk: &Chunk) -> Result<OfMesh, ExportError> {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for thing in scene.instances(index)? {
            let shown = &thing.prototype_in(&self.prototypes)?.levels[thing.level].mesh;
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
}

fn of_wall(mesh: &Mesh) -> OfMesh {
    let label = |normal: [f32; 3]| ply::label(slope::zone(normal));
    let vertices = mesh.normals.iter().map(|&normal| label(normal)).collect();
    (vertices, slope::face_normals(mesh).into_iter().map(label).collect())
}
