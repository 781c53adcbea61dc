//! Whether a dataset is as it was made.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use plume::cave::CaveError;
use plume::store::{StoreError, sha256};
use plume_disk::regular;
use plume_exporters::check::{Fault, check as check_package};
use rayon::prelude::*;
use serde_json::Value;

use crate::finish::{COSTS, SUMS};
use crate::folder::{self, DATASET, LOCK};
use crate::item::WORK;

/// Largest size of a file.
const MOST_BYTES: u64 = 4 << 30;

/// What was found in a dataset.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Its name.
    pub name: String,
    /// Number of caves in its index.
    pub caves: usize,
    /// Number of files that were compared.
    pub files: usize,
    /// What is wrong.
    pub faults: Vec<Fault>,
}

/// Whether a folder is a dataset.
pub fn is_dataset(root: &Path) -> bool {
    root.join(DATASET).is_file()
}

/// Compares all files with their sums, the index with the caves, the parts with each other, and checks each package.
///
/// # Errors
/// If there is no dataset, or none that is finished.
pub fn check(root: &Path) -> Result<Report, CaveError> {
    let spec = folder::identity(root)?.spec;
    let text = |name: &str| {
        let path = root.join(name);
        let bytes = regular::read(&path, MOST_BYTES).map_err(|error| StoreError::io(&path, error))?;
        String::from_utf8(bytes).map_err(|error| CaveError::from(StoreError::damaged(&path, error)))
    };
    let sums = text(SUMS)?;
    let sums: BTreeMap<&str, &str> =
        sums.lines().filter_map(|line| line.split_once("  ")).map(|(a, b)| (b, a)).collect();
    let mut faults: Vec<Fault> = sums.par_iter().filter_map(|(path, sum)| compared(root, path, sum)).collect();
    let (found, rows) = (files(root)?, text("index.json")?);
    faults
        .extend(found.iter().filter(|path| !sums.contains_key(path.as_str())).map(|path| fault(path, "is in no sum")));
    let rows: Vec<Value> =
        serde_json::from_str(&rows).map_err(|error| StoreError::damaged(&root.join("index.json"), error))?;
    faults.extend(leaks(&rows));
    let path = |row: &Value| row["path"].as_str().unwrap_or_default().to_owned();
    let packages: Vec<String> =
        rows.iter().flat_map(|row| spec.packages().map(move |package| format!("{}/{package}", path(row)))).collect();
    faults.par_extend(packages.par_iter().flat_map_iter(|package| faults_of(root, package)));
    Ok(Report { name: spec.name, caves: rows.len(), files: sums.len(), faults })
}

/// What is wrong with a file.
fn compared(root: &Path, path: &str, sum: &str) -> Option<Fault> {
    // A sum is not to lead to files elsewhere.
    if Path::new(path).components().any(|part| !matches!(part, std::path::Component::Normal(_))) {
        return Some(fault(path, "is no path inside the dataset"));
    }
    match regular::read(&root.join(path), MOST_BYTES) {
        Err(error) => Some(fault(path, &error.to_string())),
        Ok(bytes) if sha256(&bytes) != sum => Some(fault(path, "was changed: its SHA-256 does not match")),
        Ok(_) => None,
    }
}

/// All files, but what differs from run to run.
fn files(root: &Path) -> Result<BTreeSet<String>, StoreError> {
    let mut found = BTreeSet::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        let path = root.join(&folder);
        let named = |error| StoreError::io(&path, error);
        for entry in fs::read_dir(&path).map_err(named)? {
            let entry = entry.map_err(named)?;
            let name = format!("{folder}{}", entry.file_name().to_string_lossy());
            if entry.file_type().map_err(named)?.is_dir() {
                // Caves that were being made when a run was killed.
                if name != WORK {
                    folders.push(name + "/");
                }
            } else if ![COSTS, LOCK, SUMS].contains(&name.as_str()) {
                found.insert(name);
            }
        }
    }
    Ok(found)
}

/// Seeds and layouts in more than one part.
fn leaks(rows: &[Value]) -> Vec<Fault> {
    let mut part_of: BTreeMap<String, &Value> = BTreeMap::new();
    let mut faults = Vec::new();
    for row in rows {
        for key in ["seed", "graph_sha256"] {
            let part = *part_of.entry(format!("{key} {}", row[key])).or_insert(&row["part"]);
            if *part != row["part"] {
                faults.push(fault("index.json", &format!("{key} {} is in two parts", row[key])));
            }
        }
    }
    faults
}

fn faults_of(root: &Path, package: &str) -> Vec<Fault> {
    match check_package(&root.join(package)) {
        Err(error) => vec![fault(package, &error.to_string())],
        Ok(report) => {
            let inside = |found: Fault| Fault { path: format!("{package}/{}", found.path), ..found };
            report.faults.into_iter().map(inside).collect()
        }
    }
}

fn fault(path: &str, what: &str) -> Fault {
    Fault { path: path.to_owned(), what: what.to_owned() }
}
