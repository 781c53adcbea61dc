//! Models of the user as things: errors word by word, the same bytes on any number of threads, and folders that keep them.

use std::fs;
use std::path::Path;

use crate::command;
use command::{Desk, SMALL, files};
use insta::assert_snapshot;
use plume_exporters::check::check;

const RECIPE: &str = "[[things.files]]\nname = \"crate\"\npath = \"crate.obj\"\ncount = 6\n";

/// A desk with the crate of the samples, its recipe beside it.
fn desk() -> Desk {
    let desk = Desk::new();
    for name in ["crate.obj", "crate.mtl"] {
        fs::copy(Path::new("../samples/models").join(name), desk.path(name)).unwrap();
    }
    desk.file("cave.toml", RECIPE);
    desk
}

#[test]
fn faulty_entries_are_reported() {
    let desk = desk();
    let entry = |name: &str, path: &str| format!("[[things.files]]\nname = \"{name}\"\npath = \"{path}\"\n");
    let entries = [("boulder", "a.glb"), ("crate", "b.glb"), ("crate", "c.fbx"), ("My Crate", ""), ("con", "d.obj")];
    for (snapshot, entries) in [("model_entries", &entries[..3]), ("model_entries_by_form", &entries[3..])] {
        let text: String = entries.iter().map(|(name, path)| entry(name, path)).collect();
        desk.file("cave.toml", &text);
        assert_snapshot!(snapshot, desk.fault(&["generate", "cave.toml"]));
    }
    desk.file("cave.toml", "[[things.files]]\ncount = 0\n");
    assert_snapshot!("model_entry_without_a_name", desk.fault(&["generate", "cave.toml"]));
}

#[test]
fn faulty_models_are_reported() {
    let desk = desk();
    let fault = |desk: &Desk| desk.fault(&["generate", "cave.toml"]);
    desk.file("cave.toml", &RECIPE.replace("crate.obj", "nowhere/crate.obj"));
    assert_snapshot!("model_missing", fault(&desk));
    desk.file("crate.glb", "a text");
    desk.file("cave.toml", &RECIPE.replace("crate.obj", "crate.glb"));
    assert_snapshot!("model_of_another_format", fault(&desk));
    desk.file("cave.toml", &format!("{RECIPE}scale = 100.0\n"));
    assert_snapshot!("model_too_large", fault(&desk));
    desk.file("cave.toml", RECIPE);
    let text = fs::read_to_string(desk.path("crate.obj")).unwrap();
    desk.file("crate.obj", text.rsplit_once("f ").unwrap().0);
    assert_snapshot!("model_open", fault(&desk));
    desk.file("crate.obj", &text.replace("crate.mtl", "../crate.mtl"));
    assert_snapshot!("model_outside", fault(&desk));
    fs::remove_file(desk.path("crate.mtl")).unwrap();
    desk.file("crate.obj", &text);
    assert_snapshot!("model_without_its_materials", fault(&desk));
    assert!(!desk.path("cave").exists());
}

#[test]
fn models_make_the_same_bytes_on_any_number_of_threads() {
    let desk = desk();
    desk.make(&["things", "cave.toml", "--output", "one", "--threads", "1"]);
    desk.make(&["things", "cave.toml", "--output", "many", "--threads", "4"]);
    assert_eq!(desk.hashes("one"), desk.hashes("many"));
    let things: String = files(&desk.path("one/things")).iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    assert!(things.contains("\"crate\""), "{things}");
}

/// The folder has all that it needs, and follows a changed model: its things alone are made again.
#[test]
fn folders_keep_models_and_follow_their_changes() {
    let desk = desk();
    desk.make(&["generate", "cave.toml", "--output", "cave"]);
    let whole = desk.hashes("cave");
    for name in ["crate.obj", "crate.mtl"] {
        let path = format!("models/crate/{name}");
        assert_eq!(fs::read(desk.path(name)).unwrap(), fs::read(desk.path("cave").join(path)).unwrap());
        fs::remove_file(desk.path(name)).unwrap();
    }
    fs::remove_file(desk.path("cave/textures/things.ply")).unwrap();
    assert!(desk.run(&["generate", "cave"]).status.success());
    assert_eq!(whole, desk.hashes("cave"));
    let changed = desk.path("cave/models/crate/crate.mtl");
    let text = fs::read_to_string(&changed).unwrap();
    fs::write(&changed, text.replace("Kd 0.02", "Kd 0.5")).unwrap();
    assert!(desk.run(&["generate", "cave"]).status.success());
    let now = desk.hashes("cave");
    let remade: Vec<&str> = whole.iter().filter(|file| !now.contains(file)).map(|(path, _)| path.as_str()).collect();
    assert_eq!(remade, ["manifest.json", "models/crate/crate.mtl", "textures/things_base_color.jpg"]);
}

#[test]
fn packages_have_models_among_their_things() {
    let desk = desk();
    let all = ["export", "cave.toml", "--target", "gltf,mujoco", "--output", "packages"];
    assert!(desk.run(&[&all[..], &SMALL].concat()).status.success());
    for target in ["gltf", "mujoco"] {
        let package = desk.path("packages").join(target);
        assert!(check(&package).unwrap().is_whole(), "{target}");
        let instances = fs::read_to_string(package.join("instances.json")).unwrap();
        assert!(instances.contains("\"crate\""), "{target}: {instances}");
    }
}
