//! Things: a layer with the prototypes, and a layer per chunk with instances of them.

use std::path::Path;

use serde_json::{Value, json};

use super::colliders::collider;
use super::{Contents, Library, describe_pose, layer_path, place_layer, textures, unlabelled};
use crate::collision::Collision;
use crate::error::ExportError;
use crate::inertia::Inertia;
use crate::names;
use crate::package::Package;
use crate::scene::{ByZone, Chunk, Instance, Prototype, Scene, Zone};

/// File of the layer with the prototypes, beside those of the chunks.
const LAYER: &str = "prototypes.usdc";
/// Its prims: the prototypes, and if those have no collider the same with one.
const PROTOTYPES: &str = "Prototypes";
const BODIES: &str = "Bodies";

/// The prototypes of a stage, which its things refer to.
pub(super) struct Prototypes {
    all: Vec<Prototype>,
    physics: Option<Collision>,
    /// Whether things that do not move are part of one mesh with the rock, and have no collider of their own.
    is_merged: bool,
    friction: ByZone,
}

impl Prototypes {
    /// Writes their layer and images, if the scene has things.
    pub fn write(
        target: &'static str,
        scene: &Scene,
        contents: &Contents,
        library: &dyn Library,
        scratch: &Path,
        out: &mut dyn Package,
    ) -> Result<Self, ExportError> {
        let Contents { physics, is_merged, .. } = *contents;
        let made = Self { all: scene.prototypes()?, physics, is_merged, friction: scene.friction };
        if made.all.is_empty() {
            return Ok(made);
        }
        let (path, mut arrays, mut prototypes) = (scratch.join(LAYER), Vec::new(), Vec::new());
        for Prototype { name, levels, hull, material, .. } in &made.all {
            material.refuse_unless(target, &super::IMAGES)?;
            let mut described = Vec::new();
            for (number, level) in levels.iter().enumerate() {
                let own = format!("{name}.LOD{number}");
                let mut level_spec = unlabelled(format!("LOD{number}"), &own, level.mesh.clone(), &mut arrays);
                level_spec["error_m"] = level.error_m.into();
                described.push(level_spec);
            }
            let hull =
                made.physics.map(|_| collider(format!("{name}.Collision"), "convexHull", hull.clone(), &mut arrays));
            let textures = textures(material, out)?;
            prototypes.push(json!({ "name": name, "levels": described, "collider": hull, "textures": textures }));
        }
        let spec = json!({ "path": path, "prototypes": prototypes, "apart": made.is_merged });
        library.call("write_prototypes", &spec, arrays)?;
        out.copy(&format!("chunks/{LAYER}"), &path)?;
        Ok(made)
    }

    /// Writes the layer of a chunk of things; returns its description for the root layer, and its collision triangles.
    pub fn write_chunk(
        &self,
        chunk: &Chunk,
        things: &[Instance],
        library: &dyn Library,
        scratch: &Path,
        out: &mut dyn Package,
    ) -> Result<(Value, u64), ExportError> {
        let (mut described, mut triangles) = (Vec::new(), 0);
        for thing in things {
            let prototype = thing.prototype_in(&self.all)?;
            triangles += if self.collides(thing) { prototype.hull.triangles() } else { 0 };
            described.push(self.describe(thing, prototype)?);
        }
        let levels: Vec<String> = (0..=chunk.lods.len()).map(|level| format!("LOD{level}")).collect();
        // Pieces have the friction of their zone.
        let has_friction = self.physics == Some(Collision::Pieces);
        let zone =
            |zone: Zone| json!({ "name": zone.name(), "friction": has_friction.then(|| self.friction.of(zone)) });
        let zones = Zone::ALL.into_iter().filter(|zone| described.iter().any(|thing| thing["zone"] == zone.name()));
        let zones: Vec<Value> = zones.map(zone).collect();
        let spec = json!({
            "path": layer_path(&chunk.name, scratch),
            "zones": zones,
            "levels": levels,
            "things": described,
        });
        library.call("write_things", &spec, Vec::new())?;
        Ok((place_layer(&chunk.name, chunk.visual.bounds(), scratch, out)?, triangles))
    }

    /// Whether a thing has a collider of its own.
    fn collides(&self, thing: &Instance) -> bool {
        self.physics.is_some() && (thing.movable || !self.is_merged)
    }

    fn describe(&self, thing: &Instance, prototype: &Prototype) -> Result<Value, ExportError> {
        let levels: Vec<String> = (thing.level..prototype.levels.len()).map(|level| format!("LOD{level}")).collect();
        let mut described = describe_pose(&thing.pose);
        described["name"] = names::thing(thing).into();
        described["class"] = thing.class.as_str().into();
        let scope = if self.is_merged && self.collides(thing) { BODIES } else { PROTOTYPES };
        described["prototype"] = format!("/{scope}/{}", prototype.name).into();
        described["layer"] = format!("./{LAYER}").into();
        described["zone"] = prototype.zone.name().into();
        described["levels"] = levels.into();
        described["scale"] = thing.scale.into();
        if thing.movable && self.physics.is_some() {
            described["body"] = body(thing, prototype)?;
        }
        Ok(described)
    }
}

/// How a movable thing moves. Its centre of mass is in its own frame, which is scaled; its moments are those of its size.
fn body(thing: &Instance, prototype: &Prototype) -> Result<Value, ExportError> {
    let inertia = Inertia::of_thing(thing, prototype)?;
    let (moments, axes) = inertia.principal();
    let axes = axes.quaternion();
    Ok(json!({
        "mass_kg": inertia.mass_kg,
        "center": (inertia.center.coords / thing.scale).as_slice(),
        "inertia_kg_m2": moments,
        "axes_wxyz": [axes.w, axes.i, axes.j, axes.k],
    }))
}
