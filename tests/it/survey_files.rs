//! Survey files: compared with what other programs read in them, and invalid ones.

use std::fs;
use std::path::Path;

use crate::common::dump;
use crate::common::files;
use dump::dumped_passages;
use files::Files;
use nalgebra::{Point3, Vector3};
use plume::field::{CaveField, Field, PassageSettings};
use plume::graph::{Graph, StationId};
use plume::material::{Look, MATERIALS};
use plume::survey::{Import, Parts, ReadError, read};
use serde_json::json;

fn data(path: &str) -> Vec<u8> {
    fs::read(format!("tests/data/{path}")).expect("it is in the repository")
}

fn parsed(name: &str, bytes: &[u8], parts: Parts) -> Result<Import, ReadError> {
    read(Path::new(name), parts, &Files::one(name, bytes))
}

fn hollow() -> Vec<u8> {
    data("formats/survex-3d/hollow.3d")
}

fn node_at(graph: &Graph, place: Point3<f64>) -> Option<StationId> {
    graph.stations().find(|&node| (graph[node].position - place).norm() < 0.001)
}

#[test]
fn a_3d_file_reads_as_survex_reads_it() {
    let bytes = data("formats/survex-3d/bare.3d");
    let Import { graph, tally, .. } = parsed("bare.3d", &bytes, Parts::Refuse).unwrap();
    let dump = String::from_utf8(data("surveys/bare.dump")).unwrap();
    let passages = dumped_passages(&dump);
    let origin = tally.origin_m.coords;
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
    assert_eq!(tally.origin_m, Point3::new(500_000.25, 4_600_000.5, 1234.56));
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

/// Of 3, which has two cross-sections, the wider counts; 7 has neither a left wall nor a ceiling.
#[test]
fn cross_sections_become_sections_and_gaps_are_filled() {
    let Import { graph, tally, .. } = parsed("hollow.3d", &hollow(), Parts::Refuse).unwrap();
    let node = |node: &plume::graph::Node| {
        let section = node.section.expect("something was measured in this part");
        let [x, y, z] = node.position.into();
        format!("{x:8.3} {y:8.3} {z:8.3}  {:6.3} wide {:6.3} high\n", section.width_m, section.height_m)
    };
    insta::assert_snapshot!("hollow", graph.nodes.iter().map(node).collect::<String>());
    assert_eq!(tally.interpolated, 6);
}

/// How far one can go straight through air from a point, in metres.
fn clear_m(field: &CaveField, from: Point3<f64>, way: Vector3<f64>) -> f64 {
    const STEP_M: f64 = 0.01;
    let point = |step: u32| (from + way * (STEP_M * f64::from(step))).coords.map(|x| x as f32).into();
    let points: Vec<[f32; 3]> = (0..1000).map(point).collect();
    let steps = field.distances_at(&points).iter().take_while(|&&distance| distance < 0.0).count();
    STEP_M * steps as f64
}

/// Station 8 touches the wall, and rock protrudes slightly in places.
const AT_WALL_M: f32 = 0.1;

#[test]
fn every_surveyed_station_is_in_the_open_in_every_rock() {
    let dump = String::from_utf8(data("surveys/hollow.dump")).unwrap();
    let Import { graph, tally, .. } = parsed("hollow.3d", &hollow(), Parts::Refuse).unwrap();
    let stations = dumped_passages(&dump).into_iter().flatten().map(|place| place - tally.origin_m.coords);
    let stations: Vec<[f32; 3]> = stations.map(|place| place.coords.map(|x| x as f32).into()).collect();
    for (row, seed) in MATERIALS.iter().flat_map(|row| (0..8).map(move |seed| (row, seed))) {
        let rock = (row.read)(json!({})).unwrap();
        let field = CaveField::new(&graph, &PassageSettings::default(), rock, Look::default(), seed);
        for (station, distance) in stations.iter().zip(field.distances_at(&stations)) {
            assert!(distance < AT_WALL_M, "{} seed {seed}: {station:?} is {distance} m in the rock", row.name);
        }
    }
}

/// A station that no side passage leaves, as `hollow.svx` has it: where it is, the stations before and after it, and
/// left, right, up and down.
struct Measured {
    place: [f64; 3],
    looking: [[f64; 2]; 2],
    walls: [f64; 4],
}

/// Two passages that meet at a station bulge by a fifth of the blend radius; see `field/passage.rs`.
const BULGE_M: f64 = 0.25;

#[test]
fn smooth_walls_stand_where_they_were_measured() {
    let Import { graph, tally, .. } = parsed("hollow.3d", &hollow(), Parts::Refuse).unwrap();
    let entrance = [500_000.25, 4_600_000.50];
    let measured = [
        Measured {
            place: [500_000.25, 4_600_000.50, 1234.56],
            looking: [entrance, [500_001.30, 4_600_006.47]],
            walls: [1.0, 1.5, 0.8, 1.2],
        },
        Measured {
            place: [500_001.30, 4_600_006.47, 1233.27],
            looking: [entrance, [500_005.07, 4_600_014.93]],
            walls: [0.6, 2.2, 2.0, 1.1],
        },
    ];
    let settings = PassageSettings { floor_roughness_m: 0.0, floor_flatness: 1.0, ..Default::default() };
    let rock = (MATERIALS.default_row().read)(json!({"relief": 0.0, "wander_m": 0.0, "rubble": -0.5})).unwrap();
    let field = CaveField::new(&graph, &settings, rock, Look::default(), 3);
    for Measured { place, looking: [from, to], walls } in measured {
        let station = Point3::from(place) - tally.origin_m.coords;
        let ahead = Vector3::new(to[0] - from[0], to[1] - from[1], 0.0).normalize();
        let left = Vector3::new(-ahead.y, ahead.x, 0.0);
        let axis = graph.nodes.iter().map(|node| node.position);
        let axis = axis.min_by(|a, b| (a - station).norm().total_cmp(&(b - station).norm())).unwrap();
        let beside = Point3::new(station.x, station.y, axis.z);
        let above = Point3::new(axis.x, axis.y, station.z);
        let found = [(beside, left), (beside, -left), (above, Vector3::z()), (above, -Vector3::z())];
        let found = found.map(|(from, way)| clear_m(&field, from, way));
        let (sides, floor) = (found.iter().zip(walls).take(3), found[3] - walls[3]);
        assert!(floor.abs() < 0.03, "{station}: the floor is {} m down, not {} m", found[3], walls[3]);
        for (found, wall) in sides {
            assert!((wall - 0.01..wall + BULGE_M).contains(found), "{station}: a wall is {found} m off, not {wall} m");
        }
    }
}

/// Compares the passages of a file with those that Survex lists.
fn assert_is_as_dumped(name: &str, outside: &Files, dump: &str, tolerance_m: f64) {
    let Import { graph, tally, .. } = read(Path::new(name), Parts::Refuse, outside).unwrap();
    let dump = String::from_utf8(data(dump)).unwrap();
    let passages = dumped_passages(&dump);
    for ends in &passages {
        let [a, b] = ends.map(|end| {
            let place = end - tally.origin_m.coords;
            let away = |node: &StationId| (graph[*node].position - place).norm();
            let node = graph.stations().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
            assert!(away(&node) < tolerance_m, "{name}: {place} is {} m off", away(&node));
            node
        });
        assert!(graph.edges.contains(&[a.min(b), a.max(b)]), "{name}: {ends:?}");
    }
    assert_eq!(graph.edges.len(), passages.len(), "{name}");
}

fn burrow() -> Files {
    let names = ["burrow.mak", "bare-burrow.dat", "shaft.dat"];
    names.into_iter().map(|name| (name, data(&format!("surveys/{name}")))).collect()
}

/// Two centimetres: Survex rounds stations to one, and weights its loop closures differently.
#[test]
fn compass_books_and_projects_read_as_survex_reads_them() {
    assert_is_as_dumped("bare-burrow.dat", &burrow(), "surveys/bare-burrow.dump", 0.02);
    assert_is_as_dumped("burrow.mak", &burrow(), "surveys/burrow-project.dump", 0.02);
}

/// A survey file in which each shot adds a station.
fn book(header: &str, shots: &str) -> Vec<u8> {
    let table = "FROM TO LENGTH BEARING INC LEFT UP DOWN RIGHT FLAGS COMMENTS\r\n\r\n";
    format!(
        "CAVE\r\nSURVEY NAME: A\r\nSURVEY DATE: 0 0 0\r\nSURVEY TEAM:\r\n\r\n{header}\r\n\r\n{table}{shots}\x0c\r\n\x1a"
    )
    .into()
}

/// Where the second station is, in feet.
fn second_ft(header: &str, shot: &str) -> [f64; 3] {
    let graph = parsed("a.dat", &book(header, shot), Parts::Refuse).unwrap().graph;
    (graph.nodes[1].position / 0.3048).coords.map(|x| (100.0 * x).round() / 100.0 + 0.0).into()
}

/// Contrary to the description, Survex 1.4.4 takes the correction of lengths as metres and ignores that of backsights.
#[test]
fn calibrations_and_backsights_of_compass_are_applied() {
    let shot = "A1 A2 10.0 80.0 20.0 -1 -1 -1 -1 266.0 -18.0\r\n";
    let plain = "DECLINATION: 4.0 FORMAT: DDDDLUDRADLNF CORRECTIONS: 6.0 -20.0 90.0 CORRECTIONS2: 1.0 2.0";
    assert_eq!(second_ft(plain, shot), [100.0, 0.0, 0.0]);
    let both = "DECLINATION: 5.0 FORMAT: DDDDLUDRADLadBF CORRECTIONS: 6.0 -20.0 90.0 CORRECTIONS2: -2.0 18.0";
    assert_eq!(second_ft(both, shot), [100.0, 0.0, 0.0]);
    let back = shot.replace(" 80.0 20.0 ", " -999.0 -999.0 ");
    assert_eq!(
        second_ft("DECLINATION: 4.0 FORMAT: DDDDLUDRADLBF CORRECTIONS: 0 0 0 CORRECTIONS2: 0 18.0", &back),
        [10.0, 0.0, 0.0]
    );
    assert_eq!(second_ft("DECLINATION: 4.0", "A1 A2 10.0 -999 90 -1 -1 -1 -1\r\n"), [0.0, 0.0, 10.0]);
}

#[test]
fn flags_of_compass_are_counted() {
    let flags = ["L", "S", "P", "PL", "X", "C", ""];
    let shot = |(index, flag): (usize, &&str)| format!("A1 B{index} 10 {index}0 0 1 1 1 1 #|{flag}# note\n");
    let shots: String = flags.iter().enumerate().map(shot).collect();
    let Import { graph, tally, .. } = parsed("a.dat", &book("DECLINATION: 0", &shots), Parts::Refuse).unwrap();
    assert_eq!((tally.duplicates, tally.splays, tally.surface, graph.edges.len()), (1, 1, 2, 2));
}

/// As Survex has them.
#[test]
fn shots_of_compass_without_length_join_and_those_repeated_are_averaged() {
    let shots = "A1 A2 0 -999 -999 1 1 1 1\nA2 A3 10 90 0 1 1 1 1\nA2 A3 12 90 0 1 1 1 1\nA1 A1 0 0 0 1 1 1 1\n";
    let graph = parsed("a.dat", &book("DECLINATION: 0", shots), Parts::Refuse).unwrap().graph;
    assert_eq!((graph.nodes.len(), (graph.length_m() / 0.3048).round()), (2, 11.0));
}

/// Looking east, left is north; walls at the end of a shot are those of the station it leads to.
#[test]
fn walls_of_compass_belong_to_the_station_that_the_format_says() {
    let shots = "A1 A2 100 90 0 9 10 0 1\nA2 A3 100 90 0 3 10 0 3\n";
    for (end, expected) in [("F", [4.0, 0.0, 0.0]), ("T", [0.0, 4.0, 0.0])] {
        let bytes = book(&format!("DECLINATION: 0 FORMAT: DDDDLUDRADLN{end}"), shots);
        let graph = parsed("a.dat", &bytes, Parts::Refuse).unwrap().graph;
        let found: Vec<f64> = graph.nodes.iter().map(|node| (node.position.y / 0.3048).round()).collect();
        assert_eq!(found, expected, "{end}");
    }
}

#[test]
fn compass_files_with_any_byte_changed_or_cut_are_read_or_refused() {
    let whole = data("formats/compass/burrow.dat");
    let project = data("surveys/burrow.mak");
    let law = |name: &str, bytes: Vec<u8>| {
        let mut outside = burrow();
        outside.0.insert(name.into(), bytes);
        if let Err(error) = read(Path::new(name), Parts::Longest, &outside) {
            assert!(!error.hint.is_empty(), "{error}");
        }
    };
    for (name, whole) in [("odd.dat", whole), ("odd.mak", project)] {
        for at in 0..whole.len() {
            law(name, whole[..at].to_vec());
            for other in [whole[at] ^ 0x01, whole[at] ^ 0x80, b'\n', b'-', b'9', b'#'] {
                let mut bytes = whole.clone();
                bytes[at] = other;
                law(name, bytes);
            }
        }
    }
}

#[test]
fn what_is_wrong_with_compass_files_is_told() {
    let one = |shot: &str| ("a.dat", book("DECLINATION: 0 FORMAT: DDDDLUDRADLNF", shot));
    let faults = [
        ("no book", ("a.dat", b"1 2 3\n4 5 6\n".to_vec())),
        ("no declination", ("a.dat", book("DECLINATION: FORMAT:", ""))),
        ("no shots", one("")),
        ("one name", one("A1\n")),
        ("cut shot", one("A1 A2 10 20\n")),
        ("no number", one("A1 A2 10 20 0 NaN 1 1 1\n")),
        ("negative length", one("A1 A2 -10 20 0 1 1 1 1\n")),
        ("no bearing", one("A1 A2 10 -999 0 1 1 1 1\n")),
        ("no inclination", one("A1 A2 10 20 -999 1 1 1 1\n")),
        ("far wall", one("A1 A2 10 20 0 9999 1 1 1\n")),
        ("empty project", ("a.mak", b"/ nothing\n".to_vec())),
        ("open end", ("a.mak", b"\n#a.dat\n".to_vec())),
        ("no file", ("a.mak", b"#sub\\A.DAT;".to_vec())),
        ("bad fix", ("a.mak", b"#a.dat,A1[K,1,2,3];".to_vec())),
        ("open fix", ("a.mak", b"#a.dat,A1[M,1,2,3;".to_vec())),
    ];
    let told = faults.map(|(case, (name, bytes))| {
        let error = parsed(name, &bytes, Parts::Join).unwrap_err();
        format!("{case}\n  {error}\n  {}\n", error.hint)
    });
    insta::assert_snapshot!("compass-faults", told.concat());
}
