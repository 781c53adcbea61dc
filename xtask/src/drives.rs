//! `cargo xtask drives [SEEDS | campaign]`: holds certificates to drives of a rover in MuJoCo and a Husky in Bullet.
//!
//! Default caves of that many seeds, ten unless told otherwise, whose results are lines of `target/drives/results.jsonl`. The campaign
//! has 300 default caves, and every sample recipe, which are every preset and generator, and caves of three layers, of four seeds each.
//! It takes hours, so it goes on where it was stopped, on any machine: its results are in `docs/drives.jsonl`. That file is to be removed
//! when certificates change. Caves are removed once they were driven, unless a path failed.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::num::NonZero;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;

use serde_json::Value;

use crate::interop::certify::{self, JUDGES, Judge};
use crate::plume::{Plume, Profile};
use crate::samples;
use crate::tools::{Result, root, show};

/// Seeds of default caves.
const SEEDS: u64 = 10;
/// The same of the campaign.
const MANY_SEEDS: u64 = 300;
/// Seeds of every other kind of cave.
const OTHERS: u64 = 4;
/// What came of the campaign so far.
const CAMPAIGN: &str = "docs/drives.jsonl";

/// The task.
pub fn run(arguments: &[String]) -> Result<()> {
    let folder = root().join("target/drives");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    match arguments {
        [] => drive_anew(&folder, SEEDS),
        [word] if word == "campaign" => {
            let caves = in_turns(default_caves(MANY_SEEDS), other_caves()?);
            drive(&caves, &folder, &root().join(CAMPAIGN))
        }
        [count] => drive_anew(&folder, count.parse().map_err(|_| format!("{count} is no number of seeds"))?),
        _ => Err("a number of seeds, or the word campaign".to_owned()),
    }
}

fn drive_anew(folder: &Path, seeds: u64) -> Result<()> {
    let results = folder.join("results.jsonl");
    if results.exists() {
        fs::remove_file(&results).map_err(|error| format!("{}: {error}", results.display()))?;
    }
    drive(&default_caves(seeds), folder, &results)
}

/// A cave that is made, driven and removed.
struct Cave {
    name: String,
    /// What it is made of, for the command line.
    input: Vec<String>,
    /// Passages that are driven, of each class.
    passages: &'static str,
}

/// Little goes wrong in them, so many are driven and few passages of each.
fn default_caves(seeds: u64) -> Vec<Cave> {
    let cave = |seed: u64| Cave { name: format!("seed_{seed}"), input: of_seed(seed), passages: "2" };
    (1..=seeds).map(cave).collect()
}

fn other_caves() -> Result<Vec<Cave>> {
    let cave = |kind: &str, seed: u64, input: &[String]| Cave {
        name: format!("{kind}_{seed}"),
        input: [input, &of_seed(seed)].concat(),
        passages: "6",
    };
    let recipes = samples::recipes()?;
    let layers = ["--set", "graph.layers=3"].map(str::to_owned);
    let of_seed = |seed: u64| {
        let sample = move |recipe: &PathBuf| {
            let kind = recipe.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            cave(&kind, seed, &[recipe.to_string_lossy().into_owned()])
        };
        let deep = cave("three-layers", seed, &layers);
        recipes.iter().map(sample).chain([deep]).collect::<Vec<_>>()
    };
    Ok((1..=OTHERS).flat_map(of_seed).collect())
}

/// Both kinds evenly mixed, so that a campaign that is stopped has driven as large a share of either.
fn in_turns(some: Vec<Cave>, others: Vec<Cave>) -> Vec<Cave> {
    let shares = |caves: Vec<Cave>| {
        let count = caves.len();
        caves.into_iter().enumerate().map(move |(number, cave)| (number as f64 / count as f64, cave))
    };
    let mut all: Vec<(f64, Cave)> = shares(some).chain(shares(others)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().map(|(_, cave)| cave).collect()
}

fn of_seed(seed: u64) -> Vec<String> {
    vec!["--seed".to_owned(), seed.to_string()]
}

/// Drives in caves that are not among the results.
fn drive(caves: &[Cave], folder: &Path, results: &Path) -> Result<()> {
    let plume = Plume::build(Profile::Release)?;
    let driven = driven(results)?;
    let left = Mutex::new(caves.iter());
    let left = || left.lock().unwrap_or_else(PoisonError::into_inner);
    let next = || left().next();
    // Nobody waits for hours to be told.
    let give_up = |error: String| {
        *left() = [].iter();
        error
    };
    let drive_some = || -> Result<()> {
        while let Some(cave) = next() {
            let is_new = |judge: &Judge| !driven.contains(&(cave.name.clone(), judge.robot.to_owned()));
            let judges: Vec<Judge> = JUDGES.into_iter().filter(is_new).collect();
            if !judges.is_empty() {
                cave.drive(&plume, &folder.join(&cave.name), &judges, results).map_err(give_up)?;
            }
        }
        Ok(())
    };
    // Each simulator takes one core.
    let workers = thread::available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(drive_some)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })?;
    show(&mut certify::table(results)?)
}

/// The caves that were driven, and by which robot.
fn driven(results: &Path) -> Result<HashSet<(String, String)>> {
    let Ok(file) = File::open(results) else { return Ok(HashSet::new()) };
    let parse = |line: std::io::Result<String>| {
        let line: Value = serde_json::from_str(&line.map_err(|error| error.to_string())?)
            .map_err(|error| format!("{}: {error}", results.display()))?;
        let text = |key: &str| line[key].as_str().unwrap_or_default().to_owned();
        Ok((text("cave"), text("robot")))
    };
    BufReader::new(file).lines().map(parse).collect()
}

impl Cave {
    /// Makes the cave and drives in it; it stays in the folder only if a path was not driven that should have been.
    fn drive(&self, plume: &Plume, folder: &Path, judges: &[Judge], results: &Path) -> Result<()> {
        let (cave, targets) = (folder.join("cave"), JUDGES.map(|judge| judge.target).join(","));
        let [output, kept] = [folder, &cave].map(|path| path.to_string_lossy().into_owned());
        let export = ["export", "--target", &targets, "-o", &output, "--keep", &kept, "--force", "--quiet"];
        // Nobody looks at it. As many caves are made at once as there are cores.
        let cheap = ["--set", "texture.density_px_per_m=5", "--set", "lod.levels=0", "--threads", "1"];
        let input: Vec<&str> = self.input.iter().map(String::as_str).collect();
        plume.show(&[&export[..], &cheap, &input].concat())?;
        let mut is_good = true;
        for judge in judges {
            let certificate = folder.join(format!("{}.json", judge.robot));
            certify::certify(plume.program(), &cave, judge.robot, &certificate)?;
            let mut drives = judge.drive(&self.name, &folder.join(judge.target), &cave, &certificate)?;
            is_good &= show(drives.args(["--passages", self.passages, "--results"]).arg(results)).is_ok();
        }
        if is_good {
            fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        Ok(())
    }
}
