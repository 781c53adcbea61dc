//! Targets by name, with their options.

use std::sync::Arc;
use std::time::Duration;

use cpu_time::ThreadTime;
use plume_exporters::bundle::Bundle;
use plume_exporters::check::{Report, check};
use plume_exporters::package::Files;
use plume_exporters::place::Place;
use plume_exporters::scene::Scene;
use plume_exporters::stage::Library;
use plume_exporters::with::With;
use plume_exporters::{Choice, ExportError, Summary, TARGETS, Target, TargetRow};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::CaveError;
use crate::recipe::{self, Recipe};
use crate::store::sha256;
use crate::texture::MapFormats;
use plume_graph::echo::{plain, shown};

/// The target called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which suggests the nearest.
pub fn target(name: &str) -> Result<Choice, CaveError> {
    let name = name.trim();
    let usages: Vec<String> = TARGETS.iter().map(TargetRow::usage).collect();
    let unknown = |_| CaveError::unknown("target", name, usages.iter().map(String::as_str));
    plume_exporters::target(name).map_err(unknown)
}

/// The kind of bundle called `name`, which all these targets support.
///
/// # Errors
/// [`CaveError::Usage`], which suggests the nearest, or the targets that support it.
pub fn bundle(name: &str, choices: &[Choice]) -> Result<Bundle, CaveError> {
    let bundle = Bundle::ALL.into_iter().find(|bundle| bundle.name() == name);
    let bundle = bundle.ok_or_else(|| CaveError::unknown("bundle", name, Bundle::ALL.map(Bundle::name).into_iter()))?;
    let mut rows = choices.iter().map(|choice| choice.row);
    let Some(row) = rows.find(|row| !row.has(bundle)) else { return Ok(bundle) };
    let able = TARGETS.iter().filter(|row| row.has(bundle));
    let hint = format!("targets that support it: {}", able.map(|row| row.name).collect::<Vec<_>>().join(", "));
    Err(CaveError::Usage { message: format!("target `{}` does not support the bundle `{name}`", row.name), hint })
}

/// Refuses a recipe whose textures have a format that one of these targets does not take. Targets without images take any.
///
/// # Errors
/// [`CaveError::Usage`], which names the formats that the target takes.
pub fn refuse_unfit_images(rows: &[&TargetRow], recipe: &Recipe) -> Result<(), CaveError> {
    let format = recipe.texture().format;
    let takes = |row: &TargetRow, format: MapFormats| row.images.is_empty() || format.is_among(row.images);
    let Some(row) = rows.iter().find(|row| !takes(row, format)) else { return Ok(()) };
    let taken = MapFormats::ALL.into_iter().filter(|format| takes(row, *format)).map(MapFormats::name);
    let able = TARGETS.iter().filter(|row| format.is_among(row.images)).map(|row| row.name);
    Err(CaveError::Usage {
        message: format!("target `{}` does not take texture.format = {:?}", row.name, format.name()),
        hint: format!(
            "formats that it takes: {}; targets that take {}: {}",
            taken.collect::<Vec<_>>().join(", "),
            format.name(),
            able.collect::<Vec<_>>().join(", ")
        ),
    })
}

/// A target with its options.
pub struct Wanted {
    /// The target as requested.
    pub choice: Choice,
    /// The target built from its options, with others inside if that was requested.
    pub target: Box<dyn Target>,
    settings: Value,
}

impl Wanted {
    /// SHA-256 of everything that its package of the cave with this fingerprint follows from.
    fn fingerprint(&self, cave: &str) -> String {
        let revision = match self.choice.row.revision {
            0 => String::new(),
            revision => format!("\nrevision {revision}"),
        };
        let target = self.choice.name() + &revision;
        sha256([cave, &target, &self.settings.to_string()].join("\n").as_bytes())
    }
}

/// The targets with their options, `TARGET.KEY=VALUE`; each package holds those of `inside` in folders with their names, and
/// `library` is the USD library of the host program.
///
/// # Errors
/// Faulty options; a missing USD library; the same target twice in a package.
pub fn build(
    choices: Vec<Choice>,
    inside: &[Choice],
    options: &[String],
    library: Option<&Arc<dyn Library>>,
) -> Result<Vec<Wanted>, CaveError> {
    let all = choices.iter().chain(inside);
    let rows: Vec<&TargetRow> = all.clone().map(|choice| choice.row).collect();
    options.iter().try_for_each(|pair| refuse_stray(pair, &rows))?;
    let schemas: Map<String, Value> =
        all.map(|Choice { row, .. }| (row.name.to_owned(), (row.settings)().to_value())).collect();
    let schema = json!({"type": "object", "properties": schemas});
    let settings = recipe::options(&schema, options)?;
    let built = |choice: &Choice| choice.build(settings[choice.row.name].clone(), library).map_err(named);
    let wanted = choices.into_iter().map(|choice| {
        refuse_twice(&choice, inside)?;
        let own = settings[choice.row.name].clone();
        let target = built(&choice)?;
        if inside.is_empty() {
            return Ok(Wanted { choice, target, settings: own });
        }
        let others =
            inside.iter().map(|other| Ok((other.folder(), built(other)?))).collect::<Result<_, CaveError>>()?;
        let target = Box::new(With { target, inside: others });
        let others: Map<String, Value> =
            inside.iter().map(|other| (other.name(), settings[other.row.name].clone())).collect();
        Ok(Wanted { choice, target, settings: json!([own, others]) })
    });
    wanted.collect()
}

/// Refuses an option without its target, or of a target that is not among `rows`.
fn refuse_stray(pair: &str, rows: &[&TargetRow]) -> Result<(), CaveError> {
    let Some((key, value)) = pair.split_once('=') else { return Ok(()) };
    let (target, option) = match key.trim().split_once('.') {
        Some((target, option)) => (Some(target), option),
        None => (None, key.trim()),
    };
    let is_known = |row: &TargetRow| target == Some(row.name);
    if rows.iter().any(|row| is_known(row)) {
        return Ok(());
    }
    if let Some(row) = TARGETS.iter().find(|row| is_known(row)) {
        let names: Vec<&str> = rows.iter().map(|row| row.name).collect();
        let message = format!("{}: target `{}` is not exported", shown(pair), row.name);
        return Err(CaveError::Usage { message, hint: format!("exported targets: {}", names.join(", ")) });
    }
    let has_option = |row: &TargetRow| (row.settings)().to_value()["properties"].get(option).is_some();
    let able: Vec<&str> = TARGETS.iter().filter(|row| has_option(row)).map(|row| row.name).collect();
    if target.is_some() || able.is_empty() {
        return Ok(());
    }
    let meant = rows.iter().find(|row| has_option(row));
    let meant =
        meant.map(|row| format!("did you mean {}? ", plain(&format!("{}.{option}={}", row.name, value.trim()))));
    let hint = format!("{}targets with this option: {}", meant.unwrap_or_default(), able.join(", "));
    Err(CaveError::Usage { message: format!("{}: names an option without its target", shown(pair)), hint })
}

/// Refuses a package inside one of the same target, and two of the same target inside one.
fn refuse_twice(choice: &Choice, inside: &[Choice]) -> Result<(), CaveError> {
    let names: Vec<String> = [choice].into_iter().chain(inside).map(Choice::name).collect();
    let twice = names.iter().enumerate().find(|(place, name)| names[..*place].contains(name));
    twice.map_or(Ok(()), |(_, name)| {
        let message = format!("a package of target `{name}` cannot hold one of the same target");
        Err(CaveError::Usage { message, hint: "name each target only once".into() })
    })
}

/// An unknown format, with the nearest name.
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
    /// The target and its options.
    pub wanted: Wanted,
    /// Where the package goes.
    pub place: Place,
}

impl Order {
    /// Whether an intact package of the cave with this fingerprint is there already.
    pub fn is_done(&self, cave: &str) -> bool {
        let is_whole = |report: Report| report.is_whole() && report.fingerprint == self.wanted.fingerprint(cave);
        self.place.path.exists() && check(&self.place.path).is_ok_and(is_whole)
    }

    /// Writes the package; it appears whole or not at all.
    ///
    /// # Errors
    /// If something else is at its path, the scene cannot be read, or the disk fails.
    pub fn write(&self, scene: &Scene) -> Result<(Summary, Files), ExportError> {
        let Wanted { choice, target, .. } = &self.wanted;
        let scene = Scene { fingerprint: self.wanted.fingerprint(&scene.fingerprint), ..scene.clone() };
        self.place.write(&choice.name(), &**target, &scene)
    }
}

/// A written package.
pub struct Exported {
    /// The target's summary.
    pub summary: Summary,
    /// Its files.
    pub files: Files,
    /// CPU time that it took.
    pub cpu: Duration,
}

/// Writes packages of a scene, one per thread in parallel; each appears whole or not at all. Memory: a few chunks per
/// thread. Every package loads its own chunks, which takes about a tenth of its time; sharing them would force all packages
/// to the same pace, or keep all chunks in memory.
///
/// # Errors
/// As [`Order::write`]: after all are done, the first in the order of `orders`.
pub fn export(scene: &Scene, orders: &[Order]) -> Result<Vec<Exported>, ExportError> {
    let all: Vec<_> = orders.par_iter().map(|order| export_one(scene, order)).collect();
    all.into_iter().collect()
}

fn export_one(scene: &Scene, order: &Order) -> Result<Exported, ExportError> {
    let clock = ThreadTime::now();
    let (summary, files) = order.write(scene)?;
    Ok(Exported { summary, files, cpu: clock.elapsed() })
}
