//! Packages of target `truth`: which files there are. What is in them is held to foreign readers by `tests/interop/truth`.

use std::collections::BTreeSet;

use crate::changed::Changed;
use crate::sample::Chamber;
use crate::told::told;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Chunk, Scene};
use plume_exporters::{ExportError, target};
use serde_json::{Value, json};

fn export(scene: &Scene, settings: Value) -> Result<Memory, ExportError> {
    let mut package = Memory::default();
    target("truth")?.build(settings, None)?.export(scene, &mut package)?;
    Ok(package)
}

#[test]
fn parts_can_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let whole = export(&chamber.scene(), json!({})).unwrap();
    let always = ["README.md", "labels.json", "truth.json"];
    let mut all = BTreeSet::from(always.map(str::to_owned));
    let schema = serde_json::to_value((target("truth").unwrap().row.settings)()).unwrap();
    for part in schema["properties"]["files"]["default"].as_array().unwrap() {
        let alone = export(&chamber.scene(), json!({ "files": [part] })).unwrap();
        let own: Vec<&String> = alone.bytes.keys().filter(|path| !always.contains(&path.as_str())).collect();
        assert!(!own.is_empty() && own.iter().all(|path| alone.bytes[*path] == whole.bytes[*path]), "{part}");
        let told: Value = serde_json::from_slice(&alone.bytes["truth.json"]).unwrap();
        let listed = told["files"].as_array().unwrap().iter().map(|entry| entry["file"].as_str().unwrap());
        let listed: BTreeSet<&str> = listed.collect();
        let named: BTreeSet<&str> =
            own.iter().map(|path| path.as_str()).filter(|path| !path.ends_with(".yaml")).collect();
        assert_eq!(listed, named.into_iter().chain(["labels.json"]).collect(), "{part}");
        let readme = String::from_utf8(alone.bytes["README.md"].clone()).unwrap();
        assert!(own.iter().any(|path| readme.contains(path.as_str())), "{part} is not in its README: {readme}");
        assert!(own.iter().all(|path| all.insert((*path).clone())), "{part} has a file of another part");
    }
    assert_eq!(all, whole.bytes.into_keys().collect());
}

#[test]
fn an_octomap_that_does_not_reach_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let away = |_: usize, mut chunk: Chunk| {
        chunk.visual.positions.iter_mut().for_each(|[x, _, _]| *x += 2000.0);
        Ok(chunk)
    };
    let scene = Scene { chunks: &Changed { inner: &chamber, change: away }, ..chamber.scene() };
    let error = export(&scene, json!({ "voxel_m": 0.05 })).unwrap_err();
    insta::assert_snapshot!(told(&error), @"usage: occupancy.bt: OctoMap reaches 1638.4 m from the origin, and the scene is larger (hint: choose larger cells (`voxel_m`), or leave the file out (`files`))");
    export(&scene, json!({ "voxel_m": 0.05, "files": ["voxels"] })).unwrap();
    export(&scene, json!({ "voxel_m": 0.1 })).unwrap();
}
