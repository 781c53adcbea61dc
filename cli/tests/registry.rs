//! A generator written outside of Plume is found wherever the built-in ones are.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[allow(dead_code, reason = "its main is not called")]
#[path = "../examples/own_generator.rs"]
mod own_generator;

use std::ffi::OsString;

use plume::generators::GENERATORS;
use plume::graph::Nowhere;
use plume::recipe::Recipe;
use plume::registry::RegisterError;

/// In one test, because what is registered stays for the whole process.
#[test]
fn a_generator_of_ones_own_works_in_recipes_layers_and_commands() {
    let settings = ["graph.generator=spiral".to_owned(), "graph.turns=2".to_owned()];
    let unknown = Recipe::from_overrides(&settings).unwrap_err().to_string();
    assert!(unknown.contains("spiral"), "{unknown}");

    own_generator::register().unwrap();
    assert_eq!(own_generator::register(), Err(RegisterError::Taken("spiral")));
    assert_eq!(GENERATORS.iter().last().unwrap().name, "spiral");

    let recipe = Recipe::from_overrides(&settings).unwrap();
    assert_eq!(recipe.graph().generate(7, &Nowhere).unwrap().nodes.len(), 33);
    assert!(recipe.to_toml().contains("Number of turns around the shaft"), "{}", recipe.to_toml());
    let out_of_range = recipe.with("graph.turns", 51).unwrap_err().to_string();
    assert!(out_of_range.contains("graph.turns"), "{out_of_range}");

    let layer = serde_json::json!({"generator": "spiral", "turns": 1});
    let layers = Recipe::from_overrides(&["graph.generator=layers".to_owned()]).unwrap();
    layers.with("graph.layer", [layer.clone(), layer]).unwrap();

    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("cave").into_os_string();
    let words = ["plume", "graph", "--quiet", "--set", "graph.generator=spiral", "--output"].map(OsString::from);
    assert_eq!(plume_cli::run(words.into_iter().chain([output]), &plume_cli::Host::Binary), 0);
    let graph = std::fs::read_to_string(folder.path().join("cave/graph.json")).unwrap();
    assert!(graph.contains("\"generator\": \"spiral\"") || graph.contains("\"generator\":\"spiral\""), "{graph}");
}
