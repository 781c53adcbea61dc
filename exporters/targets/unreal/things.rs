//! Things: a mesh for each prototype and level that things show in full detail, and where its instances are.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry as Slot;

use serde::Serialize;

use super::index::{Entry, Placed, micro};
use super::{Unreal, colliders, write_textures, write_visual};
use crate::error::ExportError;
use crate::format::fbx;
use crate::frame::Up;
use crate::names;
use crate::package::Package;
use crate::scene::{Instance, Piece, Prototype, Scene};

/// The things of a scene.
pub(super) struct Things {
    prototypes: Vec<Prototype>,
    /// By prototype and level.
    shapes: BTreeMap<(String, usize), Shape>,
}

/// A mesh with its instances, for the script.
#[derive(Serialize)]
pub(super) struct Shape {
    /// The mesh.
    #[serde(flatten)]
    pub entry: Entry,
    instances: Vec<Placement>,
}

/// Where one of its instances is.
#[derive(Serialize)]
struct Placement {
    #[serde(flatten)]
    placed: Placed,
    scale: f64,
}

impl Shape {
    /// Number of its instances.
    pub fn count(&self) -> u64 {
        self.instances.len() as u64
    }
}

impl Things {
    /// Those of a scene, none of which is written yet.
    ///
    /// # Errors
    /// As [`Scene::prototypes`].
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        Ok(Self { prototypes: scene.prototypes()?, shapes: BTreeMap::new() })
    }

    /// Adds the things of a chunk, and writes the meshes that none before has used.
    ///
    /// # Errors
    /// If a prototype is missing, and those of `out`.
    pub fn add(
        &mut self,
        target: &Unreal,
        scene: &Scene,
        things: &[Instance],
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        for thing in things {
            let shape = match self.shapes.entry((thing.prototype.clone(), thing.level)) {
                Slot::Occupied(known) => known.into_mut(),
                Slot::Vacant(place) => {
                    let prototype = thing.prototype_in(&self.prototypes)?;
                    let entry = write(target, scene, prototype, thing.level, out)?;
                    place.insert(Shape { entry, instances: Vec::new() })
                }
            };
            let placed = Placed::new(names::thing(thing), &thing.pose);
            shape.instances.push(Placement { placed, scale: micro(thing.scale) });
        }
        Ok(())
    }

    /// The meshes with their instances, in the order of their names.
    pub fn shapes(self) -> Vec<Shape> {
        self.shapes.into_values().collect()
    }
}

/// Writes a prototype from a level on, with its hull as a convex piece.
fn write(
    target: &Unreal,
    scene: &Scene,
    prototype: &Prototype,
    finest: usize,
    out: &mut dyn Package,
) -> Result<Entry, ExportError> {
    let name = format!("{}_level{finest}", prototype.name);
    let material = &prototype.material;
    let full = &prototype.levels[finest].mesh;
    let mut entry = Entry::new(&name, &material.name, full, write_textures(material, out)?);
    let shown = prototype.levels[finest..].iter().enumerate();
    let levels = target.levels(shown.map(|(number, level)| fbx::Level {
        name: names::level(&name, number),
        mesh: &level.mesh,
        error_m: if number == 0 { 0.0 } else { level.error_m },
    }));
    entry.set_levels(&levels);
    let hull = [Piece { mesh: prototype.hull.clone(), zone: prototype.zone }];
    entry.set_pieces(&hull);
    let head = fbx::Head { generator: &scene.generator, up: Up::Z };
    write_visual(&head, &entry, levels, colliders(&name, &hull), out)?;
    Ok(entry)
}
