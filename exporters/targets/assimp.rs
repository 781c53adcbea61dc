//! Target `assimp:<id>`: any format that the installed libassimp writes, Y up, metres where the format has units.
//!
//! ```text
//! <name>.<extension>             every chunk in full detail, or chunks/<chunk>.<extension>
//! textures/<chunk>_<role>.png    the images, which it refers to if the format can
//! README.md, recipe.toml
//! ```
//! assimp gets a GLB in memory whose images are external file names, and keeps these names. It gets no lights, because
//! version 5.2 aborts on the nodes of KHR_lights_punctual. How much of a material a format can express, and whether its files
//! contain a time stamp, as Collada does, is up to assimp: bytes are reproducible only as far as its output is. Formats that
//! assimp cannot write to memory, such as 3MF, are reported as its failure; whatever it prints is not captured.
//!
//! Memory: three times the scene (as GLB, in assimp, and as output); with `per_chunk = true`, three times a chunk.

use minijinja::context;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::format::gltf::{Compression, Layout, Place, Style, glb, image_files};
use crate::frame::Axes;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::Scene;
use crate::{Build, Open, Summary, Target, TargetRow, template};

pub mod library;

use library::{Format, Library};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "assimp",
    summary: "any format that the installed libassimp writes, such as assimp:collada or assimp:x3d",
    revision: 0,
    opened_by: "programs that read the format",
    contents: "any format that an installed libassimp writes: `assimp:collada`, `assimp:x3d`, …",
    tested_by: "trimesh and pycollada (Collada, OBJ)",
    checks: &["assimp"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: false,
    bundles: &[],
    settings: plume_registry::settings_schema::<AssimpSettings>,
    build: Build::WithFormat(|format, table| {
        let settings = serde_json::from_value(table)?;
        Ok(Box::new(Assimp::new(settings, format, Library::load()?)?))
    }),
};

/// Settings of target `assimp`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct AssimpSettings {
    /// Write one file per chunk instead of a single file: needs less memory, and avoids assimp's limit of 4 GiB.
    pub per_chunk: bool,
}

/// The target.
pub struct Assimp {
    settings: AssimpSettings,
    library: Library,
    format: Format,
}

/// The placeholder by which files that assimp writes to memory refer to each other.
const NAME_OF_ASSIMP: &str = "$blobfile";

impl Assimp {
    /// The target for the format with the id `format`.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`], which lists all formats; [`ExportError::MissingPart`] if this version of the library is
    /// known to write the format incorrectly.
    pub fn new(settings: AssimpSettings, format: Option<&str>, library: Library) -> Result<Self, ExportError> {
        let formats = library.formats();
        let Some(found) = formats.iter().find(|known| Some(known.id.as_str()) == format) else {
            let known = formats.into_iter().map(|format| format.id).collect();
            return Err(ExportError::UnknownFormat {
                target: "assimp",
                name: format.unwrap_or_default().to_owned(),
                known,
            });
        };
        refuse_broken_fbx(&found.id, library.version())?;
        Ok(Self { settings, format: found.clone(), library })
    }

    /// Writes some chunks as `<stem>.<extension>` with its companion files; returns their number of triangles.
    fn write(
        &self,
        scene: &Scene,
        chunks: std::ops::Range<usize>,
        stem: &str,
        out: &mut dyn Package,
    ) -> Result<u64, ExportError> {
        let (folder, name) = stem.rsplit_once('/').map_or(("", stem), |(folder, name)| (folder, name));
        let path = format!("{stem}.{}", self.format.extension);
        let style = Style { buffers: Place::Embedded, images: Place::Beside, compression: Compression::None };
        let scratch = out.scratch()?;
        let (mut layout, mut payload, mut triangles) = (Layout::new(scene, style, scratch.path()), Vec::new(), 0);
        for index in chunks {
            let chunk = scene.chunk(index)?;
            // Its GLB reader does not support EXT_texture_webp, and would drop the images.
            chunk.material.refuse_unless(ROW.name, ROW.images)?;
            for (image_path, image) in image_files(&chunk) {
                out.share(&image_path_in(folder, &image_path), image)?;
            }
            layout.add_chunk(&chunk, &[])?.1.write(&mut payload)?;
            triangles += chunk.visual.triangles();
        }
        let mut bytes = Vec::new();
        glb::write_head(&mut bytes, &path, &layout.finish()?)?;
        bytes.append(&mut payload);
        self.library.convert(&bytes, &self.format.id, &mut |extension, file| {
            let path = if extension.is_empty() { path.clone() } else { format!("{stem}.{extension}") };
            out.write(&path, |sink| Ok(sink.write_all(&named(file, name))?))
        })?;
        Ok(triangles)
    }
}

impl Target for Assimp {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let extension = &self.format.extension;
        let (visual_triangles, open) = match self.settings.per_chunk {
            true => (self.write_chunks(scene, out)?, "the files of chunks/ together".to_owned()),
            false => {
                let triangles = self.write(scene, 0..scene.chunks.len(), &scene.name, out)?;
                (triangles, format!("{}.{extension}", scene.name))
            }
        };
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            format => &self.format.description,
            version => self.library.version().map(|part| part.to_string()).join("."),
            open => &open,
            folder => if self.settings.per_chunk { "chunks/" } else { "" },
        };
        let text = template::fill("README.md", include_str!("../templates/assimp/README.md.jinja"), &values);
        out.text("README.md", &text)?;
        out.text("recipe.toml", &scene.recipe)?;
        Ok(Summary { visual_triangles, collision_triangles: 0, open: Open::Words(format!("open {open}")) })
    }

    fn axes(&self) -> Axes {
        Axes::GLTF
    }
}

impl Assimp {
    fn write_chunks(&self, scene: &Scene, out: &mut dyn Package) -> Result<u64, ExportError> {
        let mut triangles = 0;
        for index in 0..scene.chunks.len() {
            let name = scene.chunk(index)?.name;
            triangles += self.write(scene, index..index + 1, &format!("chunks/{name}"), out)?;
        }
        Ok(triangles)
    }
}

fn image_path_in(folder: &str, image: &str) -> String {
    if folder.is_empty() { image.to_owned() } else { format!("{folder}/{image}") }
}

/// Replaces assimp's placeholder name in a text with that of the package; other bytes are unchanged.
fn named<'a>(file: &'a [u8], name: &str) -> std::borrow::Cow<'a, [u8]> {
    match std::str::from_utf8(file) {
        Ok(text) if text.contains(NAME_OF_ASSIMP) => text.replace(NAME_OF_ASSIMP, name).into_bytes().into(),
        _ => file.into(),
    }
}

fn refuse_broken_fbx(format: &str, version: [u32; 2]) -> Result<(), ExportError> {
    if !["fbx", "fbxa"].contains(&format) || version >= [5, 3] {
        return Ok(());
    }
    let [major, minor] = version;
    Err(ExportError::MissingPart {
        message: format!(
            "assimp {major}.{minor} writes FBX without the empty record that ends nested nodes, which Blender, ufbx and assimp \
             itself refuse (assimp#4686)"
        ),
        hint: "use target `fbx`, or install assimp 5.3 or later".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fbx_is_refused_only_for_versions_that_break_it() {
        assert!(refuse_broken_fbx("collada", [5, 2]).is_ok());
        assert!(refuse_broken_fbx("fbx", [5, 3]).is_ok() && refuse_broken_fbx("fbx", [6, 0]).is_ok());
        for format in ["fbx", "fbxa"] {
            let error = refuse_broken_fbx(format, [5, 2]).expect_err("5.2 breaks it");
            assert!(error.to_string().contains("assimp#4686"));
            assert!(error.hint().is_some_and(|hint| hint.contains("target `fbx`")));
        }
    }

    #[test]
    fn placeholders_are_replaced_and_other_bytes_stay() {
        assert_eq!(&*named(b"mtllib $blobfile.mtl", "cave"), b"mtllib cave.mtl");
        assert_eq!(&*named(b"\xff$blobfile", "cave"), b"\xff$blobfile");
    }
}
