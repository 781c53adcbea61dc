//! Target `usd`: the plain stage, for usdview, Houdini, Blender, Omniverse and simulators that read UsdPhysics.

use std::sync::Arc;

use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::Package;
use crate::scene::Scene;
use crate::stage::{self, Library, StageSettings};
use crate::{Build, Open, Summary, Target, TargetRow};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "usd",
    summary: "USD stage with a payload per chunk, levels of detail, UsdPreviewSurface and UsdPhysics",
    revision: 0,
    opened_by: "usdview, Omniverse, Houdini, Blender, Newton",
    contents: "the stage of `isaac` for any USD application",
    tested_by: "as for `isaac`; Blender 4.2",
    checks: &["usd", "usd-old", "newton", "physx", "blender", "orient"],
    images: &stage::IMAGES,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<StageSettings>,
    build: Build::WithUsd(|table, library| Ok(Box::new(Usd { settings: serde_json::from_value(table)?, library }))),
};

const README: &str = include_str!("../templates/usd/README.md.jinja");

/// The target.
pub struct Usd {
    /// Its settings.
    pub settings: StageSettings,
    /// The library that writes the layers.
    pub library: Arc<dyn Library>,
}

impl Target for Usd {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        let contents = self.settings.contents();
        let open = Open::Command(format!("usdview {}", stage::root_name(scene)));
        let summary = stage::write("usd", scene, &contents, &*self.library, out, open)?;
        stage::write_readme(README, scene, &contents, &summary, out)?;
        Ok(summary)
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.settings.contents().wants_pieces()
    }

    fn moves_things(&self) -> bool {
        self.settings.contents().moves_things()
    }
}
