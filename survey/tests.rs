//! Names of stations and georeferences, from surveys and through the files of graphs.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use plume_graph::{Georeference, Graph, Outside};

use super::{FORMATS, FormatRow, Import, Parts, Written, format, json, read, read_as};

/// Files in memory.
#[derive(Default)]
struct Memory {
    files: BTreeMap<PathBuf, Vec<u8>>,
    /// The only folder whose files count as below that of the imported file.
    inside: &'static str,
}

impl Outside for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn is_below(&self, _: &Path, path: &Path) -> bool {
        path.starts_with(self.inside)
    }

    fn allows_outside_files(&self) -> bool {
        true
    }
}

fn memory<const N: usize>(files: [(&str, &str); N]) -> Memory {
    let files = files.map(|(name, text)| (name.into(), text.into())).into_iter().collect();
    Memory { files, ..Memory::default() }
}

fn imported<const N: usize>(files: [(&str, &str); N]) -> Import {
    read(Path::new(files[0].0), Parts::Refuse, &memory(files)).unwrap_or_else(|error| panic!("{error}"))
}

/// The names of nodes in their order, `-` for none.
fn names(graph: &Graph) -> Vec<&str> {
    graph.nodes.iter().map(|node| node.name.as_deref().unwrap_or("-")).collect()
}

fn georeference(origin_m: [f64; 3], system: &str) -> Option<Georeference> {
    Georeference::of(origin_m.into(), plume_graph::name(system))
}

#[test]
fn stations_of_survex_keep_their_names_and_their_place() {
    let text = "*cs UTM33N\n*begin Upper\n*fix 1 494000 5200000 900\n1 2 10 0 0\n2 3 9 90 0\n3 .. 2 0 0\n\
                *equate 3 new.a\n*begin new\na b 8 90 0\nb ... 5 0 0\n*end new\n*end Upper\n";
    let graph = imported([("cave.svx", text)]).graph;
    assert_eq!(names(&graph), ["upper.1", "upper.2", "upper.3", "upper.new.b", "-"]);
    assert_eq!(graph.georeference, georeference([494_000.0, 5_200_000.0, 900.0], "UTM33N"));
    let local = imported([("cave.svx", "1 2 5 0 0\n")]).graph;
    assert_eq!((names(&local), &local.georeference), (vec!["1", "2"], &None));
}

/// The axis of a passage is where its section is, so that its node need not be at the station.
#[test]
fn stations_beside_the_axis_keep_their_names() {
    let text = "1 2 10 0 0\n2 3 10 90 0\n*data passage station left right up down\n1 0 4 1 1\n2 0 6 1 3\n3 1 1 1 1\n";
    let graph = imported([("cave.svx", text)]).graph;
    assert_eq!(names(&graph), ["1", "2", "3"]);
    assert!(graph.nodes[1].position.y != 10.0, "{}", graph.nodes[1].position);
}

#[test]
fn stations_of_therion_and_compass_keep_their_names() {
    let therion = "survey deep\ncentreline\ncs EPSG:32633\nfix 0 494000 5200000 900\n0 1 10 0 0\nendcentreline\n\
                   survey far\ncentreline\n1 2 9 0 0\nendcentreline\nendsurvey\nequate 1 1@far\nendsurvey\n";
    let graph = imported([("cave.th", therion)]).graph;
    assert_eq!(names(&graph), ["deep.0", "deep.1", "deep.far.2"]);
    assert_eq!(graph.georeference, georeference([494_000.0, 5_200_000.0, 900.0], "EPSG:32633"));
    let project = "&WGS 1984; / datum\n$33;\n#a.dat,A1[M,494000,5200000,900];\n#b.dat,A2;\n";
    let book = "FROM TO\n\nA1 A2 10 0 0 1 1 1 1\n";
    let other = "FROM TO\n\nA2 A3 10 0 0 1 1 1 1\n";
    let graph = imported([("cave.mak", project), ("a.dat", book), ("b.dat", other)]).graph;
    assert_eq!(names(&graph), ["A1", "A2", "A3"]);
    assert_eq!(graph.georeference, georeference([494_000.0, 5_200_000.0, 900.0], "WGS 1984, UTM zone 33"));
}

fn placed(code: &[u8], east_cm: i32) -> Vec<u8> {
    [code, &[east_cm, 0, 0].map(i32::to_le_bytes).concat()].concat()
}

#[test]
fn stations_of_processed_surveys_keep_their_first_name() {
    let head = b"Survex 3D Image File\nv8\nCave\0EPSG:32633\n@0\n\0\0".to_vec();
    let legs = [placed(b"\x0f", 100), placed(b"\x60", 600), placed(b"\x60", 900)];
    // Each name drops some bytes of the last one and adds others.
    let labels = [placed(b"\x84\x04up.1", 100), placed(b"\x80\x112", 600), placed(b"\x80\x113", 600)];
    let bytes = [head, legs.concat(), labels.concat(), b"\0".to_vec()].concat();
    let files = Memory { files: [("cave.3d".into(), bytes)].into(), ..Memory::default() };
    let graph = read(Path::new("cave.3d"), Parts::Refuse, &files).unwrap().graph;
    assert_eq!(names(&graph), ["up.1", "up.2", "-"]);
    assert_eq!(graph.georeference, georeference([1.0, 0.0, 0.0], "EPSG:32633"));
}

/// The user may not be the author of the survey, and should not hand on what it makes the reader read.
#[test]
fn nothing_of_files_outside_the_folder_is_kept() {
    let files = |inside| Memory {
        inside,
        ..memory([
            ("in/cave.svx", "*include secret\n*include legs\n"),
            ("in/secret.svx", "*cs UTM33N\n"),
            ("in/legs.svx", "1 2 5 0 0\n"),
        ])
    };
    let graph = |inside| read(Path::new("in/cave.svx"), Parts::Refuse, &files(inside)).unwrap().graph;
    assert_eq!((names(&graph("in")), graph("in").georeference), (vec!["1", "2"], georeference([0.0; 3], "UTM33N")));
    assert_eq!((names(&graph("out")), graph("out").georeference), (vec!["-", "-"], None));
}

#[test]
fn long_names_are_dropped_and_cost_nothing() {
    let deep = "a.".repeat(15_000);
    let text = format!("*prefix {deep}b\n1 2 5 0 0\n2 {} 5 0 0\n*prefix \\\n\\{deep}b.2 c 5 90 0\n", "n".repeat(300));
    assert_eq!(names(&imported([("cave.svx", &text)]).graph), ["-", "-", "-", "c"]);
}

/// A graph with some names, in the coordinates of a survey.
fn surveyed() -> Graph {
    let text = "*cs UTM33N\n*fix 1 494000.25 5200000 -9\n1 2 10 0 0\n2 3 9 90 0\n2 ... 7 180 0\n";
    let mut graph = imported([("cave.svx", text)]).graph;
    graph.nodes[1].name = plume_graph::name("a <\"b\"> & \\c, d; 'é'");
    graph
}

fn written_and_read(row: &FormatRow, graph: &Graph) -> Import {
    let name = |file: &Written| PathBuf::from(format!("cave{}{}", file.suffix, row.endings[0]));
    let written = row.write.expect("it is written")(graph);
    let files = written.into_iter().map(|file| (name(&file), file.bytes)).collect();
    let path = PathBuf::from(format!("cave{}", row.endings[0]));
    read_as(row, &path, Parts::Keep, &Memory { files, ..Memory::default() }).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn names_and_georeference_survive_files_of_graphs() {
    let graph = surveyed();
    for name in ["json", "graphml", "csv"] {
        let read = written_and_read(format(name).unwrap(), &graph).graph;
        assert_eq!(names(&read), names(&graph), "{name}");
        if name != "csv" {
            assert_eq!(read.georeference, graph.georeference, "{name}");
        }
    }
}

#[test]
fn graphs_without_names_are_written_as_if_there_were_none() {
    for row in FORMATS.iter().filter(|row| row.write.is_some()) {
        let write = row.write.expect("it is written");
        let text = |graph: &Graph| String::from_utf8(write(graph).remove(0).bytes).unwrap();
        let (with, without) = (text(&surveyed()), text(&surveyed().anonymous()));
        let words = ["\"name\"", "name1", "xlabel", "georeference", "origin", "system"];
        assert!(words.iter().all(|word| !without.contains(word)), "{}", row.name);
        // karstnet has places only.
        assert_eq!(with == without, row.name == "karstnet", "{}", row.name);
    }
    let drawing = String::from_utf8(format("dot").unwrap().write.unwrap()(&surveyed()).remove(0).bytes).unwrap();
    assert!(drawing.contains(r#"xlabel="a <\"b\"> & \\c, d; 'é'""#), "{drawing}");
    assert!(drawing.contains("origin=\"494000.25,5200000,-9\"") && drawing.contains("system=\"UTM33N\""), "{drawing}");
}

#[test]
fn names_of_other_programs_do_not_stop_the_reader() {
    let text = r#"{"nodes": [{"id": 0, "name": 7, "edges": [1], "coordinates": {"x": 0, "y": 0}},
        {"id": 1, "name": "a\nb", "coordinates": {"x": 5, "y": 0}}]}"#;
    assert_eq!(names(&json::read(text).unwrap().graph), ["-", "-"]);
    let table = "x1,y1,name1,station1,x2,y2,name2\n0,0,A,B,5,0,\n";
    assert_eq!(names(&imported([("a.csv", table)]).graph), ["A", "-"]);
    for wrong in ["7", "{}", r#"{"origin_m": [1, 2]}"#, r#"{"origin_m": [1, 2, 1e300]}"#] {
        let error = json::read(&text.replacen('{', &format!("{{\"georeference\": {wrong}, "), 1)).unwrap_err();
        assert_eq!(error.to_string(), "`georeference` must have an `origin_m` of three coordinates in metres");
    }
}

#[test]
fn a_scaled_or_moved_graph_knows_where_it_is() {
    let import = || imported([("cave.svx", "*fix 1 494000 5200000 9\n1 2 10 0 0\n")]);
    let path = Path::new("cave.svx");
    assert_eq!(import().scaled(1.0, path).unwrap(), import());
    let larger = import().scaled(2.0, path).unwrap().graph;
    assert_eq!((names(&larger), &larger.georeference), (vec!["1", "2"], &None));
    let far = "x1,y1,x2,y2\n494000,5200000,494010,5200000\n";
    assert_eq!(imported([("far.csv", far)]).graph.georeference, georeference([494_000.0, 5_200_000.0, 0.0], ""));
}

/// The sample of the documentation; places are those of cavern 1.4.4, in centimetres.
#[test]
fn the_sample_is_in_order() {
    let text = include_str!("../samples/survey.svx");
    let Import { graph, tally, warnings, .. } = imported([("survey.svx", text)]);
    assert_eq!((graph.nodes.len(), graph.loops(), graph.length_m().round()), (21, 1, 208.0));
    assert_eq!((warnings, tally.splays, tally.unplaced, tally.left_out), (Vec::new(), 3, 0, 0));
    assert_eq!(graph.georeference, georeference([412_350.0, 5_312_480.0, 862.0], "UTM33N"));
    assert!(graph.nodes.iter().all(|node| node.name.is_some() && node.section.is_some()));
    // Nodes are in the middle of their passages, so only these are at their stations in plan.
    let distance = |name: &str, x: f64, y: f64| {
        let node = graph.nodes.iter().find(|node| node.name.as_deref() == Some(name)).expect(name);
        libm::hypot(node.position.x + 412_350.0 - x, node.position.y + 5_312_480.0 - y)
    };
    assert!(distance("badger.pit.6", 412_432.86, 5_312_461.39) < 0.06);
    assert!(distance("badger.hall.7", 412_389.57, 5_312_481.88) < 0.3);
}

const WALLS: &str = include_str!("../tests/data/formats/walls/pit.srv");

/// Where each named station is, relative to the first.
fn places(graph: &Graph) -> Vec<(String, [f64; 3])> {
    let name = |node: &plume_graph::Node| node.name.as_deref().unwrap_or("-").to_owned();
    graph.nodes.iter().map(|node| (name(node), node.position.map(|x| (x * 100.0).round() / 100.0).into())).collect()
}

#[test]
fn vectors_of_walls_are_read() {
    // Without walls, nodes are at their stations.
    let bare: String =
        WALLS.lines().map(|line| line.split(['<', '*']).next().unwrap_or_default().to_owned() + "\n").collect();
    let bare = bare.replace("A2 \n", "");
    let Import { graph, tally, warnings, .. } = imported([("cave.srv", &bare)]);
    let expected = [
        ("deep.A1", [0.0, 0.0, 0.0]),
        ("deep.A2", [10.0, 0.0, 0.0]),
        ("deep.A3", [10.0, 0.0, -6.1]),
        ("deep.A4", [10.0, -5.0, -6.1]),
        ("B1", [6.95, -5.0, -6.1]),
        ("deep.a5", [14.0, -2.0, -6.1]),
    ];
    let expected: Vec<(String, [f64; 3])> = expected.map(|(name, place)| (name.to_owned(), place)).into();
    assert_eq!(places(&graph), expected);
    assert_eq!((tally.splays, warnings), (1, Vec::new()));
    assert_eq!(graph.georeference, georeference([494_000.0, 5_200_000.0, 900.0], ""));
}

#[test]
fn walls_of_walls_are_where_they_were_measured() {
    let graph = imported([("cave.srv", WALLS)]).graph;
    let of = |name: &str| graph.nodes.iter().find(|node| node.name.as_deref() == Some(name)).expect(name);
    let size = |name: &str| of(name).section.map(|section| [section.width_m, section.height_m]);
    assert_eq!(size("deep.A1"), Some([3.0, 3.5]));
    // Looking east from A1, left is north.
    assert_eq!(of("deep.A1").position.y, -0.5);
    assert_eq!(size("deep.A4"), Some([0.61, 1.829]));
}

#[test]
fn what_is_wrong_with_walls_data_is_told() {
    let told = |text: &str| {
        let files = memory([("cave.srv", text)]);
        read(Path::new("cave.srv"), Parts::Refuse, &files).expect_err(text).to_string()
    };
    let leg = "A B 5 0 0\n";
    for (text, message) in [
        ("", "cave.srv: has no legs"),
        ("#[\nA B 5 0 0\n", "cave.srv:1: the comment is never closed"),
        ("A B 5 0\n", "cave.srv:1: the vector has 2 readings, not 3"),
        ("A B 5 0 0 1.5 2\n", "cave.srv:1: \"1.5\" follows the last reading"),
        ("A B\n", "cave.srv:1: a vector is two stations and its readings"),
        ("A B 5 x 0\n", "cave.srv:1: \"x\" is not an angle"),
        ("A B 5 -- 0\n", "cave.srv:1: the bearing is missing, and the shot is not plumbed"),
        ("A B 5 0 0 <1,2,3>\n", "cave.srv:1: distances to walls are left, right, up and down"),
        ("A B 5 0 0 <1,2,3,4\n", "cave.srv:1: `<` is not followed by `>`"),
        ("a:b:c:d:e B 5 0 0\n", "cave.srv:1: \"a:b:c:d:e\" has more than three prefixes"),
        ("a: B 5 0 0\n", "cave.srv:1: \"a:\" is not a name"),
        ("#units a=mils\n", "cave.srv:1: \"mils\" is not a supported unit of angles"),
        ("#units order=DDA\n", "cave.srv:1: \"DDA\" is not an order of columns"),
        ("#units inch=0.2\n", "cave.srv:1: \"inch\" is not a supported unit or option"),
        ("#units $a=b\n", "cave.srv:1: \"$a\" is not a supported unit or option"),
        ("#units restore\n", "cave.srv:1: no settings have been saved"),
        (
            "#units grid=1 rect\nA B 1 2 3\n",
            "cave.srv:2: rectangular vectors would have to be turned by the grid convergence",
        ),
        ("#fix A W97:43 N31:16 5\n", "cave.srv:1: \"W97:43\" is not a length"),
        ("#fix A 1 2\n", "cave.srv:1: a fix has three coordinates"),
        ("#frobnicate\n", "cave.srv:1: #frobnicate is not a supported directive"),
    ] {
        assert_eq!(told(&text.replace("LEG", leg)), message);
    }
    let many = "#units save\n".repeat(100);
    assert_eq!(told(&many), "cave.srv:65: settings are saved more than 64 deep");
    let long = format!("#prefix {}\n", "p".repeat(60_000));
    assert_eq!(told(&long), "cave.srv:1: a prefix has more than 200 letters");
}

/// Bytes that end a word, a line or a group, or begin something.
const ODD: &[u8] = b"\n-9#:*</(;\xff";

#[test]
fn damaged_files_are_read_or_refused() {
    let graph = format("graphml").unwrap().write.unwrap()(&surveyed()).remove(0).bytes;
    let json = format("json").unwrap().write.unwrap()(&surveyed()).remove(0).bytes;
    for (name, whole) in [("cave.srv", WALLS.as_bytes().to_vec()), ("cave.graphml", graph), ("cave.json", json)] {
        let law = |bytes: Vec<u8>| {
            let files = Memory { files: [(name.into(), bytes)].into(), ..Memory::default() };
            match read(Path::new(name), Parts::Longest, &files) {
                Ok(import) => assert!(import.graph.nodes.len() >= 2),
                Err(error) => assert!(!error.message.is_empty() && !error.hint.is_empty(), "{error}"),
            }
        };
        for at in 0..whole.len() {
            law(whole[..at].to_vec());
            for other in ODD.iter().copied().chain([whole[at] ^ 0x01, whole[at] ^ 0x80]) {
                let mut bytes = whole.clone();
                bytes[at] = other;
                law(bytes);
            }
        }
    }
}
