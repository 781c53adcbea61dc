//! The index of a dataset: a line per cave.

use plume::cave::CaveError;
use serde_json::{Map, Value, json};

use crate::item::{self, Record};
use crate::plan::Plan;
use crate::spec::Part;

/// A cave that is no part of a dataset, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Its number.
    pub item: usize,
    /// The seed of its recipe.
    pub seed: u64,
    /// Why.
    pub fault: String,
}

/// Takes out caves with the layout of one in another part: seeds do not differ for every generator.
pub fn without_leaks(records: Vec<Record>, failures: &mut Vec<Failure>) -> Vec<Record> {
    let mut first: std::collections::BTreeMap<String, (usize, Part)> = std::collections::BTreeMap::new();
    let mut kept = Vec::new();
    for record in records {
        let (item, part) = *first.entry(record.graph_sha256.clone()).or_insert((record.item, record.part));
        if part == record.part {
            kept.push(record);
            continue;
        }
        let fault = format!("has the layout of {item}, which is in part {}", part.name());
        failures.push(Failure { item: record.item, seed: record.seed, fault });
    }
    failures.sort_by_key(|failure| failure.item);
    kept
}

/// The columns of a cave, in their order.
pub fn row(plan: &Plan, record: &Record) -> Map<String, Value> {
    let mut row = Map::new();
    let mut put = |key: &str, value: Value| row.insert(key.to_owned(), value);
    put("item", json!(record.item));
    put("part", json!(record.part));
    put("seed", json!(record.seed));
    put("path", json!(item::path(record.item)));
    for vary in &plan.spec().vary {
        put(&vary.key, record.drawn.get(&vary.key).cloned().unwrap_or_default());
    }
    put("recipe_sha256", json!(record.recipe_sha256));
    put("graph_sha256", json!(record.graph_sha256));
    if let Value::Object(measures) = json!(record.measures) {
        measures.into_iter().for_each(|(key, value)| drop(put(&key, value)));
    }
    put("files", json!(record.files.len()));
    put("bytes", json!(record.files.iter().map(|file| file.bytes).sum::<u64>()));
    row
}

/// A line of names, and rows as CSV: numbers as JSON has them, texts without quotes, nothing for nothing.
///
/// # Errors
/// None that the disk makes: it is written to memory.
pub fn csv(head: &[&str], rows: &[Map<String, Value>]) -> Result<Vec<u8>, CaveError> {
    let failed = |error: &dyn std::fmt::Display| CaveError::Failed(format!("the index: {error}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(head).map_err(|error| failed(&error))?;
    let text = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    for row in rows {
        writer.write_record(row.values().map(text)).map_err(|error| failed(&error))?;
    }
    writer.into_inner().map_err(|error| failed(&error))
}

/// The names of the columns of caves; of no cave only those that all have are known.
pub fn columns(rows: &[Map<String, Value>]) -> Vec<&str> {
    rows.first().map_or_else(|| vec!["item", "part", "seed", "path"], |row| row.keys().map(String::as_str).collect())
}

impl Failure {
    /// The names of its columns.
    pub const COLUMNS: [&str; 3] = ["item", "seed", "fault"];

    /// The columns of a failure.
    pub fn row(&self) -> Map<String, Value> {
        let values = [json!(self.item), json!(self.seed), json!(self.fault)];
        Self::COLUMNS.map(str::to_owned).into_iter().zip(values).collect()
    }
}
