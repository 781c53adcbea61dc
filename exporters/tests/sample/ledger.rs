//! A USD library that writes down what it is told, so that the laws of targets hold for those that need one. What the
//! real one makes of it is judged in `tests/python`.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use plume_exporters::ExportError;
use plume_exporters::stage::{Array, Library};
use serde_json::Value;

/// Writes each call as text into the file that the call names.
pub struct Ledger;

/// The library as a host program lends it.
pub fn ledger() -> Option<Arc<dyn Library>> {
    Some(Arc::new(Ledger))
}

impl Library for Ledger {
    fn check(&self) -> Result<(), ExportError> {
        Ok(())
    }

    fn call(&self, function: &'static str, spec: &Value, arrays: Vec<(String, Array)>) -> Result<(), ExportError> {
        let path = spec["path"].as_str().unwrap();
        let mut said = spec.clone();
        // Where the files are gathered is no part of what is written.
        for place in ["path", "root"] {
            said.as_object_mut().unwrap().remove(place);
        }
        let sizes: Vec<String> = arrays.iter().map(|(name, array)| format!("{name} {}", size(array))).collect();
        let layers = spec["root"].as_str().map_or_else(String::new, |root| layers(Path::new(root)));
        Ok(fs::write(path, format!("{function}\n{said:#}\n{}\n{layers}", sizes.join("\n")))?)
    }
}

/// What an archive holds beside images.
fn layers(root: &Path) -> String {
    let chunks = fs::read_dir(root.with_file_name("chunks")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = chunks.filter(|path| path.is_file()).chain([root.to_owned()]).collect();
    files.sort();
    files.iter().map(|file| fs::read_to_string(file).unwrap()).collect()
}

fn size(array: &Array) -> usize {
    match array {
        Array::Float3(rows) => rows.len(),
        Array::Float2(rows) => rows.len(),
        Array::Index(indices) => indices.len(),
    }
}
