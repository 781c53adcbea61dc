//! Chunks made one by one: put together they are the cave, and none is made twice.

use std::time::SystemTime;

use crate::command::Desk;

const RECIPE: &str = "graph.nodes = 12\nmesh.voxel_m = 0.25\nmesh.chunk_m = [12, 12, 12]\ntexture.size_px = 256\n";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.file("recipe.toml", RECIPE);
    desk
}

fn run(desk: &Desk, arguments: &[&str]) -> String {
    let output = desk.run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn parts_put_together_are_the_cave() {
    let desk = desk();
    run(&desk, &["generate", "recipe.toml", "-o", "whole"]);
    run(&desk, &["pieces", "recipe.toml", "-o", "whole"]);
    let counted: serde_json::Value = serde_json::from_str(&run(&desk, &["chunk", "recipe.toml", "--json"])).unwrap();
    let count = counted["chunks"].as_u64().unwrap();
    assert!(count > 4, "{count} chunks");
    let all = "mesh,things,texture,pieces";
    run(&desk, &["chunk", "recipe.toml", &format!("0-{}", count / 2), "-o", "a", "--stages", "mesh"]);
    run(&desk, &["chunk", "recipe.toml", &format!("{}-{}", count / 2 + 1, count - 1), "-o", "b", "--stages", all]);
    run(&desk, &["chunk", "recipe.toml", &format!("0-{}", count / 2), "-o", "c", "--stages", all, "--parts", "a", "b"]);
    let put_together = SystemTime::now();
    run(&desk, &["generate", "recipe.toml", "-o", "cave", "--parts", "a", "b", "c"]);
    assert_eq!(desk.hashes("cave"), desk.hashes("whole"));
    for (path, changed) in desk.times("cave") {
        let is_of_a_chunk = path.parent().unwrap() != desk.path("cave");
        assert!(!is_of_a_chunk || changed < put_together, "{} was made again", path.display());
    }
}

#[test]
fn a_part_is_an_unfinished_cave() {
    let desk = desk();
    run(&desk, &["chunk", "recipe.toml", "0", "--stages", "mesh"]);
    let status: serde_json::Value = serde_json::from_str(&run(&desk, &["status", "cave-0-0", "--json"])).unwrap();
    assert_eq!(status["finished"], false);
    let mesh = status["stages"].as_array().unwrap().iter().find(|stage| stage["stage"] == "mesh").unwrap();
    assert_eq!((&mesh["state"], &mesh["done"]), (&"partial".into(), &1.into()));
}

#[test]
fn wrong_parts_and_chunks_are_refused() {
    let desk = desk();
    run(&desk, &["chunk", "recipe.toml", "0", "-o", "part", "--stages", "mesh"]);
    let faults = [
        &["generate", "recipe.toml", "-o", "cave", "--seed", "2", "--parts", "part"][..],
        &["generate", "recipe.toml", "-o", "cave", "--parts", "part", "nothing"],
        &["chunk", "recipe.toml", "9-3"],
        &["chunk", "recipe.toml", "0", "--stages", "mesh,texure"],
    ];
    let faults: Vec<String> = faults.iter().map(|arguments| desk.fault(arguments)).collect();
    insta::assert_snapshot!(faults.join("\n"));
    assert!(!desk.path("cave").join("chunks").exists());
}
