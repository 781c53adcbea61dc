//! What follows from a specification: each cave by its number.

use std::path::{Path, PathBuf};

use plume::cave::{self, CaveError, Input, Wanted, named_robot};
use plume::pipeline::Disk;
use plume::recipe::{self, Recipe};
use plume_disk::sealed::sha256;
use plume_exporters::stage::Library;
use plume_exporters::{Choice, TargetRow};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::sync::Arc;

use crate::draw::{Draw, MOST_POINTS, MOST_SOBOL};
use crate::spec::{Part, Spec};

/// Most caves of a dataset.
pub const MOST_ITEMS: usize = 10_000_000;
/// The key that sets several, by the curve of the task.
pub const DIFFICULTY: &str = "difficulty";
/// The key that chooses what a cave is made from.
pub const RECIPE: &str = "recipe";

/// A specification and what its caves are made from.
///
/// Cave `n` follows from the specification and `n` alone: any process can make any of them, in any order.
#[derive(Debug)]
pub struct Plan {
    spec: Spec,
    /// The folder of its file.
    folder: PathBuf,
    disk: Disk,
    /// The part of each seed.
    parts: Vec<Part>,
    fingerprint: String,
}

/// A cave of a dataset, before it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its number, from 0.
    pub number: usize,
    /// The seed of its recipe.
    pub seed: u64,
    /// The part of the dataset that it is in.
    pub part: Part,
    /// What was drawn for it: keys and values, in the order of the specification.
    pub drawn: Vec<(String, Value)>,
}

impl Item {
    /// What was drawn for a key.
    pub fn drawn(&self, key: &str) -> Option<&Value> {
        self.drawn.iter().find(|(other, _)| other == key).map(|(_, value)| value)
    }
}

impl Plan {
    /// Reads a specification (TOML).
    ///
    /// # Errors
    /// Every fault of the file.
    pub fn read(file: &Path, disk: Disk) -> Result<Self, CaveError> {
        let text = cave::read(file)?;
        let spec: Spec = recipe::from_toml(&text, file)?;
        if let Some((key, message)) = fault(&spec) {
            return Err(recipe::fault_in(&text, file, &key, &message).into());
        }
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let parts = spec.split.parts(spec.seeds[0], count(spec.seeds));
        let mut plan = Self { spec, folder, disk, parts, fingerprint: String::new() };
        plan.fingerprint = plan.fingerprint_of_sources()?;
        Ok(plan)
    }

    /// Makes sure that every cave has a valid recipe whose images the targets take, and that targets and robot are known.
    ///
    /// # Errors
    /// Unknown targets, faulty options, an unknown robot, the first faulty recipe, images that a target does not take.
    pub fn verify(&self) -> Result<(), CaveError> {
        self.targets(None)?;
        self.spec.robot.as_deref().map(named_robot).transpose()?;
        let rows: Vec<&TargetRow> = self.choices()?.iter().map(|choice| choice.row).collect();
        let check = |number| cave::refuse_unfit_images(&rows, &self.input(&self.item(number))?.recipe);
        (0..self.len()).into_par_iter().try_for_each(check)
    }

    /// The first target of a specification that needs a USD library; none if it cannot be read.
    pub fn usd_target(file: &Path) -> Option<&'static str> {
        let spec: Spec = recipe::from_toml(&cave::read(file).ok()?, file).ok()?;
        let rows = spec.targets.iter().filter_map(|name| Some(cave::target(name).ok()?.row));
        rows.filter(|row| row.needs_usd()).map(|row| row.name).next()
    }

    /// The specification.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// SHA-256 of everything that the caves follow from.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Number of caves.
    #[expect(clippy::len_without_is_empty, reason = "there is at least one seed")]
    pub fn len(&self) -> usize {
        self.parts.len() * cells(&self.spec)
    }

    /// The cave of this number.
    pub fn item(&self, number: usize) -> Item {
        let (place, mut cell) = (number / cells(&self.spec), number % cells(&self.spec));
        let seed = self.spec.seeds[0] + place as u64;
        let mut dimension = 0;
        let mut drawn = Vec::new();
        for vary in &self.spec.vary {
            let step = if vary.draw == Draw::Grid { cell % vary.values.len() } else { 0 };
            drawn.push((vary.key.clone(), vary.value(seed, place, dimension, step)));
            match vary.draw {
                Draw::Grid => cell /= vary.values.len(),
                Draw::Sobol => dimension += 1,
                _ => {}
            }
        }
        Item { number, seed, part: self.parts[place], drawn }
    }

    /// What a cave is made from.
    ///
    /// # Errors
    /// If its source cannot be read, or a value that was drawn is out of range.
    pub fn input(&self, item: &Item) -> Result<Input, CaveError> {
        let pair = |(key, value): (String, Value)| format!("{key}={value}");
        let drawn = item.drawn.iter().filter(|(key, _)| key != DIFFICULTY && key != RECIPE).cloned();
        let own = [("name", json!(self.spec.name)), ("seed", json!(item.seed))];
        let own = own.map(|(key, value)| (key.to_owned(), value));
        // What comes later takes precedence.
        let settings: Vec<String> = self.spec.set.iter().cloned().chain(drawn.chain(own).map(pair)).collect();
        let Some(difficulty) = item.drawn(DIFFICULTY).and_then(Value::as_f64) else {
            return self.source(item, &settings);
        };
        // Which keys there are depends on the generator and the rock.
        let curve = self.spec.task.settings(difficulty, &self.source(item, &settings)?.recipe);
        self.source(item, &curve.into_iter().map(pair).chain(settings).collect::<Vec<_>>())
    }

    /// The targets, with their options.
    ///
    /// # Errors
    /// Unknown targets, faulty options, a missing USD library.
    pub fn targets(&self, library: Option<&Arc<dyn Library>>) -> Result<Vec<Wanted>, CaveError> {
        let choices = self.choices()?;
        let needs_usd = choices.iter().any(|choice| choice.row.needs_usd());
        // Whoever only reads the plan needs no library.
        if needs_usd && library.is_none() {
            return Ok(Vec::new());
        }
        cave::build(choices, &[], &self.spec.options, library)
    }

    fn choices(&self) -> Result<Vec<Choice>, CaveError> {
        self.spec.targets.iter().map(|name| cave::target(name)).collect()
    }

    fn source(&self, item: &Item, settings: &[String]) -> Result<Input, CaveError> {
        let name = item.drawn(RECIPE).and_then(Value::as_str).unwrap_or(&self.spec.recipe);
        match cave::preset(name) {
            Ok(preset) => Ok(Input::of(Recipe::from_preset(preset, settings)?)),
            Err(_) => Input::read(Some(&self.folder.join(name)), settings, self.disk),
        }
    }

    fn fingerprint_of_sources(&self) -> Result<String, CaveError> {
        let mut sources = vec![plume::VERSION.to_owned(), json!(self.spec).to_string()];
        let varied = self.spec.vary.iter().filter(|vary| vary.key == RECIPE).flat_map(|vary| &vary.values);
        for name in varied.filter_map(Value::as_str).chain([self.spec.recipe.as_str()]) {
            if let Err(unknown) = cave::preset(name) {
                let path = self.folder.join(name);
                if path.is_file() {
                    sources.push(cave::read(&path)?);
                } else if path.extension().is_none() {
                    return Err(unknown);
                }
            }
        }
        Ok(sha256(sources.join("\n").as_bytes()))
    }
}

fn count([first, last]: [u64; 2]) -> usize {
    usize::try_from(last - first).unwrap_or(usize::MAX).saturating_add(1)
}

/// Combinations of the values of the grid.
fn cells(spec: &Spec) -> usize {
    let grid = spec.vary.iter().filter(|vary| vary.draw == Draw::Grid);
    grid.map(|vary| vary.values.len()).fold(1, usize::saturating_mul)
}

/// The first fault that the schema cannot express: a key of the file and what is wrong with it.
fn fault(spec: &Spec) -> Option<(String, String)> {
    let [first, last] = spec.seeds;
    if first > last {
        return Some(("seeds".into(), "must be the first and the last seed".into()));
    }
    if count(spec.seeds).saturating_mul(cells(spec)) > MOST_ITEMS {
        return Some(("seeds".into(), format!("make more than {MOST_ITEMS} caves")));
    }
    if !spec.split.is_possible() {
        return Some(("split".into(), "must have a share above 0".into()));
    }
    let of_vary = spec.vary.iter().enumerate().find_map(|(place, vary)| {
        let is_twice = spec.vary[..place].iter().any(|other| other.key == vary.key);
        let is_own = ["name", "seed"].contains(&vary.key.as_str());
        let is_no_share = |value: &Value| !value.as_f64().is_some_and(|value| (0.0..=1.0).contains(&value));
        let (part, message) = match vary.fault() {
            Some(message) => ("values", message),
            None if is_twice => ("key", "is drawn twice"),
            None if is_own => ("key", "is set by the dataset"),
            None if vary.key == DIFFICULTY && vary.values.iter().any(is_no_share) => ("values", "must be from 0 to 1"),
            None if vary.key == RECIPE && !vary.values.iter().all(Value::is_string) => ("values", "must be names"),
            None => return None,
        };
        Some((format!("vary[{place}].{part}"), message.to_owned()))
    });
    let sobol = spec.vary.iter().filter(|vary| vary.draw == Draw::Sobol).count();
    if sobol > MOST_SOBOL {
        return Some(("vary".into(), format!("has more than {MOST_SOBOL} keys that are drawn by sobol")));
    }
    if sobol > 0 && count(spec.seeds) > MOST_POINTS {
        return Some(("seeds".into(), format!("are more than {MOST_POINTS}, the points of sobol")));
    }
    of_vary
}
