//! Text surveys: compared with what Survex and Therion make of them, and invalid ones.

use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

use crate::common::dump;
use crate::common::files;
use dump::dumped_passages;
use files::Files;
use nalgebra::Point3;
use plume::graph::Outside;
use plume::survey::{Import, Parts, ReadError, read};

/// The disk.
struct Disk;

impl Outside for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        fs::read(path)
    }
}

/// Compares the passages of a survey with those of a foreign program, which rounds to centimetres.
fn agrees(survey: &str, dump: &str) {
    let import = read(Path::new(survey), Parts::Refuse, &Disk);
    let Import { graph, tally, .. } = import.unwrap_or_else(|error| panic!("{error}"));
    let origin = tally.origin_m.coords;
    let ours: Vec<[Point3<f64>; 2]> =
        graph.edges.iter().map(|edge| edge.map(|node| graph[node].position + origin)).collect();
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

#[test]
fn therion_data_comes_out_where_therion_puts_it() {
    agrees("tests/data/formats/therion/pit.th", "tests/data/formats/therion/pit.dump");
}

fn parsed(name: &str, text: &str) -> Result<Import, ReadError> {
    read(Path::new(name), Parts::Refuse, &Files::one(name, text))
}

#[test]
fn legs_that_are_no_passages_are_left_out_and_counted() {
    let import = read(Path::new("tests/data/formats/svx/loops.svx"), Parts::Refuse, &Disk).unwrap();
    assert_eq!((import.tally.splays, import.tally.duplicates, import.tally.surface), (4, 1, 2));
}

#[test]
fn what_is_wrong_with_survey_data_is_told() {
    let leg = "1 2 5 0 0\n";
    let svx = [
        ("empty", String::new()),
        ("no text", "\0\u{1}\u{fffd}\u{7f}".repeat(9)),
        ("auto declination", format!("*declination auto 1 2 3\n{leg}")),
        ("unclosed", format!("*begin a\n*begin b\n{leg}*end b\n")),
        ("closed twice", format!("*begin a\n{leg}*end a\n*end\n")),
        ("wrong end", format!("*begin a\n{leg}*end b\n")),
        ("deep", "*begin x\n".repeat(10_000)),
        ("no command", "*\n".to_owned()),
        ("unknown command", "*frobnicate 1\n".to_owned()),
        ("column missing", "1 2 5 0\n".to_owned()),
        ("column too many", "1 2 5 0 0 0\n".to_owned()),
        ("not a number", "1 2 NaN 0 0\n".to_owned()),
        ("far", "1 2 99999999 0 0\n".to_owned()),
        ("endless", format!("1 2 {} 0 0\n", "9".repeat(400))),
        ("no bearing", "1 2 5 - 0\n".to_owned()),
        ("to itself", "1 1 5 0 0\n".to_owned()),
        ("bad name", "1 / 5 0 0\n".to_owned()),
        ("bad quantity", "*units salt metres\n".to_owned()),
        ("bad unit", "*units tape degrees\n".to_owned()),
        ("no factor", "*units tape 0 metres\n".to_owned()),
        ("bad style", "*data poetry from to\n".to_owned()),
        ("bad columns", "*data normal from to tape\n".to_owned()),
        ("column twice", "*data normal from to tape tape compass\n".to_owned()),
        ("fixed twice", format!("{leg}*fix 1 0 0 0\n*fix 1 0 0 1\n")),
        ("fixes equated", format!("{leg}*fix 1 0 0 0\n*fix 3 0 0 1\n*equate 1 3\n")),
        ("fixed far", format!("{leg}*fix 1 0 0 9e99\n")),
        ("quote", "*include \"a\n".to_owned()),
        ("itself", "*include itself\n".to_owned()),
        ("missing file", "*include nothing\n".to_owned()),
        ("degrees", "*cs long-lat\n".to_owned()),
        ("two systems", "*cs UTM33N\n*cs out EPSG:31257\n".to_owned()),
        ("long line", "1".repeat(1_000_000)),
        ("apart", "1 2 5 0 0\n3 4 5 0 0\n".to_owned()),
        ("equated in circles", "1 2 5 0 0\n*equate 1 3\n*equate 3 4\n*equate 4 1\n*equate 2 1\n".to_owned()),
        ("no position", "*data nosurvey from to\n1 2\n".to_owned()),
    ];
    let therion = [
        ("unclosed", "survey a\ncentreline\n".to_owned()),
        ("crossed", "survey a\ncentreline\nendsurvey\n".to_owned()),
        ("deep", "survey x\n".repeat(10_000)),
        ("unknown", "survey a\nimport b.3d\nendsurvey\n".to_owned()),
        ("by date", "survey a -declination [1990 2 2000 3 deg]\nendsurvey\n".to_owned()),
        ("not a number", "centreline\n1 2 NaN 0 0\nendcentreline\n".to_owned()),
        ("bracket", "survey [a\n".to_owned()),
        ("itself", "input itself\n".to_owned()),
        ("long names", format!("centreline\nstation-names {} _\nendcentreline\n", "a".repeat(60_000))),
        ("long word", format!("centreline\n1 2 {} 0 0\nendcentreline\n", "\u{1b}".repeat(60_000))),
    ];
    let mut told = String::new();
    let faults = svx.iter().map(|(name, text)| ("svx", name, text));
    for (ending, name, text) in faults.chain(therion.iter().map(|(name, text)| ("th", name, text))) {
        let file = if *name == "itself" { format!("itself.{ending}") } else { format!("cave.{ending}") };
        let error = parsed(&file, text).expect_err(name);
        writeln!(told, "{name}: {error}\n  {}", error.hint).unwrap();
    }
    insta::assert_snapshot!("survey_text_faults", told);
}

/// Files that include two others each grow beyond all bounds, and chains of equates are walked again and again.
#[test]
fn what_would_take_for_ever_is_refused_or_quick() {
    let files: Files = (0..60)
        .map(|depth| (format!("{depth}.svx"), format!("*include {0}\n*include {0}\n", depth + 1)))
        .chain([("60.svx".to_owned(), "1 2 5 0 0\n".to_owned())])
        .collect();
    let error = read(Path::new("0.svx"), Parts::Refuse, &files).unwrap_err();
    assert!(error.message.contains("more than 1000 files"), "{error}");
    let names = (0..70).fold(String::new(), |all, line| format!("{all}*equate {line}{} 1\n", ".a".repeat(30_000)));
    assert!(parsed("names.svx", &names).unwrap_err().message.contains("more than 2000000 stations and surveys"));
    let mut text = "0 a 5 0 0\n".to_owned();
    for station in (0..50_000).rev() {
        writeln!(text, "*equate {} {station}", station + 1).unwrap();
    }
    let import = parsed("chain.svx", &text).unwrap();
    assert_eq!(import.graph.nodes.len(), 2);
}

/// Cavern 1.4.4 and Therion 6.1.6 have these stations there, too.
#[test]
fn who_takes_no_bearing_has_plumbed_the_shot() {
    let cylpolar = "*data cylpolar from to tape compass depthchange\n1 2 0 - 5\n2 3 1 - -9\n";
    let upright = "centreline\n1 2 7 - 90\n2 3 2 - -90\nendcentreline\n";
    for (name, text, heights) in [("a.svx", cylpolar, [0.0, 5.0, -4.0]), ("a.th", upright, [0.0, 7.0, 5.0])] {
        let graph = parsed(name, text).unwrap().graph;
        let places: Vec<[f64; 3]> = graph.nodes.iter().map(|node| node.position.coords.into()).collect();
        assert_eq!(places, heights.map(|z| [0.0, 0.0, z]), "{name}");
    }
}

#[test]
fn of_pieces_that_lie_anywhere_the_longest_may_stay() {
    let pieces = "1 2 5 0 0\n3 4 5 90 0\n4 5 6 90 0\n*fix 1 9 9 9\n";
    let import = read(Path::new("a.svx"), Parts::Longest, &Files::one("a.svx", pieces)).unwrap();
    assert_eq!((import.graph.length_m(), import.tally.left_out), (11.0, 2));
}

#[test]
fn names_from_the_root_and_entrances_of_surveys_are_found() {
    let svx = "*begin a\n1 2 5 0 0\n*begin b\n\\a.2 1 5 90 0\n*prefix \\\n1 a.b.1 3 0 0\n*end b\n*end a\n";
    assert_eq!(parsed("a.svx", svx).unwrap().graph.nodes.len(), 4);
    let therion = "survey a -entrance 2\ncentreline\nfix 1 0 0 0\n1 2 5 0 0\nendcentreline\nendsurvey\n";
    assert_eq!(parsed("a.th", therion).unwrap().tally.origin_m, Point3::new(0.0, 5.0, 0.0));
}

#[test]
fn text_in_any_encoding_is_read() {
    let import = read(Path::new("tests/data/formats/svx/latin.svx"), Parts::Refuse, &Disk).unwrap();
    assert_eq!(import.graph.nodes.len(), 3);
}
