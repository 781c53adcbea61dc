//! Target `stl`: binary STL, Z up, metres: the shape alone.
//!
//! ```text
//! <name>.stl, or chunks/<chunk>.stl
//! README.md
//! ```
//! STL has no units or axes: both are in the header, which hardly any reader shows, and in the README. Triangles do not
//! share vertices, but neighbours have exactly the same coordinates, so that readers can merge them.

use minijinja::context;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::chunk_files::{self, ChunkFiles, TempFile, Triangles};
use crate::error::ExportError;
use crate::format::stl;
use crate::frame::Axes;
use crate::package::Package;
use crate::scene::{Chunk, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, template};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "stl",
    summary: "binary STL, the shape without colours",
    revision: 0,
    opened_by: "CAD programs, slicers, MeshLab, Blender, trimesh",
    contents: "binary STL, visual or collision mesh",
    tested_by: "numpy-stl, trimesh, Blender 4.2, assimp",
    checks: &["trimesh", "blender", "libassimp", "orient"],
    images: &[],
    is_single_file: true,
    has_pieces: false,
    bundles: &[],
    settings: plume_registry::settings_schema::<StlSettings>,
    build: Build::Plain(|table| Ok(Box::new(Stl(serde_json::from_value(table)?)))),
};

/// Settings of target `stl`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct StlSettings {
    /// Write one file per chunk instead of a single file.
    pub per_chunk: bool,
    /// Which mesh is written.
    pub mesh: Shape,
}

/// Which mesh of a chunk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// The visual mesh, in full detail.
    #[default]
    Visual,
    /// The collision mesh: fewer triangles.
    Collision,
}

/// The target.
pub struct Stl(
    /// Its settings.
    pub StlSettings,
);

impl Target for Stl {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let comment = format!("{}, made by {}; binary STL, metres, Z up", scene.name, scene.generator);
        let [visual_triangles, collision_triangles] = chunk_files::write(scene, self.0.per_chunk, out, |stem| {
            Ok(Solid { shape: self.0.mesh, comment: &comment, body: stem.grow(".stl")?, triangles: 0 })
        })?;
        let open = chunk_files::how_to_open(scene, self.0.per_chunk, "stl");
        let triangles = visual_triangles + collision_triangles;
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            stations => scene.network.has_names(),
            per_chunk => self.0.per_chunk,
            touched => self.0.mesh == Shape::Collision,
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            triangles,
        };
        let readme = include_str!("../templates/stl/README.md.jinja");
        out.text("README.md", &template::fill("README.md", readme, &values))?;
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

/// A file being written.
struct Solid<'a> {
    shape: Shape,
    comment: &'a str,
    body: TempFile,
    triangles: u64,
}

impl ChunkFiles for Solid<'_> {
    fn add(&mut self, _: &Scene, _: usize, chunk: &Chunk, _: &mut dyn Package) -> Result<Triangles, ExportError> {
        let (mesh, triangles) = match self.shape {
            Shape::Visual => (&chunk.visual, [chunk.visual.triangles(), 0]),
            Shape::Collision => (&chunk.collision, [0, chunk.collision.triangles()]),
        };
        stl::write_triangles(&mut self.body, mesh)?;
        self.triangles += mesh.triangles();
        Ok(triangles)
    }

    fn finish(self, out: &mut dyn Package) -> Result<(), ExportError> {
        if self.triangles == 0 {
            return Ok(());
        }
        let path = self.body.path().to_owned();
        let bytes = 84 + 50 * self.triangles;
        let too_large = |_| ExportError::TooLarge { path: path.clone(), format: "STL", bytes };
        let triangles = u32::try_from(self.triangles).map_err(too_large)?;
        out.write(&path, |file| {
            stl::write_head(file, self.comment, triangles)?;
            self.body.append_to(file)
        })
    }
}
