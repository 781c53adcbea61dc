//! Recipes drawn from the schema that the program prints.

use std::time::Duration;

use serde_json::Value;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::program::{End, Outcome};
use crate::rng::Rng;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "recipes",
    tries: "numeric keys at, beyond and between their bounds, alone and in pairs; a whole cave, or a reason",
    share: 20,
    run,
};

/// Time limit: valid recipes may take arbitrarily long.
const LIMIT: Duration = Duration::from_secs(10);

/// Recipes of a short campaign: of one key each, and of two.
const FEW: [usize; 2] = [24, 20];
/// Minimum number of pairs in a long campaign, in addition to single keys.
const MANY: usize = 600;

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    let keys = match keys(context) {
        Ok(keys) => keys,
        Err(fault) => {
            tally.enter("plume schema", Err(fault));
            return tally;
        }
    };
    tally.note(format!("{} numeric keys", keys.len()));
    let alone: Vec<(&Key, Choice)> = keys.iter().flat_map(|key| CHOICES.map(|choice| (key, choice))).collect();
    for (key, choice) in context.length.some_of(&alone, FEW[0]) {
        let drawn = [key.drawn(choice, &mut context.rng)];
        try_recipe(context, &mut tally, &drawn);
    }
    for _ in context.length.rounds(FEW[1], MANY) {
        let pair = pair(&keys, &mut context.rng);
        try_recipe(context, &mut tally, &pair);
    }
    known(context, &mut tally);
    tally
}

/// A numeric key.
struct Key {
    /// As in `--set`.
    path: String,
    /// The variant that it belongs to, such as `graph.generator=mine`.
    of: Option<String>,
    least: f64,
    most: f64,
    is_whole: bool,
    /// How many numbers it takes, where it takes several.
    count: Option<usize>,
}

/// A key with a value.
struct Drawn {
    of: Option<String>,
    path: String,
    value: String,
    is_allowed: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Choice {
    Least,
    Most,
    Below,
    Above,
    Between,
}

const CHOICES: [Choice; 5] = [Choice::Least, Choice::Below, Choice::Most, Choice::Above, Choice::Between];

impl Key {
    fn drawn(&self, choice: Choice, rng: &mut Rng) -> Drawn {
        let span = self.most - self.least;
        let step = if self.is_whole { 1.0 } else { span.max(1e-3) * 1e-3 };
        let number = match choice {
            Choice::Least => self.least,
            Choice::Most => self.most,
            Choice::Below => self.least - step,
            Choice::Above => self.most + step,
            // Most keys have their usual values near the lower bound.
            Choice::Between => self.least + span * rng.unit() * rng.unit() * rng.unit(),
        };
        let number = if self.is_whole { format!("{number:.0}") } else { format!("{number:?}") };
        let value = match self.count {
            Some(count) => format!("[{}]", vec![number; count].join(", ")),
            None => number,
        };
        let is_allowed = !matches!(choice, Choice::Below | Choice::Above);
        Drawn { of: self.of.clone(), path: self.path.clone(), value, is_allowed }
    }
}

/// Two keys that can be in the same recipe.
fn pair(keys: &[Key], rng: &mut Rng) -> [Drawn; 2] {
    let one = rng.pick(keys);
    let other = loop {
        let other = rng.pick(keys);
        let same_part =
            |of: &str| other.of.as_deref().is_some_and(|it| it != of && it.split('=').next() == of.split('=').next());
        if other.path != one.path && !one.of.as_deref().is_some_and(same_part) {
            break other;
        }
    };
    let inside = [Choice::Least, Choice::Most, Choice::Between, Choice::Between];
    [one, other].map(|key| key.drawn(*rng.pick(&inside), rng))
}

/// The numeric keys of the schema with their bounds.
fn keys(context: &Context) -> Result<Vec<Key>, String> {
    let outcome = context.desk().run(&["schema"]);
    outcome.done()?;
    let schema: Value = serde_json::from_str(&outcome.stdout).map_err(|error| error.to_string())?;
    let mut keys = Vec::new();
    collect(&schema, "", None, &mut keys);
    if keys.len() < 50 { Err(format!("has {} numeric keys only", keys.len())) } else { Ok(keys) }
}

fn collect(schema: &Value, path: &str, of: Option<&str>, keys: &mut Vec<Key>) {
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        let Some(choice) = choice(variant) else { continue };
        // These take programs and files, and layers take tables.
        if !choice.ends_with("=external") && !choice.ends_with("=file") {
            collect(variant, path, Some(&format!("{path}.{choice}")), keys);
        }
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        match kind(property) {
            "object" | "" => collect(property, &path, of, keys),
            "integer" | "number" => keys.extend(key(property, &path, of, None)),
            "array" => {
                let count = property["minItems"].as_u64().unwrap_or(1) as usize;
                keys.extend(key(&property["items"], &path, of, Some(count)));
            }
            _ => {}
        }
    }
}

/// `generator=mine`, of the variant of the mine.
fn choice(variant: &Value) -> Option<String> {
    let mut properties = variant["properties"].as_object()?.iter();
    properties.find_map(|(name, property)| {
        let only = property["enum"].as_array().filter(|names| names.len() == 1)?;
        Some(format!("{name}={}", only[0].as_str()?))
    })
}

fn kind(property: &Value) -> &str {
    let kinds = &property["type"];
    kinds.as_str().or_else(|| kinds[0].as_str()).unwrap_or_default()
}

fn key(property: &Value, path: &str, of: Option<&str>, count: Option<usize>) -> Option<Key> {
    let is_whole = kind(property) == "integer";
    if !is_whole && kind(property) != "number" {
        return None;
    }
    let (least, most) = (property["minimum"].as_f64()?, property["maximum"].as_f64()?);
    Some(Key { path: path.to_owned(), of: of.map(str::to_owned), least, most, is_whole, count })
}

/// Settings that keep most recipes fast.
const SMALL: [&str; 4] = ["graph.nodes=4", "mesh.voxel_m=0.4", "texture.size_px=256", "lod.levels=1"];

fn try_recipe(context: &Context, tally: &mut Tally, drawn: &[Drawn]) {
    let mut sets: Vec<String> = drawn.iter().filter_map(|drawn| drawn.of.clone()).collect();
    sets.dedup();
    let generator = sets.iter().find(|set| set.starts_with("graph.generator="));
    // Not every generator counts nodes.
    let counts = generator.is_none_or(|set| !set.ends_with("=layers") && !set.ends_with("=tiles"));
    let is_free = |set: &&&str| drawn.iter().all(|drawn| !set.starts_with(&format!("{}=", drawn.path)));
    let small = SMALL.iter().filter(is_free).filter(|set| counts || !set.starts_with("graph.nodes"));
    sets.extend(small.map(|set| (*set).to_owned()));
    sets.extend(drawn.iter().map(|drawn| format!("{}={}", drawn.path, drawn.value)));
    make(context, tally, &sets, drawn);
}

fn make(context: &Context, tally: &mut Tally, sets: &[String], drawn: &[Drawn]) {
    let desk = context.desk();
    let mut words = vec!["generate", "-o", "c", "--quiet", "--json"];
    sets.iter().for_each(|set| words.extend(["--set", set]));
    let outcome = run_within(&desk, &words);
    if outcome.end == End::Late {
        return tally.set_apart("slow");
    }
    let refused = drawn.iter().find(|drawn| !drawn.is_allowed);
    let held = match refused {
        Some(drawn) => outcome.refused().and_then(|()| names(&outcome, &drawn.path)),
        None if outcome.is_done() => match whole(&desk, &outcome) {
            Ok(true) => Ok(()),
            Ok(false) => return tally.set_apart("slow"),
            Err(fault) => Err(fault),
        },
        None => outcome.refused(),
    };
    tally.enter(&format!("`plume {}`", words.iter().map(quoted).collect::<Vec<_>>().join(" ")), held);
}

fn quoted(word: &&str) -> String {
    if word.contains([' ', '[']) { format!("'{word}'") } else { (*word).to_owned() }
}

fn run_within(desk: &Desk, words: &[&str]) -> Outcome {
    desk.call(words).within(LIMIT).run()
}

fn names(outcome: &Outcome, key: &str) -> Result<(), String> {
    if outcome.stderr.contains(key) { Ok(()) } else { Err(outcome.told("does not name the key")) }
}

/// Checks that the result is a cave: finite numbers, a clean mesh, an intact package. Skipped if the check takes too long.
fn whole(desk: &Desk, made: &Outcome) -> Result<bool, String> {
    let told: Value =
        serde_json::from_str(&made.stdout).map_err(|error| made.told(&format!("printed no JSON ({error})")))?;
    numbers(&told, "")?;
    if told["mesh"]["triangles"].as_f64() == Some(0.0) || told["mesh"]["chunks"].as_f64() == Some(0.0) {
        return Err(made.told("made an empty cave"));
    }
    for words in [&["measure", "c", "--json"][..], &["export", "c", "-t", "obj", "-o", "out"], &["check", "out"]] {
        let outcome = run_within(desk, words);
        if outcome.end == End::Late {
            return Ok(false);
        }
        outcome.done()?;
        if words[0] == "measure" {
            let told: Value = serde_json::from_str(&outcome.stdout)
                .map_err(|error| outcome.told(&format!("printed no JSON ({error})")))?;
            numbers(&told, "")?;
        }
    }
    Ok(true)
}

/// Result keys that may be null.
const NOTHING: [&str; 1] = [".graph.sampling"];

/// Fails on −0.0, and on null where a number is expected.
fn numbers(value: &Value, place: &str) -> Result<(), String> {
    match value {
        Value::Null if NOTHING.contains(&place) => Ok(()),
        Value::Null => Err(format!("--json: {place} is null")),
        Value::Number(number) if number.as_f64().is_some_and(|x| x == 0.0 && x.is_sign_negative()) => {
            Err(format!("--json: {place} is -0.0"))
        }
        Value::Object(entries) => entries.iter().try_for_each(|(key, value)| numbers(value, &format!("{place}.{key}"))),
        Value::Array(items) => {
            items.iter().enumerate().try_for_each(|(at, value)| numbers(value, &format!("{place}[{at}]")))
        }
        _ => Ok(()),
    }
}

/// Recipes that once caused failures.
fn known(context: &Context, tally: &mut Tally) {
    let empty =
        ["seed=0", "graph.generator=karst", "graph.nodes=2", "rock.kind=basalt", "rock.wander_m=0", "mesh.voxel_m=1"];
    make(context, tally, &empty.map(str::to_owned), &[]);
}
