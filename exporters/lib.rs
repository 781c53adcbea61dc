//! Writes a resolved [`scene::Scene`] as packages for simulators.
//!
//! This crate has never heard of a cave: it gets meshes, encoded textures, lights and poses, in metres and Z up, and
//! writes what each simulator expects. Targets never name each other, unless their package holds that of another ([`with`]);
//! what they share are formats ([`mod@format`], [`stage`]), the frame changes ([`frame`]) and the sink ([`package`]). A new
//! target is one file in [`targets`] and one row of [`TARGETS`].
//!
//! ```
//! use plume_exporters::{TARGETS, target};
//!
//! let without_python: Vec<&str> = TARGETS.iter().filter(|row| !row.needs_usd()).map(|row| row.name).collect();
//! assert!(without_python.contains(&"gazebo") && !without_python.contains(&"isaac"));
//!
//! let gazebo = target("gazebo")?.build(serde_json::json!({"lights": false}), None)?;
//! assert!(!gazebo.wants_pieces());
//! # Ok::<(), plume_exporters::ExportError>(())
//! ```

pub mod bundle;
pub mod check;
mod chunk_files;
#[doc(hidden)]
pub mod collision;
#[doc(hidden)]
pub mod contents;
pub mod error;
pub mod format;
pub mod frame;
mod image_format;
mod inertia;
pub mod instances;
pub mod labels;
pub mod manifest;
#[doc(hidden)]
pub mod names;
pub mod package;
pub mod place;
mod rover;
pub mod scene;
mod slope;
mod split_nonmanifold;
#[doc(hidden)]
pub mod stage;
pub mod stations;
pub mod surface;
mod target;
#[doc(hidden)]
pub mod targets;
mod template;
pub mod with;
mod zip_entry;

use plume_registry::Registry;

pub use error::ExportError;
pub use image_format::ImageFormat;
pub use target::{Build, BuildError, Built, Choice, Lent, Open, Summary, Target, TargetRow};

/// All targets, in the order in which they are listed. Programs may [register](Registry::register) their own.
pub static TARGETS: Registry<TargetRow> = Registry::new(&[
    targets::gazebo::ROW,
    targets::isaac::ROW,
    targets::mujoco::ROW,
    targets::unity::ROW,
    targets::unreal::ROW,
    targets::urdf::ROW,
    targets::usd::ROW,
    targets::usdz::ROW,
    targets::glb::ROW,
    targets::gltf::ROW,
    targets::tiles::ROW,
    targets::fbx::ROW,
    targets::obj::ROW,
    targets::ply::ROW,
    targets::stl::ROW,
    targets::assimp::ROW,
    targets::truth::ROW,
]);

/// The target called `name`.
///
/// # Errors
/// [`ExportError::UnknownTarget`], which lists the names.
pub fn target(name: &str) -> Result<Choice, ExportError> {
    let (target, format) = name.split_once(':').map_or((name, None), |(target, format)| (target, Some(format)));
    let row = TARGETS.find(target).filter(|row| format.is_none() || row.needs_format());
    let row = row.ok_or_else(|| ExportError::UnknownTarget {
        name: name.to_owned(),
        known: TARGETS.iter().map(TargetRow::usage).collect::<Vec<_>>().join(", "),
    })?;
    Ok(Choice { row, format: format.map(str::to_owned) })
}
