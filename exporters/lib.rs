//! Writes a resolved [`scene::Scene`] as packages for simulators.
//!
//! This crate has never heard of a cave: it gets meshes, encoded textures, lights and poses, in metres and Z up, and
//! writes what each simulator expects. Targets never name each other; what they share are formats ([`format`], [`stage`]), the frame
//! changes ([`frame`]) and the sink ([`package`]). A new target is one file and one row of [`TARGETS`].

use std::sync::Arc;

use schemars::Schema;
use serde_json::Value;

pub mod bundle;
pub mod check;
pub mod collision;
pub mod contents;
pub mod error;
pub mod fbx;
pub mod format;
pub mod frame;
pub mod gazebo;
pub mod gltf;
pub mod isaac;
pub mod manifest;
pub mod mujoco;
pub mod names;
pub mod package;
mod pinch;
pub mod place;
pub mod scene;
mod slope;
pub mod stage;
mod template;
pub mod unity;
pub mod urdf;
pub mod usd;
pub mod usdz;

use bundle::Bundle;
pub use error::ExportError;
use frame::Axes;
use package::Package;
use scene::Scene;

/// Something that writes a scene the way one simulator wants it.
pub trait Target: Send + Sync {
    /// Writes the whole package into `out`, loading one chunk at a time.
    ///
    /// # Errors
    /// When the scene is not what [`scene`] promises, a chunk cannot be loaded or a file cannot be written.
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError>;

    /// The frame that the files are in.
    fn axes(&self) -> Axes;

    /// What of others the package names without containing it, one sentence each.
    fn references(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether [`export`](Self::export) asks the scene for convex pieces, which a host program makes only then.
    fn wants_pieces(&self) -> bool {
        false
    }
}

/// What an export wrote and how it is opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Triangles that cameras see.
    pub visual_triangles: u64,
    /// Triangles that wheels touch, be they of collision meshes or of convex pieces; 0 if the target carries none.
    pub collision_triangles: u64,
    /// A command for a shell in the package folder, or a sentence, that opens the package.
    pub open: String,
}

/// A row of [`TARGETS`].
pub struct TargetRow {
    /// What the user types, and the name of the source file.
    pub name: &'static str,
    /// What is written, in a few words.
    pub summary: &'static str,
    /// What opens the package.
    pub opened_by: &'static str,
    /// Kinds of files that a package can become beside those that every package can, [`Bundle::COMMON`].
    pub bundles: &'static [Bundle],
    /// JSON schema of the settings: meaning, unit, default and range of each.
    pub settings: fn() -> Schema,
    /// Makes the target.
    pub build: Build,
}

/// How a target is made of its settings: a JSON object in which any may be left out.
pub enum Build {
    /// By this crate alone.
    Plain(fn(Value) -> Built),
    /// With the USD library that a host program lends.
    WithUsd(fn(Value, Arc<dyn stage::Library>) -> Built),
}

/// A target, or what is wrong with its settings.
pub type Built = Result<Box<dyn Target>, ExportError>;

impl TargetRow {
    /// The target with these settings; `library` is the USD library of the host program, if it has one.
    ///
    /// # Errors
    /// [`ExportError::Settings`]; [`ExportError::MissingPart`] without a USD library that fits, where one is needed.
    pub fn build(&self, settings: Value, library: Option<&Arc<dyn stage::Library>>) -> Built {
        match self.build {
            Build::Plain(build) => build(settings),
            Build::WithUsd(build) => {
                let library = library.ok_or_else(|| ExportError::no_usd(self.name))?;
                library.check()?;
                build(settings, Arc::clone(library))
            }
        }
    }

    /// Whether a package can become a file of this kind.
    pub fn has(&self, bundle: Bundle) -> bool {
        Bundle::COMMON.contains(&bundle) || self.bundles.contains(&bundle)
    }

    /// Whether the host program must lend a USD library.
    pub fn needs_usd(&self) -> bool {
        matches!(self.build, Build::WithUsd(_))
    }
}

/// Every target, in the order they are listed.
pub static TARGETS: &[TargetRow] =
    &[gazebo::ROW, isaac::ROW, mujoco::ROW, usd::ROW, usdz::ROW, gltf::ROW, fbx::ROW, unity::ROW, urdf::ROW];

/// The row called `name`.
///
/// # Errors
/// [`ExportError::UnknownTarget`], which lists the names.
pub fn target(name: &str) -> Result<&'static TargetRow, ExportError> {
    TARGETS.iter().find(|row| row.name == name).ok_or_else(|| ExportError::UnknownTarget {
        name: name.to_owned(),
        known: TARGETS.iter().map(|row| row.name).collect::<Vec<_>>().join(", "),
    })
}

/// Reads the settings of a target.
fn settings<T: serde::de::DeserializeOwned>(target: &'static str, table: Value) -> Result<T, ExportError> {
    serde_json::from_value(table).map_err(|source| ExportError::Settings { target, source })
}
