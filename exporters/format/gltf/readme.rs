//! The README of glTF packages.

use minijinja::context;

use super::Compression;
use crate::error::ExportError;
use crate::package::Package;
use crate::scene::Scene;
use crate::template;

/// Values for the text.
pub struct Readme<'a> {
    /// What to open.
    pub open: &'a str,
    /// What holds the coarser levels of detail, if they are there.
    pub levels: Option<&'a str>,
    /// Whether there are convex pieces.
    pub pieces: bool,
    /// Compression of vertices and triangles.
    pub compression: Compression,
    /// Whether things with the same mesh are one node.
    pub instancing: bool,
}

impl Readme<'_> {
    /// Writes `README.md`.
    ///
    /// # Errors
    /// Those of the package.
    pub fn write(&self, scene: &Scene, out: &mut dyn Package) -> Result<(), ExportError> {
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            open => self.open,
            levels => self.levels,
            is_apart => self.levels.is_some_and(|levels| levels != self.open),
            pieces => self.pieces,
            instancing => self.instancing,
            is_packed => self.compression == Compression::Meshopt,
        };
        let text = template::fill("README.md", include_str!("../../templates/gltf/README.md.jinja"), &values);
        out.text("README.md", &text)
    }
}
