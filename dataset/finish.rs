//! The files that describe a dataset, written once its caves are made: index, card, contact sheet, sums.

use std::collections::BTreeMap;
use std::fmt::Write;

use plume::cave::CaveError;
use plume::pipeline::Observer;
use plume_disk::sealed::sha256;
use serde_json::{Map, Value};

use crate::card::card;
use crate::engine::Reply;
use crate::folder::{DATASET, Folder};
use crate::index::{self, Failure};
use crate::item::{self, RECORD, Record};

use crate::plan::Plan;
use crate::sheet::sheet;

/// Sums of all files.
pub const SUMS: &str = "SHA256SUMS";
/// CPU seconds.
pub const COSTS: &str = "costs.csv";

/// What a dataset came to.
#[derive(Debug)]
pub struct Outcome {
    /// The index: a row for each cave in it.
    pub rows: Vec<Map<String, Value>>,
    /// Those that are not, by number.
    pub failures: Vec<Failure>,
    /// How many of them this run has made.
    pub made: usize,
    /// CPU seconds that these took.
    pub cpu_s: f64,
}

/// Writes the files that describe a dataset. `faults` says why caves are missing, by their numbers.
///
/// # Errors
/// If a record is damaged, the disk fails, or work was stopped.
pub fn finish(
    plan: &Plan,
    folder: &Folder,
    faults: &BTreeMap<usize, String>,
    observer: &dyn Observer,
) -> Result<Outcome, CaveError> {
    let (mut records, mut failures) = (Vec::new(), Vec::new());
    for number in 0..plan.len() {
        if folder.has(number) {
            records.push(folder.record(number)?);
        } else {
            let fault = faults.get(&number).map_or("was not made", String::as_str).to_owned();
            failures.push(Failure { item: number, seed: plan.item(number).seed, fault });
        }
    }
    let mut files = sums_of(folder, &records)?;
    let records = index::without_leaks(records, &mut failures);
    let rows: Vec<_> = records.iter().map(|record| index::row(plan, record)).collect();
    let failed: Vec<_> = failures.iter().map(Failure::row).collect();
    let json: Value = rows.iter().cloned().map(Value::Object).collect();
    let sheet = sheet(plan, &records, observer)?;
    let card = card(plan, &rows, &failures, sheet.is_some());
    let described = [
        ("README.md", Some(card.into_bytes())),
        ("failed.csv", Some(index::csv(&Failure::COLUMNS, &failed)?)),
        ("index.csv", Some(index::csv(&index::columns(&rows), &rows)?)),
        ("index.json", Some(format!("{json:#}\n").into_bytes())),
        ("sheet.png", sheet),
    ];
    for (name, bytes) in described {
        if let Some(bytes) = bytes {
            folder.write(name, &bytes)?;
            files.push((name.to_owned(), sha256(&bytes)));
        }
    }
    files.sort();
    let sums: String = files.into_iter().map(|(path, sum)| format!("{sum}  {path}\n")).collect();
    folder.write(SUMS, sums.as_bytes())?;
    Ok(Outcome { rows, failures, made: 0, cpu_s: 0.0 })
}

/// Adds what caves took to the costs that earlier runs have recorded.
///
/// # Errors
/// I/O errors.
pub fn record_costs(folder: &Folder, replies: &[Reply]) -> Result<(), CaveError> {
    let path = folder.root().join(COSTS);
    let mut text = std::fs::read_to_string(path).unwrap_or_else(|_| "item,cpu_s\n".to_owned());
    for reply in replies.iter().filter(|reply| reply.fault.is_none()) {
        let _ = writeln!(text, "{},{:.3}", reply.item, reply.cpu_s);
    }
    folder.write(COSTS, text.as_bytes())
}

/// The sums of the files of caves, also of those that are left out of the index.
fn sums_of(folder: &Folder, records: &[Record]) -> Result<Vec<(String, String)>, CaveError> {
    let mut sums = vec![(DATASET.to_owned(), sha256(&folder.read(DATASET)?))];
    for record in records {
        let at = item::path(record.item);
        sums.extend(record.files.iter().map(|file| (format!("{at}/{}", file.path), file.sha256.clone())));
        sums.push((format!("{at}/{RECORD}"), sha256(&folder.read(&format!("{at}/{RECORD}"))?)));
    }
    Ok(sums)
}
