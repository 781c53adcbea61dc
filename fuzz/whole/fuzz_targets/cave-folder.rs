//! Manifest and journal of a cave folder, split by the byte 1: no record leads out of the folder. Both are sealed here, as
//! an attacker can do too.
#![no_main]

use std::fs;
use std::path::{Component, Path};

use plume::store::{CaveFolder, Stage, sha256};
use plume_disk::sealed;

const NEXT_FILE: char = '\u{1}';

libfuzzer_sys::fuzz_target!(|text: &str| {
    let (manifest, journal) = text.split_once(NEXT_FILE).unwrap_or((text, ""));
    let folder = tempfile::tempdir().expect("a folder can be made");
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file can be written");
    put("manifest.json", &sealed::seal(manifest));
    put("journal.jsonl", &journal.lines().map(line).collect::<String>());
    let Ok(cave) = CaveFolder::open(folder.path()) else { return };
    for stage in [Stage::Graph, Stage::Preview, Stage::Mesh, Stage::Things, Stage::Texture, Stage::Pieces] {
        for unit in cave.units(stage) {
            assert!(unit.files.iter().all(|file| stays_inside(&file.path)), "{unit:?}");
        }
    }
});

fn line(event: &str) -> String {
    format!("{{\"sha256\":\"{}\",\"event\":{event}}}\n", sha256(event.as_bytes()))
}

fn stays_inside(path: &str) -> bool {
    !path.is_empty() && Path::new(path).components().all(|part| matches!(part, Component::Normal(_)))
}
