//! `cargo xtask vslam [VARIANT... | strips]`: what recorded runs are worth to visual SLAM.
//!
//! ORB-SLAM3 judges runs along a lap of the same cave in other rock, air and light: with the calibration that `plume record`
//! writes, held to the truth by `evo`. All that is made stays below `target/vslam`, so that a run that was stopped goes on; remove
//! the folder to begin again. Some 45 CPU minutes. `strips` are pictures of a few frames for each rock instead.

use std::fs;
use std::path::{Path, PathBuf};

use crate::tools::{Result, run as run_program};
use studio::{Cave, Studio};

mod strips;
mod studio;

/// The default cave, whose longest loop has 27 m with this seed.
const DEFAULT: Cave = Cave::new("default", "--seed 11");
const DRY: Cave = Cave::new("humidity-0", "--seed 11 --set look.humidity=0");
const MOIST: Cave = Cave::new("humidity-0.5", "--seed 11 --set look.humidity=0.5");
const WET: Cave = Cave::new("humidity-1", "--seed 11 --set look.humidity=1");
const BARE: Cave = Cave::new("bare", "--seed 11 --set things.cover=0");
const BASALT: Cave = Cave::new("basalt", "--seed 11 --set rock.kind=basalt");
const GRANITE: Cave = Cave::new("drilled", "--seed 11 --set rock.kind=drilled");

/// Caves that no run goes through.
const ELSEWHERE: [Cave; 3] = [
    Cave::new("elsewhere-limestone", "--seed 5 --set graph.nodes=20"),
    Cave::new("elsewhere-basalt", "--seed 6 --set graph.nodes=20 --set rock.kind=basalt"),
    Cave::new("elsewhere-drilled", "--seed 7 --set graph.nodes=20 --set rock.kind=drilled"),
];

const HEADLAMP: &str = "tests/interop/slam/rigs/headlamp.toml";
const LAMPS: &str = "tests/interop/slam/rigs/lamps.toml";
const SPARSE: &str = "tests/interop/slam/rigs/sparse.toml";

/// A row of the table.
struct Variant {
    name: &'static str,
    cave: &'static Cave,
    rig: &'static str,
    /// What ORB-SLAM3 is given: `rgbd`, `stereo` or `mono`.
    sensor: &'static str,
}

const fn variant(name: &'static str, cave: &'static Cave, rig: &'static str, sensor: &'static str) -> Variant {
    Variant { name, cave, rig, sensor }
}

const VARIANTS: [Variant; 13] = [
    variant("default", &DEFAULT, HEADLAMP, "rgbd"),
    variant("humidity-0", &DRY, HEADLAMP, "rgbd"),
    variant("humidity-0.5", &MOIST, HEADLAMP, "rgbd"),
    variant("humidity-1", &WET, HEADLAMP, "rgbd"),
    variant("dark", &DEFAULT, "dark", "rgbd"),
    variant("hard", &DEFAULT, "hard", "rgbd"),
    variant("easy", &DEFAULT, "easy", "rgbd"),
    variant("lamps", &DEFAULT, LAMPS, "rgbd"),
    variant("basalt", &BASALT, HEADLAMP, "rgbd"),
    variant("drilled", &GRANITE, HEADLAMP, "rgbd"),
    variant("bare", &BARE, HEADLAMP, "rgbd"),
    variant("mono", &DEFAULT, HEADLAMP, "mono"),
    variant("stereo", &DEFAULT, "stereo", "stereo"),
];

/// The task: all variants, or those with the given names.
pub fn run(chosen: &[String]) -> Result<()> {
    if chosen == ["strips"] {
        return strips::run(&Studio::open()?);
    }
    if let Some(unknown) = chosen.iter().find(|name| VARIANTS.iter().all(|variant| variant.name != **name)) {
        let known = VARIANTS.map(|variant| variant.name).join(", ");
        return Err(format!("there is no variant {unknown}; there are {known}"));
    }
    let studio = Studio::open()?;
    let vocabulary = vocabulary(&studio)?;
    let wanted = |variant: &&Variant| chosen.is_empty() || chosen.iter().any(|name| name == variant.name);
    let judged: Vec<Result<()>> =
        VARIANTS.iter().filter(wanted).map(|variant| judge(&studio, variant, &vocabulary)).collect();
    let names = VARIANTS.map(|variant| variant.name);
    println!("{}", run_program(studio.script("table.py").arg(studio.place("")).args(names))?);
    judged.into_iter().collect()
}

/// Records a variant and asks ORB-SLAM3, unless that was done.
fn judge(studio: &Studio, variant: &Variant, vocabulary: &Path) -> Result<()> {
    let results = studio.place("results");
    if results.join(format!("{}.json", variant.name)).exists() {
        return Ok(());
    }
    eprintln!("{}", variant.name);
    let recording = studio.record(variant.cave, &studio.lap(variant.cave)?, variant.rig)?;
    let mut judge = studio.script("judge.py");
    judge.args([variant.name, variant.sensor]).args([&recording, vocabulary, &results]);
    run_program(&mut judge).map(drop).inspect_err(|reason| eprintln!("{}: {reason}", variant.name))
}

/// The vocabulary by which ORB-SLAM3 knows places again: see `vocabulary.py`.
fn vocabulary(studio: &Studio) -> Result<PathBuf> {
    let vocabulary = studio.place("vocabulary.txt");
    if vocabulary.exists() {
        return Ok(vocabulary);
    }
    let mut images = Vec::new();
    for cave in &ELSEWHERE {
        let recording = studio.record(cave, &studio.path(cave, "longest")?, SPARSE)?;
        let folder = fs::read_dir(recording.join("rgb")).map_err(|error| error.to_string())?;
        images.extend(folder.filter_map(|entry| Some(entry.ok()?.path())));
    }
    images.sort();
    eprintln!("{}", run_program(studio.script("vocabulary.py").arg(&vocabulary).args(images))?);
    Ok(vocabulary)
}
