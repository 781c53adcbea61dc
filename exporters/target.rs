//! What every target is, and the row by which it is found.

use std::sync::Arc;

use plume_registry::{Named, settings_schema};
use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::bundle::Bundle;
use crate::error::ExportError;
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::Scene;
use crate::stage;

/// Writes a scene in the form that a simulator expects.
pub trait Target: Send + Sync {
    /// Writes the whole package into `out`, loading one chunk at a time.
    ///
    /// # Errors
    /// When the scene is not what [`scene`](crate::scene) promises, a chunk cannot be loaded or a file cannot be written.
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError>;

    /// The frame that the files are in.
    fn axes(&self) -> Axes;

    /// Third-party items that the package refers to without containing them, one sentence each.
    fn references(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether [`export`](Self::export) uses convex pieces, which a host program makes only in this case.
    fn wants_pieces(&self) -> bool {
        false
    }

    /// Whether movable things are bodies that move in the package; if not, they are part of the static world.
    fn moves_things(&self) -> bool {
        false
    }
}

/// What an export wrote and how to open it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// Visual triangles.
    pub visual_triangles: u64,
    /// Collision triangles, of collision meshes or convex pieces; 0 if the target has none.
    pub collision_triangles: u64,
    /// How to open the package.
    pub open: Open,
}

/// How to open a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Open {
    /// A shell command to run in its folder.
    Command(String),
    /// What to do, in words.
    Words(String),
}

impl Open {
    /// The command, or the words.
    pub fn text(&self) -> &str {
        match self {
            Self::Command(text) | Self::Words(text) => text,
        }
    }
}

/// A row of [`TARGETS`](crate::TARGETS).
pub struct TargetRow {
    /// Its name on the command line.
    pub name: &'static str,
    /// Short summary of what is written.
    pub summary: &'static str,
    /// Which version of the target this is: packages that another one wrote are written again.
    pub revision: u32,
    /// Programs that open the package.
    pub opened_by: &'static str,
    /// What is written, in full: Markdown for `docs/formats.md`.
    pub contents: &'static str,
    /// Programs that open the package in the tests, and with which result: Markdown for `docs/formats.md`.
    pub tested_by: &'static str,
    /// Names of the interop checks that open the package.
    pub checks: &'static [&'static str],
    /// Supported encodings of images; none if it writes no images.
    pub images: &'static [ImageFormat],
    /// Whether no file of a package refers to another.
    pub is_single_file: bool,
    /// Whether it writes convex pieces, always or with the setting `collision = "pieces"`.
    pub has_pieces: bool,
    /// Kinds of bundles in addition to those that every target supports, [`Bundle::COMMON`].
    pub bundles: &'static [Bundle],
    /// JSON schema of the settings: meaning, unit, default and range of each.
    pub settings: fn() -> Schema,
    /// Makes the target.
    pub build: Build,
}

/// The USD library that a host program lends.
pub type Lent = Arc<dyn stage::Library>;

/// How a target is made from its settings: a JSON object, in which all keys are optional.
pub enum Build {
    /// By this crate alone.
    Plain(fn(Value) -> Built),
    /// With the USD library that a host program lends.
    WithUsd(fn(Value, Lent) -> Built),
    /// In a format given after a colon, as in `assimp:collada`. Without one, the error lists all formats.
    WithFormat(fn(Option<&str>, Value) -> Built),
}

/// A target, or why there is none.
pub type Built = Result<Box<dyn Target>, BuildError>;

/// Why a target could not be made.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// Its settings cannot be read.
    #[error(transparent)]
    Settings(#[from] serde_json::Error),
    /// A library or a format is missing.
    #[error(transparent)]
    Export(#[from] ExportError),
}

impl TargetRow {
    /// The row of a target whose settings are its fields, each with a doc comment, a range and a default. It takes PNG and
    /// JPEG; the other facts are empty or no.
    ///
    /// ```
    /// # use plume_exporters::{TargetRow, package::Package, frame::Axes, scene::Scene, ExportError, Open, Summary, Target};
    /// # #[derive(Default, serde::Deserialize, schemars::JsonSchema)] #[serde(default)] struct Names {}
    /// # impl Target for Names {
    /// #     fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
    /// #         let names = (0..scene.chunks.len()).map(|index| Ok(scene.chunk(index)?.name));
    /// #         out.text("names.txt", &names.collect::<Result<Vec<_>, ExportError>>()?.join("\n"))?;
    /// #         Ok(Summary { visual_triangles: 0, collision_triangles: 0, open: Open::Command("cat names.txt".to_owned()) })
    /// #     }
    /// #     fn axes(&self) -> Axes { Axes::SCENE }
    /// # }
    /// const ROW: TargetRow = TargetRow {
    ///     opened_by: "any text editor",
    ///     images: &[],
    ///     ..TargetRow::new::<Names>("names", "the names of the chunks")
    /// };
    /// ```
    pub const fn new<T>(name: &'static str, summary: &'static str) -> Self
    where
        T: Target + DeserializeOwned + JsonSchema + 'static,
    {
        Self {
            name,
            summary,
            revision: 0,
            opened_by: "",
            contents: "",
            tested_by: "",
            checks: &[],
            images: &ImageFormat::COMMON,
            is_single_file: false,
            has_pieces: false,
            bundles: &[],
            settings: settings_schema::<T>,
            build: Build::Plain(|table| Ok(Box::new(serde_json::from_value::<T>(table)?))),
        }
    }

    /// Builds the target with these settings; `library` is the USD library of the host program, if it has one.
    ///
    /// # Errors
    /// [`ExportError::Settings`]; [`ExportError::MissingPart`] if a required library is missing;
    /// [`ExportError::UnknownFormat`] if a required format is unknown.
    pub fn build(&'static self, settings: Value, library: Option<&Lent>) -> Result<Box<dyn Target>, ExportError> {
        Choice { row: self, format: None }.build(settings, library)
    }

    /// Whether it supports this kind of bundle.
    pub fn has(&self, bundle: Bundle) -> bool {
        Bundle::COMMON.contains(&bundle) || self.bundles.contains(&bundle)
    }

    /// All supported kinds of bundles.
    pub fn all_bundles(&self) -> impl Iterator<Item = Bundle> {
        Bundle::ALL.into_iter().filter(|bundle| self.has(*bundle))
    }

    /// Whether the host program must lend a USD library.
    pub fn needs_usd(&self) -> bool {
        matches!(self.build, Build::WithUsd(_))
    }

    /// Whether it needs the name of a format.
    pub fn needs_format(&self) -> bool {
        matches!(self.build, Build::WithFormat(_))
    }

    /// Its notation on the command line: its name, with `:<id>` if it needs a format.
    pub fn usage(&self) -> String {
        let format = if self.needs_format() { ":<id>" } else { "" };
        format!("{}{format}", self.name)
    }
}

impl Named for TargetRow {
    fn name(&self) -> &'static str {
        self.name
    }
}

impl std::fmt::Debug for TargetRow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TargetRow").field("name", &self.name).finish_non_exhaustive()
    }
}

/// A requested target: `gazebo`, or `assimp:collada` with the name of a format.
#[derive(Clone)]
pub struct Choice {
    /// Its row.
    pub row: &'static TargetRow,
    /// The format, if the row [needs](TargetRow::needs_format) one.
    pub format: Option<String>,
}

impl Choice {
    /// Builds the target with these settings; `library` is the USD library of the host program, if it has one.
    ///
    /// # Errors
    /// As [`TargetRow::build`].
    pub fn build(&self, settings: Value, library: Option<&Lent>) -> Result<Box<dyn Target>, ExportError> {
        let target = self.row.name;
        let built = match self.row.build {
            Build::Plain(build) => build(settings),
            Build::WithUsd(build) => {
                let library = library.ok_or_else(|| ExportError::no_usd(target))?;
                library.check()?;
                build(settings, Arc::clone(library))
            }
            Build::WithFormat(build) => build(self.format.as_deref(), settings),
        };
        built.map_err(|error| match error {
            BuildError::Settings(source) => ExportError::Settings { target, source },
            BuildError::Export(error) => error,
        })
    }

    /// What was asked for.
    pub fn name(&self) -> String {
        [Some(self.row.name), self.format.as_deref()].into_iter().flatten().collect::<Vec<_>>().join(":")
    }

    /// The same for use in the name of a folder.
    pub fn folder(&self) -> String {
        self.name().replace(|letter: char| !letter.is_ascii_alphanumeric(), "-")
    }
}
