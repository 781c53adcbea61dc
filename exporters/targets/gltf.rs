//! Target `gltf`: glTF 2.0 in separate files, Y up, metres.
//!
//! ```text
//! <name>.gltf                    every chunk in full detail: opens anywhere
//! <name>_lods.gltf               the same with coarser levels (MSFT_lod), for readers that support it
//! buffers/<chunk>.bin            vertices, triangles and convex pieces of a chunk; of one of things, the prototypes that no
//!                                chunk before it has
//! buffers/<chunk>_lods.bin       its coarser levels
//! textures/<chunk>_<role>.png    its images
//! scene.json, README.md
//! ```
//! Both documents refer to the same buffers and images, so the second costs only its text. There are two because Blender 4.2
//! shows every node of a document, including those outside the scene, where MSFT_lod keeps the coarser levels: it would show
//! all of them together. A streaming reader loads the buffers of the chunks that it needs.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::NamedCollision;
use crate::error::ExportError;
use crate::format::gltf::index::{self, Entry};
use crate::format::gltf::{
    Compression, Copies, Layout, Payload, Place, Readme, Style, buffer_file, image_files, level_buffer,
};
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Instance, Piece, Scene};
use crate::{Build, Open, Summary, Target, TargetRow};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "gltf",
    summary: "glTF 2.0 in separate files, levels of detail (MSFT_lod), and scene.json with spawn poses",
    revision: 0,
    opened_by: "Blender, three.js, Babylon.js, Godot, any glTF viewer",
    contents: "the same in separate files; `<name>_lods.gltf` next to it has the levels of detail",
    tested_by: "as for `glb`",
    checks: &["validator", "three", "trimesh", "blender", "libassimp", "orient"],
    images: &ImageFormat::ALL,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<GltfSettings>,
    build: Build::Plain(|table| {
        let settings: GltfSettings = serde_json::from_value(table)?;
        settings.compression.check()?;
        Ok(Box::new(Gltf(settings)))
    }),
};

/// Settings of target `gltf`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GltfSettings {
    /// Include the lights (extension KHR_lights_punctual).
    pub lights: bool,
    /// Write a second document with coarser levels of detail (extension MSFT_lod).
    pub lods: bool,
    /// Collision shapes.
    pub collision: NamedCollision,
    /// Compression of vertices and triangles.
    pub compression: Compression,
    /// Draw the things of a chunk that look alike as instances of one node (extension EXT_mesh_gpu_instancing): a quarter of
    /// the bytes, for viewers that support it, among them three.js, Babylon.js and Blender.
    pub instancing: bool,
}

impl Default for GltfSettings {
    fn default() -> Self {
        Self {
            lights: true,
            lods: true,
            collision: NamedCollision::None,
            compression: Compression::None,
            instancing: false,
        }
    }
}

/// The target.
pub struct Gltf(
    /// Its settings.
    pub GltfSettings,
);

impl Target for Gltf {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let scratch = out.scratch()?;
        let mut documents = self.documents(scene, scratch.path());
        let copies = Copies::of(scene, self.wants_pieces(), self.0.instancing)?;
        let mut entries = Vec::new();
        for index in 0..scene.chunks.len() {
            let pieces = if self.wants_pieces() { scene.pieces(index)? } else { Vec::new() };
            let chunk = scene.chunk(index)?;
            entries.push(documents.add(&chunk, &pieces, &scene.instances(index)?, &copies, out)?);
        }
        if self.0.lights {
            documents.add_lights(scene);
        }
        documents.add_landmarks(scene);
        documents.write(out)?;
        index::write(scene, &entries, out)?;
        let (open, levels) = (format!("{}.gltf", scene.name), self.0.lods.then(|| lods_path(scene)));
        let GltfSettings { compression, instancing, .. } = self.0;
        let pieces = self.wants_pieces();
        Readme { open: &open, levels: levels.as_deref(), pieces, compression, instancing }.write(scene, out)?;
        let [visual_triangles, collision_triangles] = index::triangles(&entries);
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(format!("open {open}")) })
    }

    fn axes(&self) -> Axes {
        Axes::GLTF
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == NamedCollision::Pieces
    }
}

impl Gltf {
    fn documents(&self, scene: &Scene, scratch: &Path) -> Documents {
        let style = Style { buffers: Place::Beside, images: Place::Beside, compression: self.0.compression };
        let start = |path: String| Document { layout: Layout::new(scene, style, scratch), path };
        Documents { full: start(format!("{}.gltf", scene.name)), lods: self.0.lods.then(|| start(lods_path(scene))) }
    }
}

fn lods_path(scene: &Scene) -> String {
    format!("{}_lods.gltf", scene.name)
}

/// The documents of a package, built chunk by chunk.
struct Documents {
    full: Document,
    lods: Option<Document>,
}

struct Document {
    layout: Layout,
    path: String,
}

impl Documents {
    /// Adds a chunk to each document and writes its buffers and images.
    fn add(
        &mut self,
        chunk: &Chunk,
        pieces: &[Piece],
        things: &[Instance],
        copies: &Copies,
        out: &mut dyn Package,
    ) -> Result<Entry, ExportError> {
        let add = |layout: &mut Layout| match chunk.content {
            Content::Wall | Content::Gravel { .. } => layout.add_chunk(chunk, pieces),
            Content::Things { .. } => layout.add_things(chunk, things, copies),
        };
        let (_, payload) = add(&mut self.full.layout)?;
        if !payload.is_empty() {
            write_buffer(&chunk.name, &payload, out)?;
        }
        let mut entry = Entry::new(&self.full.path, chunk, pieces);
        if let Some(lods) = &mut self.lods {
            let (placed, _) = add(&mut lods.layout)?;
            let levels = lods.layout.add_levels(chunk, &placed);
            if !levels.is_empty() {
                write_buffer(&level_buffer(&chunk.name), &levels, out)?;
            }
            entry = entry.with_levels(chunk);
        }
        for (path, image) in image_files(chunk) {
            out.share(&path, image)?;
        }
        Ok(entry)
    }

    fn add_landmarks(&mut self, scene: &Scene) {
        let landmarks = scene.network.landmarks();
        for document in [Some(&mut self.full), self.lods.as_mut()].into_iter().flatten() {
            document.layout.add_landmarks(&landmarks);
        }
    }

    fn add_lights(&mut self, scene: &Scene) {
        for document in [Some(&mut self.full), self.lods.as_mut()].into_iter().flatten() {
            document.layout.add_lights(&scene.lights);
        }
    }

    fn write(self, out: &mut dyn Package) -> Result<(), ExportError> {
        for Document { layout, path } in [Some(self.full), self.lods].into_iter().flatten() {
            out.json(&path, &layout.finish()?)?;
        }
        Ok(())
    }
}

fn write_buffer(name: &str, payload: &Payload, out: &mut dyn Package) -> Result<(), ExportError> {
    out.write(&buffer_file(name), |file| payload.write(file))
}
