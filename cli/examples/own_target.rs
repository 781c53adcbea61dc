//! The `plume` command with a target of its own: a point cloud as text, one line for each vertex of the wall.
//!
//! The package is a folder or an archive like any other: it appears whole or not at all, has a manifest, and `plume check`
//! checks it.
//!
//! ```text
//! cargo run --release --example own_target -- export --target xyz --option xyz.keep_every=10 --output cloud
//! ```

use std::error::Error;
use std::process::ExitCode;

use plume::exporters::frame::Axes;
use plume::exporters::package::Package;
use plume::exporters::scene::Scene;
use plume::exporters::{ExportError, Open, Summary, TARGETS, Target, TargetRow};
use plume::registry::RegisterError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the target.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct Xyz {
    /// Writes one vertex in this many.
    #[schemars(range(min = 1, max = 1000))]
    keep_every: usize,
}

impl Default for Xyz {
    fn default() -> Self {
        Self { keep_every: 1 }
    }
}

impl Target for Xyz {
    /// One chunk at a time, so that memory does not grow with the cave.
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let mut visual_triangles = 0;
        out.write(&format!("{}.xyz", scene.name), |file| {
            for index in 0..scene.chunks.len() {
                let chunk = scene.chunk(index)?;
                visual_triangles += chunk.visual.triangles();
                for [x, y, z] in chunk.visual.positions.iter().step_by(self.keep_every) {
                    writeln!(file, "{x} {y} {z}")?;
                }
            }
            Ok(())
        })?;
        let open = format!("open {}.xyz in CloudCompare or MeshLab", scene.name);
        Ok(Summary { visual_triangles, collision_triangles: 0, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

/// Before any target is asked for.
pub fn register() -> Result<(), RegisterError> {
    TARGETS.register(TargetRow {
        opened_by: "CloudCompare, MeshLab",
        images: &[],
        ..TargetRow::new::<Xyz>("xyz", "a point cloud as text")
    })
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    register()?;
    Ok(plume_cli::run(std::env::args_os(), &plume_cli::Host::Binary).into())
}
