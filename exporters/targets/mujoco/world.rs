//! The cave in MJCF: what its chunks share, and the elements of each.
//!
//! An archive has all in one file. Otherwise each chunk has a file of its own, with the material that no other one uses, so that a
//! model may include a part of a large cave. Memory: the convex pieces of one chunk.

use std::collections::BTreeSet;
use std::io::{self, Write};

use serde_json::json;

use crate::error::ExportError;
use crate::package::Package;
use crate::scene::{Content, Scene};
use crate::template;

use super::Mujoco;
use super::chunk::{self, Rock, ShapeCount};
use super::things::Things;

/// Folder of the files of chunks.
const FOLDER: &str = "chunks/";
/// The box of each chunk.
const INDEX: &str = "chunks.json";

/// A cave whose meshes and images are written.
pub struct World<'a> {
    target: &'a Mujoco,
    scene: &'a Scene<'a>,
    parts: Vec<Part>,
    /// Materials of several chunks.
    shared: BTreeSet<String>,
    /// Its things.
    pub things: Things,
    /// Triangles to be seen.
    pub visual_triangles: u64,
}

/// What is known of a chunk.
struct Part {
    /// Its index in the scene.
    index: usize,
    chunk: String,
    content: Content,
    /// That of what is drawn.
    material: Option<String>,
    bounds_m: [[f32; 3]; 2],
}

impl<'a> World<'a> {
    /// Writes the meshes and images of a scene.
    ///
    /// # Errors
    /// If a chunk cannot be read or has images that MuJoCo does not read; those of the package.
    pub fn write_files(target: &'a Mujoco, scene: &'a Scene<'a>, out: &mut dyn Package) -> Result<Self, ExportError> {
        let is_seen = target.0.visuals;
        let (mut parts, mut visual_triangles) = (Vec::new(), 0);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            let is_mesh = matches!(chunk.content, Content::Wall | Content::Gravel { .. });
            if is_seen {
                visual_triangles += chunk.visual.triangles();
                chunk::write_images(&chunk, out)?;
            }
            if is_seen && is_mesh {
                chunk::write_visual(&chunk, out)?;
            }
            if is_seen || !matches!(chunk.content, Content::Gravel { .. }) {
                let bounds_m = chunk.visual.bounds();
                let material = is_seen.then_some(chunk.material.name);
                parts.push(Part { index, chunk: chunk.name, content: chunk.content, material, bounds_m });
            }
        }
        let things = Things::of(scene, &target.0)?;
        things.write_files(out)?;
        Ok(Self { target, scene, shared: shared(&parts), parts, things, visual_triangles })
    }

    /// Writes the model `path`, some text and the whole cave. Returns how many collision shapes it has.
    ///
    /// # Errors
    /// If a chunk cannot be read; those of the package.
    pub fn write_whole(&self, path: &str, options: &str, out: &mut dyn Package) -> Result<ShapeCount, ExportError> {
        let mut shapes = ShapeCount::default();
        out.write(path, |file| {
            write!(file, "<mujoco model=\"{}\">\n{options}", self.scene.name)?;
            self.write_shared(file)?;
            for part in &self.parts {
                self.write_own_material(file, part)?;
                shapes += self.write_elements(file, part)?;
            }
            Ok(writeln!(file, "</mujoco>")?)
        })?;
        Ok(shapes)
    }

    /// Writes the world, and what it includes. Returns how many collision shapes it has.
    ///
    /// # Errors
    /// As [`Self::write_whole`].
    pub fn write_parts(&self, out: &mut dyn Package) -> Result<ShapeCount, ExportError> {
        let mut shapes = ShapeCount::default();
        let name = &self.scene.name;
        let shared = format!("{name}_shared.xml");
        out.write(&shared, |file| {
            writeln!(file, "<mujocoinclude>")?;
            self.write_shared(file)?;
            Ok(writeln!(file, "</mujocoinclude>")?)
        })?;
        for part in &self.parts {
            out.write(&part.file(), |file| {
                writeln!(file, "<mujocoinclude>")?;
                self.write_own_material(file, part)?;
                shapes += self.write_elements(file, part)?;
                Ok(writeln!(file, "</mujocoinclude>")?)
            })?;
        }
        out.write(&format!("{name}_world.xml"), |file| {
            writeln!(file, "<mujoco model=\"{name}\">\n  <include file=\"{shared}\"/>")?;
            self.parts.iter().try_for_each(|part| writeln!(file, "  <include file=\"{}\"/>", part.file()))?;
            Ok(writeln!(file, "</mujoco>")?)
        })?;
        let described = |part: &Part| json!({ "file": part.file(), "bounds_m": part.bounds_m });
        let index = json!({ "shared": shared, "chunks": self.parts.iter().map(described).collect::<Vec<_>>() });
        out.json(INDEX, &index)?;
        Ok(shapes)
    }

    /// Writes what several chunks use.
    fn write_shared(&self, file: &mut dyn Write) -> io::Result<()> {
        let template = include_str!("../../templates/mujoco/world.xml.jinja");
        write!(file, "{}", template::fill("world.xml", template, &self.target.values(self.scene)))?;
        self.things.write_assets(file, &self.scene.name)?;
        self.shared.iter().try_for_each(|material| chunk::write_material(file, self.scene, material))
    }

    /// Writes the material of a chunk that no other one uses.
    fn write_own_material(&self, file: &mut dyn Write, part: &Part) -> io::Result<()> {
        match part.material.as_ref().filter(|material| !self.shared.contains(*material)) {
            Some(material) => chunk::write_material(file, self.scene, material),
            None => Ok(()),
        }
    }

    fn write_elements(&self, file: &mut dyn Write, part: &Part) -> Result<ShapeCount, ExportError> {
        let Part { index, chunk, content, material, .. } = part;
        let rock = match content {
            Content::Wall => self.target.rock(self.scene, *index)?,
            Content::Gravel { .. } => Rock::Pieces(Vec::new()),
            Content::Things { .. } => return self.things.write_chunk(file, self.scene, *index, chunk),
        };
        chunk::write_elements(file, self.scene, chunk, material.as_deref(), &rock)?;
        Ok(rock.shapes())
    }
}

/// Materials of several chunks.
fn shared(parts: &[Part]) -> BTreeSet<String> {
    let (mut seen, mut shared) = (BTreeSet::new(), BTreeSet::new());
    for material in parts.iter().filter_map(|part| part.material.as_ref()) {
        if !seen.insert(material) {
            shared.insert(material.clone());
        }
    }
    shared
}

impl Part {
    fn file(&self) -> String {
        format!("{FOLDER}{}.xml", self.chunk)
    }
}
