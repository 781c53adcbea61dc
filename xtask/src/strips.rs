//! `cargo xtask strips`: pictures side by side for the documentation, of caves that differ in one thing: what a setting changes, and
//! each generator in every rock. They are previews, which take seconds, not renderings.

use std::fs;
use std::path::{Path, PathBuf};

use crate::interop;
use crate::plume::{Plume, Profile};
use crate::tools::{Result, root};

/// Where they are, relative to the repository.
const FOLDER: &str = "docs/pictures";
/// Width and height of each picture.
const SIZE: &str = "240x150";
/// Stations of each cave: enough for a passage with a bend.
const NODES: &str = "graph.nodes=20";

/// The rocks, in the order of the pictures of a generator.
const ROCKS: [&str; 4] = ["limestone", "basalt", "drilled", "salt"];
/// The generators that need no file or program.
const GENERATORS: [&str; 11] = [
    "gaussian-perlin",
    "mine",
    "layers",
    "grown-tunnels",
    "cellular",
    "worms",
    "karst",
    "heightmap",
    "tiles",
    "space-colonization",
    "l-system",
];

/// Settings that can be seen, with four values from their range, and the rock of the pictures.
pub const SETTINGS: [(&str, [&str; 4], &str); 14] = [
    ("passage.width_per_radius", ["0.3", "0.6", "0.9", "1.3"], "limestone"),
    ("passage.height_ratio", ["0.6", "1.1", "1.6", "2.2"], "limestone"),
    ("passage.collapse", ["0", "0.7", "1.3", "2"], "limestone"),
    ("rock.relief", ["0", "0.5", "1", "1.5"], "limestone"),
    ("rock.flowstone", ["-0.6", "-0.2", "0.2", "0.6"], "limestone"),
    ("rock.bed_m", ["0.4", "0.62", "1", "1.5"], "limestone"),
    ("rock.rubble", ["-0.5", "-0.2", "0.1", "0.5"], "limestone"),
    ("rock.overbreak", ["-0.6", "-0.2", "0.2", "0.6"], "drilled"),
    ("look.humidity", ["0", "0.3", "0.6", "1"], "limestone"),
    ("look.stain", ["0", "0.5", "1", "1.5"], "limestone"),
    ("things.cover", ["0", "0.06", "0.2", "0.4"], "limestone"),
    ("things.dripstone", ["0", "0.5", "1", "2"], "limestone"),
    ("things.artefacts", ["0", "20", "100", "400"], "drilled"),
    ("world.light_spacing_m", ["4", "9", "18", "40"], "limestone"),
];

/// Draws all, or those whose name is an argument.
pub fn run(arguments: &[String]) -> Result<()> {
    let plume = Plume::build(Profile::Dev)?;
    let is_wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|argument| argument == name);
    for (key, values, rock) in SETTINGS.iter().filter(|(key, ..)| is_wanted(key)) {
        let rock = format!("rock.kind={rock}");
        draw(&plume, key, &values.map(|value| vec![rock.clone(), format!("{key}={value}")]))?;
    }
    for generator in GENERATORS.into_iter().filter(|name| is_wanted(name)) {
        let chosen = format!("graph.generator={generator}");
        draw(&plume, generator, &ROCKS.map(|rock| vec![chosen.clone(), format!("rock.kind={rock}")]))?;
    }
    Ok(())
}

/// All of them, relative to the repository.
pub fn all() -> impl Iterator<Item = PathBuf> {
    SETTINGS.iter().map(|(key, ..)| *key).chain(GENERATORS).map(picture)
}

/// The picture of a setting or a generator, relative to the repository.
pub fn picture(name: &str) -> PathBuf {
    Path::new(FOLDER).join(format!("{name}.jpg"))
}

fn draw(plume: &Plume, name: &str, caves: &[Vec<String>; 4]) -> Result<()> {
    let scratch = root().join("target/strips");
    fs::create_dir_all(&scratch).map_err(|error| format!("{}: {error}", scratch.display()))?;
    let mut parts = Vec::new();
    for (number, settings) in caves.iter().enumerate() {
        let part = scratch.join(format!("{name}-{number}.png"));
        let output = part.display().to_string();
        let set = settings.iter().map(String::as_str).chain([NODES]).flat_map(|setting| ["--set", setting]);
        let drawn = ["preview", "--view", "inside", "--size", SIZE, "--output", &output];
        plume.output(&drawn.into_iter().chain(set).collect::<Vec<_>>())?;
        parts.push(part);
    }
    let strip = root().join(picture(name));
    interop::side_by_side(&parts, &strip)?;
    println!("{}", strip.display());
    Ok(())
}
