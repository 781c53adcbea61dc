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

/// Settings that can be seen, with four values from their range, and the rock and the generator of the pictures.
pub const SETTINGS: [(&str, [&str; 4], [&str; 2]); 14] = [
    ("passage.width_per_radius", ["0.3", "0.6", "0.9", "1.3"], ["limestone", "gaussian-perlin"]),
    ("passage.height_ratio", ["0.6", "1.1", "1.6", "2.2"], ["limestone", "gaussian-perlin"]),
    ("passage.collapse", ["0", "0.7", "1.3", "2"], ["limestone", "gaussian-perlin"]),
    ("rock.relief", ["0", "0.5", "1", "1.5"], ["limestone", "gaussian-perlin"]),
    ("rock.flowstone", ["-0.6", "-0.2", "0.2", "0.6"], ["limestone", "gaussian-perlin"]),
    ("rock.bed_m", ["0.4", "0.62", "1", "1.5"], ["limestone", "gaussian-perlin"]),
    ("rock.rubble", ["-0.5", "-0.2", "0.1", "0.5"], ["limestone", "cellular"]),
    ("rock.overbreak", ["-0.6", "-0.2", "0.2", "0.6"], ["drilled", "gaussian-perlin"]),
    ("look.humidity", ["0", "0.3", "0.6", "1"], ["limestone", "gaussian-perlin"]),
    ("look.stain", ["0", "0.5", "1", "1.5"], ["limestone", "cellular"]),
    ("things.cover", ["0", "0.06", "0.2", "0.4"], ["limestone", "cellular"]),
    ("things.dripstone", ["0", "0.5", "1", "2"], ["limestone", "cellular"]),
    ("things.artefacts", ["0", "20", "100", "400"], ["drilled", "mine"]),
    ("world.light_spacing_m", ["4", "9", "18", "40"], ["limestone", "gaussian-perlin"]),
];

/// Draws all, or those whose name is an argument.
pub fn run(arguments: &[String]) -> Result<()> {
    let plume = Plume::build(Profile::Dev)?;
    let is_wanted = |name: &str| arguments.is_empty() || arguments.iter().any(|argument| argument == name);
    for (key, values, [rock, generator]) in SETTINGS.iter().filter(|(key, ..)| is_wanted(key)) {
        let of = |value| [cave(generator, rock), vec![format!("{key}={value}")]].concat();
        draw(&plume, key, &values.map(of))?;
    }
    for generator in GENERATORS.into_iter().filter(|name| is_wanted(name)) {
        draw(&plume, generator, &ROCKS.map(|rock| cave(generator, rock)))?;
    }
    Ok(())
}

/// The settings of a cave. The layers of a cave have stations of their own.
fn cave(generator: &str, rock: &str) -> Vec<String> {
    let size = (generator != "layers").then(|| NODES.to_owned());
    [format!("graph.generator={generator}"), format!("rock.kind={rock}")].into_iter().chain(size).collect()
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
        let set = settings.iter().flat_map(|setting| ["--set", setting.as_str()]);
        let drawn = ["preview", "--view", "inside", "--size", SIZE, "--output", &output];
        plume.output(&drawn.into_iter().chain(set).collect::<Vec<_>>())?;
        parts.push(part);
    }
    let strip = root().join(picture(name));
    interop::side_by_side(&parts, &strip)?;
    println!("{}", strip.display());
    Ok(())
}
