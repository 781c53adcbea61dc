//! `cargo xtask scale [KM...]`: what large caves take by stage and target: CPU seconds, peak memory, disk. Each step is a process
//! of its own, so its peak is not that of another one.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::plume::{Plume, Profile};
use crate::targets::Target;
use crate::tools::{Result, root};

/// Lengths of passage unless told otherwise, in kilometres.
const LENGTHS_KM: [f64; 2] = [1.0, 10.0];
/// Nodes of the default generator to a kilometre.
const NODES_PER_KM: f64 = 260.0;
/// Few texels, since images are as many bytes as one asks for.
const DENSITY: &str = "texture.density_px_per_m=8";
const STAGES: [&str; 5] = ["graph", "mesh", "things", "texture", "pieces"];

/// The task.
pub fn run(arguments: &[String]) -> Result<()> {
    let length = |word: &String| word.parse::<f64>().map_err(|_| format!("{word} is no number of kilometres"));
    let mut lengths_km = arguments.iter().map(length).collect::<Result<Vec<f64>>>()?;
    if lengths_km.is_empty() {
        lengths_km.extend(LENGTHS_KM);
    }
    let plume = Plume::build(Profile::Release)?;
    println!("| passage | step | CPU s | CPU s per km | peak MB | disk MB |");
    println!("|---:|---|---:|---:|---:|---:|");
    lengths_km.into_iter().try_for_each(|km| measure(&plume, (km * NODES_PER_KM).round() as u32))
}

fn measure(plume: &Plume, nodes: u32) -> Result<()> {
    let (cave, package) = ("target/scale-cave", "target/scale-package");
    remove([cave, package])?;
    let nodes = format!("graph.nodes={nodes}");
    let mut length_km = 0.0;
    let mut before = 0.0;
    for stage in STAGES {
        let made = summary(plume, &[stage, "samples/cave.toml", "--set", &nodes, "--set", DENSITY, "--output", cave])?;
        if stage == STAGES[0] {
            length_km = made["graph"]["length_m"].as_f64().unwrap_or(f64::NAN) / 1000.0;
        }
        let after = megabytes(&root().join(cave))?;
        print(length_km, stage, &made[stage]["cpu_s"], &made, after - before);
        before = after;
    }
    for target in Target::all(plume)?.iter().filter(|target| target.is_in_binary()).map(Target::name) {
        let made = summary(plume, &["export", cave, "--target", target, "--output", package])?;
        print(length_km, target, &made[target]["cpu_s"], &made, megabytes(&root().join(package))?);
        remove([package])?;
    }
    remove([cave])
}

/// What a command says of itself.
fn summary(plume: &Plume, arguments: &[&str]) -> Result<Value> {
    let text = plume.output(&[arguments, &["--json", "--quiet"]].concat())?;
    serde_json::from_str(&text).map_err(|error| format!("plume {}: {error}", arguments[0]))
}

/// The peak is what the kernel says of the process.
fn print(length_km: f64, step: &str, cpu_s: &Value, made: &Value, disk: f64) {
    let cpu_s = cpu_s.as_f64().unwrap_or(f64::NAN);
    let peak = made["peak_memory_bytes"].as_f64().unwrap_or(f64::NAN) / 1e6;
    println!("| {length_km:.1} km | {step} | {cpu_s:.1} | {:.2} | {peak:.0} | {disk:.0} |", cpu_s / length_km);
}

/// The files below a folder.
fn megabytes(folder: &Path) -> Result<f64> {
    let failed = |error| format!("{}: {error}", folder.display());
    let mut bytes = 0.0;
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let about = entry.metadata().map_err(failed)?;
        bytes += if about.is_dir() { megabytes(&entry.path())? } else { about.len() as f64 / 1e6 };
    }
    Ok(bytes)
}

fn remove<const N: usize>(folders: [&str; N]) -> Result<()> {
    let mut there = folders.map(|folder| root().join(folder)).into_iter().filter(|folder| folder.exists());
    there.try_for_each(|folder| fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display())))
}
