//! All references of a Gazebo package resolve.

use std::collections::BTreeSet;

use crate::sample;
use crate::strewn::Strewn;
use plume_exporters::collision::Collision;
use plume_exporters::frame::{micro, sdf_pose};
use plume_exporters::package::Memory;
use plume_exporters::targets::gazebo::{Gazebo, GazeboSettings};
use plume_exporters::{Summary, Target, target};
use roxmltree::{Document, Node};

fn export(settings: GazeboSettings) -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    Gazebo(settings).export(&chamber.scene(), &mut memory).unwrap();
    memory
}

fn text<'a>(package: &'a Memory, path: &str) -> &'a str {
    std::str::from_utf8(&package.bytes[path]).unwrap()
}

#[test]
fn every_reference_resolves_and_every_file_is_referenced() {
    for collision in [Collision::Triangles, Collision::Pieces] {
        check_references(&export(GazeboSettings { collision, ..GazeboSettings::default() }));
    }
}

fn check_references(package: &Memory) {
    let mut named = BTreeSet::new();
    for path in ["models/chamber/model.sdf", "worlds/chamber.sdf"] {
        let document = Document::parse(text(package, path)).unwrap();
        assert_eq!(document.root_element().attribute("version"), Some("1.9"));
        for node in document.descendants().filter(|node| node.is_element()) {
            let Some(rest) = node.text().and_then(|text| text.strip_prefix("model://")) else {
                continue;
            };
            let path = if node.parent_element().unwrap().has_tag_name("include") {
                format!("models/{rest}/model.config")
            } else {
                format!("models/{rest}")
            };
            assert!(package.bytes.contains_key(&path), "{path}");
            named.insert(path);
        }
    }
    for path in package.bytes.keys().filter(|path| path.contains("/materials/") || path.ends_with(".obj")) {
        assert!(named.contains(path), "{path}");
    }
}

fn strewn(movable: bool) -> (Memory, Strewn, Summary) {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), movable).unwrap();
    let mut memory = Memory::default();
    let summary = Gazebo(GazeboSettings::default()).export(&strewn.scene(), &mut memory).unwrap();
    (memory, strewn, summary)
}

fn child<'a, 'input>(node: Node<'a, 'input>, path: &str) -> Node<'a, 'input> {
    path.split('/').fold(node, |node, tag| node.children().find(|child| child.has_tag_name(tag)).unwrap())
}

fn number(node: Node, path: &str) -> f64 {
    child(node, path).text().unwrap().parse().unwrap()
}

#[test]
fn movable_things_are_models_that_share_their_meshes() {
    let (package, strewn, summary) = strewn(true);
    check_references(&package);
    let shared = |ending: &str| package.bytes.keys().filter(|path| path.ends_with(ending)).count();
    assert_eq!([shared("/box_0_level_0.obj"), shared("/box_0_hull.obj"), shared("/prototypes.mtl")], [1; 3]);
    assert!(!package.bytes.keys().any(|path| path.contains("things_0_0_0")));
    let document = Document::parse(text(&package, "worlds/chamber.sdf")).unwrap();
    let models: Vec<Node> = document.descendants().filter(|node| node.has_tag_name("model")).collect();
    assert_eq!(models.len(), strewn.things().len());
    for (model, thing) in models.into_iter().zip(strewn.things()) {
        assert_eq!(model.attribute("name"), Some(format!("box_{:016x}", thing.id).as_str()));
        assert_eq!(child(model, "static").text(), Some("false"));
        assert_eq!(child(model, "pose").text(), Some(sdf_pose(&thing.pose).as_str()));
        let link = child(model, "link");
        assert_eq!(number(link, "inertial/mass"), thing.mass_kg);
        assert_eq!(child(link, "inertial/pose").text(), Some("0 0 0 0 0 0"));
        let edge_m = 0.2 * thing.scale;
        for moment in ["ixx", "iyy", "izz"] {
            let found = number(link, &format!("inertial/inertia/{moment}"));
            assert!((found - thing.mass_kg * edge_m * edge_m / 6.0).abs() < 1e-6, "{moment} {found}");
        }
        for shape in ["visual", "collision"] {
            let scale = child(link, &format!("{shape}/geometry/mesh/scale")).text().unwrap();
            assert_eq!(scale, [micro(thing.scale).as_str(); 3].join(" "));
        }
    }
    let walls = export_summary();
    assert_eq!(summary.visual_triangles - walls.visual_triangles, 12 * 3);
    assert_eq!(summary.collision_triangles - walls.collision_triangles, 12 * 3);
}

#[test]
fn other_things_are_part_of_the_static_model() {
    let (package, ..) = strewn(false);
    check_references(&package);
    assert!(package.bytes.contains_key("models/chamber/meshes/things_0_0_0_collision.obj"));
    assert!(!text(&package, "worlds/chamber.sdf").contains("<model"));
}

fn export_summary() -> Summary {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    Gazebo(GazeboSettings::default()).export(&chamber.scene(), &mut Memory::default()).unwrap()
}

#[test]
fn material_libraries_lead_to_textures() {
    let package = export(GazeboSettings::default());
    let libraries: Vec<_> = package.bytes.keys().filter(|path| path.ends_with(".mtl")).collect();
    assert_eq!(libraries.len(), 2);
    for library in libraries {
        let maps: Vec<_> = text(&package, library).lines().filter_map(|line| line.split_once(" ../")).collect();
        assert_eq!(maps.iter().map(|map| map.0).collect::<Vec<_>>(), ["map_Kd", "norm", "map_Pr"]);
        for (_, path) in maps {
            assert!(package.bytes.contains_key(&format!("models/chamber/{path}")), "{path}");
        }
    }
}

#[test]
fn each_chunk_has_one_visual_and_one_collision() {
    let package = export(GazeboSettings::default());
    let document = Document::parse(text(&package, "models/chamber/model.sdf")).unwrap();
    let count = |tag| document.descendants().filter(|node| node.has_tag_name(tag)).count();
    assert_eq!([count("visual"), count("collision"), count("mu"), count("link")], [2, 2, 2, 1]);
}

#[test]
fn pieces_have_the_friction_of_their_zone() {
    let package = export(GazeboSettings { collision: Collision::Pieces, ..GazeboSettings::default() });
    let document = Document::parse(text(&package, "models/chamber/model.sdf")).unwrap();
    let collisions: Vec<_> = document.descendants().filter(|node| node.has_tag_name("collision")).collect();
    assert_eq!(collisions.len(), 6);
    for collision in collisions {
        let friction = if collision.attribute("name").unwrap().ends_with("_floor") { "0.8" } else { "0.6" };
        let numbers: Vec<_> = collision.descendants().filter(|node| node.has_tag_name("mu")).collect();
        assert_eq!(numbers.iter().map(|node| node.text()).collect::<Vec<_>>(), [Some(friction)]);
    }
}

#[test]
fn lights_can_be_omitted() {
    for lights in [true, false] {
        let package = export(GazeboSettings { lights, ..GazeboSettings::default() });
        let document = Document::parse(text(&package, "models/chamber/model.sdf")).unwrap();
        let found = document.descendants().filter(|node| node.has_tag_name("light")).count();
        assert_eq!(found, if lights { 2 } else { 0 });
    }
}

/// So that those who include the model in a world of their own have them, too.
#[test]
fn lights_and_frames_are_in_the_model() {
    let package = export(GazeboSettings::default());
    let count = |path: &str, tag: &str| {
        let document = Document::parse(text(&package, path)).unwrap();
        document.descendants().filter(|node| node.has_tag_name(tag)).count()
    };
    for (tag, in_model) in [("light", 2), ("frame", 1)] {
        assert_eq!(count("models/chamber/model.sdf", tag), in_model);
        assert_eq!(count("worlds/chamber.sdf", tag), 0);
    }
}

#[test]
fn texts_are_escaped() {
    let package = export(GazeboSettings::default());
    let document = Document::parse(text(&package, "models/chamber/model.config")).unwrap();
    let description = document.descendants().find(|node| node.has_tag_name("description"));
    assert_eq!(description.unwrap().text(), Some("A bumpy chamber for tests & <examples>"));
    assert!(text(&package, "README.md").contains("tests & <examples>"));
}

fn for_ros2() -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let gazebo = target("gazebo").unwrap().build(serde_json::json!({ "ros2": true }), None).unwrap();
    let mut memory = Memory::default();
    gazebo.export(&chamber.scene(), &mut memory).unwrap();
    memory
}

#[test]
fn a_rover_is_added_on_request_only() {
    let (alone, with) = (export(GazeboSettings::default()), for_ros2());
    assert!(alone.bytes.keys().all(|path| !path.contains("ros2") && !path.contains("rover")));
    assert!(with.bytes.contains_key("ros2/maps/map_0.png"), "the chamber has a floor");
    for (path, bytes) in &alone.bytes {
        assert!(path == "README.md" || with.bytes[path] == *bytes, "{path} differs");
    }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// The rover of MuJoCo has its sizes in halves.
#[test]
fn the_rover_is_that_of_mujoco() {
    let (package, folder) = (for_ros2(), tempfile::tempdir().unwrap());
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut other = Memory::default();
    let mujoco = target("mujoco").unwrap().build(serde_json::json!({}), None).unwrap();
    mujoco.export(&chamber.scene(), &mut other).unwrap();
    let mjcf = Document::parse(text(&other, "rover.xml")).unwrap();
    let sdf = Document::parse(text(&package, "models/chamber_rover/model.sdf")).unwrap();
    let named = |name: &str, tag: &str| {
        let found = |node: &Node| node.has_tag_name(tag) && node.attribute("name") == Some(name);
        mjcf.descendants().find(found).or_else(|| sdf.descendants().find(found)).unwrap_or_else(|| panic!("{name}"))
    };
    for part in ["chassis", "deck", "mast", "head"] {
        let geom = named(&format!("rover_{}", if part == "chassis" { "hull" } else { part }), "geom");
        let visual = named(part, "visual");
        let half: Vec<f64> =
            numbers(child(visual, "geometry/box/size").text().unwrap()).iter().map(|n| n / 2.0).collect();
        assert_eq!(numbers(geom.attribute("size").unwrap()), half, "{part}");
        assert_eq!(
            numbers(geom.attribute("pos").unwrap()),
            numbers(child(visual, "pose").text().unwrap())[..3],
            "{part}"
        );
    }
    for wheel in ["front_left", "front_right", "rear_left", "rear_right"] {
        let body = named(&format!("rover_wheel_{wheel}"), "body");
        let link = named(&format!("wheel_{wheel}"), "link");
        assert_eq!(numbers(body.attribute("pos").unwrap()), numbers(child(link, "pose").text().unwrap())[..3]);
        assert_eq!(number(link, "inertial/mass"), 2.5);
    }
    let camera = named("camera", "sensor");
    assert_eq!(
        numbers(named("rover_camera", "camera").attribute("pos").unwrap()),
        numbers(child(camera, "pose").text().unwrap())[..3]
    );
}

/// The full text, so that changes show up in review.
#[test]
fn texts_for_ros_2_are_golden() {
    let package = for_ros2();
    for path in [
        "models/chamber_rover/model.sdf",
        "ros2/launch/cave.launch.py",
        "ros2/config/bridge.yaml",
        "ros2/config/nav2.yaml",
    ] {
        insta::assert_snapshot!(path.replace('/', "_"), text(&package, path));
    }
}

/// The full text, so that changes show up in review.
#[test]
fn texts_are_golden() {
    let package = export(GazeboSettings::default());
    for path in ["models/chamber/model.sdf", "worlds/chamber.sdf", "README.md"] {
        insta::assert_snapshot!(path.replace('/', "_"), text(&package, path));
    }
}
