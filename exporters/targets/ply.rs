//! Target `ply`: binary PLY with normals, colours and labels per vertex, Z up, metres: for point cloud and mesh tools, and
//! as training data.
//!
//! ```text
//! <name>.ply, or chunks/<chunk>.ply
//! README.md
//! ```
//! Colours are sampled from the base colour image at the vertices; detail finer than the distance of vertices is lost.
//!
//! Labels of the wall are those of target `isaac`: a face that faces up or down within 45° is floor or ceiling, the others are
//! wall. The label of a vertex follows from its normal. Things have a label for each class of the scene.

use minijinja::context;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::chunk_files::{self, ChunkFiles, TempFile, Triangles};
use crate::error::ExportError;
use crate::format::pixels::Sampler;
use crate::format::ply;
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::labels::Labels;
use crate::package::Package;
use crate::scene::{Chunk, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, template};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "ply",
    summary: "binary PLY with colours and labels of floor, wall, ceiling and things at vertices and faces",
    revision: 0,
    opened_by: "MeshLab, CloudCompare, Open3D, Blender, trimesh",
    contents: "binary PLY: normals, colours, labels for floor, wall, ceiling and each class of things",
    tested_by: "plyfile, trimesh, Blender 4.2, assimp",
    checks: &["trimesh", "blender", "libassimp", "orient"],
    images: &ImageFormat::COMMON,
    is_single_file: true,
    has_pieces: false,
    bundles: &[],
    settings: plume_registry::settings_schema::<PlySettings>,
    build: Build::Plain(|table| Ok(Box::new(Ply(serde_json::from_value(table)?)))),
};

/// Settings of target `ply`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct PlySettings {
    /// Write one file per chunk instead of a single file.
    pub per_chunk: bool,
}

/// The target.
pub struct Ply(
    /// Its settings.
    pub PlySettings,
);

impl Target for Ply {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let labels = Labels::of(scene)?;
        let comments = comments(scene, &labels);
        let [visual_triangles, collision_triangles] = chunk_files::write(scene, self.0.per_chunk, out, |stem| {
            let (body, faces) = (stem.grow(".ply")?, stem.grow(".faces")?);
            Ok(Cloud { comments: &comments, labels: &labels, body, faces, counts: [0, 0] })
        })?;
        let open = chunk_files::how_to_open(scene, self.0.per_chunk, "ply");
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            stations => scene.network.has_names(),
            per_chunk => self.0.per_chunk,
            triangles => visual_triangles,
            labels => labels.texts(),
        };
        let readme = include_str!("../templates/ply/README.md.jinja");
        out.text("README.md", &template::fill("README.md", readme, &values))?;
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

fn comments(scene: &Scene, labels: &Labels) -> Vec<String> {
    let labels = labels.texts().into_iter().map(|text| format!("label {text}"));
    let made = format!("{}, made by {}", scene.name, scene.generator);
    [made, "metres, right-handed, Z up; s t from the lower left of the image".to_owned()]
        .into_iter()
        .chain(labels)
        .collect()
}

/// A file being written, and its second half.
struct Cloud<'a> {
    comments: &'a [String],
    labels: &'a Labels,
    body: TempFile,
    faces: TempFile,
    /// Vertices and faces.
    counts: [u64; 2],
}

impl Cloud<'_> {
    fn too_large(&self) -> ExportError {
        let bytes = 36 * self.counts[0] + 14 * self.counts[1];
        ExportError::TooLarge { path: self.body.path().to_owned(), format: "PLY", bytes }
    }
}

impl ChunkFiles for Cloud<'_> {
    fn add(
        &mut self,
        scene: &Scene,
        index: usize,
        chunk: &Chunk,
        _: &mut dyn Package,
    ) -> Result<Triangles, ExportError> {
        chunk.material.refuse_unless(ROW.name, ROW.images)?;
        let mesh = &chunk.visual;
        let before = self.counts[0];
        self.counts = [before + mesh.positions.len() as u64, self.counts[1] + mesh.triangles()];
        // Readers treat indices as signed.
        if i32::try_from(self.counts[0]).is_err() {
            return Err(self.too_large());
        }
        let colors = Sampler::open(&chunk.material.base_color)?;
        let colors: Vec<[u8; 3]> = mesh.uvs.iter().map(|&uv| colors.at(uv)).collect();
        let (vertices, faces) = self.labels.of_chunk(scene, index, chunk)?;
        ply::write_vertices(&mut self.body, mesh, &colors, &vertices)?;
        ply::write_faces(&mut self.faces, mesh, &faces, before as u32)?;
        Ok([mesh.triangles(), 0])
    }

    fn finish(self, out: &mut dyn Package) -> Result<(), ExportError> {
        let path = self.body.path().to_owned();
        let [vertices, faces] = self.counts;
        out.write(&path, |file| {
            ply::write_head(file, self.comments, &ply::mesh(vertices, faces))?;
            self.body.append_to(file)?;
            self.faces.append_to(file)
        })
    }
}
