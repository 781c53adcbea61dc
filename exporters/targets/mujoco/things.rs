//! Things in MJCF: a mesh per prototype and size for the eye and one for contacts, and a geom of each per thing.
//!
//! Static things are geoms of the world body, like the rock; movable ones are bodies with a free joint.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

use nalgebra::Isometry3;

use crate::error::ExportError;
use crate::format::msh;
use crate::frame::micro;
use crate::names;
use crate::package::Package;
use crate::scene::{Instance, Prototype, Scene};

use super::chunk::{ShapeCount, write_numbers};
use super::{pose_text, position, quaternion};

/// The things of a scene, and the meshes that they share.
pub struct Things {
    prototypes: Vec<Prototype>,
    /// Name of the mesh of each shape, without that of the scene.
    meshes: BTreeMap<Shape, String>,
    /// Poses of the free joints, in their order.
    free: Vec<Isometry3<f64>>,
}

/// A prototype in a size, at a level of detail.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Shape {
    prototype: String,
    level: usize,
    /// Bits of the scale, which is positive.
    scale: u64,
}

impl Shape {
    fn of(thing: &Instance) -> Self {
        Self { prototype: thing.prototype.clone(), level: thing.level, scale: thing.scale.to_bits() }
    }
}

impl Things {
    /// Those of a scene.
    ///
    /// # Errors
    /// As [`Scene::prototypes`], and if a prototype is missing.
    pub fn of(scene: &Scene) -> Result<Self, ExportError> {
        let prototypes = scene.prototypes()?;
        let (mut meshes, mut free) = (BTreeMap::new(), Vec::new());
        for index in 0..scene.chunks.len() {
            for thing in scene.instances(index)? {
                thing.prototype_in(&prototypes)?;
                meshes.insert(Shape::of(&thing), String::new());
                free.extend(thing.movable.then_some(thing.pose));
            }
        }
        for (number, (shape, name)) in meshes.iter_mut().enumerate() {
            *name = format!("{}_size_{number}", shape.prototype);
        }
        Ok(Self { prototypes, meshes, free })
    }

    /// Whether there are any.
    pub fn are_there(&self) -> bool {
        !self.meshes.is_empty()
    }

    /// Number of those that move.
    pub fn bodies(&self) -> usize {
        self.free.len()
    }

    /// Coordinates of all free joints, in the order of their bodies, each followed by a space.
    pub fn coordinates(&self) -> String {
        self.free.iter().fold(String::new(), |mut text, pose| {
            let _ = write!(text, "{} {} ", position(pose), quaternion(pose));
            text
        })
    }

    /// Writes the visual meshes, one per prototype and level.
    ///
    /// # Errors
    /// Those of the package.
    pub fn write_files(&self, out: &mut dyn Package) -> Result<(), ExportError> {
        for Shape { prototype, level, .. } in self.meshes.keys() {
            let path = visual_file(prototype, *level);
            let known = self.prototypes.iter().find(|known| known.name == *prototype);
            if let Some(known) = known.filter(|_| !out.has(&path)) {
                out.write(&path, |file| Ok(msh::write_visual(file, &known.levels[*level].mesh)?))?;
            }
        }
        Ok(())
    }

    /// Writes the meshes that things share.
    ///
    /// # Errors
    /// Those of `file`.
    pub fn write_assets(&self, file: &mut dyn Write, scene: &str) -> io::Result<()> {
        if !self.are_there() {
            return Ok(());
        }
        writeln!(file, "  <asset>")?;
        for (Shape { prototype, level, scale }, mesh) in &self.meshes {
            let size = micro(f64::from_bits(*scale));
            let (name, scale) = (format!("{scene}_{mesh}"), format!("{size} {size} {size}"));
            let path = visual_file(prototype, *level);
            writeln!(file, r#"    <mesh name="{name}" file="{path}" scale="{scale}" inertia="shell"/>"#)?;
            for known in self.prototypes.iter().filter(|known| known.name == *prototype) {
                write!(file, r#"    <mesh name="{name}_hull" scale="{scale}" vertex=""#)?;
                write_numbers(file, &known.hull.positions)?;
                writeln!(file, r#""/>"#)?;
            }
        }
        writeln!(file, "  </asset>")
    }

    /// Writes the things of a chunk. Returns how many collision shapes they have.
    ///
    /// # Errors
    /// As [`Scene::instances`], and those of `file`.
    pub fn write_chunk(
        &self,
        file: &mut dyn Write,
        scene: &Scene,
        index: usize,
        chunk: &str,
    ) -> Result<ShapeCount, ExportError> {
        let mut shapes = ShapeCount::default();
        writeln!(file, "  <worldbody>\n    <frame name=\"{}_{chunk}\">", scene.name)?;
        for thing in scene.instances(index)? {
            let prototype = thing.prototype_in(&self.prototypes)?;
            shapes += ShapeCount { geoms: 1, triangles: prototype.hull.triangles() };
            self.write_thing(file, &scene.name, &thing, prototype)?;
        }
        writeln!(file, "    </frame>\n  </worldbody>")?;
        Ok(shapes)
    }

    fn write_thing(
        &self,
        file: &mut dyn Write,
        scene: &str,
        thing: &Instance,
        prototype: &Prototype,
    ) -> Result<(), ExportError> {
        let name = format!("{scene}_{}", names::thing(thing));
        let mesh = format!("{scene}_{}", self.meshes[&Shape::of(thing)]);
        let material = format!("{scene}_{}", prototype.material.name);
        let zone = prototype.zone.name();
        let pose = pose_text(&thing.pose);
        let (at, mass) = match thing.movable {
            true => (String::new(), format!(r#" mass="{}""#, micro(thing.mass_kg))),
            false => (format!(" {pose}"), String::new()),
        };
        if thing.movable {
            writeln!(file, r#"      <body name="{name}" {pose}><freejoint name="{name}"/>"#)?;
        }
        let visual = format!(r#"class="{scene}_visual" mesh="{mesh}" material="{material}""#);
        writeln!(file, r#"      <geom name="{name}" {visual}{at}/>"#)?;
        let hull = format!(r#"class="{scene}_{zone}" mesh="{mesh}_hull""#);
        writeln!(file, r#"      <geom name="{name}_hull" {hull}{at}{mass}/>"#)?;
        if thing.movable {
            writeln!(file, "      </body>")?;
        }
        Ok(())
    }
}

fn visual_file(prototype: &str, level: usize) -> String {
    format!("assets/{prototype}_level_{level}.msh")
}
