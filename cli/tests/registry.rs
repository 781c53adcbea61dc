//! A generator, a rock and a target written outside of Plume are found wherever the built-in ones are.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[allow(dead_code, reason = "its main is not called")]
#[path = "../examples/own_generator.rs"]
mod own_generator;
#[allow(dead_code, reason = "its main is not called")]
#[path = "../examples/own_rock.rs"]
mod own_rock;
#[allow(dead_code, reason = "its main is not called")]
#[path = "../examples/own_target.rs"]
mod own_target;

use std::ffi::OsString;
use std::fs;

use plume::exporters::check::check;
use plume::generators::GENERATORS;
use plume::graph::NoOutside;
use plume::material::{MATERIALS, MaterialRow};
use plume::recipe::Recipe;
use plume::registry::RegisterError;

/// The command in this process, in which the rows are registered; gives its exit code.
fn plume(words: &[&str]) -> u8 {
    let words = ["plume", "--quiet"].iter().chain(words).map(OsString::from);
    plume_cli::run(words, &plume_cli::Host::Binary)
}

/// In one test, because registrations last for the whole process.
#[test]
fn a_registered_generator_works_in_recipes_layers_and_commands() {
    let settings = ["graph.generator=spiral".to_owned(), "graph.turns=2".to_owned()];
    let unknown = Recipe::from_overrides(&settings).unwrap_err().to_string();
    assert!(unknown.contains("spiral"), "{unknown}");

    own_generator::register().unwrap();
    assert_eq!(own_generator::register(), Err(RegisterError::Taken("spiral")));
    assert_eq!(GENERATORS.iter().last().unwrap().name, "spiral");

    let recipe = Recipe::from_overrides(&settings).unwrap();
    assert_eq!(recipe.graph().generate(7, &NoOutside).unwrap().nodes.len(), 33);
    assert!(recipe.to_toml().contains("Number of turns around the shaft"), "{}", recipe.to_toml());
    let out_of_range = recipe.with("graph.turns", 51).unwrap_err().to_string();
    assert!(out_of_range.contains("graph.turns"), "{out_of_range}");

    let layer = serde_json::json!({"generator": "spiral", "turns": 1});
    let layers = Recipe::from_overrides(&["graph.generator=layers".to_owned()]).unwrap();
    layers.with("graph.layer", [layer.clone(), layer]).unwrap();

    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("cave").into_os_string().into_string().unwrap();
    assert_eq!(plume(&["graph", "--set", "graph.generator=spiral", "--output", &output]), 0);
    let graph = fs::read_to_string(folder.path().join("cave/graph.json")).unwrap();
    assert!(graph.contains("\"generator\": \"spiral\"") || graph.contains("\"generator\":\"spiral\""), "{graph}");
}

#[test]
fn a_registered_rock_and_target_work_in_commands() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).into_os_string().into_string().unwrap();
    let (cave, cloud) = (path("cave"), path("cloud"));
    let settings = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256", "rock.kind=gypsum", "rock.bed_m=2"];
    let export = |options: &[&str]| {
        let set = settings.iter().flat_map(|pair| ["--set", *pair]);
        let words = ["export", "--target", "xyz", "--output", &cloud, "--keep", &cave, "--force"];
        plume(&words.into_iter().chain(options.iter().copied()).chain(set).collect::<Vec<_>>())
    };
    assert_eq!(export(&[]), 2, "neither is registered");

    own_rock::register().unwrap();
    own_target::register().unwrap();
    assert_eq!(own_rock::register(), Err(RegisterError::Taken("gypsum")));
    assert_eq!(own_target::register(), Err(RegisterError::Taken("xyz")));
    assert_eq!(export(&[]), 0);
    assert!(check(cloud.as_ref()).unwrap().is_whole());
    let points = fs::read_to_string(path("cloud/cave.xyz")).unwrap().lines().count();
    assert_eq!(export(&["--option", "xyz.keep_every=10"]), 0);
    let kept = fs::read_to_string(path("cloud/cave.xyz")).unwrap().lines().count();
    assert!(kept >= points / 10 && kept < points / 9, "{kept} of {points}");
    assert_eq!(export(&["--option", "xyz.keep_every=many"]), 2);
}

#[test]
fn a_revised_rock_is_another_version() {
    let row = |name| MaterialRow::new::<own_rock::Gypsum>(name, "gypsum");
    MATERIALS.register(row("gypsum-1")).unwrap();
    MATERIALS.register(row("gypsum-2").revised(2)).unwrap();
    let version = |kind: &str| Recipe::from_overrides(&[format!("rock.kind={kind}")]).unwrap().version();
    assert_eq!(version("gypsum-1"), plume::VERSION);
    assert_eq!(version("gypsum-2"), format!("{} revision 2", plume::VERSION));
}
