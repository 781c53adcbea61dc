//! Destinations of packages, and how a complete package is written: the target's files, its licence, and its manifest.
//!
//! ```
//! use plume_exporters::place::{Existing, Place};
//!
//! let folder = tempfile::tempdir()?;
//! std::fs::write(folder.path().join("thesis.txt"), "mine")?;
//! let place = Place { path: folder.path().to_owned(), bundle: None, existing: Existing::Replace };
//! assert!(place.check().is_err(), "no export wrote what is there");
//! # Ok::<(), std::io::Error>(())
//! ```

use std::path::PathBuf;

use minijinja::context;
pub use plume_disk::Existing;

pub use self::archive::Archive;
pub use self::folder::Folder;
use crate::bundle::Bundle;
use crate::error::ExportError;
use crate::instances;
use crate::manifest::Manifest;
use crate::manifest::recorder::RecordingChunks;
use crate::package::{Files, MANIFEST, Package};
use crate::scene::Scene;
use crate::stations;
use crate::target::{Open, Summary, Target};
use crate::template;

mod archive;
mod folder;
mod pack;
mod user_files;

/// Name of the licence file.
pub const LICENSE: &str = "LICENSE.md";

/// Destination of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The folder or file.
    pub path: PathBuf,
    /// The kind of bundle, if the package is not a folder.
    pub bundle: Option<Bundle>,
    /// What to do with an existing package.
    pub existing: Existing,
}

impl Place {
    /// Whether a package can be made here: checked before the long work.
    ///
    /// # Errors
    /// As [`Folder::check`] and [`Archive::check`].
    pub fn check(&self) -> Result<(), ExportError> {
        match self.bundle {
            None => Folder::check(&self.path, self.existing),
            Some(_) => Archive::check(&self.path, self.existing),
        }
    }

    /// Writes the package; it appears whole or not at all. `name` is the requested target, such as `gazebo`.
    ///
    /// # Errors
    /// If something else is here, the scene cannot be read, or the disk fails.
    pub fn write(&self, name: &str, target: &dyn Target, scene: &Scene) -> Result<(Summary, Files), ExportError> {
        match self.bundle {
            None => {
                let mut folder = Folder::create(&self.path, self.existing)?;
                let summary = fill(name, target, scene, &mut folder)?;
                Ok((summary, folder.finish()?))
            }
            Some(bundle) => {
                let mut archive = Archive::create(bundle, &self.path, self.existing)?;
                let mut summary = fill(name, target, scene, &mut archive)?;
                if Bundle::COMMON.contains(&bundle) {
                    summary.open = Open::Words(format!("unpack it, then in its folder: {}", summary.open.text()));
                }
                Ok((summary, archive.finish()?))
            }
        }
    }
}

/// Writes a complete package into `out`, which is empty. `name` is the requested target, such as `gazebo`.
///
/// # Errors
/// As [`Target::export`].
pub fn fill(name: &str, target: &dyn Target, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
    let recording = RecordingChunks::new(scene);
    let recorded = Scene { chunks: &recording, ..scene.clone() };
    let summary = target.export(&recorded, out)?;
    let values = context! {
        name => &scene.name,
        generator => &scene.generator,
        target => name,
        license => env!("CARGO_PKG_LICENSE"),
        repository => env!("CARGO_PKG_REPOSITORY"),
        references => target.references().to_vec(),
    };
    let license = template::fill(LICENSE, include_str!("templates/package/LICENSE.md.jinja"), &values);
    out.text(LICENSE, &license)?;
    let facts = recording.facts(scene)?;
    let things = instances::write(target, scene, out)?;
    stations::write(scene, out)?;
    let manifest = Manifest::new(name, target, scene, &facts, things, out);
    out.text(MANIFEST, &manifest.to_text()?)?;
    Ok(summary)
}
