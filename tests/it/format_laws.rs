//! The laws of formats, held by every row of the table that reads or writes.
//!
//! A row is tried with the files in `tests/data/formats/<its name>`, as soon as there are any: each is read, then cut off
//! and changed byte by byte; those under `bad` are refused, with the errors that the snapshots hold.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use crate::common::damage::damaged;
use crate::common::files;
use crate::common::world;
use files::Files;
use nalgebra::{Point3, Vector3};
use plume::generators::GENERATORS;
use plume::graph::{Graph, Node, Section, Shape, StationId};
use plume::survey::{self, FORMATS, FormatRow, Import, Parts, ReadError, Written, read_as};
use world::small;

const ALL_PARTS: [Parts; 4] = [Parts::Refuse, Parts::Join, Parts::Keep, Parts::Longest];
/// Rows whose files hold radii and sections as they are.
const HOLD_SECTIONS: &[&str] = &["json", "graphml", "csv"];

fn ends_as(row: &FormatRow, path: &Path) -> bool {
    let name = path.to_string_lossy().to_lowercase();
    row.endings.iter().any(|ending| name.ends_with(ending))
}

/// The files that a row reads.
fn readable(row: &FormatRow, files: &Files) -> Vec<PathBuf> {
    files.0.keys().filter(|path| ends_as(row, path)).cloned().collect()
}

fn written(row: &FormatRow, graph: &Graph) -> Files {
    let write = row.write.expect("it is written");
    let extension = row.endings[0].rsplit('.').next().expect("there is a last part");
    let named = |file: Written| (format!("cave{}.{extension}", file.suffix), file.bytes);
    write(graph).into_iter().map(named).collect()
}

fn folder(row: &FormatRow) -> PathBuf {
    Path::new("tests/data/formats").join(row.name)
}

fn readers() -> impl Iterator<Item = &'static FormatRow> {
    FORMATS.iter().filter(|row| row.read.is_some())
}

fn read(row: &FormatRow, path: &Path, parts: Parts, files: &Files) -> Result<Import, ReadError> {
    read_as(row, path, parts, files)
}

/// Invariants of any graph, whatever its source.
fn keeps_the_laws(graph: &Graph, parts: Parts) {
    assert!(graph.nodes.len() >= 2);
    let ids: BTreeSet<u64> = graph.nodes.iter().map(|node| node.id).collect();
    assert_eq!(ids.len(), graph.nodes.len());
    assert!(graph.edges.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(graph.edges.iter().all(|[a, b]| a < b && b.index() < graph.nodes.len()));
    let neighbors = graph.neighbors();
    assert!(neighbors.iter().all(|others| !others.is_empty()));
    let components = graph.components().len();
    assert!(parts == Parts::Keep || components == 1);
    for (node, others) in graph.nodes.iter().zip(neighbors.iter()) {
        let section = node.section.iter().flat_map(|section| [section.width_m, section.height_m]);
        for length in section.chain([node.radius]) {
            assert!(length > 0.0 && length <= 1e6, "{length} m");
            assert_eq!((length * 1000.0).round() / 1000.0, length);
        }
        assert!(node.position.iter().all(|x| x.abs() <= 1e6 && (x * 1000.0).round() / 1000.0 == *x));
        assert!(node.parent.is_none_or(|parent| others.contains(&parent)));
    }
    let places: BTreeSet<[u64; 3]> =
        graph.nodes.iter().map(|node| node.position.coords.map(f64::to_bits).into()).collect();
    assert_eq!(places.len(), graph.nodes.len());
    assert_eq!(graph.nodes.iter().filter(|node| node.parent.is_none()).count(), components);
    assert!(graph.stations().all(|node| leads_to_an_origin(graph, node)));
}

fn leads_to_an_origin(graph: &Graph, node: StationId) -> bool {
    std::iter::successors(Some(node), |&node| graph[node].parent).take(graph.nodes.len() + 1).count()
        <= graph.nodes.len()
}

/// A valid graph, or a meaningful error.
fn is_read_or_refused(row: &FormatRow, path: &Path, parts: Parts, files: &Files) {
    match read(row, path, parts, files) {
        Ok(import) => keeps_the_laws(&import.graph, parts),
        Err(error) => assert!(!error.place.to_string().is_empty() && !error.message.is_empty()),
    }
}

/// Graphs of every generator, one with sections of both shapes, and one in two parts.
fn graphs() -> Vec<Graph> {
    let mut graphs: Vec<Graph> = GENERATORS.iter().map(|row| small(row, 40, 3)).collect();
    let mut shaped = graphs[0].clone();
    for (index, node) in shaped.nodes.iter_mut().enumerate().skip(1) {
        let shape = if index % 2 == 0 { Shape::Drift } else { Shape::Cave };
        node.section = Some(Section { width_m: 1.5 + index as f64 / 8.0, height_m: 2.001, shape });
        node.level = index as u32 / 9;
    }
    let mut two = graphs[1].clone();
    let count = two.nodes.len();
    let moved = |station: StationId| StationId::new(station.index() + count);
    for index in 0..count {
        let node = &mut two.nodes[index];
        node.id = 3 * node.id + 7;
        let far = Node { id: node.id + 1, parent: node.parent.map(moved), ..node.clone() };
        two.nodes.push(Node { position: far.position + Vector3::new(500.0, 0.0, -3.5), ..far });
    }
    two.edges.extend_from_within(..);
    let edges = two.edges.len();
    two.edges[edges / 2..].iter_mut().flatten().for_each(|end| *end = moved(*end));
    graphs.extend([shaped, two]);
    graphs
}

/// Positions in whole millimetres, and the passages between them.
fn geometry(graph: &Graph) -> (BTreeSet<[i64; 3]>, BTreeSet<[[i64; 3]; 2]>) {
    let place = |node: &Node| node.position.coords.map(|x| (x * 1000.0).round() as i64).into();
    let places: Vec<[i64; 3]> = graph.nodes.iter().map(place).collect();
    let passage = |ends: &[StationId; 2]| {
        let [a, b] = ends.map(|end| places[end.index()]);
        [a.min(b), a.max(b)]
    };
    (places.iter().copied().collect(), graph.edges.iter().map(passage).collect())
}

type Widths = BTreeMap<[i64; 3], (Option<Section>, f64, u32)>;

fn widths(graph: &Graph) -> Widths {
    let place = |node: &Node| node.position.coords.map(|x| (x * 1000.0).round() as i64).into();
    graph.nodes.iter().map(|node| (place(node), (node.section, node.radius, node.level))).collect()
}

#[test]
fn written_graphs_read_back() {
    for row in readers().filter(|row| row.write.is_some()) {
        for (index, graph) in graphs().into_iter().enumerate() {
            let name = format!("{} graph {index}", row.name);
            let files = written(row, &graph);
            for path in readable(row, &files) {
                let import = read(row, &path, Parts::Keep, &files).expect(&name);
                keeps_the_laws(&import.graph, Parts::Keep);
                assert_eq!(geometry(&import.graph), geometry(&graph), "{name}");
                assert_eq!((import.tally.joined, import.tally.left_out), (0, 0), "{name}");
                if HOLD_SECTIONS.contains(&row.name) {
                    assert_eq!(widths(&import.graph), widths(&graph), "{name}");
                }
            }
        }
    }
}

#[test]
fn writing_is_deterministic() {
    for row in FORMATS.iter().filter(|row| row.write.is_some()) {
        for graph in graphs() {
            assert_eq!(written(row, &graph), written(row, &graph.clone()), "{}", row.name);
        }
    }
}

#[test]
fn names_and_extensions_lead_to_their_rows() {
    for row in FORMATS {
        assert!(std::ptr::eq(survey::format(row.name).unwrap(), row));
        assert!(!row.summary.is_empty() && (row.read.is_some() || row.write.is_some()));
        for ending in row.endings {
            assert_eq!(*ending, ending.to_lowercase());
            let path = PathBuf::from(format!("Cave{}", ending.to_uppercase()));
            let of = |has: fn(&FormatRow) -> bool| survey::format_of(&path, has).map(|row| row.name);
            assert!(row.read.is_none() || of(|row| row.read.is_some()) == Some(row.name), "{} {ending}", row.name);
            assert!(row.write.is_none() || of(|row| row.write.is_some()) == Some(row.name), "{} {ending}", row.name);
        }
    }
}

#[test]
fn small_files_are_read() {
    for row in readers() {
        let files = Files::folder(&folder(row));
        for path in readable(row, &files) {
            for parts in ALL_PARTS {
                let import = read(row, &path, parts, &files);
                let import = import.unwrap_or_else(|error| panic!("{} {parts:?}: {error}", row.name));
                keeps_the_laws(&import.graph, parts);
            }
        }
    }
}

/// The counts are those of karstnet itself.
#[test]
fn a_real_cave_is_read_from_either_file_of_its_pair() {
    let files = Files::folder(Path::new("tests/data/sakany"));
    let import = |name: &str| survey::read(name.as_ref(), Parts::Refuse, &files).unwrap();
    let graph = import("Sakany_nodes.dat").graph;
    assert_eq!((graph.nodes.len(), graph.edges.len(), graph.loops()), (1716, 1784, 69));
    assert_eq!(import("Sakany_links.dat").graph, graph);
}

#[test]
fn a_factor_welds_coinciding_nodes_and_is_limited() {
    let table = "x1,y1,x2,y2,width1,height1\n0,0,0.4,0,2,1\n0.4,0,900,0,,\n";
    let files = Files::one("cave.csv", table);
    let import = || survey::read("cave.csv".as_ref(), Parts::Refuse, &files).unwrap();
    let small = import().scaled(0.001, "cave.csv".as_ref()).unwrap().graph;
    keeps_the_laws(&small, Parts::Refuse);
    assert_eq!((small.nodes.len(), small.length_m()), (2, 0.9));
    assert_eq!(small.nodes[0].section.map(|section| section.width_m), Some(0.002));
    assert_eq!(import().scaled(1.0, "cave.csv".as_ref()).unwrap(), import());
    let error = import().scaled(5000.0, "cave.csv".as_ref()).unwrap_err();
    assert_eq!(error.to_string(), "cave.csv: is too far from the origin after scaling");
}

/// Formats whose files may count from anywhere.
const OF_ANY_GRID: [&str; 3] = ["graphml", "karstnet", "csv"];

#[test]
fn distant_graphs_are_moved_to_their_first_node() {
    let [near, ..] = &graphs()[..] else { panic!("there is one") };
    let mut far = near.clone();
    far.nodes.iter_mut().for_each(|node| node.position += Vector3::new(431_234.567, 5_287_654.321, 812.25));
    for row in readers().filter(|row| OF_ANY_GRID.contains(&row.name)) {
        for (graph, is_moved) in [(near, false), (&far, true)] {
            let files = written(row, graph);
            for path in readable(row, &files) {
                let Import { graph: mut found, tally, .. } = read(row, &path, Parts::Refuse, &files).expect(row.name);
                keeps_the_laws(&found, Parts::Refuse);
                let first = graph[graph.edges[0][0]].position;
                assert_eq!(tally.origin_m, if is_moved { first } else { Point3::origin() }, "{}", row.name);
                found.nodes.iter_mut().for_each(|node| node.position += tally.origin_m.coords);
                assert_eq!(geometry(&found), geometry(graph), "{}", row.name);
            }
        }
    }
}

#[test]
fn coordinates_are_moved_before_they_are_rounded() {
    let table = |z: &str| format!("x1,y1,z1,x2,y2,z2\n500000,5200000.0004,{z},500000,5200010.0008,{z}\n");
    let read = |table: &str| {
        let files = Files::one("cave.csv", table.as_bytes().to_vec());
        survey::read("cave.csv".as_ref(), Parts::Refuse, &files)
    };
    let Import { graph, tally, .. } = read(&table("7")).unwrap();
    assert_eq!((graph.nodes[1].position.y, tally.origin_m), (10.0, Point3::new(500_000.0, 5_200_000.000_4, 7.0)));
    let apart = read(&(table("7") + "500000,5200010.0008,7,500000,1000000,7\n")).unwrap_err();
    assert_eq!(apart.to_string(), "cave.csv: has stations 4200 km from each other, more than 1000 km");
    let nowhere = read(&table("2e8")).unwrap_err();
    assert_eq!(nowhere.to_string(), "cave.csv:2: \"2e8\" is too far away");
}

#[test]
fn a_drawing_of_yed_is_where_it_is_drawn() {
    let files = Files::folder(Path::new("tests/data/formats/graphml"));
    let graph = survey::read("yed.graphml".as_ref(), Parts::Refuse, &files).unwrap().graph;
    let places: Vec<[f64; 3]> = graph.nodes.iter().map(|node| node.position.coords.into()).collect();
    assert_eq!(places, [[140.0, -115.0, -2.0], [155.0, -95.0, 1.5]]);
}

#[test]
fn damaged_files_are_read_or_refused() {
    for row in readers() {
        let whole = Files::folder(&folder(row));
        for path in readable(row, &whole) {
            let mut files = whole.clone();
            for (how, bytes) in damaged(&whole.0[&path], b"9\n") {
                files.0.insert(path.clone(), bytes);
                for parts in [Parts::Refuse, Parts::Join] {
                    let read = AssertUnwindSafe(|| is_read_or_refused(row, &path, parts, &files));
                    assert!(catch_unwind(read).is_ok(), "{} {} {how}", row.name, path.display());
                }
            }
        }
    }
}

/// The error for each bad file: one golden text per format.
#[test]
fn bad_files_are_refused_with_a_message() {
    for row in readers() {
        let files = Files::folder(&folder(row).join("bad"));
        let mut told = String::new();
        for path in readable(row, &files) {
            let name = path.display();
            let error = read(row, &path, Parts::Refuse, &files).expect_err(&format!("{} {name}", row.name));
            let error = format!("{error}\n  hint: {}\n", error.hint);
            // Either file of a pair may be named.
            if !told.ends_with(&error) {
                told += &error;
            }
        }
        if !told.is_empty() {
            insta::assert_snapshot!(format!("bad_{}", row.name), told);
        }
    }
}

/// Files that exhaust a careless reader, and a part of the error for each.
fn wasteful() -> Vec<(&'static str, &'static str, String, &'static str)> {
    let graphml = |inside: String| format!("<graphml><graph>{inside}</graph></graphml>");
    let nodes = |count: usize| {
        (0..count).map(|node| format!(r#"<node id="{node}"><data key="x">{node}</data><data key="y">0</data></node>"#))
    };
    let attributes: String = (0..300_000).map(|attribute| format!(" a{attribute}=''")).collect();
    vec![
        ("graphml", "deep.graphml", "<graphml>".repeat(500_000), "more than 64 elements deep"),
        ("graphml", "wide.graphml", graphml(format!("<node{attributes}/>")), "no id"),
        ("graphml", "long.graphml", graphml(format!("<node id='a'><data key='x'>{}", "1".repeat(1 << 22))), "too long"),
        ("graphml", "many.graphml", graphml(nodes(1_000_001).collect()), "more than 1000000 nodes"),
        (
            "graphml",
            "keys.graphml",
            (0..2000).fold("<graphml>".into(), |all, key| format!("{all}<key id='{key}'/>")),
            "keys",
        ),
        ("karstnet", "many_nodes.dat", "0 0 0\n".repeat(1_000_001), "more than 1000000 nodes"),
        ("karstnet", "long_nodes.dat", "0 ".repeat(1 << 20), "is too long"),
        (
            "csv",
            "many.csv",
            (0..500_001).fold("x1,y1,x2,y2\n".into(), |all, row| all + &format!("{row},0,{row},5\n")),
            "more than 1000000 stations",
        ),
    ]
}

#[test]
fn malicious_files_are_refused() {
    for (name, path, text, words) in wasteful() {
        let row = survey::format(name).unwrap();
        let mut files = Files::one(path, text);
        files.0.insert("many_links.dat".into(), b"1 2\n".to_vec());
        files.0.insert("long_links.dat".into(), b"1 2\n".to_vec());
        let error = read(row, path.as_ref(), Parts::Join, &files).expect_err(path);
        assert!(error.to_string().contains(words), "{path}: {error}");
    }
}
