//! `plume certify`, `plume path` and `plume truth` on one small cave.

use std::fs;

use insta::assert_snapshot;
use serde_json::Value;

use crate::command::Desk;

/// A robot that is smaller than any in the table.
const MOUSE: &str = "length_m = 0.2\nwidth_m = 0.15\nheight_m = 0.1\nwheel_base_m = 0.12\ntrack_m = 0.12\n\
                     ground_clearance_m = 0.05\nstep_m = 0.04\nslope_deg = 30\nside_slope_deg = 30\npassage_m = 0.2\n";

fn fault(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.run(arguments);
    format!("exit {}\n{}", output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_robot_is_certified_and_finds_its_way() {
    let desk = Desk::new();
    desk.make(&["generate", "-o", "cave", "-q"]);
    desk.file("mouse.toml", MOUSE);
    let certify = ["certify", "cave", "--robot", "mouse.toml", "-o", "mouse.json", "-o", "mouse.png"];
    let said = desk.run(&certify);
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let text = String::from_utf8(said.stdout).unwrap();
    assert!(text.starts_with("mouse: ") && text.contains("stations: 12 of 12 reached and left again\n"), "{text}");
    let certificate: Value = serde_json::from_str(&fs::read_to_string(desk.path("mouse.json")).unwrap()).unwrap();
    assert_eq!(certificate["robot"]["settings"]["radius_m"], Value::Null);
    assert!(certificate["floor"]["share"].as_f64().unwrap() > 0.4);
    assert!(fs::read(desk.path("mouse.png")).unwrap().starts_with(b"\x89PNG"));

    // The same bytes again, whatever the number of threads.
    let before = fs::read(desk.path("mouse.json")).unwrap();
    assert!(desk.run(&[&certify[..], &["--threads", "1"]].concat()).status.success());
    assert!(before == fs::read(desk.path("mouse.json")).unwrap());

    let path =
        |kind: &str, file: &str| desk.run(&["path", "cave", "--robot", "mouse.toml", "--kind", kind, "-o", file]);
    for (kind, file) in [("longest", "a.tum"), ("tour", "b.csv"), ("0..5", "c.yaml")] {
        let output = path(kind, file);
        assert!(output.status.success(), "{kind}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let tum = fs::read_to_string(desk.path("a.tum")).unwrap();
    let rows: Vec<Vec<f64>> =
        tum.lines().map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect()).collect();
    assert!(rows.len() > 50 && rows.iter().all(|row| row.len() == 8));
    assert!(rows.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    assert!(fs::read_to_string(desk.path("c.yaml")).unwrap().starts_with("header:\n"));
    assert!(desk.run(&["truth", "cave", "-o", "truth", "--option", "cell_m=0.1", "-q"]).status.success());
    assert!(desk.run(&["export", "cave", "-t", "obj", "--with", "truth", "-o", "obj", "-q"]).status.success());
    assert!(desk.path("obj/truth/floor.npz").is_file());
    let checked = desk.run(&["check", "obj"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    assert_snapshot!("with_twice", fault(&desk, &["export", "cave", "-t", "truth", "--with", "truth", "-o", "twice"]));
    assert_snapshot!("no_such_station", fault(&desk, &["path", "cave", "--kind", "0..99", "-o", "x.tum"]));
}

#[test]
fn wrong_robots_paths_and_files_are_refused() {
    let desk = Desk::new();
    desk.file("mouse.toml", &MOUSE.replace("0.2\n", "-0.2\n").replace("track_m", "tracks_m"));
    let faults = [
        &["certify", "cave", "--robot", "hsky"][..],
        &["certify", "cave", "--robot", "mouse.toml"],
        &["certify", "cave", "--robot", "cat.toml"],
        &["certify", "cave", "-o", "certificate.pdf"],
        &["certify", "cave"],
        &["path", "cave", "--kind", "shortest", "-o", "x.tum"],
        &["path", "cave", "-o", "x.txt"],
        &["path", "cave", "--speed", "0", "-o", "x.tum"],
    ];
    assert_snapshot!("certify_faults", faults.map(|arguments| fault(&desk, arguments)).join("\n"));
}

#[test]
fn a_cave_is_held_to_the_robots_of_its_recipe() {
    let desk = Desk::new();
    // Passages of less than a metre in all.
    let narrow = [
        "--set",
        "passage.width_per_radius=0.1",
        "--set",
        "passage.width_min_m=0.8",
        "--set",
        "world.certify=[\"husky\"]",
    ];
    let output = desk.run(
        &[&["generate", "-o", "cave", "-q", "--set", "graph.nodes=4", "--set", "texture.size_px=256"][..], &narrow]
            .concat(),
    );
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("world.certify: husky is sure of 0 of 4 stations; first "), "{text}");
    assert_snapshot!("certify_unknown", fault(&desk, &["generate", "--set", "world.certify=[\"hsky\"]"]));
}
