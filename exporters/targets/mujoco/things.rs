//! Things in MJCF: a mesh per prototype and size for the eye and one for contacts, and a geom of each per thing, as far as settings
//! want them.
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
use super::{MujocoSettings, pose_text, position, quaternion};

/// The things of a scene, and the meshes that they share.
pub struct Things {
    prototypes: Vec<Prototype>,
    shapes: BTreeMap<Shape, Meshes>,
    are_seen: bool,
    least_hull_m: f64,
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

/// The meshes of a shape.
#[derive(Default)]
struct Meshes {
    /// Their name without that of the scene.
    name: String,
    /// Whether some thing of this shape has a hull.
    are_touched: bool,
}

impl Shape {
    fn of(thing: &Instance) -> Self {
        Self { prototype: thing.prototype.clone(), level: thing.level, scale: thing.scale.to_bits() }
    }
}

impl Things {
    /// Those of a scene, as far as the settings want them.
    ///
    /// # Errors
    /// As [`Scene::prototypes`], and if a prototype is missing.
    pub fn of(scene: &Scene, settings: &MujocoSettings) -> Result<Self, ExportError> {
        let MujocoSettings { visuals: are_seen, least_hull_m, .. } = *settings;
        let (shapes, free) = (BTreeMap::new(), Vec::new());
        let mut things = Self { prototypes: scene.prototypes()?, shapes, are_seen, least_hull_m, free };
        for index in 0..scene.chunks.len() {
            for thing in scene.instances(index)? {
                let is_touched = things.is_touched(&thing, thing.prototype_in(&things.prototypes)?);
                if is_touched || are_seen {
                    things.shapes.entry(Shape::of(&thing)).or_default().are_touched |= is_touched;
                }
                things.free.extend(thing.movable.then_some(thing.pose));
            }
        }
        for (number, (shape, meshes)) in things.shapes.iter_mut().enumerate() {
            meshes.name = format!("{}_size_{number}", shape.prototype);
        }
        Ok(things)
    }

    /// Whether there are any.
    pub fn are_there(&self) -> bool {
        !self.shapes.is_empty()
    }

    /// Whether a thing has a hull.
    fn is_touched(&self, thing: &Instance, prototype: &Prototype) -> bool {
        let [low, high] = prototype.hull.bounds();
        let longest = (0..3).map(|axis| f64::from(high[axis] - low[axis])).fold(0.0, f64::max);
        thing.movable || longest * thing.scale >= self.least_hull_m
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
        for Shape { prototype, level, .. } in self.shapes.keys().filter(|_| self.are_seen) {
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
        for (Shape { prototype, level, scale }, meshes) in &self.shapes {
            let size = micro(f64::from_bits(*scale));
            let (name, scale) = (format!("{scene}_{}", meshes.name), format!("{size} {size} {size}"));
            if self.are_seen {
                let path = visual_file(prototype, *level);
                writeln!(file, r#"    <mesh name="{name}" file="{path}" scale="{scale}" inertia="shell"/>"#)?;
            }
            let known = self.prototypes.iter().find(|known| known.name == *prototype);
            if let Some(known) = known.filter(|_| meshes.are_touched) {
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
            if self.is_touched(&thing, prototype) {
                shapes += ShapeCount { geoms: 1, triangles: prototype.hull.triangles() };
            }
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
        let Some(meshes) = self.shapes.get(&Shape::of(thing)) else {
            return Ok(());
        };
        let (name, mesh) = (format!("{scene}_{}", names::thing(thing)), format!("{scene}_{}", meshes.name));
        let pose = pose_text(&thing.pose);
        let (at, mass) = match thing.movable {
            true => (String::new(), format!(r#" mass="{}""#, micro(thing.mass_kg))),
            false => (format!(" {pose}"), String::new()),
        };
        if thing.movable {
            writeln!(file, r#"      <body name="{name}" {pose}><freejoint name="{name}"/>"#)?;
        }
        if self.are_seen {
            let material = format!("{scene}_{}", prototype.material.name);
            let visual = format!(r#"class="{scene}_visual" mesh="{mesh}" material="{material}""#);
            writeln!(file, r#"      <geom name="{name}" {visual}{at}/>"#)?;
        }
        if self.is_touched(thing, prototype) {
            let hull = format!(r#"class="{scene}_{}" mesh="{mesh}_hull""#, prototype.zone.name());
            writeln!(file, r#"      <geom name="{name}_hull" {hull}{at}{mass}/>"#)?;
        }
        if thing.movable {
            writeln!(file, "      </body>")?;
        }
        Ok(())
    }
}

fn visual_file(prototype: &str, level: usize) -> String {
    format!("assets/{prototype}_level_{level}.msh")
}
