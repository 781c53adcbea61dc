//! Target `isaac`: a USD stage for Isaac Sim 4.5 and later and for Isaac Lab, whose physics engine is PhysX.
//!
//! PhysX supports static triangle meshes, concave or not. Its other approximations are unsuitable for a cave: a convex hull
//! of a passage fills it, its convex decomposition raises the floor, and a signed distance field takes minutes of
//! preparation. The convex pieces of the scene keep their tolerance instead. Not tested in Isaac Sim itself, which is not
//! available where the tests run.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::Collision;
use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::Package;
use crate::scene::Scene;
use crate::stage::{self, Contents, Library};
use crate::{Build, Open, Summary, Target, TargetRow};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "isaac",
    summary: "USD stage for Isaac Sim: payload per chunk, triangle colliders, friction, semantic labels, start poses",
    revision: 0,
    opened_by: "Isaac Sim 4.5 and later, Isaac Lab",
    contents: "USD stage: a payload per chunk with levels of detail, UsdPreviewSurface, static triangle colliders, \
        rigid bodies of movable stones, friction, lamps, semantic labels, start poses; with `isaac.collision=merged` one \
        collision mesh for all that does not move",
    tested_by: "UsdValidation without a message, usd-validation-nvidia without a failure; usd-core 25.11 and 26.11 read \
        the same arrays; Newton drops balls; rays, balls and friction in ovphysx, the PhysX of Isaac Sim, for \
        those who [accept its licence](decisions/0031-omniverse-licence.md)",
    checks: &["usd", "usd-old", "newton", "physx", "blender", "orient"],
    images: &stage::IMAGES,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<IsaacSettings>,
    build: Build::WithUsd(|table, library| Ok(Box::new(Isaac { settings: serde_json::from_value(table)?, library }))),
};

/// Settings of target `isaac`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct IsaacSettings {
    /// Include the lights of the scene; without them only the robot's own lights shine.
    pub lights: bool,
    /// Factor on the lights. The default camera of Isaac Sim (f/5, 1/50 s, ISO 100) shows about 870 cd/m² as white, most
    /// renderers 1, so lamps of realistic strength would look black; computed, not tuned by eye.
    #[schemars(range(min = 0.0, max = 1_000_000.0))]
    pub light_scale: f64,
    /// Collision shapes: `triangles`, a concave mesh per chunk; `pieces`, convex pieces of the rock behind the wall, with
    /// separate friction for floor, wall and ceiling instead of that of the floor; `merged`, the triangles of all chunks and of
    /// the things that do not move as one mesh, the first of the stage, for the ray caster of Isaac Lab, which reads no other.
    pub collision: Shapes,
}

/// Collision shapes of a stage for Isaac Sim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shapes {
    /// A concave mesh per chunk: exactly the collision mesh of the wall, and the fastest to load.
    #[default]
    Triangles,
    /// Convex pieces of the rock behind the wall, for engines that only support convex meshes.
    Pieces,
    /// One concave mesh of all that does not move. It is in memory as a whole, and chunks cannot be unloaded without it.
    Merged,
}

impl Default for IsaacSettings {
    fn default() -> Self {
        Self { lights: true, light_scale: 870.0, collision: Shapes::Triangles }
    }
}

const README: &str = include_str!("../templates/isaac/README.md.jinja");

/// The target.
pub struct Isaac {
    /// Its settings.
    pub settings: IsaacSettings,
    /// The library that writes the layers.
    pub library: Arc<dyn Library>,
}

impl Target for Isaac {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        let contents = self.contents();
        let open = Open::Words(format!("File > Open {} in Isaac Sim", stage::root_name(scene)));
        let summary = stage::write("isaac", scene, &contents, &*self.library, out, open)?;
        stage::write_readme(README, scene, &contents, &summary, out)?;
        Ok(summary)
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.contents().wants_pieces()
    }

    fn moves_things(&self) -> bool {
        self.contents().moves_things()
    }
}

impl Isaac {
    fn contents(&self) -> Contents {
        let light_scale = if self.settings.lights { self.settings.light_scale } else { 0.0 };
        let shapes = self.settings.collision;
        let physics = Some(if shapes == Shapes::Pieces { Collision::Pieces } else { Collision::Triangles });
        Contents { physics, is_merged: shapes == Shapes::Merged, light_scale, omniverse_view: true }
    }
}
