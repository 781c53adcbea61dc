//! Images for Unity, and their import settings.

use minijinja::context;

use super::asset::Assets;
use super::identity::Guid;
use crate::error::ExportError;
use crate::format::pixels;
use crate::scene::{Chunk, Image, Mesh};

/// The images of a chunk.
pub struct Textures {
    /// Base colour.
    pub base_color: Texture,
    /// Normals, +Y up as in Unity.
    pub normal: Texture,
    /// Metalness in red, occlusion in green, blue unused, smoothness in alpha: the mask map of HDRP, which also serves as
    /// the metallic map and the occlusion map of the other pipelines.
    pub mask: Texture,
}

/// An image of the package.
pub struct Texture {
    /// Its file in `Runtime/Textures`.
    pub file: String,
    /// Its GUID.
    pub guid: Guid,
}

/// The largest image that Unity imports without resizing, pixels per side.
const LARGEST_PX: u32 = 16_384;
/// The smallest limit in its settings.
const SMALLEST_PX: u32 = 32;

/// The kind of an image, in the enum values of `TextureImporter`.
#[derive(Clone, Copy)]
enum Kind {
    Color,
    Normal,
    Mask,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Color => "base_color",
            Self::Normal => "normal",
            Self::Mask => "mask",
        }
    }
}

/// Writes the images of a chunk.
///
/// # Errors
/// If an image cannot be read, or a file cannot be written.
pub fn write(chunk: &Chunk, assets: &mut Assets) -> Result<Textures, ExportError> {
    let material = &chunk.material;
    material.refuse_unless(super::ROW.name, super::ROW.images)?;
    Ok(Textures {
        base_color: copy(chunk, Kind::Color, &material.base_color, assets)?,
        normal: copy(chunk, Kind::Normal, &material.normal, assets)?,
        mask: write_mask(chunk, &material.orm, assets)?,
    })
}

fn copy(chunk: &Chunk, kind: Kind, image: &Image, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{}_{}.{}", chunk.material.name, kind.name(), image.format.extension());
    if let Some(texture) = written(&file, assets) {
        return Ok(texture);
    }
    assets.out.copy(&in_package(&file), &image.path)?;
    import(chunk, kind, pixels::size(image)?, file, assets)
}

fn write_mask(chunk: &Chunk, orm: &Image, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{}_{}.png", chunk.material.name, Kind::Mask.name());
    if let Some(texture) = written(&file, assets) {
        return Ok(texture);
    }
    assets.out.write(&in_package(&file), |file| {
        pixels::remap(orm, file, |[occlusion, roughness, metalness]| [metalness, occlusion, 0, 255 - roughness])
    })?;
    import(chunk, Kind::Mask, pixels::size(orm)?, file, assets)
}

/// The texture that another chunk with the same material has written.
fn written(file: &str, assets: &mut Assets) -> Option<Texture> {
    let path = in_package(file);
    assets.out.has(&path).then(|| Texture { guid: assets.guid(&path), file: file.to_owned() })
}

fn import(
    chunk: &Chunk,
    kind: Kind,
    size_px: [u32; 2],
    file: String,
    assets: &mut Assets,
) -> Result<Texture, ExportError> {
    let longest = size_px[0].max(size_px[1]).next_power_of_two().clamp(SMALLEST_PX, LARGEST_PX);
    let values = context! {
        srgb => u8::from(matches!(kind, Kind::Color)),
        type => u8::from(matches!(kind, Kind::Normal)),
        size_px => longest,
        wrap => u8::from(is_atlas(chunk)),
    };
    let template = include_str!("../../templates/unity/texture.meta.jinja");
    let guid = assets.fill_meta(&in_package(&file), template, &values)?;
    Ok(Texture { file, guid })
}

/// Whether no texture coordinate is outside the image, so that it can be clamped and its edges do not bleed.
fn is_atlas(chunk: &Chunk) -> bool {
    let fits = |mesh: &Mesh| mesh.uvs.iter().flatten().all(|part| (0.0..=1.0).contains(part));
    fits(&chunk.visual) && chunk.lods.iter().all(|lod| fits(&lod.mesh))
}

fn in_package(file: &str) -> String {
    format!("Runtime/Textures/{file}")
}
