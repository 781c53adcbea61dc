//! `cargo xtask gallery`: the picture beside each sample recipe, as three.js shows its GLB.

use crate::judge::{self, SAMPLES};
use crate::plume::Plume;
use crate::tools::{Result, root};

/// Finer than the default, since the camera stands a metre from the wall; much finer fills the memory of the browser.
const DENSITY: &str = "texture.density_px_per_m=100";

/// Where to stand: the spawn pose of each sample that shows the most.
const SPAWNS: [usize; SAMPLES.len()] = [0, 2, 0, 0];

/// Makes the pictures.
pub fn run(_arguments: &[String]) -> Result<()> {
    let plume = Plume::build()?;
    for (name, spawn) in SAMPLES.iter().zip(SPAWNS) {
        let (recipe, output) = (format!("samples/{name}.toml"), format!("target/gallery/{name}"));
        plume.output(&["export", &recipe, "--target", "glb", "--output", &output, "--force", "--set", DENSITY])?;
        let picture = root().join(format!("samples/{name}.png"));
        println!("{}", judge::shoot(&root().join(output), &picture, spawn)?);
    }
    Ok(())
}
