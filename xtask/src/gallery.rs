//! `cargo xtask gallery`: the picture beside each sample recipe, as three.js shows its GLB, or the plan where the sample is
//! about a generator.

use std::path::{Path, PathBuf};

use crate::interop;
use crate::plume::{Plume, Profile};
use crate::samples::{self, SAMPLES};
use crate::tools::{Result, root};

/// Finer than the default, since the camera stands a metre from the wall; much finer fills the memory of the browser.
const DENSITY: &str = "texture.density_px_per_m=100";

/// The viewpoint: the start pose of each sample that shows most.
const SPAWNS: [usize; SAMPLES.len()] = [0, 2, 0, 0];

/// The recipe with an external graph program.
const PROGRAM: &str = "examples/external/decline.toml";

/// Renders the pictures.
pub fn run(_arguments: &[String]) -> Result<()> {
    let plume = Plume::build(Profile::Release)?;
    for (name, spawn) in SAMPLES.iter().zip(SPAWNS) {
        let (recipe, output) = (format!("samples/{name}.toml"), format!("target/gallery/{name}"));
        plume.output(&["export", &recipe, "--target", "glb", "--output", &output, "--force", "--set", DENSITY])?;
        let picture = root().join(format!("samples/{name}.png"));
        println!("{}", interop::shoot(&root().join(output), &picture, spawn)?);
    }
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
