//! `cargo xtask bench`: CPU seconds by stage, and how far they are from the floor.
//!
//! The floor is what no generator can avoid: encoding and writing the same images, measured in the same run.

use std::fs;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use crate::plume::{Plume, Profile, cargo};
use crate::targets::Target;
use crate::tools::{Result, root, run as run_program};
use crate::venv::Environment;

/// Rows of the paper's table: name, arguments, and the paper's own time (i5-12400F, RTX 3070).
const ROWS: [(&str, &[&str], &str); 3] = [
    (
        "50 nodes, 1K, one chunk",
        &["--set", "graph.nodes=50", "--set", "texture.size_px=1024", "--set", "mesh.divisions=[1,1,1]"],
        "22 s",
    ),
    ("default cave with chunks", &[], "7 min 05 s"),
    (
        "250 nodes, 3 layers, 4K, 4x4x4",
        &[
            "--set",
            "graph.nodes=250",
            "--set",
            "graph.layers=3",
            "--set",
            "texture.size_px=4096",
            "--set",
            "mesh.divisions=[4,4,4]",
        ],
        "219 min 49 s",
    ),
];

/// Runs all rows, or those with the given numbers. `usd` times writing one chunk as USD, `ray` a dataset by Ray and by processes,
/// `targets` a package of every target that needs no other program, and `graph` the graph generators.
pub fn run(chosen: &[String]) -> Result<()> {
    match chosen.first().map(String::as_str) {
        Some("usd") => return python("write_chunk.py"),
        Some("ray") => return python("ray_overhead.py"),
        Some("targets") => return targets(),
        Some("graph") => return graph(),
        _ => {}
    }
    let plume = Plume::build(Profile::Release)?;
    println!("row | graph | mesh | things | texture | sum, CPU s | floor (PNG), CPU s | ratio | peak MB | paper, wall");
    for (number, (name, arguments, paper)) in ROWS.iter().enumerate() {
        if chosen.is_empty() || chosen.contains(&(number + 1).to_string()) {
            row(&plume, name, arguments, paper)?;
        }
    }
    Ok(())
}

/// A million nodes of every generator.
fn graph() -> Result<()> {
    let mut cargo = cargo();
    println!("{}", run_program(cargo.args(["run", "--release", "--quiet", "--example", "graph_speed"]))?);
    Ok(())
}

/// A benchmark of the Python package, built for release.
fn python(name: &str) -> Result<()> {
    Plume::package(Profile::Release)?;
    let python = Environment::of_project()?.python();
    println!("{}", run_program(Command::new(python).arg(root().join("python/benches").join(name)))?);
    Ok(())
}

/// Runs of each target, of which the fastest counts.
const RUNS: usize = 5;

/// The default cave, generated once.
fn targets() -> Result<()> {
    let plume = Plume::build(Profile::Release)?;
    let (cave, package) = ("target/bench-cave", "target/bench-package");
    plume.output(&["generate", "--output", cave, "--force", "--quiet"])?;
    println!("target | files | MB | CPU s | MB/s | writing as many bytes, s | ratio");
    for target in Target::all(&plume)?.iter().filter(|target| target.is_in_binary()).map(Target::name) {
        let export = ["export", cave, "--target", target, "--output", package, "--force", "--json", "--quiet"];
        let mut runs = (0..RUNS).map(|_| plume.output(&export)).collect::<Result<Vec<_>>>()?;
        runs.sort_by(|a, b| field(a, target, "cpu_s").total_cmp(&field(b, target, "cpu_s")));
        let [files, bytes, cpu_s] = ["files", "bytes", "cpu_s"].map(|key| field(&runs[0], target, key));
        let floor_s = floor(bytes as usize).map_err(|error| error.to_string())?;
        let megabytes = bytes / 1e6;
        println!(
            "{target} | {files} | {megabytes:.1} | {cpu_s:.3} | {:.0} | {floor_s:.3} | {:.1}",
            megabytes / cpu_s,
            cpu_s / floor_s
        );
    }
    [cave, package].iter().try_for_each(|folder| fs::remove_dir_all(root().join(folder))).map_err(|e| e.to_string())
}

/// Seconds to write this many bytes to one file, the minimum of several runs.
fn floor(bytes: usize) -> std::io::Result<f64> {
    let (path, content) = (root().join("target/bench-bytes"), vec![7; bytes]);
    let mut fastest = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        fs::write(&path, &content)?;
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    fs::remove_file(path)?;
    Ok(fastest)
}

fn row(plume: &Plume, name: &str, arguments: &[&str], paper: &str) -> Result<()> {
    let folder = root().join("target/bench-cave");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|error| error.to_string())?;
    }
    let generate = ["generate", "--output", "target/bench-cave", "--json", "--quiet"];
    let all: Vec<&str> = generate.iter().chain(arguments).copied().collect();
    let summary = plume.output(&all)?;
    let number = |section: &str, key: &str| field(&summary, section, key);
    let stages = ["graph", "mesh", "things", "texture"].map(|stage| number(stage, "cpu_s"));
    let sum: f64 = stages.iter().sum();
    let floor = run_program(Command::new(Profile::Release.example("png_floor")?).arg(&folder))?;
    let floor: f64 = floor.trim().parse().map_err(|_| "png_floor printed no number")?;
    let peak = number("", "peak_memory_bytes") / 1e6;
    let [graph, mesh, things, texture] = stages;
    println!(
        "{name} | {graph:.2} | {mesh:.1} | {things:.1} | {texture:.1} | {sum:.1} | {floor:.1} | {:.1} | {peak:.0} | {paper}",
        sum / floor
    );
    fs::remove_dir_all(&folder).map_err(|error| error.to_string())
}

/// A number from a `plume … --json` summary: `key` in `section`, or at the top level if `section` is empty.
fn field(json: &str, section: &str, key: &str) -> f64 {
    let summary: Value = serde_json::from_str(json).unwrap_or_default();
    let section = if section.is_empty() { &summary } else { &summary[section] };
    section[key].as_f64().unwrap_or(f64::NAN)
}
