//! A fake USD library that records its calls, so that the laws of targets can be tested for those that need one. The output
//! of the real one is tested in `tests/python`.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plume_exporters::stage::{Array, Library};
use plume_exporters::{ExportError, TARGETS, TargetRow};
use serde_json::Value;
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Writes each call to the file that it names: as text if USD writes text, otherwise in the structure of a binary layer,
/// with its file references where USD has them.
pub struct Ledger;

/// All targets except those whose formats come from a system library, which have separate tests.
pub fn complete() -> impl Iterator<Item = &'static TargetRow> {
    TARGETS.iter().filter(|row| !row.needs_format())
}

/// The library as provided by a host program.
pub fn ledger() -> Option<Arc<dyn Library>> {
    Some(Arc::new(Ledger))
}

impl Library for Ledger {
    fn check(&self) -> Result<(), ExportError> {
        Ok(())
    }

    fn call(&self, function: &'static str, spec: &Value, arrays: Vec<(String, Array)>) -> Result<(), ExportError> {
        let path = Path::new(spec["path"].as_str().unwrap());
        if let Some(root) = spec["root"].as_str() {
            write_archive(path, Path::new(root));
            return Ok(());
        }
        let mut said = spec.clone();
        // The scratch folder is not part of the record.
        said.as_object_mut().unwrap().remove("path");
        let sizes: Vec<String> = arrays.iter().map(|(name, array)| format!("{name} {}", size(array))).collect();
        let text = format!("{function}\n{said:#}\n{}\n", sizes.join("\n"));
        let layer = match path.extension().unwrap().to_str() {
            Some("usda") => text_layer(&text, &references(spec)),
            _ => binary_layer(&text, &references(spec)),
        };
        Ok(fs::write(path, layer)?)
    }
}

/// References of a layer: its images, or the layers of chunks.
fn references(spec: &Value) -> Vec<&str> {
    let images = spec["textures"].as_object().into_iter().flatten().map(|(_, file)| file);
    let layers = spec["chunks"].as_array().into_iter().flatten().chain(spec.get("collision"));
    let layers = layers.map(|layer| &layer["layer"]);
    images.chain(layers).map(|file| file.as_str().unwrap()).collect()
}

fn text_layer(text: &str, references: &[&str]) -> Vec<u8> {
    let comments = text.lines().map(|line| format!("# {line}\n"));
    let assets = references.iter().map(|file| format!("@{file}@\n"));
    let head = std::iter::once("#usda 1.0\n".to_owned());
    head.chain(comments).chain(assets).collect::<String>().into_bytes()
}

/// A header, the text, the tokens, and the table of their offsets.
fn binary_layer(text: &str, references: &[&str]) -> Vec<u8> {
    let tokens: Vec<u8> = references.iter().flat_map(|file| [file.as_bytes(), b"\0"].concat()).collect();
    let packed = [&[0][..], &lz4_flex::block::compress(&tokens)].concat();
    let numbers = [references.len(), tokens.len(), packed.len()].map(|number| (number as u64).to_le_bytes());
    let section = [numbers.concat(), packed].concat();
    let start = 88 + 1 + text.len();
    let mut layer = b"PXR-USDC\0\x08\0\0\0\0\0\0".to_vec();
    layer.extend(((start + section.len()) as u64).to_le_bytes());
    layer.resize(88, 0);
    layer.push(b'\n');
    layer.extend(text.as_bytes());
    layer.extend(&section);
    layer.extend(1_u64.to_le_bytes());
    layer.extend(b"TOKENS\0\0\0\0\0\0\0\0\0\0");
    layer.extend([start, section.len()].map(|number| (number as u64).to_le_bytes()).concat());
    layer
}

/// The root layer and the files next to it.
fn write_archive(path: &Path, root: &Path) {
    let folder = root.parent().unwrap();
    let mut files = files(folder);
    files.sort_by_key(|file| (file != root, file.clone()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).with_alignment(64);
    let mut zip = ZipWriter::new(File::create(path).unwrap());
    for file in files {
        let name = file.strip_prefix(folder).unwrap().to_str().unwrap();
        zip.start_file(name, options.last_modified_time(zip::DateTime::default())).unwrap();
        zip.write_all(&fs::read(&file).unwrap()).unwrap();
    }
    zip.finish().unwrap();
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

fn size(array: &Array) -> usize {
    match array {
        Array::Float3(rows) => rows.len(),
        Array::Float2(rows) => rows.len(),
        Array::Index(indices) => indices.len(),
    }
}
