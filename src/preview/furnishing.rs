//! The things of a cave that is only a graph and a field.

use std::sync::atomic::AtomicBool;

use super::PreviewError;
use crate::mesh::MeshSettings;
use crate::things::{Setting, Shelf, Thing, place_in};
use plume_graph::Aabb;

/// What the things of a cave follow from.
pub struct Furnishing<'a> {
    /// Everything but the walls.
    pub setting: Setting<'a>,
    /// The shapes of the prototypes.
    pub shelf: &'a Shelf,
    /// How the walls are meshed on which things lie.
    pub mesh: &'a MeshSettings,
}

impl Furnishing<'_> {
    /// The things in a box: those of the packages.
    pub fn things_in(&self, bounds: Aabb<f64>, stop: &AtomicBool) -> Result<Vec<Thing>, PreviewError> {
        place_in(&self.setting, self.mesh, bounds, stop).ok_or(PreviewError::Stopped)
    }
}
