//! Handmade packages: arbitrary files with a matching manifest.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use plume_exporters::check::{Report, check};
use plume_exporters::manifest::Manifest;
use plume_exporters::package::{Entry, MANIFEST, Memory};
use plume_exporters::{place, target};
use serde_json::json;
use sha2::{Digest, Sha256};
use zip::write::{SimpleFileOptions, ZipWriter};

use crate::sample::Chamber;

/// Files by path.
pub type Forged = BTreeMap<String, Vec<u8>>;

/// The sample for a target.
pub fn package(name: &str) -> Forged {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    place::fill(name, &*target(name).unwrap().build(json!({}), None).unwrap(), &chamber.scene(), &mut memory).unwrap();
    memory.bytes
}

/// Exactly these files, with a manifest that lists them.
pub fn package_of(files: &[(&str, &[u8])]) -> Forged {
    let mut forged = package("gltf");
    let manifest = forged.remove(MANIFEST).unwrap();
    forged = files.iter().map(|(path, bytes)| ((*path).to_owned(), bytes.to_vec())).collect();
    forged.insert(MANIFEST.to_owned(), manifest);
    amend(&mut forged, |_| ());
    forged
}

/// Updates the manifest for the files, and then applies `change` to it.
pub fn amend(forged: &mut Forged, change: impl FnOnce(&mut Manifest)) {
    let mut manifest = Manifest::from_text(&forged.remove(MANIFEST).unwrap()).unwrap();
    manifest.files.0 = forged.iter().map(|(path, bytes)| (path.clone(), entry(bytes))).collect();
    for chunk in &mut manifest.chunks {
        chunk.textures.retain(|_, path| forged.contains_key(path));
    }
    change(&mut manifest);
    forged.insert(MANIFEST.to_owned(), manifest.to_text().unwrap().into_bytes());
}

/// The manifest entry of a file.
pub fn entry(bytes: &[u8]) -> Entry {
    let sha256 = Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        write!(hex, "{byte:02x}").unwrap();
        hex
    });
    Entry { bytes: bytes.len() as u64, sha256, source: None }
}

/// A zip of some files, and what `more` adds to it.
pub fn zip(forged: &Forged, more: impl FnOnce(&mut ZipWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in forged {
        zip.start_file(path.as_str(), SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    more(&mut zip);
    zip.finish().unwrap().into_inner()
}

/// A tar of some files, and what `more` adds to it.
pub fn tar(forged: &Forged, more: impl FnOnce(&mut tar::Builder<Vec<u8>>)) -> Vec<u8> {
    let mut builder = tar::Builder::new(Vec::new());
    for (path, bytes) in forged {
        let mut header = tar::Header::new_ustar();
        header.set_path(path).unwrap();
        header.set_size(bytes.len() as u64);
        header.set_cksum();
        builder.append(&header, &bytes[..]).unwrap();
    }
    more(&mut builder);
    builder.into_inner().unwrap()
}

/// The bytes, compressed with Zstandard.
pub fn zstd(bytes: &[u8]) -> Vec<u8> {
    zstd::encode_all(bytes, 1).unwrap()
}

/// The report on an archive of these bytes.
pub fn verdict(archive: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("archive");
    fs::write(&path, archive).unwrap();
    told(&path)
}

/// The report on a package, one line per fault.
pub fn told(path: &Path) -> String {
    match check(path) {
        Ok(Report { faults, .. }) if faults.is_empty() => "whole".to_owned(),
        Ok(report) => {
            let lines: Vec<String> =
                report.faults.iter().map(|fault| format!("{}: {}", fault.path, fault.what)).collect();
            lines.join("\n")
        }
        Err(error) => error.to_string().replace(path.to_str().unwrap(), "ARCHIVE"),
    }
}
