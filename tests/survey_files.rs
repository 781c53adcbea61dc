//! Cave surveys as files: held against what other programs read in them, and with something wrong.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use nalgebra::{Point3, Vector3};
use plume::graph::format::{Import, Parts, ReadError, read};
use plume::graph::{Graph, Nowhere, Outside, RunError, Task};

/// Files by name.
#[derive(Default)]
struct Files(BTreeMap<String, Vec<u8>>);

impl Files {
    fn one(name: &str, bytes: &[u8]) -> Self {
        Self([(name.to_owned(), bytes.to_vec())].into())
    }
}

impl Outside for Files {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = path.to_str().and_then(|name| self.0.get(name));
        found.cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn run(&self, task: &Task) -> Result<Vec<u8>, RunError> {
        Nowhere.run(task)
    }
}

fn data(path: &str) -> Vec<u8> {
    fs::read(format!("tests/data/{path}")).expect("it is in the repository")
}

fn parsed(name: &str, bytes: &[u8], parts: Parts) -> Result<Import, ReadError> {
    read(Path::new(name), parts, &Files::one(name, bytes))
}

fn hollow() -> Vec<u8> {
    data("formats/survex-3d/hollow.3d")
}

/// Passages that Survex lists in a file, as pairs of places.
fn dumped_passages(dump: &str) -> Vec<[Point3<f64>; 2]> {
    let legs = dump.lines().filter_map(|line| line.strip_prefix("LEG "));
    let passages = legs.filter(|leg| !["SPLAY", "SURFACE", "DUPLICATE"].iter().any(|flag| leg.contains(flag)));
    let places = passages.map(|leg| {
        let x: Vec<f64> = leg.split(' ').take(6).map(|x| x.parse().expect("a coordinate")).collect();
        [Point3::new(x[0], x[1], x[2]), Point3::new(x[3], x[4], x[5])]
    });
    places.filter(|[a, b]| a != b).collect()
}

fn node_at(graph: &Graph, place: Point3<f64>) -> Option<usize> {
    (0..graph.nodes.len()).find(|&node| (graph.nodes[node].position - place).norm() < 0.001)
}

#[test]
fn a_3d_file_reads_as_survex_reads_it() {
    let bytes = data("formats/survex-3d/bare.3d");
    let Import { graph, tally, .. } = parsed("bare.3d", &bytes, Parts::Refuse).unwrap();
    let dump = String::from_utf8(data("surveys/bare.dump")).unwrap();
    let passages = dumped_passages(&dump);
    let origin = Vector3::from(tally.origin_m);
    for ends in &passages {
        let [a, b] = ends.map(|end| node_at(&graph, end - origin).expect("a node stands there"));
        assert!(graph.edges.contains(&[a.min(b), a.max(b)]), "{ends:?}");
    }
    assert_eq!((graph.edges.len(), graph.nodes.len(), graph.loops()), (passages.len(), 12, 1));
    assert_eq!((tally.splays, tally.duplicates, tally.surface, tally.welded), (3, 1, 2, 1));
    assert_eq!((tally.interpolated, tally.joined, tally.left_out), (0, 0, 0));
}

#[test]
fn the_first_entrance_is_the_origin_wherever_the_grid_has_it() {
    let Import { graph, tally, .. } = parsed("bare.3d", &data("formats/survex-3d/bare.3d"), Parts::Refuse).unwrap();
    assert_eq!(tally.origin_m, [500_000.25, 4_600_000.5, 1234.56]);
    assert_eq!(graph.nodes[0].position, Point3::origin());
    assert!(graph.nodes.iter().all(|node| node.section.is_none() && (2.5..=6.0).contains(&node.radius)));
}

#[test]
fn every_beginning_of_a_3d_file_is_an_error() {
    let whole = hollow();
    for length in 0..whole.len() {
        let error = parsed("cut.3d", &whole[..length], Parts::Refuse).unwrap_err();
        assert!(!error.hint.is_empty(), "{length}: {error}");
    }
}

#[test]
fn a_3d_file_with_any_byte_changed_is_read_or_refused() {
    let whole = hollow();
    for at in 0..whole.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] ^= flip;
            if let Err(error) = parsed("odd.3d", &bytes, Parts::Join) {
                assert!(!error.hint.is_empty(), "{at}: {error}");
            }
        }
    }
}

/// A file with these items.
fn with_items(items: &[&[u8]]) -> Vec<u8> {
    [b"Survex 3D Image File\nv8\ntitle\n@0\n\0", items.concat().as_slice()].concat()
}

fn place(code: &[u8], cm: [i32; 3]) -> Vec<u8> {
    [code, &cm.map(i32::to_le_bytes).concat()].concat()
}

#[test]
fn what_is_wrong_with_a_3d_file_is_told() {
    let start = place(b"\0\x0f", [0; 3]);
    let leg = place(b"\x60", [500, 0, 0]);
    let far = place(b"\x60", [i32::MAX, 0, 0]);
    let other = place(b"\x60", [500, 1000, 0]);
    let named = place(b"\x84\x01a", [0; 3]);
    let wide = place(b"\x33\x11a\0\0\x10\0", [-1; 3]);
    let apart = [start.as_slice(), &leg, &place(b"\x0f", [0, 1000, 0]), &other].concat();
    let faults = [
        ("no survey", b"solid cave\n".to_vec()),
        ("version 7", b"Survex 3D Image File\nv7\ntitle\n".to_vec()),
        ("version 9", b"Survex 3D Image File\nv9\ntitle\n@0\n\0".to_vec()),
        ("extended", b"Survex 3D Image File\nv8\ntitle\n@0\n\x80".to_vec()),
        ("no legs", with_items(&[b"\0\0"])),
        ("only over the ground", with_items(&[&start, &place(b"\x61", [500, 0, 0]), b"\0"])),
        ("unknown item", with_items(&[b"\x05"])),
        ("leg from nowhere", with_items(&[&leg, b"\0"])),
        ("name underflow", with_items(&[&place(b"\x80\x10", [0; 3])])),
        ("name of four gigabytes", with_items(&[b"\x80\0\0\xff\xff\xff\xff\xff"])),
        ("section of nobody", with_items(&[&named, b"\x31\x01b\0\0\0\0\0\0\0\0", b"\0"])),
        ("section too large", with_items(&[&start, &leg, &named, &wide, b"\0"])),
        ("too far", with_items(&[&start, &far, b"\0"])),
        ("in parts", with_items(&[&apart, b"\0"])),
    ];
    let told = faults.map(|(name, bytes)| {
        let error = parsed("cave.3d", &bytes, Parts::Refuse).unwrap_err();
        format!("{name}\n  {error}\n  {}\n", error.hint)
    });
    insta::assert_snapshot!("survex-3d-faults", told.concat());
}

/// A passage of several cross-sections, from the smaller and the larger kind of item.
#[test]
fn cross_sections_become_sections_with_the_floor_where_it_was() {
    let graph = parsed("hollow.3d", &hollow(), Parts::Refuse).unwrap().graph;
    let sections: Vec<_> = graph.nodes.iter().map(|node| (node.position, node.section)).collect();
    insta::assert_snapshot!(
        "hollow",
        sections
            .iter()
            .map(|(at, section)| {
                let section = section.map(|section| [section.width_m, section.height_m]);
                format!("{:?} {section:?}\n", at.coords.data.0[0])
            })
            .collect::<String>()
    );
}
