//! Laws of the disk: no file of the user is deleted, overwritten or redirected, whatever a cave folder says and whatever is
//! next to an output.

use std::fs;

use crate::command;
use command::Desk;
use insta::assert_snapshot;
use plume_disk::sealed::{seal, sha256, unseal};
use serde_json::{Value, json};

/// An even smaller cave, in a separate folder.
const TINY: [&str; 8] = [
    "--set",
    "graph.nodes=4",
    "--set",
    "mesh.voxel_m=0.4",
    "--set",
    "texture.size_px=256",
    "--set",
    "mesh.chunk_m=[16, 16, 16]",
];

fn made(arguments: &[&str]) -> Desk {
    let desk = Desk::new();
    works(&desk, &[arguments, &TINY].concat());
    desk
}

fn cave() -> Desk {
    made(&["generate", "--output", "cave"])
}

fn works(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.run(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {stderr}");
    stderr
}

/// The output of a command that must fail without crashing.
fn refused(desk: &Desk, arguments: &[&str]) -> String {
    let fault = desk.fault(arguments);
    assert!(["exit 1\n", "exit 2\n"].iter().any(|start| fault.starts_with(start)), "{arguments:?}: {fault}");
    fault
}

fn manifest(desk: &Desk) -> Value {
    let text = fs::read(desk.path("cave/manifest.json")).unwrap();
    serde_json::from_slice(&unseal(&text).unwrap()).unwrap()
}

fn write_manifest(desk: &Desk, manifest: &Value) {
    desk.file("cave/manifest.json", &seal(&serde_json::to_string_pretty(manifest).unwrap()));
}

fn texture_unit(name: &str, path: &str) -> Value {
    json!({
        "stage": "texture", "name": name, "fingerprint": "0", "facts": {},
        "files": [{"path": path, "bytes": 6, "sha256": sha256(b"victim")}],
    })
}

const COMMANDS: [&[&str]; 7] = [
    &["generate", "cave"],
    &["generate", "cave", "--force"],
    &["export", "cave", "--target", "obj", "--output", "out"],
    &["mesh", "cave"],
    &["pieces", "cave"],
    &["measure", "cave"],
    &["status", "cave"],
];

#[test]
fn a_record_that_leads_outside_is_refused() {
    let desk = cave();
    desk.file("victim", "victim");
    let absolute = desk.path("victim").to_str().unwrap().to_owned();
    let whole = manifest(&desk);
    for (name, path) in [
        ("chunk_9_9_9", absolute.as_str()),
        ("chunk_9_9_9", "../victim"),
        ("../../victim", "textures/../../victim"),
        ("chunk_9_9_9", "cave.toml"),
    ] {
        let mut hostile = whole.clone();
        hostile["units"].as_array_mut().unwrap().push(texture_unit(name, path));
        write_manifest(&desk, &hostile);
        for command in COMMANDS {
            let fault = refused(&desk, command);
            assert!(fault.contains("manifest.json"), "{command:?}: {fault}");
        }
    }
    write_manifest(&desk, &whole);
    let event = json!({"done": texture_unit("chunk_9_9_9", &absolute)}).to_string();
    desk.file("cave/journal.jsonl", &format!("{{\"sha256\":\"{}\",\"event\":{event}}}\n", sha256(event.as_bytes())));
    for command in COMMANDS {
        let fault = refused(&desk, command);
        assert!(fault.contains("journal.jsonl"), "{command:?}: {fault}");
    }
    assert_eq!(fs::read(desk.path("victim")).unwrap(), b"victim");
    assert!(desk.path("cave/cave.toml").exists());
}

#[test]
fn an_edited_manifest_is_refused() {
    let desk = cave();
    let path = desk.path("cave/manifest.json");
    let text = fs::read_to_string(&path).unwrap();
    let edited = text.replacen("\"error_m\": 0", "\"error_m\": 1", 1);
    assert_ne!(text, edited);
    fs::write(&path, edited).unwrap();
    assert_snapshot!("edited_manifest", refused(&desk, COMMANDS[2]));
    assert!(!desk.path("out").exists());
}

#[cfg(unix)]
#[test]
fn nothing_is_read_or_written_through_a_link() {
    let desk = Desk::new();
    fs::create_dir(desk.path("elsewhere")).unwrap();
    desk.file("elsewhere/letter", "dear");
    let link = |to: &str, at: &str| std::os::unix::fs::symlink(desk.path(to), desk.path(at)).unwrap();
    for (name, target) in [
        ("textures", "elsewhere"),
        ("chunks", "elsewhere"),
        ("journal.jsonl", "elsewhere/letter"),
        ("manifest.json", "elsewhere/letter"),
    ] {
        fs::create_dir(desk.path("cave")).unwrap();
        desk.file("cave/journal.jsonl", "\n");
        if name == "journal.jsonl" {
            fs::remove_file(desk.path("cave/journal.jsonl")).unwrap();
        }
        link(target, &format!("cave/{name}"));
        let fault = refused(&desk, &[&["generate", "--output", "cave"], &TINY[..]].concat());
        assert!(fault.contains(name) && (fault.contains("link") || fault.contains("not a regular")), "{fault}");
        assert_eq!(desk.hashes("elsewhere"), [("letter".to_owned(), sha256(b"dear"))], "{name}");
        fs::remove_dir_all(desk.path("cave")).unwrap();
    }
}

#[test]
fn a_truncated_recipe_is_refused() {
    let desk = cave();
    let recipe = fs::read_to_string(desk.path("cave/cave.toml")).unwrap();
    let before = desk.hashes("cave/chunks");
    for kept in [0, 40, recipe.len() / 2, recipe.trim_end().rfind('\n').unwrap() + 1] {
        desk.file("cave/cave.toml", &recipe[..kept]);
        for command in COMMANDS.iter().filter(|command| command[0] != "measure") {
            let fault = refused(&desk, command);
            assert!(fault.contains("cave.toml"), "{kept}: {fault}");
        }
    }
    desk.file("cave/cave.toml", "");
    assert_snapshot!("empty_recipe", refused(&desk, COMMANDS[0]));
    desk.file("cave/cave.toml", &recipe.replacen("nodes = 4\n", "", 1));
    assert_snapshot!("incomplete_recipe", refused(&desk, COMMANDS[0]));
    assert_eq!(before, desk.hashes("cave/chunks"));
    desk.file("cave/cave.toml", &recipe.replacen("nodes = 4\n", "nodes = 5\n", 1));
    assert!(works(&desk, COMMANDS[0]).contains("changed   graph.nodes: 4 → 5"));
    let graph = fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    desk.file("cave/graph.json", &graph.replacen("\"radius\":", "\"radius\":1", 1));
    for command in [["measure", "cave"], ["generate", "cave"]] {
        assert!(works(&desk, &command).contains("changed   graph.json has been edited"), "{command:?}");
    }
}

#[test]
fn overrides_leave_a_kept_folder_as_it_is() {
    let desk = cave();
    let (before, times) = (desk.hashes("cave"), desk.times("cave"));
    for (number, change) in [["--set", "name=north"], ["--set", "graph.nodes=6"], ["--seed", "9"]].iter().enumerate() {
        let out = format!("out{number}");
        works(&desk, &[&["export", "cave", "--target", "obj", "--output", &out], &change[..]].concat());
        works(&desk, &["check", &out]);
        works(&desk, &[&["preview", "cave", "--output", "map.png"], &change[..]].concat());
        assert_eq!((&before, &times), (&desk.hashes("cave"), &desk.times("cave")), "{change:?}");
    }
    let from_scratch = ["export", "--target", "obj", "--output", "scratch", "--set", "name=north"];
    works(&desk, &[&from_scratch[..], &TINY].concat());
    assert_eq!(desk.hashes("out0"), desk.hashes("scratch"));
    assert_eq!(desk.folders(), ["cave", "out0", "out1", "out2", "scratch"]);
}

#[test]
fn an_export_from_a_finished_folder_writes_nothing_there() {
    let desk = cave();
    works(&desk, &["pieces", "cave"]);
    let times = |desk: &Desk| (desk.times("cave"), fs::metadata(desk.path("cave")).unwrap().modified().unwrap());
    let before = times(&desk);
    for target in ["obj", "mujoco"] {
        works(&desk, &["export", "cave", "--target", target, "--output", target]);
    }
    works(&desk, &["generate", "cave"]);
    assert_eq!(before, times(&desk));
}

#[test]
fn a_changed_file_is_named_and_stays() {
    let desk = cave();
    let image = "cave/textures/chunk_0_0_0_base_color.jpg";
    assert!(desk.path(image).exists());
    let whole = fs::read(desk.path(image)).unwrap();
    fs::write(desk.path(image), "painted by hand").unwrap();
    assert_snapshot!("changed_file", refused(&desk, COMMANDS[2]));
    for command in [&["generate", "cave"][..], &["generate", "cave", "--set", "texture.format=png"]] {
        assert!(refused(&desk, command).contains("chunk_0_0_0_base_color.jpg"));
    }
    assert_eq!(fs::read(desk.path(image)).unwrap(), b"painted by hand");
    works(&desk, &["generate", "cave", "--force"]);
    assert_eq!(fs::read(desk.path(image)).unwrap(), whole);
    let chunk = "cave/chunks/chunk_0_0_0.ply";
    let mut bits = fs::read(desk.path(chunk)).unwrap();
    let last = bits.len() - 1;
    bits[last] ^= 1;
    fs::write(desk.path(chunk), bits).unwrap();
    assert_snapshot!("measure_damaged", refused(&desk, &["measure", "cave"]));
}

#[test]
fn neighbours_of_an_output_survive() {
    let desk = cave();
    let neighbours = [
        "fresh.partial",
        ".fresh.cave",
        "out.partial",
        "out.old.partial",
        ".out.cave",
        ".plume-notes",
        ".plume-AbCdEfGh",
        "out.zip.partial",
    ];
    for name in neighbours {
        fs::create_dir(desk.path(name)).unwrap();
        desk.file(&format!("{name}/thesis.txt"), "x");
    }
    let export = ["export", "cave", "--target", "obj", "--output", "out"];
    works(&desk, &export);
    works(&desk, &[&export[..], &["--force"]].concat());
    works(&desk, &[&export[..], &["--bundle", "zip"]].concat());
    assert_snapshot!("hidden_cave_of_others", refused(&desk, &["export", "--target", "obj", "--output", "fresh"]));
    for name in neighbours {
        assert_eq!(desk.hashes(name), [("thesis.txt".to_owned(), sha256(b"x"))], "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_planted_next_to_an_output_is_not_followed() {
    let desk = cave();
    desk.file("victim", "dear");
    for name in ["out.zip.partial", "cave/plan.png.partial", "map.png.partial", "graph.csv.partial"] {
        std::os::unix::fs::symlink(desk.path("victim"), desk.path(name)).unwrap();
    }
    works(&desk, &["export", "cave", "--target", "obj", "--output", "out", "--bundle", "zip"]);
    works(&desk, &["generate", "cave", "--set", "name=north"]);
    works(&desk, &["preview", "cave", "--output", "map.png"]);
    works(&desk, &["graph", "export", "cave", "--output", "graph.csv"]);
    assert!(fs::read(desk.path("victim")).unwrap() == b"dear");
}

#[test]
fn files_that_the_user_has_put_into_a_package_stay() {
    let desk = cave();
    let export = ["export", "cave", "--target", "obj", "--output", "out", "--force"];
    works(&desk, &export);
    fs::create_dir_all(desk.path("out/notes/empty")).unwrap();
    desk.file("out/notes/robot.txt", "drives");
    desk.file("out/textures/mine.png", "pixels");
    works(&desk, &[&export[..], &["--set", "name=north"]].concat());
    assert_eq!(fs::read(desk.path("out/notes/robot.txt")).unwrap(), b"drives");
    assert_eq!(fs::read(desk.path("out/textures/mine.png")).unwrap(), b"pixels");
    assert!(desk.path("out/notes/empty").is_dir() && desk.path("out/north.obj").exists());
    assert!(!desk.path("out/cave.obj").exists());
    desk.file("out/cave.obj", "mine now");
    assert_snapshot!("in_the_way", refused(&desk, &export));
    assert_eq!(fs::read(desk.path("out/cave.obj")).unwrap(), b"mine now");
    assert_eq!(desk.folders(), ["cave", "out"]);
}

#[test]
fn finished_packages_of_an_interrupted_export_are_kept() {
    let desk = cave();
    works(&desk, &["export", "cave", "--target", "obj", "--output", "out/obj"]);
    let times = desk.times("out/obj");
    let both = ["export", "cave", "--target", "obj,ply", "--output", "out"];
    assert!(works(&desk, &both).contains("already up to date"));
    assert_eq!(times, desk.times("out/obj"));
    works(&desk, &["check", "out/ply"]);
    let another = [&both[..], &["--option", "obj.lods=true"]].concat();
    assert!(refused(&desk, &another).contains("not empty"));
    fs::remove_file(desk.path("out/obj/LICENSE.md")).unwrap();
    assert!(refused(&desk, &both).contains("not empty"));
}

#[test]
fn a_cave_without_space_is_an_error() {
    let desk = Desk::new();
    let nothing = ["--seed", "0", "--set", "graph.generator=karst", "--set", "graph.nodes=2", "--set"];
    let nothing = [&nothing[..], &["rock.wander_m=0", "--set", "rock.kind=basalt", "--set", "mesh.voxel_m=1"]].concat();
    assert_snapshot!("empty_cave", refused(&desk, &[&["generate", "--output", "cave"], &nothing[..]].concat()));
    let status = String::from_utf8(desk.run(&["status", "cave"]).stdout).unwrap();
    assert!(status.contains("plume generate"), "{status}");
    let json = [&["export", "--target", "obj", "--output", "out", "--json"], &nothing[..]].concat();
    let told = String::from_utf8(desk.run(&json).stdout).unwrap();
    assert!(!told.contains("-0.0") && !told.contains("null"), "{told}");
    assert_eq!(desk.folders(), ["cave"]);
}

#[test]
fn leftovers_of_killed_runs_are_removed_by_the_next() {
    let desk = cave();
    fs::create_dir(desk.path(".plume-01234567")).unwrap();
    desk.file(".plume-01234567/plume-staging", "");
    desk.file(".plume-01234567/package", "half");
    fs::create_dir(desk.path(".plume-89abcdef")).unwrap();
    works(&desk, &["export", "cave", "--target", "obj", "--output", "out"]);
    assert_eq!(desk.folders(), ["cave", "out"]);
}

impl Desk {
    /// Everything in the test folder, hidden or not.
    fn folders(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path("")).unwrap().map(|entry| entry.unwrap());
        let folders = entries.filter(|entry| entry.path().is_dir());
        let mut names: Vec<String> = folders.map(|entry| entry.file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

#[test]
fn two_runs_at_one_path_never_both_succeed() {
    let desk = cave();
    for bundle in [&[][..], &["--bundle", "zip"], &["--bundle", "tar.zst"]] {
        let arguments = [&["export", "cave", "--quiet", "--target", "obj", "--output", "race/out"], bundle].concat();
        let mut racers: Vec<_> = (0..3).map(|_| desk.command(&arguments).spawn().unwrap()).collect();
        let codes: Vec<_> = racers.iter_mut().map(|racer| racer.wait().unwrap().code()).collect();
        assert!(codes.contains(&Some(0)) && codes.iter().all(|code| [Some(0), Some(2)].contains(code)), "{codes:?}");
        let left: Vec<_> = fs::read_dir(desk.path("race")).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert_eq!(left.len(), 1, "{left:?}");
        works(&desk, &["check", left[0].to_str().unwrap()]);
        fs::remove_dir_all(desk.path("race")).unwrap();
    }
}
