//! Target `usdz`: the stage of target `usd` and its images as one archive, for viewers and for sharing.
//!
//! Loaded as a whole: an archive has payloads too, but is read in one piece.

use std::sync::Arc;

use serde_json::json;

use crate::error::ExportError;
use crate::frame::Axes;
use crate::package::Package;
use crate::place::{Existing, Folder};
use crate::scene::Scene;
use crate::stage::{self, Library, StageSettings};
use crate::{Build, Open, Summary, Target, TargetRow};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "usdz",
    summary: "the USD stage and its textures as one archive",
    revision: 0,
    opened_by: "Isaac Sim, usdview, Blender, any USD viewer",
    contents: "the same stage and its textures as one archive",
    tested_by: "as for `isaac`",
    checks: &["usd", "usd-old", "newton", "physx", "blender", "orient"],
    images: &stage::IMAGES,
    is_single_file: true,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<StageSettings>,
    build: Build::WithUsd(|table, library| Ok(Box::new(Usdz { settings: serde_json::from_value(table)?, library }))),
};

const README: &str = include_str!("../templates/usd/README.md.jinja");

/// The target.
pub struct Usdz {
    /// Its settings.
    pub settings: StageSettings,
    /// The library that writes the layers and the archive.
    pub library: Arc<dyn Library>,
}

impl Target for Usdz {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        let contents = self.settings.contents();
        let archive = format!("{}.usdz", scene.name);
        let scratch = out.scratch()?;
        let stage = scratch.path().join("stage");
        let mut loose = Folder::create(&stage, Existing::Keep)?;
        let open = Open::Command(format!("usdview {archive}"));
        let summary = stage::write("usdz", scene, &contents, &*self.library, &mut loose, open)?;
        loose.finish()?;
        let path = scratch.path().join(&archive);
        let spec = json!({ "root": stage.join(stage::root_name(scene)), "path": path });
        self.library.call("write_usdz", &spec, Vec::new())?;
        out.copy(&archive, &path)?;
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
