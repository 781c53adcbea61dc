//! Writes a resolved [`scene::Scene`] as packages for simulators.
//!
//! This crate has never heard of a cave: it gets meshes, encoded textures, lights and poses, in metres and Z up, and
//! writes what each simulator expects. Targets never name each other; what they share are formats ([`mod@format`], [`stage`]), the frame
//! changes ([`frame`]) and the sink ([`package`]). A new target is one file and one row of [`TARGETS`].

use std::sync::Arc;

use schemars::Schema;
use serde_json::Value;

pub mod assimp;
pub mod bundle;
pub mod check;
mod chunk_files;
pub mod collision;
pub mod contents;
pub mod error;
pub mod fbx;
mod foreign;
pub mod format;
pub mod frame;
pub mod gazebo;
pub mod glb;
pub mod gltf;
pub mod isaac;
pub mod manifest;
pub mod mujoco;
pub mod names;
pub mod obj;
pub mod package;
mod pinch;
pub mod place;
pub mod ply;
pub mod scene;
mod slope;
pub mod stage;
pub mod stl;
mod template;
pub mod unity;
pub mod unreal;
pub mod urdf;
pub mod usd;
pub mod usdz;

use bundle::Bundle;
pub use error::ExportError;
use frame::Axes;
use package::Package;
use scene::{ImageFormat, Scene};

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
    /// What is written, in full: Markdown for the README.
    pub contents: &'static str,
    /// What opens the package in the tests, and with which result: Markdown for the README.
    pub tested_by: &'static str,
    /// Names of the interop checks that open the package.
    pub checks: &'static [&'static str],
    /// Encodings of images that it takes; none if it writes no images.
    pub images: &'static [ImageFormat],
    /// Whether no file of a package names another.
    pub is_single_file: bool,
    /// Whether robots touch convex pieces, always or with the setting `collision = "pieces"`.
    pub has_pieces: bool,
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
    /// In a format that follows the name after a colon, as in `assimp:collada`. Without one, the error lists those there are.
    WithFormat(fn(Option<&str>, Value) -> Built),
}

/// A target, or what is wrong with its settings.
pub type Built = Result<Box<dyn Target>, ExportError>;

impl TargetRow {
    /// The target with these settings; `library` is the USD library of the host program, if it has one.
    ///
    /// # Errors
    /// [`ExportError::Settings`]; [`ExportError::MissingPart`] without a library that fits, where one is needed;
    /// [`ExportError::UnknownFormat`] where a format is.
    pub fn build(&'static self, settings: Value, library: Option<&Arc<dyn stage::Library>>) -> Built {
        Choice { row: self, format: None }.build(settings, library)
    }

    /// Whether a package can become a file of this kind.
    pub fn has(&self, bundle: Bundle) -> bool {
        Bundle::COMMON.contains(&bundle) || self.bundles.contains(&bundle)
    }

    /// Every kind of file that a package can become.
    pub fn all_bundles(&self) -> impl Iterator<Item = Bundle> {
        Bundle::ALL.into_iter().filter(|bundle| self.has(*bundle))
    }

    /// Whether the host program must lend a USD library.
    pub fn needs_usd(&self) -> bool {
        matches!(self.build, Build::WithUsd(_))
    }

    /// Whether the name of a format belongs to it.
    pub fn needs_format(&self) -> bool {
        matches!(self.build, Build::WithFormat(_))
    }

    /// How it is asked for: its name, with `:<id>` where a format belongs to it.
    pub fn usage(&self) -> String {
        let format = if self.needs_format() { ":<id>" } else { "" };
        format!("{}{format}", self.name)
    }
}

/// A target as it is asked for: `gazebo`, or `assimp:collada` with the name of a format.
#[derive(Clone)]
pub struct Choice {
    /// Its row.
    pub row: &'static TargetRow,
    /// The format, where the row [needs](TargetRow::needs_format) one.
    pub format: Option<String>,
}

impl Choice {
    /// The target with these settings; `library` is the USD library of the host program, if it has one.
    ///
    /// # Errors
    /// As [`TargetRow::build`].
    pub fn build(&self, settings: Value, library: Option<&Arc<dyn stage::Library>>) -> Built {
        match self.row.build {
            Build::Plain(build) => build(settings),
            Build::WithUsd(build) => {
                let library = library.ok_or_else(|| ExportError::no_usd(self.row.name))?;
                library.check()?;
                build(settings, Arc::clone(library))
            }
            Build::WithFormat(build) => build(self.format.as_deref(), settings),
        }
    }

    /// What was asked for.
    pub fn name(&self) -> String {
        [Some(self.row.name), self.format.as_deref()].into_iter().flatten().collect::<Vec<_>>().join(":")
    }

    /// The same as part of the name of a folder.
    pub fn folder(&self) -> String {
        self.name().replace(|letter: char| !letter.is_ascii_alphanumeric(), "-")
    }
}

/// Every target, in the order they are listed.
pub static TARGETS: &[TargetRow] = &[
    gazebo::ROW,
    isaac::ROW,
    mujoco::ROW,
    unity::ROW,
    unreal::ROW,
    urdf::ROW,
    usd::ROW,
    usdz::ROW,
    glb::ROW,
    gltf::ROW,
    fbx::ROW,
    obj::ROW,
    ply::ROW,
    stl::ROW,
    assimp::ROW,
];

/// The target called `name`.
///
/// # Errors
/// [`ExportError::UnknownTarget`], which lists the names.
pub fn target(name: &str) -> Result<Choice, ExportError> {
    let (target, format) = name.split_once(':').map_or((name, None), |(target, format)| (target, Some(format)));
    let row = TARGETS.iter().find(|row| row.name == target && (format.is_none() || row.needs_format()));
    let row = row.ok_or_else(|| ExportError::UnknownTarget {
        name: name.to_owned(),
        known: TARGETS.iter().map(TargetRow::usage).collect::<Vec<_>>().join(", "),
    })?;
    Ok(Choice { row, format: format.map(str::to_owned) })
}

/// Reads the settings of a target.
fn settings<T: serde::de::DeserializeOwned>(target: &'static str, table: Value) -> Result<T, ExportError> {
    serde_json::from_value(table).map_err(|source| ExportError::Settings { target, source })
}
