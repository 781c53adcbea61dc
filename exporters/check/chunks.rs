//! Whether the manifest is consistent.

use std::collections::{BTreeMap, BTreeSet};

use super::Fault;
use crate::manifest::Manifest;
use crate::package::{MANIFEST, path_fault};

/// Invalid paths, images that are not listed, neighbours that are not mutual.
pub fn faults(manifest: &Manifest) -> Vec<Fault> {
    let paths = manifest.files.0.keys();
    let wild = paths.filter_map(|path| Some(format!("lists `{path}`, which {}", path_fault(path)?)));
    let whats = wild.chain(images(manifest)).chain(neighbors(manifest));
    whats.map(|what| Fault { path: MANIFEST.to_owned(), what }).collect()
}

fn images(manifest: &Manifest) -> impl Iterator<Item = String> {
    let named = manifest.chunks.iter().flat_map(|chunk| chunk.textures.values().map(move |path| (&chunk.name, path)));
    let absent = named.filter(|(_, path)| !manifest.files.0.contains_key(*path));
    absent.map(|(chunk, path)| format!("lists chunk `{chunk}` with the image `{path}`, but not that file"))
}

fn neighbors(manifest: &Manifest) -> impl Iterator<Item = String> {
    let table: BTreeMap<&str, BTreeSet<&str>> = manifest
        .chunks
        .iter()
        .map(|chunk| (chunk.name.as_str(), chunk.neighbors.iter().map(String::as_str).collect()))
        .collect();
    let pairs = manifest.chunks.iter().flat_map(|chunk| chunk.neighbors.iter().map(|other| (&*chunk.name, &**other)));
    let lonely = pairs.filter(move |(chunk, other)| !table.get(other).is_some_and(|back| back.contains(chunk)));
    lonely
        .map(|(chunk, other)| format!("lists `{other}` as a neighbour of chunk `{chunk}`, but not the other way round"))
}
