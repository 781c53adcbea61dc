//! How like real caves the graphs of every generator are, as Markdown: `cargo xtask realism [SEEDS]`.
//!
//! The first table has the median of each metric over the seeds at 250 nodes with the default settings, and how many graphs
//! are like real caves as they are and after `realism.gate = "repair"`. The second counts, for the default generator, the
//! seeds that pass. Generators that need a file or a program are left out.
#![allow(clippy::print_stdout, reason = "the result of the example")]

use std::error::Error;

use plume::generators::{GENERATORS, GeneratorRow};
use plume::graph::realism::{Gate, Likeness, METRICS, Metric, RealismSettings, SCALE_FREE, Verdict};
use plume::graph::{Generator, NoOutside};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Seeds per generator, and per size of the default one.
const SEEDS: [u64; 2] = [20, 100];
const NODES: u32 = 250;
/// Nodes and layers of the second table.
const SIZES: [[u32; 2]; 6] = [[50, 1], [50, 3], [250, 1], [250, 3], [1000, 1], [1000, 3]];

fn main() -> Result<(), Box<dyn Error>> {
    let asked = std::env::args().nth(1).map(|word| word.parse::<u64>()).transpose()?;
    let [few, many] = SEEDS.map(|usual| asked.unwrap_or(usual).max(1));
    println!("{}", heading());
    for row in GENERATORS.iter() {
        let generator = (row.read)(settings(row, NODES))?;
        if generator.generate(1, &NoOutside).is_ok() {
            println!("{}", line(row.name, generator.as_ref(), few));
        }
    }
    println!("\n| nodes | layers | like real caves |\n|---:|---:|---:|");
    for [nodes, layers] in SIZES {
        let generator = (GENERATORS.default_row().read)(json!({"nodes": nodes, "layers": layers}))?;
        let graphs = likenesses(generator.as_ref(), Gate::Off, many);
        println!("| {nodes} | {layers} | {} of {many} |", real(&graphs));
    }
    Ok(())
}

fn settings(row: &GeneratorRow, nodes: u32) -> Value {
    let has_nodes = !(row.schema)().to_value()["properties"]["nodes"].is_null();
    if has_nodes { json!({ "nodes": nodes }) } else { json!({}) }
}

/// The titles, and the reference values.
fn heading() -> String {
    let metrics = &METRICS[..SCALE_FREE];
    let titles: String = metrics.iter().map(|metric| format!(" {} |", metric.name)).collect();
    let range = |low: fn(&Metric) -> f64, high: fn(&Metric) -> f64| {
        metrics.iter().map(|metric| format!(" {:.2} to {:.2} |", low(metric), high(metric))).collect::<String>()
    };
    format!(
        "| generator |{titles} like real caves | repaired |\n|---|{}---:|---:|\n| 34 real caves: all |{} | |\n| 80 % of them |{} | |",
        "---:|".repeat(SCALE_FREE),
        range(|metric| metric.range.min, |metric| metric.range.max),
        range(|metric| metric.range.p10, |metric| metric.range.p90)
    )
}

/// Medians outside all real caves are bold.
fn line(name: &str, generator: &dyn Generator, seeds: u64) -> String {
    let graphs = likenesses(generator, Gate::Off, seeds);
    let cells: String = METRICS[..SCALE_FREE].iter().map(|metric| cell(metric, &graphs)).collect();
    let [plain, repaired] = [real(&graphs), real(&likenesses(generator, Gate::Repair, seeds))];
    format!("| {name} |{cells} {plain} of {seeds} | {repaired} of {seeds} |")
}

fn cell(metric: &Metric, graphs: &[Likeness]) -> String {
    let mut values: Vec<f64> = graphs.iter().map(|likeness| (metric.of)(&likeness.metrics)).collect();
    values.sort_by(f64::total_cmp);
    let Some(&median) = values.get(values.len() / 2) else { return " |".to_owned() };
    if metric.range.holds(median) { format!(" {median:.2} |") } else { format!(" **{median:.2}** |") }
}

/// Of the seeds that make a graph.
fn likenesses(generator: &dyn Generator, gate: Gate, seeds: u64) -> Vec<Likeness> {
    let settings = RealismSettings { gate, tries: 1 };
    let one = |seed: u64| Likeness::of(&settings.generate(generator, seed, &NoOutside).ok()?);
    (1..=seeds).into_par_iter().filter_map(one).collect()
}

fn real(graphs: &[Likeness]) -> usize {
    graphs.iter().filter(|likeness| likeness.verdict == Verdict::Real).count()
}
