//! Recipes to start from: `plume new`, and the schema behind it.

use std::fs;

use crate::command::Desk;
use insta::assert_snapshot;

#[test]
fn the_printed_recipe_reads_back_as_itself() {
    let desk = Desk::new();
    for preset in ["cave", "lava-tube", "mine", "layers"] {
        let printed = String::from_utf8(desk.run(&["new", "--preset", preset]).stdout).unwrap();
        desk.file("printed.toml", &printed);
        let made = desk.run(&["graph", "printed.toml", "--output", preset, "--json"]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let kept = fs::read_to_string(desk.path(preset).join("cave.toml")).unwrap();
        let (schema, printed) = printed.split_once("\n\n").unwrap();
        assert!(schema.starts_with("#:schema https://") && schema.ends_with("/docs/recipe.schema.json"), "{schema}");
        let (recipe, last_line) = kept.trim_end().rsplit_once('\n').unwrap();
        assert_eq!((printed.trim_end(), last_line), (recipe.trim_end(), "# End of the recipe: keep this line."));
    }
}

#[test]
fn a_recipe_file_can_be_started_from_like_a_preset() {
    let desk = Desk::new();
    fs::create_dir(desk.path("own")).unwrap();
    desk.file("own/cave.toml", "[graph]\ngenerator = \"file\"\npath = \"a.json\"\n\n[rock]\nkind = \"basalt\"\n");
    let printed = |arguments: &[&str]| {
        let output = desk.run(&[&["new", "--preset"], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let recipe = printed(&["own/cave.toml", "--set", "seed=9"]);
    // The path leads there from where the recipe is printed.
    for line in ["seed = 9", "path = \"own/a.json\"", "kind = \"basalt\""] {
        assert!(recipe.lines().any(|other| other == line), "{line}: {recipe}");
    }
    fs::copy(desk.path("own/cave.toml"), desk.path("own.toml")).unwrap();
    let mine = printed(&["own.toml", "--set", "graph.generator=mine"]);
    assert!(mine.contains("\ngenerator = \"mine\"\n") && mine.contains("\nkind = \"basalt\"\n"), "{mine}");
    assert_snapshot!("no_such_preset_file", desk.fault(&["new", "--preset", "none.toml"]));
    desk.file("own.toml", "sed = 3\n");
    assert_snapshot!("faulty_preset_file", desk.fault(&["new", "--preset", "./own.toml"]));
}

#[test]
fn every_generator_and_rock_can_be_chosen_in_a_new_recipe() {
    let desk = Desk::new();
    let listed: serde_json::Value = serde_json::from_slice(&desk.run(&["list", "--json"]).stdout).unwrap();
    let names = |table: &str| -> Vec<String> {
        listed[table].as_array().unwrap().iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect()
    };
    let generators = names("generators").into_iter().map(|name| ("graph.generator", "generator", name));
    let rocks = names("materials").into_iter().map(|name| ("rock.kind", "kind", name));
    let choices: Vec<_> = generators.chain(rocks).collect();
    for preset in names("presets") {
        for (path, key, name) in &choices {
            let made = desk.run(&["new", "--preset", &preset, "--set", &format!("{path}={name}")]);
            let said = String::from_utf8_lossy(&made.stderr);
            assert!(made.status.success(), "{preset} {name}: {said}");
            let recipe = String::from_utf8(made.stdout).unwrap();
            assert!(recipe.contains(&format!("\n{key} = \"{name}\"\n")), "{preset} {name}");
        }
    }
    let printed = desk.run(&["new", "--set", "graph.generator=mine", "--set", "graph.levels=3"]).stdout;
    assert!(String::from_utf8(printed).unwrap().contains("\nlevels = 3\n"));
}

#[test]
fn every_key_is_documented_with_its_range() {
    let desk = Desk::new();
    let schema: serde_json::Value = serde_json::from_slice(&desk.run(&["schema"]).stdout).unwrap();
    for (section, schema) in schema["properties"].as_object().unwrap() {
        let variants = schema["oneOf"].as_array().cloned().unwrap_or_else(|| vec![schema.clone()]);
        for (key, schema) in variants.iter().filter_map(|v| v["properties"].as_object()).flatten() {
            assert!(schema["description"].is_string(), "{section}.{key} says nothing");
            for number in [schema, &schema["items"]] {
                let kinds = number["type"].to_string();
                let is_number = kinds.contains("integer") || kinds.contains("number");
                let has_range = number["minimum"].is_number() && number["maximum"].is_number();
                assert!(!is_number || has_range, "{section}.{key} has no range: {schema}");
            }
        }
    }
}
