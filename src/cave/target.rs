//! Targets by name, with their options.

use std::sync::Arc;
use std::time::Duration;

use cpu_time::ThreadTime;
use plume_exporters::bundle::Bundle;
use plume_exporters::package::Files;
use plume_exporters::place::Place;
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::{ExportError, Summary, TARGETS, Target, TargetRow};
use rayon::prelude::*;
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
    let Some(row) = rows.iter().find(|row| !row.has(bundle)) else { return Ok(bundle) };
    let able = TARGETS.iter().filter(|row| row.has(bundle));
    let able: Vec<&str> = able.map(|row| row.name).collect();
    let hint = match able.is_empty() {
        true => "no target has it".to_owned(),
        false => format!("targets that have it: {}", able.join(", ")),
    };
    Err(CaveError::Usage { message: format!("target `{}` has no bundle `{name}`", row.name), hint })
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

/// A package to be written.
pub struct Order {
    /// The row of the target.
    pub row: &'static TargetRow,
    /// The target, built from the row.
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
    let (summary, files) = order.place.write(order.row, &*order.target, scene)?;
    Ok(Exported { summary, files, cpu: clock.elapsed() })
}
