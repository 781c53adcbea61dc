//! Targets by name, with their options.

use std::sync::Arc;
use std::time::Duration;

use cpu_time::ThreadTime;
use plume_exporters::bundle::Bundle;
use plume_exporters::package::Files;
use plume_exporters::place::Place;
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::{Choice, ExportError, Summary, TARGETS, Target, TargetRow};
use rayon::prelude::*;
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
    let Some(row) = rows.find(|row| !row.has(bundle)) else { return Ok(bundle) };
    let able = TARGETS.iter().filter(|row| row.has(bundle));
    let hint = format!("targets that have it: {}", able.map(|row| row.name).collect::<Vec<_>>().join(", "));
    Err(CaveError::Usage { message: format!("target `{}` has no bundle `{name}`", row.name), hint })
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

/// A package to be written.
pub struct Order {
    /// What was asked for.
    pub choice: Choice,
    /// The target that was built of it.
    pub target: Box<dyn Target>,
    /// Where the package goes.
    pub place: Place,
}

/// A package that was written.
pub struct Exported {
    /// What the target says of it.
    pub summary: Summary,
    /// Its files.
    pub files: Files,
    /// Processor time that it took.
    pub cpu: Duration,
}

/// Writes packages of a scene, as many at once as there are threads; each appears whole or not at all. Memory: a few chunks a
/// thread. Chunks are loaded for each package anew: that is about a tenth of the time that a package takes, and to keep them would
/// tie all packages to one pace, or hold all chunks.
///
/// # Errors
/// The first in the order of `orders`, after all are done: something else is at a place, the scene cannot be read, the
/// disk refuses.
pub fn export(scene: &Scene, orders: &[Order]) -> Result<Vec<Exported>, ExportError> {
    let all: Vec<_> = orders.par_iter().map(|order| export_one(scene, order)).collect();
    all.into_iter().collect()
}

fn export_one(scene: &Scene, order: &Order) -> Result<Exported, ExportError> {
    let clock = ThreadTime::now();
    let (summary, files) = order.place.write(&order.choice.name(), &*order.target, scene)?;
    Ok(Exported { summary, files, cpu: clock.elapsed() })
}
