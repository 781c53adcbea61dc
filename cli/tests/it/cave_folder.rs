//! Laws of the cave folder: same bytes for any number of threads, after a kill, and from the graph file alone.

use std::collections::BTreeSet;
use std::fs;
use std::process::Child;
use std::sync::atomic::AtomicBool;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::command;
use command::{Desk, SMALL};
use nalgebra::Vector3;
use plume::Recipe;
use plume::assemble::FolderChunks;
use plume::material::MATERIALS;
use plume::store::{CaveFolder, Stage, Unit};
use plume_disk::sealed::{sha256, unseal};
use plume_exporters::scene::{Chunks, Mesh};

#[test]
fn one_thread_and_many_make_the_same_bytes() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "one", "--threads", "1"]);
    desk.make(&["generate", "--output", "many", "--threads", "4"]);
    let hashes = desk.hashes("one");
    assert!(hashes.len() > 10, "{hashes:?}");
    assert!(hashes.iter().any(|(path, _)| path.ends_with("_lod2.ply")), "{hashes:?}");
    assert_eq!(hashes, desk.hashes("many"));
}

#[test]
fn another_seed_makes_another_cave() {
    let desk = Desk::new();
    desk.make(&["mesh", "--output", "a", "--seed", "1"]);
    desk.make(&["mesh", "--output", "b", "--seed", "2"]);
    assert_ne!(desk.hashes("a"), desk.hashes("b"));
}

#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "whole"]);
    for units in [1, 3, 6] {
        kill_after(&desk, units);
        desk.make(&["generate", "--output", "killed"]);
        assert_eq!(desk.hashes("whole"), desk.hashes("killed"), "killed after {units} units");
        fs::remove_dir_all(desk.path("killed")).unwrap();
    }
}

/// Starts the work and kills it as soon as the journal has `units` lines.
fn kill_after(desk: &Desk, units: usize) {
    let arguments: Vec<&str> = ["generate", "--output", "killed"].iter().chain(&SMALL).copied().collect();
    let mut child = desk.command(&arguments).spawn().unwrap();
    wait_for_units(desk, "killed", units, &mut child);
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Waits until the journal of a cave folder has `units` lines, or the work is done.
fn wait_for_units(desk: &Desk, folder: &str, units: usize, worker: &mut Child) {
    let journal = desk.path(folder).join("journal.jsonl");
    let started = Instant::now();
    while fs::read_to_string(&journal).unwrap_or_default().lines().count() < units {
        assert!(started.elapsed() < Duration::from_secs(300), "no journal");
        if worker.try_wait().unwrap().is_some() {
            return;
        }
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn stages_run_one_by_one_make_the_same() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "at_once"]);
    for stage in ["graph", "mesh", "texture"] {
        desk.make(&[stage, "--output", "one_by_one"]);
    }
    assert_eq!(desk.hashes("at_once"), desk.hashes("one_by_one"));
}

#[test]
fn the_graph_file_alone_makes_the_cave_again() {
    let desk = Desk::new();
    desk.make(&["mesh", "--output", "first"]);
    fs::copy(desk.path("first/graph.json"), desk.path("alone.json")).unwrap();
    let again = desk.run(&["mesh", "alone.json", "--output", "again"]);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert_eq!(desk.hashes("first"), desk.hashes("again"));
}

#[test]
fn a_lost_file_is_made_again() {
    let desk = Desk::new();
    desk.make(&["mesh", "--output", "cave"]);
    let before = desk.hashes("cave");
    let chunk = before.iter().find(|(path, _)| path.starts_with("chunks")).unwrap().0.clone();
    fs::remove_file(desk.path("cave").join(chunk)).unwrap();
    desk.make(&["mesh", "--output", "cave"]);
    assert_eq!(before, desk.hashes("cave"));
}

#[test]
fn only_the_images_follow_the_look() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "cave"]);
    let before = desk.hashes("cave");
    let changed = |start: &str| {
        let part = |hashes: &[(String, String)]| -> Vec<(String, String)> {
            hashes.iter().filter(|(path, _)| path.starts_with(start)).cloned().collect()
        };
        part(&before) != part(&desk.hashes("cave"))
    };
    for set in ["look.humidity=0.9", "rock.colors.bed_pale=[0.5, 0.2, 0.1]"] {
        desk.make(&["generate", "--output", "cave", "--set", set, "--force"]);
        assert!(changed("textures") && !changed("chunks") && !changed("collision"), "{set}");
    }
}

#[test]
fn only_the_textures_follow_the_levels_of_detail() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "cave"]);
    let before = desk.hashes("cave");
    desk.make(&["generate", "--output", "cave", "--set", "lod.levels=1", "--force"]);
    let after = desk.hashes("cave");
    // Things have levels of their own.
    let is_coarser = |path: &str| path.contains("chunk_") && path.contains("_lod") && !path.ends_with("_lod1.ply");
    let told = |hashes: &[(String, String)]| -> Vec<(String, String)> {
        let tells = ["cave.toml", "graph.json", "manifest.json"];
        hashes.iter().filter(|(path, _)| !tells.contains(&path.as_str()) && !is_coarser(path)).cloned().collect()
    };
    assert_eq!(told(&before), told(&after));
    assert!(before.iter().any(|(path, _)| is_coarser(path)));
    assert!(!after.iter().any(|(path, _)| is_coarser(path)));
}

#[test]
fn a_scene_has_the_levels_of_its_folder_over_the_same_vertices() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "cave"]);
    let folder = CaveFolder::open(&desk.path("cave")).unwrap();
    let stop = AtomicBool::new(false);
    let recipe = Recipe::from_overrides(&[]).unwrap();
    let chunks = FolderChunks::new(&folder, &walls(&folder), &recipe, &stop);
    let mut levels = 0;
    for chunk in (0..chunks.len()).map(|index| chunks.load(index).unwrap()) {
        let full = vertices(&chunk.visual);
        for lod in &chunk.lods {
            assert!(vertices(&lod.mesh).is_subset(&full), "{}", chunk.name);
            assert!(lod.mesh.triangles() < chunk.visual.triangles() && lod.error_m > 0.0, "{}", chunk.name);
        }
        levels += chunk.lods.len();
    }
    assert!(levels > chunks.len(), "{levels}");
}

/// The units of the chunks that have a wall.
fn walls(folder: &CaveFolder) -> Vec<Unit> {
    folder.units(Stage::Mesh).into_iter().filter(|unit| !unit.files.is_empty()).collect()
}

/// Those with few triangles for their edges would not, and readers refuse them: they keep a finer level.
#[test]
fn every_level_of_a_prototype_faces_its_normals() {
    /// Share of the triangles that may face away.
    const MOST_AWAY: f64 = 0.03;
    let desk = Desk::new();
    for rock in MATERIALS.iter().map(|row| format!("rock.kind={}", row.name)) {
        desk.make(&["generate", "--output", "cave", "--force", "--set", &rock]);
        let folder = CaveFolder::open(&desk.path("cave")).unwrap();
        let (recipe, stop) = (Recipe::from_overrides(std::slice::from_ref(&rock)).unwrap(), AtomicBool::new(false));
        let prototypes = FolderChunks::new(&folder, &walls(&folder), &recipe, &stop).prototypes().unwrap();
        assert!(prototypes.len() > 10, "{rock}: {}", prototypes.len());
        for (prototype, level) in prototypes.iter().flat_map(|one| one.levels.iter().map(move |level| (one, level))) {
            let away = away_from_normals(&level.mesh) as f64;
            assert!(away <= MOST_AWAY * level.mesh.triangles() as f64, "{rock}: {away} of {}", prototype.name);
        }
    }
}

/// Number of triangles that face against the normals of their corners.
fn away_from_normals(mesh: &Mesh) -> usize {
    let is_away = |corners: &&[u32; 3]| {
        let [a, b, c] = corners.map(|corner| Vector3::from(mesh.positions[corner as usize]));
        let normals = corners.map(|corner| Vector3::from(mesh.normals[corner as usize]));
        (b - a).cross(&(c - a)).dot(&(normals[0] + normals[1] + normals[2])) <= 0.0
    };
    mesh.indices.as_chunks::<3>().0.iter().filter(is_away).count()
}

/// The bits of all that a vertex carries.
fn vertices(mesh: &Mesh) -> BTreeSet<Vec<u32>> {
    let bits = |v: usize| [&mesh.positions[v][..], &mesh.normals[v], &mesh.uvs[v], &mesh.tangents[v]].concat();
    (0..mesh.positions.len()).map(|v| bits(v).into_iter().map(f32::to_bits).collect()).collect()
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_no_partial_package_and_the_next_run_resumes() {
    let desk = Desk::new();
    desk.make(&["export", "--target", "gazebo", "--output", "whole"]);
    let arguments: Vec<&str> =
        ["export", "--target", "gazebo", "--output", "stopped"].iter().chain(&SMALL).copied().collect();
    let mut child = desk.command(&arguments).spawn().unwrap();
    wait_for_units(&desk, ".stopped.cave", 3, &mut child);
    let interrupted = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupted.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!desk.path("stopped").exists());
    desk.make(&["export", "--target", "gazebo", "--output", "stopped"]);
    assert_eq!(desk.hashes("whole"), desk.hashes("stopped"));
    assert!(!desk.path(".stopped.cave").exists());
}

#[test]
fn a_kill_before_the_first_unit_does_no_harm() {
    let desk = Desk::new();
    fs::create_dir(desk.path("cave")).unwrap();
    desk.file("cave/journal.jsonl", "\n{\"stage\": \"gra");
    desk.file("cave/cave.toml.partial", "name");
    desk.make(&["graph", "--output", "cave"]);
}

#[test]
fn a_truncated_line_only_costs_its_unit() {
    let desk = Desk::new();
    desk.make(&["mesh", "--output", "cave"]);
    let manifest = unseal(&fs::read(desk.path("cave/manifest.json")).unwrap()).unwrap();
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).unwrap();
    let line = |unit: &serde_json::Value| {
        let event = serde_json::json!({ "done": unit }).to_string();
        format!("{{\"sha256\":\"{}\",\"event\":{event}}}\n", sha256(event.as_bytes()))
    };
    let units: String = manifest["units"].as_array().unwrap().iter().map(line).collect();
    fs::write(desk.path("cave/journal.jsonl"), format!("{{\"stage\": \"me\n{units}")).unwrap();
    fs::remove_file(desk.path("cave/manifest.json")).unwrap();
    let made = CaveFolder::open(&desk.path("cave")).unwrap();
    let chunks = manifest["units"].as_array().unwrap().iter().filter(|unit| unit["stage"] == "mesh").count();
    assert_eq!(made.units(Stage::Mesh).len(), chunks);
}

#[test]
fn one_run_at_a_time_works_in_a_folder() {
    let desk = Desk::new();
    let first = CaveFolder::open_or_new(&desk.path("cave")).unwrap();
    first.begin().unwrap();
    let second = desk.run(&["graph", "--output", "cave"]);
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stderr).contains("another run"));
    drop(first);
    desk.make(&["graph", "--output", "cave"]);
}

#[test]
fn an_edited_recipe_or_graph_is_followed() {
    let desk = Desk::new();
    desk.make(&["graph", "--output", "cave"]);
    let nodes = || fs::read_to_string(desk.path("cave/graph.json")).unwrap().matches("\"id\"").count();
    let edit = |file: &str, from: &str, to: &str| {
        let text = fs::read_to_string(desk.path(file)).unwrap();
        assert!(text.contains(from));
        desk.file(file, &text.replacen(from, to, 1));
    };
    edit("cave/cave.toml", "\nnodes = 12", "\nnodes = 9");
    assert!(desk.run(&["mesh", "cave"]).status.success());
    assert_eq!(nodes(), 9);
    edit("cave/graph.json", "\"radius\":", "\"radius\":1");
    let edited = fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    assert!(desk.run(&["graph", "cave"]).status.success());
    assert_eq!(edited, fs::read_to_string(desk.path("cave/graph.json")).unwrap());
    fs::remove_file(desk.path("cave/graph.json")).unwrap();
    assert!(desk.run(&["graph", "cave"]).status.success());
    assert_eq!(nodes(), 9);
}

/// Moves the last station of a graph file and leaves the rest unchanged.
fn edit_graph(desk: &Desk) -> String {
    let text = fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    let (before, after) = text.rsplit_once("\"radius\":").unwrap();
    let edited = format!("{before}\"radius\":1{after}");
    desk.file("cave/graph.json", &edited);
    edited
}

#[test]
fn an_edited_graph_is_not_written_over() {
    let desk = Desk::new();
    desk.make(&["graph", "--output", "cave"]);
    let edited = edit_graph(&desk);
    let kept = || edited == fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    let fault = |arguments: &[&str]| desk.fault(&[arguments, &SMALL].concat());
    insta::assert_snapshot!(fault(&["graph", "--output", "cave"]));
    assert!(kept());
    assert!(fault(&["graph", "cave", "--seed", "3"]).contains("edited by hand"));
    assert!(kept());
    desk.make(&["graph", "cave", "--seed", "3", "--force"]);
    assert!(!kept());
}

#[test]
fn texture_settings_only_remake_textures() {
    let desk = Desk::new();
    desk.make(&["generate", "--output", "cave"]);
    let meshed = desk.times("cave/chunks");
    desk.make(&["generate", "cave", "--set", "texture.format=jpg"]);
    assert_eq!(meshed, desk.times("cave/chunks"));
    let images = desk.hashes("cave/textures");
    assert!(images.iter().any(|(path, _)| path.ends_with(".jpg")));
    assert!(!images.iter().any(|(path, _)| path.ends_with(".png")));
}

#[test]
fn a_folder_has_its_maps_and_draws_them_when_the_graph_changes() {
    let desk = Desk::new();
    let maps = ["cave/plan.png", "cave/profile.png"];
    let drawn = || maps.map(|map| fs::read(desk.path(map)).unwrap());
    desk.make(&["generate", "--output", "cave"]);
    let (first, times) = (drawn(), maps.map(|map| fs::metadata(desk.path(map)).unwrap().modified().unwrap()));
    for picture in &first {
        assert!(image::load_from_memory(picture).unwrap().width() > 1000);
    }
    let manifest = fs::read_to_string(desk.path("cave/manifest.json")).unwrap();
    assert!(maps.iter().all(|map| manifest.contains(&map["cave/".len()..])), "{manifest}");
    desk.make(&["generate", "cave", "--set", "texture.format=jpg"]);
    assert_eq!(times, maps.map(|map| fs::metadata(desk.path(map)).unwrap().modified().unwrap()));
    fs::remove_file(desk.path(maps[0])).unwrap();
    desk.make(&["generate", "cave"]);
    assert!(first == drawn());
    desk.make(&["mesh", "cave", "--seed", "3"]);
    assert!(first.iter().zip(&drawn()).all(|(before, now)| before != now));
}

#[test]
fn status_tells_how_far_a_folder_is() {
    let desk = Desk::new();
    let status = || String::from_utf8(desk.run(&["status", "cave"]).stdout).unwrap();
    desk.make(&["mesh", "--output", "cave"]);
    let mut told = status();
    desk.make(&["generate", "cave"]);
    told += &status();
    fs::remove_file(desk.path("cave/chunks/chunk_0_0_0.ply")).unwrap();
    told += &status();
    edit_graph(&desk);
    told += &status();
    insta::assert_snapshot!(told);
    let busy = CaveFolder::open(&desk.path("cave")).unwrap();
    busy.begin().unwrap();
    assert!(status().contains("another run is using this folder"));
}

/// A file-size limit simulates a full disk: the same code path, without a disk to fill.
#[cfg(unix)]
#[test]
fn a_disk_failure_is_reported_and_leaves_nothing_partial() {
    let desk = Desk::new();
    let plume = env!("CARGO_BIN_EXE_plume");
    let line =
        format!("trap '' XFSZ; ulimit -f 64; exec {plume} generate --output cave --threads 1 {}", quoted(&SMALL));
    let output = std::process::Command::new("bash").args(["-c", &line]).current_dir(desk.path("")).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("cave/") && stderr.contains("File too large"), "{stderr}");
    let half =
        command::files(&desk.path("cave")).into_iter().find(|path| path.extension().is_some_and(|e| e == "partial"));
    assert_eq!(half, None);
    desk.make(&["generate", "--output", "cave"]);
}

fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("'{word}' ")).collect()
}
