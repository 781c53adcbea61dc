//! Laws of `plume dataset`: the same bytes for any number of workers and after any kill; nothing silent.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::command::Desk;
use serde_json::Value;

const TINY: &str = r#"
seeds = [1, 3]
set = ["mesh.voxel_m=0.5", "texture.size_px=256", "things.cover=0"]
targets = ["obj"]
sheet = 0
[[vary]]
key = "graph.nodes"
draw = "grid"
values = [3, 4]
"#;

fn desk(spec: &str) -> Desk {
    let desk = Desk::new();
    desk.file("tiny.toml", spec);
    desk
}

fn make(desk: &Desk, output: &str, workers: &str) {
    let run = desk.run(&["dataset", "tiny.toml", "-o", output, "--workers", workers]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// Names and hashes of what follows from the specification.
fn hashes(desk: &Desk, name: &str) -> Vec<(String, String)> {
    // What a worker that was interrupted still had in its hands may be there for a moment.
    let top = ["README.md", "dataset.json", "failed.csv", "index.csv", "index.json", "SHA256SUMS"];
    let text = |file: &str| (file.to_owned(), fs::read_to_string(desk.path(name).join(file)).unwrap());
    desk.hashes(&format!("{name}/items")).into_iter().chain(top.map(text)).collect()
}

fn index(desk: &Desk, name: &str) -> Vec<Value> {
    serde_json::from_slice(&fs::read(desk.path(name).join("index.json")).unwrap()).unwrap()
}

#[test]
fn any_number_of_workers_makes_the_same_bytes() {
    let desk = desk(&TINY.replace("sheet = 0", "sheet = 2"));
    make(&desk, "one", "1");
    make(&desk, "three", "3");
    let one = hashes(&desk, "one");
    assert_eq!(one, hashes(&desk, "three"));
    assert!(desk.path("one/sheet.png").is_file());
    let rows = index(&desk, "one");
    assert_eq!(rows.len(), 6);
    let seeds: Vec<u64> = rows.iter().map(|row| row["seed"].as_u64().unwrap()).collect();
    assert_eq!(seeds, [1, 1, 2, 2, 3, 3]);
    assert!(rows.iter().all(|row| row["stations"] == row["graph.nodes"] && row["triangles"].as_u64().unwrap() > 100));
    let sums =
        Command::new("sha256sum").args(["--check", "--quiet", "SHA256SUMS"]).current_dir(desk.path("one")).output();
    let sums = sums.unwrap();
    assert!(sums.status.success(), "{}", String::from_utf8_lossy(&sums.stdout));
    let checked = desk.run(&["check", "one"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
}

fn start(desk: &Desk, output: &str) -> Child {
    let mut command = desk.command(&["dataset", "tiny.toml", "-o", output, "--workers", "2"]);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Waits until so many caves are done.
fn wait_for(desk: &Desk, output: &str, caves: usize) {
    let started = Instant::now();
    let items = desk.path(output).join("items");
    while fs::read_dir(&items).map_or(0, Iterator::count) < caves {
        assert!(started.elapsed() < Duration::from_secs(300), "no caves");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn after_any_kill_it_ends_as_if_there_had_been_none() {
    let desk = desk(TINY);
    make(&desk, "whole", "2");
    for caves in [0, 1, 4] {
        let mut run = start(&desk, "killed");
        wait_for(&desk, "killed", caves);
        // A worker, and then whoever has asked it.
        let _ = Command::new("pkill").args(["-KILL", "--newest", "--parent", &run.id().to_string()]).status();
        sleep(Duration::from_millis(20));
        run.kill().unwrap();
        run.wait().unwrap();
        make(&desk, "killed", "2");
        assert_eq!(hashes(&desk, "whole"), hashes(&desk, "killed"), "killed after {caves} caves");
        fs::remove_dir_all(desk.path("killed")).unwrap();
    }
}

#[test]
fn a_second_run_in_a_folder_is_refused() {
    let desk = desk(TINY);
    let mut run = start(&desk, "out");
    wait_for(&desk, "out", 1);
    let fault = desk.fault(&["dataset", "tiny.toml", "-o", "out"]);
    run.kill().unwrap();
    run.wait().unwrap();
    insta::assert_snapshot!(fault);
}

#[test]
fn another_specification_or_other_files_are_refused() {
    let desk = desk(&TINY.replace("[1, 3]", "[1, 1]"));
    make(&desk, "out", "2");
    desk.file("tiny.toml", TINY);
    fs::create_dir(desk.path("thesis")).unwrap();
    desk.file("thesis/thesis.txt", "mine");
    let faults = ["out", "thesis"].map(|output| desk.fault(&["dataset", "tiny.toml", "-o", output]));
    assert_eq!(fs::read_to_string(desk.path("thesis/thesis.txt")).unwrap(), "mine");
    insta::assert_snapshot!(faults.join("\n"));
}

#[test]
fn what_cannot_be_made_is_left_out_and_told() {
    // With stations this far apart, passages this narrow have no air in voxels this coarse.
    let spec = TINY.replace("voxel_m=0.5", "voxel_m=1.0").replace("[3, 4]", "[4]");
    let spec = spec
        + "[[vary]]\nkey = \"passage.width_min_m\"\ndraw = \"grid\"\nvalues = [0.8, 4.0]\n\
                       [[vary]]\nkey = \"passage.width_per_radius\"\ndraw = \"grid\"\nvalues = [0.1]\n";
    let desk = desk(&spec);
    let run = desk.run(&["dataset", "tiny.toml", "-o", "out", "--json"]);
    let told: Value = serde_json::from_slice(&run.stdout).unwrap();
    let failed = fs::read_to_string(desk.path("out/failed.csv")).unwrap();
    let left_out = told["failed"].as_array().unwrap().len();
    assert!(left_out > 0 && left_out < 6, "{told}");
    assert_eq!(failed.lines().count(), 1 + left_out, "{failed}");
    assert_eq!(told["caves"].as_u64().unwrap() as usize + left_out, 6);
    assert!(fs::read_to_string(desk.path("out/README.md")).unwrap().contains("Left out"));
}

#[test]
fn no_two_parts_have_a_cave_of_the_same_layout() {
    // The layout of a file is the same for every seed.
    let desk =
        desk(&TINY.replace("[1, 3]", "[1, 6]").replace("graph.nodes", "look.humidity").replace("[3, 4]", "[0.5]"));
    desk.make(&["graph", "--output", "source"]);
    let spec = fs::read_to_string(desk.path("tiny.toml")).unwrap();
    desk.file("tiny.toml", &format!("recipe = \"source/graph.json\"\n{spec}"));
    make(&desk, "out", "2");
    let rows = index(&desk, "out");
    assert!(!rows.is_empty() && rows.len() < 6);
    assert!(rows.iter().all(|row| row["part"] == rows[0]["part"]), "{rows:?}");
    let failed = fs::read_to_string(desk.path("out/failed.csv")).unwrap();
    assert!(failed.contains("has the layout of"), "{failed}");
}

#[test]
fn damage_is_found() {
    let desk = desk(&TINY.replace("[1, 3]", "[1, 2]"));
    make(&desk, "out", "2");
    let damages: [(&str, &str); 4] = [
        ("items/000001/recipe.toml", "was changed"),
        ("items/000000/obj/new.txt", "is in no sum"),
        ("index.csv", "was changed"),
        ("items/000002/item.json", "was changed"),
    ];
    for (path, fault) in damages {
        let before = fs::read(desk.path("out").join(path)).ok();
        desk.file(&format!("out/{path}"), "damage");
        let run = desk.run(&["check", "out"]);
        let told = String::from_utf8_lossy(&run.stdout).into_owned();
        assert!(!run.status.success() && told.contains(path) && told.contains(fault), "{path}: {told}");
        match before {
            Some(before) => fs::write(desk.path("out").join(path), before).unwrap(),
            None => fs::remove_file(desk.path("out").join(path)).unwrap(),
        }
    }
    assert!(desk.run(&["check", "out"]).status.success());
}
