//! All references of a Gazebo package resolve.

use std::collections::BTreeSet;

use crate::sample;
use plume_exporters::Target;
use plume_exporters::collision::Collision;
use plume_exporters::package::Memory;
use plume_exporters::targets::gazebo::{Gazebo, GazeboSettings};
use roxmltree::Document;

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
        let document = Document::parse(text(&package, "worlds/chamber.sdf")).unwrap();
        let found = document.descendants().filter(|node| node.has_tag_name("light")).count();
        assert_eq!(found, if lights { 2 } else { 0 });
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

/// The full text, so that changes show up in review.
#[test]
fn texts_are_golden() {
    let package = export(GazeboSettings::default());
    for path in ["models/chamber/model.sdf", "worlds/chamber.sdf", "README.md"] {
        insta::assert_snapshot!(path.replace('/', "_"), text(&package, path));
    }
}
