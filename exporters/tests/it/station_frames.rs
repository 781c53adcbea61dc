//! Stations that a survey names are frames of every format that has frames.

use crate::sample::Chamber;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Network, Scene, Station};
use plume_exporters::target;
use serde_json::json;

/// Targets that write frames without a USD library.
const TARGETS: [&str; 7] = ["gazebo", "urdf", "mujoco", "gltf", "glb", "fbx", "unity"];

/// Two stations of the same name, one without any, and one whose name is not safe.
fn network() -> Network {
    let station = |(number, label): (usize, &str)| Station {
        name: number.to_string(),
        position: [number as f64, 0.25, 0.5].into(),
        level: 0,
        label: (!label.is_empty()).then(|| label.to_owned()),
    };
    let labels = ["hall.1", "", "Hall.1", "<\"&>.7"];
    Network { stations: labels.into_iter().enumerate().map(station).collect(), passages: Vec::new() }
}

fn holds(package: &Memory, word: &str) -> bool {
    package.bytes.values().any(|bytes| bytes.windows(word.len()).any(|window| window == word.as_bytes()))
}

#[test]
fn named_stations_are_frames() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    for name in TARGETS {
        let export = |scene: &Scene| {
            let mut package = Memory::default();
            target(name).unwrap().build(json!({}), None).unwrap().export(scene, &mut package).unwrap();
            package
        };
        let package = export(&Scene { network: network(), ..chamber.scene() });
        for frame in ["station_hall_1", "station_hall_1_2", "station_7"] {
            assert!(holds(&package, frame), "{name} has no {frame}");
        }
        assert!(!holds(&export(&chamber.scene()), "station_"), "{name}");
    }
}
