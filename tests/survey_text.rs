//! Surveys as text: held against what Survex and Therion make of them, and with something wrong.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use nalgebra::{Point3, Vector3};
use plume::graph::Outside;
use plume::graph::format::{Import, Parts, ReadError, read};

/// The files of a folder, or such as are made up.
#[derive(Default)]
struct Files(BTreeMap<PathBuf, Vec<u8>>);

impl Files {
    fn of(texts: &[(&str, &str)]) -> Self {
        Self(texts.iter().map(|(name, text)| (name.into(), text.as_bytes().to_vec())).collect())
    }
}

impl Outside for Files {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

/// The disk.
struct Disk;

impl Outside for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        fs::read(path)
    }
}

/// Passages that Survex lists in a file, as pairs of places.
fn dumped_passages(dump: &str) -> Vec<[Point3<f64>; 2]> {
    let legs = dump.lines().filter_map(|line| line.strip_prefix("LEG "));
    let passages = legs.filter(|leg| !["SPLAY", "SURFACE", "DUPLICATE"].iter().any(|flag| leg.contains(flag)));
    let places = passages.map(|leg| {
        let x: Vec<f64> = leg.split(' ').take(6).map(|x| x.parse().expect("a coordinate")).collect();
        [Point3::new(x[0], x[1], x[2]), Point3::new(x[3], x[4], x[5])]
    });
    places.collect()
}

/// Holds the passages of a survey against those that a foreign program made of it, which rounds to centimetres.
fn agrees(survey: &str, dump: &str) {
    let import = read(Path::new(survey), Parts::Refuse, &Disk);
    let Import { graph, tally, .. } = import.unwrap_or_else(|error| panic!("{error}"));
    let origin = Vector3::from(tally.origin_m);
    let ours: Vec<[Point3<f64>; 2]> =
        graph.edges.iter().map(|edge| edge.map(|node| graph.nodes[node].position + origin)).collect();
    let theirs = dumped_passages(&fs::read_to_string(dump).expect("it is in the repository"));
    let near = |a: &Point3<f64>, b: &Point3<f64>| (a - b).amax() < 0.0056;
    let same =
        |[a, b]: &[Point3<f64>; 2], [c, d]: &[Point3<f64>; 2]| (near(a, c) && near(b, d)) || (near(a, d) && near(b, c));
    for passage in &theirs {
        assert!(ours.iter().any(|own| same(own, passage)), "{survey}: {passage:?} is missing in\n{ours:#?}");
    }
    for passage in &ours {
        assert!(theirs.iter().any(|other| same(other, passage)), "{survey}: {passage:?} is too much");
    }
}

#[test]
fn survex_data_comes_out_where_cavern_puts_it() {
    for name in ["instruments", "styles", "loops", "marks", "latin"] {
        let path = format!("tests/data/formats/svx/{name}");
        agrees(&format!("{path}.svx"), &format!("{path}.dump"));
    }
}

fn parsed(name: &str, text: &str) -> Result<Import, ReadError> {
    read(Path::new(name), Parts::Refuse, &Files::of(&[(name, text)]))
}

#[test]
fn legs_that_are_no_passages_are_left_out_and_counted() {
    let import = read(Path::new("tests/data/formats/svx/loops.svx"), Parts::Refuse, &Disk).unwrap();
    assert_eq!((import.tally.splays, import.tally.duplicates, import.tally.surface), (4, 1, 2));
}
