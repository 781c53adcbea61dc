//! Target `tiles`: 3D Tiles 1.1, for viewers that load what they see of a large world, at the level of detail that they need;
//! Z up, metres, in no place on Earth.
//!
//! ```text
//! tileset.json                              the regions, as a tree
//! tiles/region_<n>.json                     the chunks of a region, each at every level of detail
//! tiles/<chunk>_LOD<n>.glb                  a chunk at level n; 0 is full detail
//! tiles/textures/<material>_<role>.png      the images of level 0
//! tiles/textures/<material>_lod<n>_<role>.png   those of level n: half as wide and high as those of the level before
//! README.md
//! ```
//! The error of a level is the larger of the distance of its mesh from full detail and the length of a texel. Glossy and matt
//! parts of a texel are averaged, as mipmaps do.
//!
//! Memory: one chunk, and a few hundred bytes for each.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use minijinja::context;
use nalgebra::{Vector2, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;
use tempfile::TempDir;

use crate::error::{ExportError, at};
use crate::format::gltf::{self, Compression, Copies, Layout, Place, Style, glb};
use crate::format::pixels::{self, Pyramid};
use crate::format::tileset::{Bounds, Tile};
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Image, Instance, Material, Mesh, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, names, template};

/// Chunks of a region. Tuned: a tileset of some 30 kB.
const CHUNKS_OF_REGION: usize = 64;
/// Folder of all that `tileset.json` leads to.
const FOLDER: &str = "tiles/";

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "tiles",
    summary: "3D Tiles 1.1: a tree of glTF tiles for viewers that stream large worlds",
    revision: 0,
    opened_by: "CesiumJS, Cesium for Unreal, Unity and Omniverse, 3DTilesRendererJS (three.js), deck.gl",
    contents: "`tileset.json`, a tree of regions of up to 64 chunks; for each chunk a GLB per level of detail with images of \
        its own, each half as wide and high as those of the next finer level; things as instances (`EXT_mesh_gpu_instancing`)",
    tested_by: "CesiumJS and 3DTilesRendererJS in Chromium; Khronos glTF validator without an error or warning",
    checks: &["cesium", "tiles", "validator"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: false,
    bundles: &[],
    settings: plume_registry::settings_schema::<TilesSettings>,
    build: Build::Plain(|table| {
        let settings: TilesSettings = serde_json::from_value(table)?;
        settings.compression.check()?;
        Ok(Box::new(Tiles(settings)))
    }),
};

/// Settings of target `tiles`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TilesSettings {
    /// Compression of vertices and triangles.
    pub compression: Compression,
}

/// The target.
pub struct Tiles(
    /// Its settings.
    pub TilesSettings,
);

impl Target for Tiles {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let copies = Copies::of(scene, false, true)?;
        let writer = Writer { scene, copies, compression: self.0.compression, scratch: out.scratch()? };
        let (mut visual_triangles, mut tiles) = (0, Vec::new());
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            chunk.material.refuse_unless(ROW.name, ROW.images)?;
            visual_triangles += chunk.visual.triangles();
            tiles.push(writer.add(chunk, &scene.instances(index)?, out)?);
        }
        write_tilesets(scene, tiles, out)?;
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            stations => scene.network.has_names(),
            is_packed => self.0.compression == Compression::Meshopt,
        };
        let readme = template::fill("README.md", include_str!("../templates/tiles/README.md.jinja"), &values);
        out.text("README.md", &readme)?;
        let open = "serve this folder by HTTP and open tileset.json in a viewer of 3D Tiles".to_owned();
        Ok(Summary { visual_triangles, collision_triangles: 0, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

/// Writes `tileset.json`, and those of the regions.
fn write_tilesets(scene: &Scene, tiles: Vec<Tile>, out: &mut dyn Package) -> Result<(), ExportError> {
    let mut regions = 0;
    let root = Tile::tree(tiles, CHUNKS_OF_REGION, &mut |tiles| {
        let path = format!("{FOLDER}region_{regions}.json");
        regions += 1;
        let region = Tile::group(tiles);
        region.write(&path, None, out)?;
        Ok(region.in_file(path))
    })?;
    let extras = json!({
        "name": scene.name,
        "description": scene.description,
        "generator": scene.generator,
        "recipe": scene.recipe,
    });
    root.write("tileset.json", Some(extras), out)
}

/// Writes the tiles of chunks.
struct Writer<'a> {
    scene: &'a Scene<'a>,
    copies: Copies,
    compression: Compression,
    scratch: TempDir,
}

impl Writer<'_> {
    /// Writes every level of a chunk.
    fn add(&self, chunk: Chunk, things: &[Instance], out: &mut dyn Package) -> Result<Tile, ExportError> {
        let bounds = chunk.levels().map(|(mesh, _)| Bounds::new(mesh.bounds())).reduce(Bounds::and);
        let bounds = bounds.expect("a chunk has a level");
        let texel_m = texel_m(&chunk.visual, pixels::size(&chunk.material.base_color)?);
        let materials = self.materials(&chunk.material, chunk.lods.len())?;
        let name = chunk.name.clone();
        let mut levels = vec![(self.write(&names::level(&name, 0), &chunk, things, out)?, 0.0)];
        for (number, (lod, material)) in (1..).zip(chunk.lods.into_iter().zip(materials)) {
            let name = names::level(&name, number);
            let part = Chunk {
                name: name.clone(),
                // Coarser levels of things and gravel are one mesh, as those of a wall are.
                content: Content::Wall,
                visual: lod.mesh,
                lods: Vec::new(),
                collision: Mesh::default(),
                material,
            };
            let error_m = f64::from(lod.error_m).max(texel_m * f64::from(1 << number));
            levels.push((self.write(&name, &part, &[], out)?, error_m));
        }
        Ok(Tile::levels(bounds, levels.into_iter().rev()))
    }

    /// Writes a chunk in full detail; returns the file relative to the tileset of its region.
    fn write(
        &self,
        name: &str,
        chunk: &Chunk,
        things: &[Instance],
        out: &mut dyn Package,
    ) -> Result<String, ExportError> {
        let style = Style { buffers: Place::Embedded, images: Place::Beside, compression: self.compression };
        let mut layout = Layout::new(self.scene, style, self.scratch.path());
        let (_, payload) = match chunk.content {
            Content::Wall | Content::Gravel { .. } => layout.add_chunk(chunk, &[])?,
            Content::Things { .. } => layout.add_things(chunk, things, &self.copies)?,
        };
        let document = layout.finish()?;
        let path = format!("{FOLDER}{name}.glb");
        out.write(&path, |file| {
            glb::write_head(file, &path, &document)?;
            payload.write(file)
        })?;
        for (path, image) in gltf::image_files(chunk) {
            out.share(&format!("{FOLDER}{path}"), image)?;
        }
        Ok(format!("{name}.glb"))
    }

    /// The material at `levels` coarser levels. Its images are made when a chunk is the first to need them.
    fn materials(&self, full: &Material, levels: usize) -> Result<Vec<Material>, ExportError> {
        let numbers = 1..=levels;
        let name = |number: usize| format!("{}_lod{number}", full.name);
        let file = |number: usize, role: &str| self.scratch.path().join(format!("{}_{role}.png", name(number)));
        let roles = gltf::images(full);
        for (role, image) in roles {
            let files: Vec<PathBuf> = numbers.clone().map(|number| file(number, role)).collect();
            if !files.iter().all(|file| file.exists()) {
                shrink(image, &files)?;
            }
        }
        let material = |number: usize| {
            let [base_color, normal, orm] =
                roles.map(|(role, _)| Image { path: file(number, role), format: ImageFormat::Png });
            Material { name: name(number), base_color, normal, orm, ..full.clone() }
        };
        Ok(numbers.map(material).collect())
    }
}

/// Writes an image into each of the files, half as wide and high as into the one before.
fn shrink(image: &Image, files: &[PathBuf]) -> Result<(), ExportError> {
    let mut pyramid = Pyramid::open(image)?;
    for path in files {
        pyramid.halve();
        let mut file = File::create(path).map(BufWriter::new).map_err(|error| at(path.display(), &error))?;
        pyramid.write(&mut file)?;
        file.flush().map_err(|error| at(path.display(), &error))?;
    }
    Ok(())
}

/// The length of a texel on a mesh with an image of this width and height, in metres: the root of the mean area.
fn texel_m(mesh: &Mesh, [width, height]: [u32; 2]) -> f64 {
    let [mut area_m2, mut share] = [0.0, 0.0];
    for corners in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|corner| corners[corner] as usize);
        let [a, b, c] = corners.map(|corner| Vector3::from(mesh.positions[corner]).cast::<f64>());
        let [u, v, w] = corners.map(|corner| Vector2::from(mesh.uvs[corner]).cast::<f64>());
        area_m2 += 0.5 * (b - a).cross(&(c - a)).norm();
        share += 0.5 * (v - u).perp(&(w - u)).abs();
    }
    let texels = share * f64::from(width) * f64::from(height);
    if texels > 0.0 { (area_m2 / texels).sqrt() } else { 0.0 }
}
