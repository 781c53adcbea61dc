//! Targets by name, with their options.

use std::path::Path;
use std::sync::Arc;

use plume_exporters::bundle::{Archive, Bundle};
use plume_exporters::package::{Existing, Files, Folder};
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::{ExportError, Summary, TARGETS, Target, TargetRow};
use serde_json::{Map, Value, json};

use super::CaveError;
use crate::recipe;

/// The row of the target called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which names the nearest.
pub fn target(name: &str) -> Result<&'static TargetRow, CaveError> {
    let row = TARGETS.iter().find(|row| row.name == name);
    row.ok_or_else(|| CaveError::unknown("target", name, TARGETS.iter().map(|row| row.name)))
}

/// The kind of file called `name`, into which each target can put its package.
///
/// # Errors
/// [`CaveError::Usage`], which names the nearest, or the targets that have it.
pub fn bundle(name: &str, rows: &[&TargetRow]) -> Result<Bundle, CaveError> {
    let bundle = Bundle::ALL.into_iter().find(|bundle| bundle.name() == name);
    let bundle = bundle.ok_or_else(|| CaveError::unknown("bundle", name, Bundle::ALL.map(Bundle::name).into_iter()))?;
    let Some(row) = rows.iter().find(|row| !row.bundles.contains(&bundle)) else { return Ok(bundle) };
    let able = TARGETS.iter().filter(|row| row.bundles.contains(&bundle));
    Err(CaveError::Usage {
        message: format!("target `{}` has no bundle `{name}`", row.name),
        hint: format!("targets that have it: {}", able.map(|row| row.name).collect::<Vec<_>>().join(", ")),
    })
}

/// The targets with their options, `TARGET.KEY=VALUE`; `library` is the USD library of the host program.
///
/// # Errors
/// Faults of the options; a missing USD library, where one is needed.
pub fn build(
    rows: &[&TargetRow],
    options: &[String],
    library: Option<&Arc<dyn Library>>,
) -> Result<Vec<Box<dyn Target>>, CaveError> {
    let schemas: Map<String, Value> =
        rows.iter().map(|row| (row.name.to_owned(), (row.settings)().to_value())).collect();
    let schema = json!({"type": "object", "properties": schemas});
    let settings = recipe::options(&schema, options)?;
    rows.iter().map(|row| Ok(row.build(settings[row.name].clone(), library)?)).collect()
}

/// Writes a package as one file; it appears whole or not at all.
///
/// # Errors
/// As [`export`].
pub fn export_bundle(
    scene: &Scene,
    target: &dyn Target,
    bundle: Bundle,
    path: &Path,
    existing: Existing,
) -> Result<(Summary, Files), ExportError> {
    let mut package = Archive::create(bundle, path, existing)?;
    let summary = target.export(scene, &mut package)?;
    Ok((summary, package.finish()?))
}

/// Writes a package; it appears whole or not at all.
///
/// # Errors
/// When something else is at `path`, the scene cannot be read, or the disk refuses.
pub fn export(
    scene: &Scene,
    target: &dyn Target,
    path: &Path,
    existing: Existing,
) -> Result<(Summary, Files), ExportError> {
    let mut package = Folder::create(path, existing)?;
    let summary = target.export(scene, &mut package)?;
    Ok((summary, package.finish()?))
}
