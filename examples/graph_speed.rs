//! Nodes that every generator lays out in a CPU second, and the memory that takes.
//!
//! `cargo run --release --example graph_speed [NODES]` prints a table; each row is a process of its own, so that its
//! peak of memory is its own.

use std::env;
use std::error::Error;
use std::fs;
use std::process::Command;

use cpu_time::ProcessTime;
use plume::generators::GENERATORS;
use plume::graph::NoOutside;
use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.as_slice() {
        [name, nodes] => row(name, nodes.parse()?),
        [nodes] => table(nodes.parse()?),
        _ => table(1_000_000),
    }
}

/// A row for every generator that supports this number of nodes.
#[expect(clippy::print_stdout, reason = "the result of the example")]
fn table(nodes: u32) -> Result<(), Box<dyn Error>> {
    println!("generator | nodes | CPU s | nodes a CPU second | peak MB");
    for row in GENERATORS.iter().filter(|row| !(row.schema)().to_value()["properties"]["nodes"].is_null()) {
        let output = Command::new(env::current_exe()?).args([row.name, &nodes.to_string()]).output()?;
        match output.status.success() {
            true => print!("{}", String::from_utf8(output.stdout)?),
            false => println!("{} | {}", row.name, String::from_utf8_lossy(&output.stderr).trim()),
        }
    }
    Ok(())
}

#[expect(clippy::print_stdout, reason = "the result of the example")]
fn row(name: &str, nodes: u32) -> Result<(), Box<dyn Error>> {
    let row = GENERATORS.find(name).ok_or("no such generator")?;
    let generator = (row.read)(json!({ "nodes": nodes }))?;
    let start = ProcessTime::now();
    let graph = generator.generate(7, &NoOutside)?;
    let cpu_s = start.elapsed().as_secs_f64();
    let count = graph.nodes.len();
    println!("{name} | {count} | {cpu_s:.3} | {:.0} | {:.0}", count as f64 / cpu_s, peak_mb());
    Ok(())
}

/// Peak memory of the process, where the system reports it (Linux).
fn peak_mb() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kib| kib.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib * 1024.0 / 1e6)
}
