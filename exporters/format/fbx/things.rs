//! Things: nodes that share the geometries of prototypes.

use super::document::{Document, ROOT};
use super::node::Written;
use super::pose::Pose;
use super::{Maps, names};
use crate::error::ExportError;
use crate::scene::{Instance, Lod, Prototype};

/// The things of a chunk.
pub struct Things<'a> {
    /// Name of the node that is above them.
    pub name: &'a str,
    /// Each with its prototype.
    pub things: &'a [(Instance, &'a Prototype)],
    /// Whether they have their coarser levels of detail as well.
    pub lods: bool,
    /// Whether they have their convex hulls as well, which have no material.
    pub hulls: bool,
    /// Name of the material.
    pub material: &'a str,
    /// Its files.
    pub maps: &'a Maps,
}

impl Document {
    /// Adds a node with a child for each thing: its mesh, or a group (`LodGroup`) of its levels of detail. There is one
    /// geometry for each prototype and level, whatever the number of its copies, and one for its hull.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_things(&mut self, things: &Things) -> Result<(), ExportError> {
        self.add_all(things).map_err(|error| self.told(error))
    }

    fn add_all(&mut self, things: &Things) -> Written {
        let material = self.add_material(things.material, things.maps)?;
        let parent = self.add_null(things.name, &Pose::ORIGIN)?;
        for (thing, prototype) in things.things {
            let levels = levels(thing, prototype, things.lods);
            self.add_thing(thing, prototype, &levels, material, parent)?;
            if things.hulls {
                let name = names::thing(thing);
                let full = if levels.len() > 1 { names::level(&name, 0) } else { name };
                self.add_hull(thing, prototype, &full)?;
            }
        }
        Ok(())
    }

    fn add_thing(
        &mut self,
        thing: &Instance,
        prototype: &Prototype,
        levels: &[(usize, &Lod)],
        material: i64,
        parent: i64,
    ) -> Written {
        let (name, pose) = (names::thing(thing), Pose::of_copy(&thing.pose, thing.scale, self.up));
        let errors_m: Vec<f64> = levels.iter().map(|(_, level)| f64::from(level.error_m) * thing.scale).collect();
        let group = if levels.len() > 1 { Some(self.add_group(&name, &errors_m, &pose, parent)?) } else { None };
        for (number, (level, lod)) in levels.iter().enumerate() {
            let geometry = self.shared_geometry(&format!("{}_level{level}", prototype.name), &lod.mesh)?;
            let model = match group {
                Some(group) => self.add_shape(&names::level(&name, number), geometry, &Pose::ORIGIN, group)?,
                None => self.add_shape(&name, geometry, &pose, parent)?,
            };
            self.link(material, model, None);
        }
        Ok(())
    }

    /// Below the root like all collision meshes, named after the mesh `full` that it belongs to.
    fn add_hull(&mut self, thing: &Instance, prototype: &Prototype, full: &str) -> Written {
        let geometry = self.shared_geometry(&names::convex_piece(&prototype.name, 0), &prototype.hull)?;
        let pose = Pose::of_copy(&thing.pose, thing.scale, self.up);
        self.add_shape(&names::convex_piece(full, 0), geometry, &pose, ROOT).map(drop)
    }
}

/// The levels of the prototype that a thing shows, with their numbers: its finest one and, if wanted, each coarser one that
/// has fewer triangles than the one before.
fn levels<'a>(thing: &Instance, prototype: &'a Prototype, lods: bool) -> Vec<(usize, &'a Lod)> {
    let mut shown: Vec<(usize, &Lod)> = Vec::new();
    for (number, level) in prototype.levels.iter().enumerate().skip(thing.level) {
        let is_coarser = |(_, before): &(usize, &Lod)| lods && level.mesh.triangles() < before.mesh.triangles();
        if shown.last().is_none_or(is_coarser) {
            shown.push((number, level));
        }
    }
    shown
}
