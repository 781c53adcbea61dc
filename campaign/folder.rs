//! Forging the records of a cave folder: its manifest and its journal.
//!
//! Whoever passes on a hostile cave folder can compute any hash that has no secret in it, so records are forged with seals as
//! well as without.

use std::fs;

use serde_json::{Value, json};

use crate::desk::Desk;
use crate::tree::sha256;

/// Whether a forger takes the trouble to seal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// A plain record, as earlier versions wrote it.
    Open,
    /// With a hash that fits.
    Sealed,
}

/// The finished units of the cave folder `c`.
pub fn units(desk: &Desk) -> Vec<Value> {
    let text = fs::read(desk.path("c/manifest.json")).expect("a cave folder has a manifest");
    let manifest: Value = serde_json::from_slice(&text).expect("a manifest is JSON");
    manifest["units"].as_array().expect("a manifest has units").clone()
}

/// Puts `units` into the manifest of the cave folder `c`, the rest being as it was.
pub fn put_manifest(desk: &Desk, units: Vec<Value>, seal: Seal) {
    let text = fs::read(desk.path("c/manifest.json")).expect("a cave folder has a manifest");
    let mut manifest: Value = serde_json::from_slice(&text).expect("a manifest is JSON");
    manifest["units"] = units.into();
    let entries = manifest.as_object_mut().expect("a manifest is an object");
    entries.remove("seal");
    desk.file("c/manifest.json", sealed(&format!("{manifest:#}"), seal));
}

fn sealed(text: &str, seal: Seal) -> String {
    if seal == Seal::Open {
        return format!("{text}\n");
    }
    let before = format!("{},\n  \"seal\": \"", text.trim_end_matches("\n}"));
    let hash = sha256(before.as_bytes());
    format!("{before}{hash}\"\n}}\n")
}

/// Puts a journal with these units into the cave folder `c`.
pub fn put_journal(desk: &Desk, units: &[Value], seal: Seal) {
    let lines: String = units.iter().map(|unit| line(unit, seal)).collect();
    desk.file("c/journal.jsonl", lines);
}

fn line(unit: &Value, seal: Seal) -> String {
    match seal {
        Seal::Open => format!("{unit}\n"),
        Seal::Sealed => {
            let event = json!({"done": unit}).to_string();
            format!("{{\"sha256\":\"{}\",\"event\":{event}}}\n", sha256(event.as_bytes()))
        }
    }
}

/// A unit that claims to have written `paths`.
pub fn unit(stage: &str, name: &str, paths: &[&str]) -> Value {
    let hash = sha256(b"");
    let files: Vec<Value> = paths.iter().map(|path| json!({"path": path, "bytes": 0, "sha256": hash})).collect();
    json!({"stage": stage, "name": name, "fingerprint": hash, "files": files, "facts": {}})
}
