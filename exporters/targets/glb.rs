//! Target `glb`: binary glTF 2.0 with everything embedded, Y up, metres.
//!
//! glTF does not support collision meshes yet, but game engines recognise them by names. With `collision = "pieces"` the
//! node of a chunk has a child `UCX_<chunk>_<NN>` for each convex piece. Unreal uses it as collision of the mesh `<chunk>`
//! and does not render it ("Import Collisions According to Mesh Names"); other viewers render it. Not tested in Unreal
//! itself.
//!
//! With `lods = true` there are coarser levels: nodes outside the scene, referenced by the extension MSFT_lod. three.js and
//! others that follow the specification show only the full detail, and Babylon.js switches levels; but Blender 4.2 shows
//! every node of the file, and so all levels together. One file cannot serve both, so this is not the default; target `gltf`
//! serves both.
//!
//! Memory: one chunk. A GLB starts with its length and a JSON with all sizes, so for a file of several chunks each chunk is
//! loaded twice: once for planning, once for writing.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::NamedCollision;
use crate::error::ExportError;
use crate::format::gltf::index::{self, Entry};
use crate::format::gltf::{Compression, Copies, Layout, Payload, Place, Readme, Style, glb};
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Instance, Piece, Scene};
use crate::{Build, Open, Summary, Target, TargetRow};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "glb",
    summary: "binary glTF 2.0 with embedded PBR textures, and scene.json with spawn poses",
    revision: 0,
    opened_by: "Blender, three.js, Unity, Unreal, Godot, any glTF viewer",
    contents: "one GLB, or one per chunk: tangents, base colour, normal, occlusion-roughness-metal; meshopt, levels of \
        detail (`MSFT_lod`) and instances (`EXT_mesh_gpu_instancing`) as options",
    tested_by: "Khronos glTF validator without an error or warning; the `gltf` crate; three.js in Chromium; Blender 4.2; \
        assimp; trimesh",
    checks: &["validator", "three", "trimesh", "blender", "libassimp", "orient"],
    images: &ImageFormat::ALL,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<GlbSettings>,
    build: Build::Plain(|table| {
        let settings: GlbSettings = serde_json::from_value(table)?;
        settings.compression.check()?;
        Ok(Box::new(Glb(settings)))
    }),
};

/// Settings of target `glb`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GlbSettings {
    /// Write one file per chunk instead of a single file: for streaming, or beyond the format's limit of 4 GiB.
    pub per_chunk: bool,
    /// Include the lights in a single file (extension KHR_lights_punctual).
    pub lights: bool,
    /// Include coarser levels of detail (extension MSFT_lod). Blender shows all of them together.
    pub lods: bool,
    /// Collision shapes.
    pub collision: NamedCollision,
    /// Compression of vertices and triangles.
    pub compression: Compression,
    /// Draw the things of a chunk that look alike as instances of one node (extension EXT_mesh_gpu_instancing): a quarter of
    /// the bytes, for viewers that support it, among them three.js, Babylon.js and Blender.
    pub instancing: bool,
}

impl Default for GlbSettings {
    fn default() -> Self {
        Self {
            per_chunk: false,
            lights: true,
            lods: false,
            collision: NamedCollision::None,
            compression: Compression::None,
            instancing: false,
        }
    }
}

/// The target.
pub struct Glb(
    /// Its settings.
    pub GlbSettings,
);

/// A chunk with what it takes to write it.
struct Part {
    chunk: Chunk,
    pieces: Vec<Piece>,
    things: Vec<Instance>,
}

impl Target for Glb {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (entries, open) = match self.0.per_chunk {
            true => (self.write_chunks(scene, out)?, "the files of chunks/ together".to_owned()),
            false => (self.write_single(scene, out)?, format!("{}.glb", scene.name)),
        };
        let [visual_triangles, collision_triangles] = index::triangles(&entries);
        index::write(scene, &entries, out)?;
        let levels = self.0.lods.then_some(&*open);
        let GlbSettings { compression, instancing, .. } = self.0;
        Readme { open: &open, levels, pieces: self.wants_pieces(), compression, instancing }.write(scene, out)?;
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(format!("open {open}")) })
    }

    fn axes(&self) -> Axes {
        Axes::GLTF
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == NamedCollision::Pieces
    }
}

impl Glb {
    fn layout(&self, scene: &Scene, scratch: &Path) -> Layout {
        let style = Style { buffers: Place::Embedded, images: Place::Embedded, compression: self.0.compression };
        Layout::new(scene, style, scratch)
    }

    fn copies(&self, scene: &Scene) -> Result<Copies, ExportError> {
        Copies::of(scene, self.wants_pieces(), self.0.instancing)
    }

    fn load(&self, scene: &Scene, index: usize) -> Result<Part, ExportError> {
        let pieces = if self.wants_pieces() { scene.pieces(index)? } else { Vec::new() };
        Ok(Part { chunk: scene.chunk(index)?, pieces, things: scene.instances(index)? })
    }

    /// Adds a chunk to the plan; returns what is to be written to the file.
    fn add<'a>(
        &self,
        layout: &mut Layout,
        Part { chunk, pieces, things }: &'a Part,
        copies: &Copies,
    ) -> Result<[Payload<'a>; 2], ExportError> {
        let (placed, full) = match chunk.content {
            Content::Wall | Content::Gravel { .. } => layout.add_chunk(chunk, pieces)?,
            Content::Things { .. } => layout.add_things(chunk, things, copies)?,
        };
        let levels = if self.0.lods { layout.add_levels(chunk, &placed) } else { Payload::default() };
        Ok([full, levels])
    }

    fn entry(&self, path: &str, Part { chunk, pieces, .. }: &Part) -> Entry {
        let entry = Entry::new(path, chunk, pieces);
        if self.0.lods { entry.with_levels(chunk) } else { entry }
    }

    fn write_single(&self, scene: &Scene, out: &mut dyn Package) -> Result<Vec<Entry>, ExportError> {
        let (path, scratch) = (format!("{}.glb", scene.name), out.scratch()?);
        let (mut layout, copies) = (self.layout(scene, scratch.path()), self.copies(scene)?);
        let mut entries = Vec::new();
        for index in 0..scene.chunks.len() {
            let part = self.load(scene, index)?;
            self.add(&mut layout, &part, &copies)?;
            entries.push(self.entry(&path, &part));
        }
        if self.0.lights {
            layout.add_lights(&scene.lights);
        }
        layout.add_landmarks(&scene.network.landmarks());
        let document = layout.finish()?;
        out.write(&path, |file| {
            glb::write_head(file, &path, &document)?;
            let mut again = self.layout(scene, scratch.path());
            for index in 0..scene.chunks.len() {
                let part = self.load(scene, index)?;
                self.add(&mut again, &part, &copies)?.iter().try_for_each(|payload| payload.write(file))?;
            }
            Ok(())
        })?;
        Ok(entries)
    }

    fn write_chunks(&self, scene: &Scene, out: &mut dyn Package) -> Result<Vec<Entry>, ExportError> {
        let (mut entries, copies, scratch) = (Vec::new(), self.copies(scene)?, out.scratch()?);
        for index in 0..scene.chunks.len() {
            let part = self.load(scene, index)?;
            let path = format!("chunks/{}.glb", part.chunk.name);
            let mut layout = self.layout(scene, scratch.path());
            let payloads = self.add(&mut layout, &part, &copies)?;
            let document = layout.finish()?;
            out.write(&path, |file| {
                glb::write_head(file, &path, &document)?;
                payloads.iter().try_for_each(|payload| payload.write(file))
            })?;
            entries.push(self.entry(&path, &part));
        }
        Ok(entries)
    }
}
