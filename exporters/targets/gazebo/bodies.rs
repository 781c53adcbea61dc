//! Movable things: a model each, of meshes that they share.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{MapTexts, ROW, write_material, write_mesh};
use crate::error::ExportError;
use crate::format::obj;
use crate::frame::{micro, sdf_pose};
use crate::inertia::Inertia;
use crate::names;
use crate::package::Package;
use crate::scene::{Instance, Prototype, Scene};

/// The movable things of a scene, and what they share.
pub struct Bodies {
    prototypes: Vec<Prototype>,
    /// The files of each material that has been written.
    maps: BTreeMap<String, MapTexts>,
    texts: Vec<BodyText>,
}

/// A movable thing for the templates.
#[derive(Serialize)]
pub struct BodyText {
    name: String,
    pose: String,
    scale: String,
    visual: String,
    maps: MapTexts,
    hull: String,
    friction: String,
    mass_kg: String,
    center_m: String,
    /// Moments and products of inertia by their names in SDF.
    inertia_kg_m2: [(&'static str, String); 6],
}

impl Bodies {
    /// None yet.
    ///
    /// # Errors
    /// As [`Scene::prototypes`].
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        Ok(Self { prototypes: scene.prototypes()?, maps: BTreeMap::new(), texts: Vec::new() })
    }

    /// Adds those of a chunk, and writes the meshes that they are the first to need. Returns their triangles: visual and
    /// collision.
    ///
    /// # Errors
    /// If a prototype is missing, its hull has no volume or an image is unfit; those of the package.
    pub fn add_chunk(
        &mut self,
        model: &str,
        scene: &Scene,
        index: usize,
        out: &mut dyn Package,
    ) -> Result<[u64; 2], ExportError> {
        let mut triangles = [0, 0];
        for thing in scene.instances(index)? {
            let prototype = thing.prototype_in(&self.prototypes)?;
            let maps = shared_maps(&mut self.maps, model, prototype, out)?;
            write_shapes(model, &thing, prototype, out)?;
            triangles[0] += prototype.levels[thing.level].mesh.triangles();
            triangles[1] += prototype.hull.triangles();
            let friction = scene.friction.of(prototype.zone);
            self.texts.push(BodyText::new(&thing, prototype, friction, maps)?);
        }
        Ok(triangles)
    }

    /// All of them.
    pub fn texts(&self) -> &[BodyText] {
        &self.texts
    }
}

impl BodyText {
    fn new(thing: &Instance, prototype: &Prototype, friction: f64, maps: MapTexts) -> Result<Self, ExportError> {
        let Inertia { mass_kg, center, tensor } = Inertia::of_thing(thing, prototype)?;
        let moment = |name, row, column| (name, format!("{:.6e}", tensor[(row, column)]));
        Ok(Self {
            name: names::thing(thing),
            pose: sdf_pose(&thing.pose),
            scale: micro(thing.scale),
            visual: visual_name(thing),
            maps,
            hull: hull_name(prototype),
            friction: micro(friction),
            mass_kg: micro(mass_kg),
            center_m: <[f64; 3]>::from(center).map(micro).join(" "),
            inertia_kg_m2: [
                moment("ixx", 0, 0),
                moment("ixy", 0, 1),
                moment("ixz", 0, 2),
                moment("iyy", 1, 1),
                moment("iyz", 1, 2),
                moment("izz", 2, 2),
            ],
        })
    }
}

/// The files of the material of a prototype, written when they are first needed.
fn shared_maps(
    written: &mut BTreeMap<String, MapTexts>,
    model: &str,
    Prototype { material, .. }: &Prototype,
    out: &mut dyn Package,
) -> Result<MapTexts, ExportError> {
    if let Some(maps) = written.get(&material.name) {
        return Ok(maps.clone());
    }
    material.refuse_unless(ROW.name, ROW.images)?;
    let maps = write_material(model, &material.name, material, out)?;
    written.insert(material.name.clone(), maps.clone());
    Ok(maps)
}

/// Writes the meshes of a thing, unless another one shares them.
fn write_shapes(
    model: &str,
    thing: &Instance,
    prototype: &Prototype,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let path = |name: &str| format!("{model}/meshes/{name}.obj");
    let (visual, hull, material) = (visual_name(thing), hull_name(prototype), &prototype.material);
    if !out.has(&path(&visual)) {
        write_mesh(model, &visual, &material.name, material, &prototype.levels[thing.level].mesh, out)?;
    }
    if !out.has(&path(&hull)) {
        out.write(&path(&hull), |file| Ok(obj::write_collision(file, &hull, &prototype.hull, 0)?))?;
    }
    Ok(())
}

fn visual_name(thing: &Instance) -> String {
    format!("{}_level_{}", thing.prototype, thing.level)
}

fn hull_name(prototype: &Prototype) -> String {
    format!("{}_hull", prototype.name)
}
