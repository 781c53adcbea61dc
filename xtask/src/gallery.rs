//! `cargo xtask gallery`: the picture beside each sample recipe. A path tracer shows the exported package with the settings of
//! the recipe, so a picture shows what users get; samples about a generator have a plan instead.

use std::path::{Path, PathBuf};

use crate::interop;
use crate::plume::{Plume, Profile};
use crate::samples::{self, SAMPLES};
use crate::tools::{Result, root};

/// A picture: the sample, the start pose where the camera is, and the name of the file.
const SCENES: [(&str, usize, &str); 6] = [
    ("cave", 2, "cave"),
    ("cave", 1, "keyhole"),
    ("lava-tube", 1, "lava-tube"),
    ("mine", 0, "mine"),
    ("salt-mine", 0, "salt-mine"),
    ("original", 0, "original"),
];

/// The recipe with an external graph program.
const PROGRAM: &str = "examples/external/decline.toml";

/// Renders the pictures.
pub fn run(_arguments: &[String]) -> Result<()> {
    let plume = Plume::build(Profile::Dev)?;
    for (sample, spawn, name) in SCENES {
        let (recipe, output) = (format!("samples/{sample}.toml"), format!("target/gallery/{sample}"));
        plume.output(&["export", &recipe, "--target", "glb", "--output", &output, "--force"])?;
        let picture = root().join(format!("samples/{name}.jpg"));
        println!("{}", interop::picture(&root().join(output), &picture, spawn)?);
    }
    let pictures = SCENES.map(|(_, _, name)| root().join(format!("samples/{name}.jpg")));
    println!("{}", interop::contrast(&pictures)?);
    plans(&plume)?;
    let inside = ["preview", "samples/cave.toml", "--view", "inside", "--size", "960x540"];
    plume.output(&[&inside[..], &["--output", "samples/inside.png"]].concat()).map(drop)
}

/// The plans of the recipes that have no picture of their rock.
fn plans(plume: &Plume) -> Result<()> {
    let is_meshed = |recipe: &Path| SAMPLES.iter().any(|name| recipe.ends_with(format!("{name}.toml")));
    let samples = samples::recipes()?.into_iter().filter(|recipe| !is_meshed(recipe));
    for recipe in samples.chain([PathBuf::from(PROGRAM)]) {
        let (recipe, picture) = (recipe.display().to_string(), recipe.with_extension("png").display().to_string());
        let plan = ["preview", &recipe, "--allow-run", "--view", "plan", "--size", "900x560", "--output", &picture];
        plume.output(&plan)?;
        println!("{picture}");
    }
    Ok(())
}
