//! Things are told apart by their classes: in the labels of PLY, and in the manifest, which a check compares with the list.

use std::collections::BTreeMap;
use std::io::{self, BufReader};

use crate::forge::{self, Forged};
use crate::strewn::Strewn;
use plume_exporters::manifest::{Manifest, ThingsEntry};
use plume_exporters::package::{MANIFEST, Memory};
use plume_exporters::scene::{Chunk, Chunks, Instance, Piece, Prototype, Scene};
use plume_exporters::{place, target};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use serde_json::{Value, json};

/// The sample with things in it, of which the larger one is of another class.
struct Sorted(Strewn);

impl Chunks for Sorted {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        self.0.load(index)
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        self.0.neighbors(index)
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        self.0.pieces(index)
    }

    fn instances(&self, index: usize) -> io::Result<Vec<Instance>> {
        let mut things = self.0.instances(index)?;
        things.iter_mut().filter(|thing| thing.scale > 1.0).for_each(|thing| thing.class = "crate".to_owned());
        Ok(things)
    }

    fn prototypes(&self) -> io::Result<Vec<Prototype>> {
        self.0.prototypes()
    }
}

/// Its package for a target.
fn package(name: &str) -> Forged {
    let folder = tempfile::tempdir().unwrap();
    let sorted = Sorted(Strewn::new(folder.path(), false).unwrap());
    let scene = Scene { chunks: &sorted, ..sorted.0.scene() };
    let mut memory = Memory::default();
    place::fill(name, &*target(name).unwrap().build(json!({}), None).unwrap(), &scene, &mut memory).unwrap();
    memory.bytes
}

fn counted(prototypes: u64, classes: &[(&str, u64)]) -> ThingsEntry {
    ThingsEntry { prototypes, classes: classes.iter().map(|(class, count)| ((*class).to_owned(), *count)).collect() }
}

#[test]
fn the_manifest_counts_things_by_class() {
    let manifest = |name| Manifest::from_text(&package(name)[MANIFEST]).unwrap();
    for name in ["stl", "mujoco", "unity"] {
        assert_eq!(manifest(name).things, Some(counted(1, &[("box", 2), ("crate", 1)])), "{name}");
    }
    assert_eq!(Manifest::from_text(&forge::package("stl")[MANIFEST]).unwrap().things, None);
}

/// The report on a package whose list of things has been changed, and everything else that follows from it.
fn verdict(change: impl FnOnce(&mut Vec<Value>)) -> String {
    let mut forged = package("stl");
    let mut listed: Value = serde_json::from_slice(&forged["instances.json"]).unwrap();
    change(listed["things"].as_array_mut().unwrap());
    forged.insert("instances.json".to_owned(), listed.to_string().into_bytes());
    forge::amend(&mut forged, |_| ());
    forge::verdict(&forge::zip(&forged, |_| ()))
}

#[test]
fn a_check_compares_the_list_of_things_with_the_manifest() {
    assert_eq!(verdict(|_| ()), "whole");
    assert_eq!(verdict(|things| things.truncate(2)), "instances.json: lists 1 things of class `box`, the manifest 2");
    assert_eq!(
        verdict(|things| things[1]["class"] = "boulder".into()),
        "instances.json: lists 0 things of class `crate`, the manifest 1\n\
         instances.json: lists 1 things of class `boulder`, the manifest 0"
    );
    assert_eq!(
        verdict(|things| things[1]["prototype"] = "box_1".into()),
        "instances.json: lists things of 2 prototypes, the manifest of 1"
    );
}

#[test]
fn things_that_the_manifest_does_not_count_are_found() {
    let mut forged = package("stl");
    forge::amend(&mut forged, |manifest| manifest.things = None);
    let told = forge::verdict(&forge::zip(&forged, |_| ()));
    assert!(told.contains("lists 2 things of class `box`, the manifest 0"), "{told}");
}

#[test]
fn a_ply_labels_vertices_and_faces_by_class() {
    let files = package("ply");
    let ply = Parser::<DefaultElement>::new().read_ply(&mut BufReader::new(&files["chamber.ply"][..])).unwrap();
    let names: Vec<&str> =
        ply.header.comments.iter().filter_map(|comment| comment.trim().strip_prefix("label ")).collect();
    assert_eq!(names, ["1 floor", "2 wall", "3 ceiling", "4 box", "5 crate"]);
    for (element, of_a_box) in [("vertex", 8), ("face", 12)] {
        let mut counts: BTreeMap<u8, usize> = BTreeMap::new();
        for row in &ply.payload[element] {
            let Property::UChar(label) = row["label"] else { panic!("{row:?}") };
            *counts.entry(label).or_default() += 1;
        }
        assert_eq!((counts[&4], counts[&5]), (2 * of_a_box, of_a_box));
        let last = &ply.payload[element][ply.payload[element].len() - of_a_box - 1];
        assert!(matches!(last["label"], Property::UChar(5)), "the crate is the second of three");
    }
}
