//! Images for Unity, and their import settings.

use minijinja::context;

use super::asset::Assets;
use super::identity::Guid;
use crate::error::ExportError;
use crate::format::pixels;
use crate::scene::{Image, Material, Mesh};

/// The images of a material.
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

/// Writes the images of a material, unless they are there; `meshes` are all that show it.
///
/// # Errors
/// If an image cannot be read, or a file cannot be written.
pub fn write(material: &Material, meshes: &[&Mesh], assets: &mut Assets) -> Result<Textures, ExportError> {
    material.refuse_unless(super::ROW.name, super::ROW.images)?;
    let (name, is_atlas) = (&material.name, is_atlas(meshes));
    Ok(Textures {
        base_color: copy(name, Kind::Color, &material.base_color, is_atlas, assets)?,
        normal: copy(name, Kind::Normal, &material.normal, is_atlas, assets)?,
        mask: write_mask(name, &material.orm, is_atlas, assets)?,
    })
}

fn copy(name: &str, kind: Kind, image: &Image, is_atlas: bool, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{name}_{}.{}", kind.name(), image.format.extension());
    if let Some(texture) = written(&file, assets) {
        return Ok(texture);
    }
    assets.out.copy(&in_package(&file), &image.path)?;
    import(kind, pixels::size(image)?, is_atlas, file, assets)
}

fn write_mask(name: &str, orm: &Image, is_atlas: bool, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{name}_{}.png", Kind::Mask.name());
    if let Some(texture) = written(&file, assets) {
        return Ok(texture);
    }
    assets.out.write(&in_package(&file), |file| {
        pixels::remap(orm, file, |[occlusion, roughness, metalness]| [metalness, occlusion, 0, 255 - roughness])
    })?;
    import(Kind::Mask, pixels::size(orm)?, is_atlas, file, assets)
}

/// The texture that another mesh with the same material has written.
fn written(file: &str, assets: &mut Assets) -> Option<Texture> {
    let path = in_package(file);
    assets.out.has(&path).then(|| Texture { guid: assets.guid(&path), file: file.to_owned() })
}

fn import(
    kind: Kind,
    size_px: [u32; 2],
    is_atlas: bool,
    file: String,
    assets: &mut Assets,
) -> Result<Texture, ExportError> {
    let longest = size_px[0].max(size_px[1]).next_power_of_two().clamp(SMALLEST_PX, LARGEST_PX);
    let values = context! {
        srgb => u8::from(matches!(kind, Kind::Color)),
        type => u8::from(matches!(kind, Kind::Normal)),
        size_px => longest,
        wrap => u8::from(is_atlas),
    };
    let template = include_str!("../../templates/unity/texture.meta.jinja");
    let guid = assets.fill_meta(&in_package(&file), template, &values)?;
    Ok(Texture { file, guid })
}

/// Whether no texture coordinate is outside the image, so that it can be clamped and its edges do not bleed.
fn is_atlas(meshes: &[&Mesh]) -> bool {
    meshes.iter().flat_map(|mesh| &mesh.uvs).flatten().all(|part| (0.0..=1.0).contains(part))
}

fn in_package(file: &str) -> String {
    format!("Runtime/Textures/{file}")
}
