//! Stations that a survey names are frames of every format that has frames, and a table in every package.

use crate::ledger::{complete, ledger};
use crate::sample::Chamber;
use plume_exporters::manifest::Manifest;
use plume_exporters::package::{MANIFEST, Memory};
use plume_exporters::scene::{MOST_FRAMES, Network, Scene, Station};
use plume_exporters::stations::STATIONS;
use plume_exporters::{place, target};
use serde_json::json;

/// Targets that write frames without a USD library.
const TARGETS: [&str; 8] = ["gazebo", "urdf", "mujoco", "gltf", "glb", "fbx", "unity", "unreal"];

/// Named stations, as many as wanted, and no passage.
fn many(count: usize) -> Network {
    let station = |number: usize| Station {
        name: number.to_string(),
        position: [number as f64, 0.25, 0.5].into(),
        level: 0,
        label: Some(format!("a.{number}")),
    };
    Network { stations: (0..count).map(station).collect(), passages: Vec::new() }
}

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

#[test]
fn every_package_has_a_table_of_named_stations() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    for row in complete() {
        let fill = |scene: &Scene| {
            let mut package = Memory::default();
            place::fill(row.name, &*row.build(json!({}), ledger().as_ref()).unwrap(), scene, &mut package).unwrap();
            package
        };
        let package = fill(&Scene { network: network(), ..chamber.scene() });
        let table = "frame,name,x_m,y_m,z_m\n\
            station_hall_1,\"hall.1\",0,0.25,0.5\n\
            station_hall_1_2,\"Hall.1\",2,0.25,0.5\n\
            station_7,\"<\"\"&>.7\",3,0.25,0.5\n";
        assert_eq!(std::str::from_utf8(&package.bytes[STATIONS]).unwrap(), table, "{}", row.name);
        assert!(!fill(&chamber.scene()).bytes.contains_key(STATIONS), "{}", row.name);
        if row.name == "unity" {
            assert!(package.bytes.contains_key("stations.csv.meta"));
        }
    }
}

/// With more, Bullet tells of no frame where it is.
#[test]
fn a_urdf_has_no_more_joints_than_bullet_holds() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    for (count, joints) in [(126, 127), (127, 127), (500, 127)] {
        let scene = Scene { network: many(count), ..chamber.scene() };
        let mut package = Memory::default();
        let target = target("urdf").unwrap().build(json!({}), None).unwrap();
        place::fill("urdf", &*target, &scene, &mut package).unwrap();
        let text = |path: &str| String::from_utf8(package.bytes[path].clone()).unwrap();
        assert_eq!(text("chamber/urdf/chamber.urdf").matches("<joint ").count(), joints, "{count} stations");
        assert_eq!(text(STATIONS).lines().count(), 1 + count);
        assert_eq!(text("README.md").contains(STATIONS), count > 126, "{count} stations");
    }
}

#[test]
fn a_manifest_lists_no_more_stations_than_are_frames() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let scene = Scene { network: many(MOST_FRAMES + 1), ..chamber.scene() };
    let mut package = Memory::default();
    place::fill("glb", &*target("glb").unwrap().build(json!({}), None).unwrap(), &scene, &mut package).unwrap();
    assert_eq!(Manifest::from_text(&package.bytes[MANIFEST]).unwrap().stations.len(), MOST_FRAMES);
    assert!(holds(&package, "station_a_9999") && !holds(&package, "\"station_a_10000\""));
}
