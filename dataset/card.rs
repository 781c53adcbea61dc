//! The data card of a dataset: a README for people, with histograms.

use std::fmt::Write;

use serde_json::{Map, Value};

use crate::index::Failure;
use crate::plan::{DIFFICULTY, Plan};
use crate::spec::Part;

/// Intervals of a histogram.
const INTERVALS: usize = 10;
/// Characters of its longest bar.
const LONGEST: usize = 40;
/// Columns of the index that say nothing as a histogram.
const NO_HISTOGRAM: [&str; 3] = ["item", "seed", "files"];

/// The card, as Markdown.
pub fn card(plan: &Plan, rows: &[Map<String, Value>], failures: &[Failure], has_sheet: bool) -> String {
    let spec = plan.spec();
    let mut text = format!("# {}\n\n", spec.name);
    let of_part = |part: Part| rows.iter().filter(|row| row["part"] == part.name()).count();
    let parts: Vec<String> = Part::ALL.map(|part| format!("{} in {}", of_part(part), part.name())).into();
    let [first, last] = spec.seeds;
    let length_m: f64 = rows.iter().filter_map(|row| row["length_m"].as_f64()).sum();
    let bytes: u64 = rows.iter().filter_map(|row| row["bytes"].as_u64()).sum();
    let _ = writeln!(
        text,
        "{} caves with {:.1} km of passages, made by Plume {} from `{}` and seeds {first} to {last}: {}. {:.2} GB.\n",
        rows.len(),
        length_m / 1e3,
        plume::VERSION,
        spec.recipe,
        parts.join(", "),
        bytes as f64 / 1e9,
    );
    text += "All caves of a seed are in one part, and no two parts have a cave of the same layout.\n\n";
    if has_sheet {
        text += "![Caves by difficulty, or by number](sheet.png)\n\n";
    }
    text += &contents(plan);
    text += &varied(plan);
    if !failures.is_empty() {
        let _ = writeln!(
            text,
            "## Left out\n\n{} caves could not be made; why is in `failed.csv`. The first:\n",
            failures.len()
        );
        for failure in failures.iter().take(5) {
            let _ = writeln!(text, "- {}: {}", failure.item, failure.fault.lines().next().unwrap_or_default());
        }
        text.push('\n');
    }
    text += "## What is in it\n\n```\n";
    let keys: Vec<&String> = rows.first().map(|row| row.keys().collect()).unwrap_or_default();
    for key in keys.into_iter().filter(|key| !NO_HISTOGRAM.contains(&key.as_str())) {
        text += &histogram(key, rows.iter().map(|row| &row[key]));
    }
    text + "```\n"
}

fn contents(plan: &Plan) -> String {
    let spec = plan.spec();
    let mut text = "## Files\n\n| file | what |\n|---|---|\n".to_owned();
    let mut line = |file: &str, what: &str| {
        let _ = writeln!(text, "| `{file}` | {what} |");
    };
    line("index.csv, index.json", "a line per cave: part, seed, what was drawn, hashes, measures");
    line("items/000000/recipe.toml", "what this cave is made from");
    line("items/000000/item.json", "what is known about it, and SHA-256 of its files");
    spec.packages().for_each(|package| line(&format!("items/000000/{package}"), "its package"));
    if spec.keeps_caves() {
        line("items/000000/cave", "its cave folder, for `plume export`");
    }
    if let Some(robot) = &spec.robot {
        line("items/000000/certificate.json", &format!("where {robot} gets in it"));
    }
    line("SHA256SUMS", "for `sha256sum -c`; `plume check` compares more");
    text + "\n"
}

fn varied(plan: &Plan) -> String {
    let spec = plan.spec();
    if spec.vary.is_empty() {
        return String::new();
    }
    let mut text = "## What varies\n\n| key | drawn | values |\n|---|---|---|\n".to_owned();
    for vary in &spec.vary {
        let values: Vec<String> = vary.values.iter().map(Value::to_string).collect();
        let _ = writeln!(text, "| `{}` | {} | {} |", vary.key, vary.draw.name(), values.join(", "));
    }
    if spec.vary.iter().any(|vary| vary.key == DIFFICULTY) {
        let _ = writeln!(text, "\nDifficulty is that of the task `{}`:\n", spec.task.name());
        text += "| key, where the generator has it | at 0 | at 1 |\n|---|---|---|\n";
        for knob in spec.task.curve() {
            let _ = writeln!(text, "| `{}` | {} | {} |", knob.key, knob.easy, knob.hard);
        }
    }
    text + "\n"
}

/// A histogram of numbers, or a count of words; nothing where all are alike or there is none.
fn histogram<'a>(key: &str, values: impl Iterator<Item = &'a Value>) -> String {
    let values: Vec<&Value> = values.filter(|value| !value.is_null()).collect();
    let numbers: Vec<f64> = values.iter().filter_map(|value| value.as_f64()).collect();
    if numbers.len() < values.len() {
        return words(key, &values);
    }
    let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let high = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if numbers.is_empty() || low == high {
        return String::new();
    }
    // An interval for each whole number, if they are few.
    let is_few = numbers.iter().all(|number| number.fract() == 0.0) && high - low < INTERVALS as f64;
    let [count, width] =
        if is_few { [high - low + 1.0, 1.0] } else { [INTERVALS as f64, (high - low) / INTERVALS as f64] };
    let count = count as usize;
    let mut counts = vec![0; count];
    numbers.iter().for_each(|number| counts[(((number - low) / width) as usize).min(count - 1)] += 1);
    let label = |place: usize| format!("{:>12}", shortened(low + width * place as f64));
    let rows = counts.iter().enumerate().map(|(place, count)| (label(place), *count));
    bars(key, rows.collect())
}

fn words(key: &str, values: &[&Value]) -> String {
    let mut counts = std::collections::BTreeMap::new();
    for value in values {
        let word = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        *counts.entry(word).or_insert(0) += 1;
    }
    // Hashes are as many as caves.
    let is_telling = counts.len() > 1 && counts.len() <= INTERVALS;
    if is_telling {
        bars(key, counts.into_iter().map(|(word, count)| (format!("{word:>12}"), count)).collect())
    } else {
        String::new()
    }
}

fn bars(key: &str, rows: Vec<(String, usize)>) -> String {
    let most = rows.iter().map(|(_, count)| *count).max().unwrap_or(1);
    let mut text = format!("{key}\n");
    for (label, count) in rows {
        let bar = "█".repeat((count * LONGEST).div_ceil(most));
        let _ = writeln!(text, "{label}  {count:>6}  {bar}");
    }
    text + "\n"
}

/// To four significant digits.
fn shortened(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = libm::pow(10.0, 3.0 - libm::log10(value.abs()).floor());
    (value * scale).round() / scale
}
