//! Targets by name, with their options.

use std::path::Path;
use std::sync::Arc;

use plume_exporters::bundle::{Archive, Bundle};
use plume_exporters::package::{Existing, Files, Folder};
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::{Choice, ExportError, Summary, TARGETS, Target, TargetRow};
use serde_json::{Map, Value, json};

use super::CaveError;
use crate::recipe;

/// The target called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which names the nearest.
pub fn target(name: &str) -> Result<Choice, CaveError> {
    let usages: Vec<String> = TARGETS.iter().map(TargetRow::usage).collect();
    let unknown = |_| CaveError::unknown("target", name, usages.iter().map(String::as_str));
    plume_exporters::target(name).map_err(unknown)
}

/// The kind of file called `name`, into which each target can put its package.
///
/// # Errors
/// [`CaveError::Usage`], which names the nearest, or the targets that have it.
pub fn bundle(name: &str, choices: &[Choice]) -> Result<Bundle, CaveError> {
    let bundle = Bundle::ALL.into_iter().find(|bundle| bundle.name() == name);
    let bundle = bundle.ok_or_else(|| CaveError::unknown("bundle", name, Bundle::ALL.map(Bundle::name).into_iter()))?;
    let mut rows = choices.iter().map(|choice| choice.row);
    let Some(row) = rows.find(|row| !row.bundles.contains(&bundle)) else { return Ok(bundle) };
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
    choices: &[Choice],
    options: &[String],
    library: Option<&Arc<dyn Library>>,
) -> Result<Vec<Box<dyn Target>>, CaveError> {
    let schemas: Map<String, Value> =
        choices.iter().map(|Choice { row, .. }| (row.name.to_owned(), (row.settings)().to_value())).collect();
    let schema = json!({"type": "object", "properties": schemas});
    let settings = recipe::options(&schema, options)?;
    choices.iter().map(|choice| choice.build(settings[choice.row.name].clone(), library).map_err(named)).collect()
}

/// An unknown format with the name that is nearest.
fn named(error: ExportError) -> CaveError {
    match error {
        ExportError::UnknownFormat { target, name, known } => {
            let known: Vec<String> = known.iter().map(|format| format!("{target}:{format}")).collect();
            let name = if name.is_empty() { target.to_owned() } else { format!("{target}:{name}") };
            CaveError::unknown("target", &name, known.iter().map(String::as_str))
        }
        error => error.into(),
    }
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
