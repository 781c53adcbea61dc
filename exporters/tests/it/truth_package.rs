//! Packages of target `truth`: which files there are. What is in them is held to foreign readers by `tests/interop/truth`.

use std::collections::BTreeSet;

use crate::changed::Changed;
use crate::sample::Chamber;
use crate::told::told;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Chunk, Network, Scene, Station};
use plume_exporters::{ExportError, target};
use plume_truth::Passage;
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

/// Two passages along the middle of the chamber, and a side that is on its own.
fn network() -> Network {
    let station = |(name, [x, y, z]): (&str, [f64; 3])| Station {
        name: name.to_owned(),
        position: [x, y, z].into(),
        level: 0,
        label: None,
    };
    let places = [("a", [-3.0, 0.0, 0.0]), ("b", [0.0, 0.0, 0.2]), ("c", [3.0, 0.2, 0.0]), ("d", [0.5, 0.0, 0.0])];
    let passage = |ends: [usize; 2]| Passage { ends, reach_m: 1.5 };
    Network { stations: places.map(station).into(), passages: [[0, 1], [1, 2]].map(passage).into() }
}

#[test]
fn a_network_is_measured_and_surveyed() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let scene = Scene { network: network(), ..chamber.scene() };
    let text =
        |settings: Value, path: &str| String::from_utf8(export(&scene, settings).unwrap().bytes[path].clone()).unwrap();
    let alone = |part: &str, path: &str| text(json!({ "files": [part] }), path);
    insta::assert_snapshot!("network", alone("network", "network.graphml"));
    insta::assert_snapshot!("survey", alone("survey", "survey.svx"));
    let erring =
        |sd: f64| text(json!({ "files": ["survey"], "tape_sd_m": sd, "angle_sd_deg": 10.0 * sd }), "survey.svx");
    assert_eq!(erring(0.1), erring(0.1));
    assert!(erring(0.1) != erring(0.2) && erring(0.1).contains("*sd tape 0.1 metres\n*sd compass clino 1 degrees\n"));
}

#[test]
fn goals_are_where_they_are_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let settings = json!({ "files": ["episodes"], "robot": "leo", "goals_at": [[2.0, 0.0, -1.9]], "episodes": 3 });
    let package = export(&chamber.scene(), settings).unwrap();
    let table = String::from_utf8(package.bytes["tasks.csv"].clone()).unwrap();
    let goals =
        table.lines().skip(1).map(|row| row.split(',').skip(6).map_while(|x| x.parse().ok()).collect::<Vec<f64>>());
    let goals: Vec<Vec<f64>> = goals.collect();
    assert!(goals.len() == 3 && goals.iter().all(|goal| (goal[0] - 2.0).abs() < 0.2), "{table}");
    let unknown = target("truth").unwrap().build(json!({ "robot": "hsky" }), None).err().unwrap();
    insta::assert_snapshot!(unknown.to_string());
}

#[test]
fn a_network_that_leads_nowhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let refused = |change: fn(&mut Network)| {
        let mut network = network();
        change(&mut network);
        export(&Scene { network, ..chamber.scene() }, json!({})).unwrap_err().to_string()
    };
    let faults = [
        refused(|network| network.passages[0].ends = [0, 4]),
        refused(|network| network.passages[0].ends = [2, 2]),
        refused(|network| network.stations[1].name = "a".to_owned()),
        refused(|network| network.stations[1].name = "a b".to_owned()),
    ];
    insta::assert_snapshot!(faults.join("\n"));
}
