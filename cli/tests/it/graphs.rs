//! Graphs and surveys on the command line: `plume graph`, `plume graph import` and `plume graph export`.

use std::fs;

use crate::command;
use command::{Desk, files};
use insta::assert_snapshot;
use serde_json::json;

#[test]
fn a_faulty_graph_is_reported() {
    let desk = Desk::new();
    desk.file("graph.json", "{\"nodes\": [");
    assert_snapshot!("graph_syntax", desk.fault(&["generate", "graph.json"]));
}

/// Two parts and a station alone.
const IN_PARTS: &str = r#"{"nodes": [
    {"id": 1, "edges": [2], "coordinates": {"x": 0, "y": 0}},
    {"id": 2, "coordinates": {"x": 5, "y": 0}},
    {"id": 3, "edges": [4], "coordinates": {"x": 9, "y": 0}},
    {"id": 4, "coordinates": {"x": 14, "y": 0}},
    {"id": 5, "coordinates": {"x": 30, "y": 0}}
]}"#;

#[test]
fn graphs_are_imported_and_exported() {
    let desk = Desk::new();
    desk.file("parts.json", IN_PARTS);
    assert_snapshot!("import_in_parts", desk.fault(&["graph", "import", "parts.json", "-o", "graph.json"]));
    assert_snapshot!("generate_in_parts", desk.fault(&["graph", "parts.json", "-o", "cave"]));
    let join = ["graph", "import", "parts.json", "-o", "graph.json", "--parts", "join", "--scale", "2"];
    assert_snapshot!("import_joined", desk.fault(&join));
    desk.file("grid.csv", "x1,y1,z1,x2,y2,z2\n500000,5200000,700,500009,5200000,701\n");
    assert_snapshot!("import_from_a_grid", desk.fault(&["graph", "import", "grid.csv", "-o", "grid.json"]));
    assert!(desk.run(&join).status.success());
    assert_snapshot!("import_over_another", desk.fault(&[&join[..7], &["--scale", "3"]].concat()));
    assert_snapshot!("export_pair", desk.fault(&["graph", "export", "graph.json", "-o", "out/my_nodes.dat"]));
    assert_snapshot!("import_pair", desk.fault(&["graph", "import", "out/my_links.dat", "-o", "back.json"]));
    fs::remove_file(desk.path("out/my_links.dat")).unwrap();
    assert_snapshot!("import_half_a_pair", desk.fault(&["graph", "import", "out/my_nodes.dat", "-o", "no.json"]));
    let works = |arguments: &[&str]| assert!(desk.run(arguments).status.success(), "{arguments:?}");
    works(&["graph", "graph.json", "-o", "cave"]);
    let json = desk.run(&["graph", "export", "cave", "-o", "cave.graphml", "--json"]);
    let told: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!((&told["graph"]["nodes"], &told["graph"]["length_m"]), (&json!(4), &json!(28.0)));
    works(&["graph", "cave.graphml", "-o", "again"]);
    works(&["graph", "parts.json", "-o", "kept", "--set", "graph.parts=keep"]);
    works(&["graph", "kept"]);
}

/// Two pieces that nothing connects, both with a position, in each format of surveys.
fn in_pieces(desk: &Desk) -> [&'static str; 4] {
    let place = |code: &[u8], [x, y]: [i32; 2]| [code, &[x, y, 0].map(i32::to_le_bytes).concat()].concat();
    let items = [(b"\0\x0f".as_slice(), [0, 0]), (b"\x60", [0, 3000]), (b"\x60", [900, 3000])];
    let more = [(b"\x0f".as_slice(), [10_000, 0]), (b"\x60", [10_000, 2000])];
    let items: Vec<u8> = items.iter().chain(&more).flat_map(|(code, at)| place(code, *at)).collect();
    let survey = [b"Survex 3D Image File\nv8\ntitle\n@0\n\0".as_slice(), &items, b"\0"].concat();
    fs::write(desk.path("pieces.3d"), survey).unwrap();
    desk.file("pieces.svx", "1 2 30 0 0\n2 3 9 90 0\n8 9 20 0 0\n*fix 1 0 0 0\n*fix 8 100 0 0\n");
    desk.file(
        "pieces.th",
        "centreline\n1 2 30 0 0\n2 3 9 90 0\n8 9 20 0 0\nfix 1 0 0 0\nfix 8 100 0 0\nendcentreline\n",
    );
    desk.file("pieces.dat", "FROM TO\n\nA1 A2 100 0 0 1 1 1 1\nB1 B2 60 0 0 1 1 1 1\n");
    desk.file("pieces.mak", "#pieces.dat,A1[M,0,0,0],B1[M,100,0,0];");
    ["pieces.3d", "pieces.svx", "pieces.th", "pieces.mak"]
}

/// What to do with pieces of a survey is decided by the settings, however the survey reaches the command.
#[test]
fn pieces_of_surveys_are_treated_as_asked() {
    let desk = Desk::new();
    for name in in_pieces(&desk) {
        let made = |parts: &str| {
            let setting = format!("graph.parts={parts}");
            let folder = format!("{name}-{parts}");
            let output = desk.run(&["graph", name, "-o", &folder, "--set", &setting]);
            let text = fs::read_to_string(desk.path(&folder).join("graph.json")).ok()?;
            assert!(output.status.success(), "{name} {parts}");
            let graph = plume_survey::json::read_parts(&text, plume_survey::Parts::Keep).unwrap().0.graph;
            Some((graph.components().len(), graph.nodes.len()))
        };
        let nodes = if name == "pieces.mak" { [4, 2] } else { [5, 3] };
        assert_eq!(made("refuse"), None, "{name}");
        assert_eq!(made("join"), Some((1, nodes[0])), "{name}");
        assert_eq!(made("keep"), Some((2, nodes[0])), "{name}");
        assert_eq!(made("longest"), Some((1, nodes[1])), "{name}");
    }
    // Pieces without a position are laid beside each other.
    desk.file("adrift.svx", "1 2 30 0 0\n8 9 20 0 0\n");
    desk.file("adrift.dat", "FROM TO\n\nA1 A2 100 0 0 1 1 1 1\nB1 B2 60 0 0 1 1 1 1\n");
    for parts in ["join", "keep", "longest"] {
        let setting = format!("graph.parts={parts}");
        for name in ["adrift.svx", "adrift.dat"] {
            assert!(desk.run(&["graph", name, "-o", &format!("{name}-{parts}"), "--set", &setting]).status.success());
        }
    }
    assert_snapshot!("pieces_adrift", desk.fault(&["graph", "adrift.svx", "-o", "no"]));
    assert_snapshot!(
        "import_adrift",
        desk.fault(&["graph", "import", "adrift.svx", "-o", "a.json", "--parts", "join"])
    );
}

#[test]
fn doubtful_readings_of_surveys_are_told() {
    let desk = Desk::new();
    desk.file("cave.svx", "1 2 10 0 95\n2 3 10 400 0\n3 4 -10 0 0\n");
    assert_snapshot!("import_doubtful", desk.fault(&["graph", "import", "cave.svx", "-o", "graph.json"]));
    let told = desk.fault(&["graph", "cave.svx", "-o", "cave"]);
    assert!(told.starts_with("exit 0") && told.contains("cave.svx:2: the compass reading 400"), "{told}");
}

#[test]
fn faulty_imports_and_exports_are_reported() {
    let desk = Desk::new();
    desk.file("parts.json", IN_PARTS);
    fs::create_dir(desk.path("empty")).unwrap();
    for (name, arguments) in [
        ("no_such_format", "graph import parts.json -o graph.json --format graphmll"),
        ("format_not_read", "graph import parts.json -o graph.json --format dot"),
        ("import_to_another_format", "graph import parts.json -o graph.csv --parts join"),
        ("import_too_large", "graph import parts.json -o graph.json --parts keep --scale 1000000"),
        ("export_to_no_format", "graph export parts.json -o cave.xyz"),
        ("export_of_no_cave", "graph export empty -o cave.csv"),
        ("no_such_parts", "graph import parts.json -o graph.json --parts glue"),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        assert_snapshot!(name, desk.fault(&arguments));
    }
    assert_eq!(files(&desk.path("")).len(), 1);
}

/// A survey in a separate folder, a secret next to that folder, and paths to it.
fn desk_with_secrets() -> Desk {
    let desk = Desk::new();
    fs::create_dir(desk.path("survey")).unwrap();
    for name in ["secret.svx", "secret.th", "secret.dat", "secret_links.dat"] {
        desk.file(name, "root:x:0:0:hunter2\n");
    }
    desk.file("survey/up.svx", "*include ../secret\n");
    desk.file("survey/absolute.svx", &format!("*include \"{}\"\n", desk.path("secret.svx").display()));
    desk.file("survey/none.svx", "*include ../nowhere\n");
    desk.file("survey/up.th", "input ../secret\n");
    desk.file("survey/up.mak", "#..\\secret.dat;\n");
    desk.file("survey/pair_nodes.dat", "0 0 0\n9 0 0\n");
    #[cfg(unix)]
    for (to, from) in [("secret.svx", "survey/link.svx"), ("secret_links.dat", "survey/pair_links.dat")] {
        std::os::unix::fs::symlink(desk.path(to), desk.path(from)).unwrap();
    }
    desk.file("survey/links.svx", "*include link\n");
    desk
}

#[cfg(unix)]
#[test]
fn surveys_only_include_files_below_their_folder() {
    let desk = desk_with_secrets();
    let surveys = ["up.svx", "absolute.svx", "none.svx", "links.svx", "up.th", "up.mak", "pair_nodes.dat"];
    let import = |more: &[&str]| {
        let told = surveys.map(|name| {
            let survey = format!("survey/{name}");
            desk.fault(&[&["graph", "import", &survey, "-o", "graph.json"], more].concat())
        });
        told.join("\n").replace(desk.path("").to_str().unwrap(), "DESK/")
    };
    let (refused, allowed) = (import(&[]), import(&["--allow-outside"]));
    assert!(!refused.contains("hunter2") && !allowed.contains("hunter2") && !allowed.contains("root"), "{allowed}");
    assert_snapshot!("surveys_that_lead_out", refused);
    assert_snapshot!("surveys_that_may_lead_out", allowed);
    // A recipe that names the survey, a complete survey elsewhere, and one in a subfolder.
    assert_snapshot!("recipe_that_leads_out", desk.fault(&["graph", "survey/up.svx"]));
    desk.file("secret.svx", "1 2 10 90 0\n");
    let works = |arguments: &[&str]| desk.run(arguments).status.success();
    assert!(works(&["graph", "survey/up.svx", "-o", "cave", "--allow-outside"]));
    assert!(works(&["graph", "import", "survey/links.svx", "-o", "a.json", "--allow-outside"]));
    desk.file("top.svx", "*include survey/in\n");
    desk.file("survey/in.svx", "*include ../secret\n");
    assert!(works(&["graph", "import", "top.svx", "-o", "b.json"]));
}
