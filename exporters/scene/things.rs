//! Things: shapes, and copies of them.

use nalgebra::Isometry3;

use super::{Lod, Material, Mesh, Zone};
use crate::error::ExportError;

/// A shape of which there are copies, in its own frame, in which it stands upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Prototype {
    /// Safe name, unique in the scene.
    pub name: String,
    /// The visual mesh at every level of detail, the full one first, which is without error.
    pub levels: Vec<Lod>,
    /// A convex hull: positions and triangles only.
    pub hull: Mesh,
    /// The zone by which copies have their friction.
    pub zone: Zone,
    /// Material of the visual mesh.
    pub material: Material,
}

/// A thing: a copy of a prototype. Its triangles are in the mesh of its chunk as well, for targets without copies: those of its
/// level, one thing after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its identity, unique in the scene.
    pub id: u64,
    /// What it is, such as `boulder`.
    pub class: String,
    /// Safe name of its prototype.
    pub prototype: String,
    /// The level of the prototype that it shows in full detail: small things have no finer one.
    pub level: usize,
    /// The name of its chunk.
    pub chunk: String,
    /// From the frame of the prototype, in which it stands upright, to that of the scene.
    pub pose: Isometry3<f64>,
    /// Its size relative to the prototype.
    pub scale: f64,
    /// Mass in kilograms.
    pub mass_kg: f64,
    /// How deep it lies in the ground, in metres.
    pub embedding_m: f64,
    /// Whether it is a body that moves when it is pushed; others are part of the static world.
    pub movable: bool,
}

/// Gravel: stones that are only drawn, and have no identity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gravel {
    /// Visual meshes in their own frames.
    pub shapes: Vec<Mesh>,
    /// The stones, from large to small.
    pub stones: Vec<Stone>,
    /// How many of them, from the first one on, each level of detail of their chunk shows; the full one has all.
    pub shown: Vec<usize>,
}

/// A stone of gravel.
#[derive(Clone, Debug, PartialEq)]
pub struct Stone {
    /// Index of its shape.
    pub shape: usize,
    /// From the frame of the shape to that of the scene.
    pub pose: Isometry3<f64>,
    /// Its size relative to the shape.
    pub scale: f64,
}

impl Instance {
    /// Its prototype among `prototypes`.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if it is missing, or has no such level.
    pub fn prototype_in<'a>(&self, prototypes: &'a [Prototype]) -> Result<&'a Prototype, ExportError> {
        let known = prototypes.iter().find(|prototype| prototype.name == self.prototype);
        known.filter(|prototype| self.level < prototype.levels.len()).ok_or_else(|| ExportError::BadScene {
            scene: self.chunk.clone(),
            fault: format!("level {} of prototype `{}` is missing", self.level, self.prototype),
        })
    }
}
