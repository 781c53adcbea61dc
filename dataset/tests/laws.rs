//! The laws of plans: caves follow from their numbers, parts share no seed, curves fit every generator.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use plume::cave::CaveError;
use plume::generators::GENERATORS;
use plume::pipeline::Disk;
use plume_dataset::{Item, Part, Plan, Task};
use serde_json::Value;

fn plan(text: &str) -> Result<Plan, CaveError> {
    plan_in(tempfile::tempdir().unwrap().path(), text)
}

fn plan_in(folder: &Path, text: &str) -> Result<Plan, CaveError> {
    let file = folder.join("caves.toml");
    fs::write(&file, text).unwrap();
    let plan = Plan::read(&file, Disk::default())?;
    plan.verify()?;
    Ok(plan)
}

fn items(plan: &Plan) -> Vec<Item> {
    (0..plan.len()).map(|number| plan.item(number)).collect()
}

const MIXED: &str = r#"
seeds = [5, 104]
[[vary]]
key = "graph.nodes"
draw = "uniform"
values = [10, 13]
[[vary]]
key = "look.humidity"
draw = "sobol"
values = [0.0, 1.0]
[[vary]]
key = "passage.width_min_m"
draw = "log"
values = [1.0, 8.0]
[[vary]]
key = "rock.kind"
draw = "choice"
values = ["limestone", "salt"]
[[vary]]
key = "mesh.voxel_m"
draw = "grid"
values = [0.2, 0.3, 0.4]
[[vary]]
key = "world.lights"
draw = "grid"
values = [true, false]
"#;

#[test]
fn every_seed_has_every_combination_of_the_grid_and_the_same_draws_in_all_of_them() {
    let plan = plan(MIXED).unwrap();
    let mut of_seed: BTreeMap<u64, Vec<Item>> = BTreeMap::new();
    items(&plan).into_iter().for_each(|item| of_seed.entry(item.seed).or_default().push(item));
    assert!(of_seed.keys().copied().eq(5..=104));
    for items in of_seed.values() {
        let grid = |item: &Item| item.drawn[4..].iter().map(|(_, value)| value.to_string()).collect::<String>();
        assert_eq!(items.iter().map(grid).collect::<BTreeSet<_>>().len(), 6);
        assert!(items.iter().all(|item| item.drawn[..4] == items[0].drawn[..4] && item.part == items[0].part));
    }
}

#[test]
fn draws_fill_their_ranges() {
    let plan = plan(MIXED).unwrap();
    let numbers = |key: &str| -> Vec<f64> {
        items(&plan).iter().step_by(6).map(|item| item.drawn(key).unwrap().as_f64().unwrap()).collect()
    };
    let counts = |values: &[f64], ends: &[f64]| -> Vec<usize> {
        ends.windows(2).map(|ends| values.iter().filter(|x| (ends[0]..ends[1]).contains(x)).count()).collect()
    };
    // Each of the four whole numbers, both ends among them.
    let nodes = numbers("graph.nodes");
    assert!(counts(&nodes, &[10.0, 11.0, 12.0, 13.0, 14.0]).iter().all(|count| *count > 10), "{nodes:?}");
    assert!(nodes.iter().all(|nodes| nodes.fract() == 0.0));
    // A Sobol sequence is even to one or two of a hundred.
    let wet = numbers("look.humidity");
    assert!(counts(&wet, &[0.0, 0.25, 0.5, 0.75, 1.0]).iter().all(|count| (23..=27).contains(count)), "{wet:?}");
    // As many between 1 and 2 as between 4 and 8.
    let widths = counts(&numbers("passage.width_min_m"), &[1.0, 2.0, 4.0, 8.0]);
    assert!(widths.iter().all(|count| *count > 20) && widths.iter().sum::<usize>() == 100, "{widths:?}");
    let salt = items(&plan).iter().filter(|item| item.drawn("rock.kind").unwrap() == "salt").count();
    assert!((6 * 35..6 * 65).contains(&salt), "{salt}");
}

#[test]
fn a_recipe_has_what_was_drawn_for_it() {
    let plan = plan(MIXED).unwrap();
    for item in items(&plan).iter().step_by(37) {
        let recipe = plan.input(item).unwrap().recipe;
        assert_eq!(recipe.seed(), item.seed);
        for (key, value) in &item.drawn {
            let (section, key) = key.split_once('.').unwrap();
            assert_eq!(&recipe.to_json()[section][key], value);
        }
    }
}

#[test]
fn images_that_a_target_does_not_take_are_refused_before_the_work() {
    let spec =
        |format: &str| format!("seeds = [1, 2]\ntargets = [\"glb\", \"usd\"]\nset = [\"texture.format={format}\"]\n");
    assert!(plan(&spec("png")).is_ok());
    let error = plan(&spec("webp")).err().unwrap();
    assert_eq!(error.to_string(), "target `usd` does not take texture.format = \"webp\"");
    assert!(error.hint().starts_with("formats that it takes: mixed, png, jpg; "), "{}", error.hint());
}

#[test]
fn a_cave_does_not_change_when_seeds_are_added() {
    let [few, many] = ["[5, 20]", "[5, 90]"].map(|seeds| plan(&MIXED.replace("[5, 104]", seeds)).unwrap());
    let drawn =
        |plan: &Plan| items(plan).into_iter().take(few.len()).map(|item| (item.seed, item.drawn)).collect::<Vec<_>>();
    assert_eq!(drawn(&few), drawn(&many));
}

#[test]
fn parts_have_their_shares_of_the_seeds() {
    let count = |split: &str| {
        let plan = plan(&format!("seeds = [0, 99]\n[split]\n{split}")).unwrap();
        Part::ALL.map(|part| items(&plan).iter().filter(|item| item.part == part).count())
    };
    assert_eq!(count(""), [80, 10, 10]);
    assert_eq!(count("train = 1\nvalidation = 1\ntest = 1"), [33, 34, 33]);
    assert_eq!(count("train = 0\nvalidation = 0\ntest = 1"), [0, 0, 100]);
}

#[test]
fn a_curve_fits_every_generator_at_every_difficulty() {
    // A preset has keys that not every generator has.
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plain.toml"), "").unwrap();
    for task in [Task::Drive, Task::Fly, Task::Slam] {
        // Some read files and programs, which are not there.
        let generators = GENERATORS.iter().map(|row| row.name).filter(|name| !["file", "external"].contains(name));
        let names: Vec<String> = generators.map(|name| format!("{name:?}")).collect();
        let spec = format!(
            "seeds = [1, 1]\nrecipe = \"plain.toml\"\ntask = {:?}\n[[vary]]\nkey = \"graph.generator\"\ndraw = \"grid\"\nvalues = [{}]\n\
             [[vary]]\nkey = \"difficulty\"\ndraw = \"grid\"\nvalues = [0, 0.25, 0.5, 1]\n",
            task.name(),
            names.join(", ")
        );
        let plan = plan_in(folder.path(), &spec).unwrap();
        assert_eq!(plan.len(), 4 * names.len());
        for knob in task.curve() {
            let recipe = plan.input(&plan.item(0)).unwrap().recipe;
            let (section, key) = knob.key.split_once('.').unwrap();
            let value = recipe.to_json()[section][key].as_f64();
            assert!(value.is_some_and(|value| (value - knob.easy).abs() < 1e-6), "{}: {value:?}", knob.key);
        }
    }
}

#[test]
fn what_is_varied_beats_the_curve() {
    let text = "task = \"drive\"\nset = [\"look.humidity=0.25\"]\n[[vary]]\nkey = \"difficulty\"\ndraw = \"grid\"\nvalues = [1]\n\
                [[vary]]\nkey = \"graph.nodes\"\ndraw = \"grid\"\nvalues = [7]\n";
    let plan = plan(text).unwrap();
    let recipe = plan.input(&plan.item(0)).unwrap().recipe;
    assert_eq!(recipe.to_json()["graph"]["nodes"], 7);
    assert_eq!(recipe.look().humidity, 0.25);
    assert_eq!(recipe.world().friction, 0.6);
}

#[test]
fn faults_name_line_and_key() {
    let vary = |key: &str, draw: &str, values: &str| {
        format!("\n[[vary]]\nkey = {key:?}\ndraw = {draw:?}\nvalues = {values}\n")
    };
    let faults = [
        "seeds = [3, 2]".to_owned(),
        "seeds = [0, 99999999999]".to_owned(),
        "[split]\ntrain = 0\nvalidation = 0\ntest = 0".to_owned(),
        "targets = [\"gazeboo\"]".to_owned(),
        "recipe = \"caev\"".to_owned(),
        "set = [\"graph.nods=3\"]".to_owned(),
        "task = \"swim\"".to_owned(),
        vary("graph.nodes", "uniform", "[9]"),
        vary("passage.width_min_m", "log", "[0, 2]"),
        vary("graph.nodes", "choice", "[]"),
        vary("graph.nodes", "uniform", "[1, 3]"),
        vary("difficulty", "uniform", "[0, 2]"),
        vary("seed", "uniform", "[0, 2]"),
        vary("recipe", "choice", "[1]"),
        vary("look.humidity", "choice", "[0.5]") + &vary("look.humidity", "grid", "[0.5]"),
    ];
    let told = faults.map(|text| {
        let error = plan(&text).unwrap_err();
        let hint = error.hint();
        let hint = if hint.is_empty() { hint } else { format!("\n hint: {hint}") };
        // The folder is another each time.
        let folder = std::env::temp_dir().display().to_string();
        let words = format!("{error}{hint}");
        words
            .split(&folder)
            .map(|part| part.split_once("/caves.toml").map_or(part, |(_, rest)| rest))
            .collect::<String>()
    });
    insta::assert_snapshot!(told.join("\n\n"));
}

#[test]
fn several_recipes_can_be_mixed() {
    let text = "[[vary]]\nkey = \"recipe\"\ndraw = \"grid\"\nvalues = [\"cave\", \"mine\"]\n";
    let plan = plan(text).unwrap();
    let generators: Vec<Value> = (0..2)
        .map(|number| plan.input(&plan.item(number)).unwrap().recipe.to_json()["graph"]["generator"].clone())
        .collect();
    assert_eq!(generators, ["gaussian-perlin", "mine"]);
}

fn of_project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(path)
}

#[test]
fn the_documentation_has_the_curves() {
    let text = fs::read_to_string(of_project("docs/datasets.md")).unwrap();
    for (task, knob) in
        [Task::Drive, Task::Fly, Task::Slam].iter().flat_map(|task| task.curve().iter().map(move |knob| (task, knob)))
    {
        let row = format!("| {} | `{}` | {} | {} |", task.name(), knob.key, knob.easy, knob.hard);
        assert!(text.contains(&row), "{row}");
    }
}

#[test]
fn samples_are_valid() {
    for entry in fs::read_dir(of_project("samples/datasets")).unwrap() {
        let path = entry.unwrap().path();
        Plan::read(&path, Disk::default())
            .and_then(|plan| plan.verify())
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
}
