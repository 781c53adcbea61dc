//! Images as Unity wants them, and how it is to read them.

use std::io;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageReader, RgbImage, RgbaImage};
use minijinja::context;

use super::asset::Assets;
use super::identity::Guid;
use crate::error::{ExportError, at};
use crate::scene::{Chunk, Image, ImageFormat, Mesh};

/// The images of a chunk.
pub struct Textures {
    /// Base colour.
    pub base_color: Texture,
    /// Normals, +Y up as Unity has them.
    pub normal: Texture,
    /// Metalness in red, occlusion in green, nothing in blue, smoothness in alpha: the mask map of HDRP, which is the metallic map
    /// and the occlusion map of the other pipelines at once.
    pub mask: Texture,
}

/// An image of the package.
pub struct Texture {
    /// Its file in `Runtime/Textures`.
    pub file: String,
    /// Its identity.
    pub guid: Guid,
}

/// The largest image that Unity takes as it is, pixels along a side.
const LARGEST_PX: u32 = 16_384;
/// The smallest limit that its settings know.
const SMALLEST_PX: u32 = 32;

/// What an image says, in the numbers of `TextureImporter`.
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
/// When an image cannot be read, or a file not be written.
pub fn write(chunk: &Chunk, assets: &mut Assets) -> Result<Textures, ExportError> {
    let material = &chunk.material;
    Ok(Textures {
        base_color: copy(chunk, Kind::Color, &material.base_color, assets)?,
        normal: copy(chunk, Kind::Normal, &material.normal, assets)?,
        mask: write_mask(chunk, &material.orm, assets)?,
    })
}

fn copy(chunk: &Chunk, kind: Kind, image: &Image, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{}_{}.{}", chunk.name, kind.name(), image.format.extension());
    let size = reader(image)?.into_dimensions().map_err(|error| unreadable(image, error))?;
    assets.out.copy(&in_package(&file), &image.path)?;
    import(chunk, kind, size, file, assets)
}

fn write_mask(chunk: &Chunk, orm: &Image, assets: &mut Assets) -> Result<Texture, ExportError> {
    let file = format!("{}_{}.png", chunk.name, Kind::Mask.name());
    let decoded = reader(orm)?.decode().map_err(|error| unreadable(orm, error))?;
    let mask = mask(&decoded.into_rgb8());
    assets.out.write(&in_package(&file), |file| {
        let encoder = PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive);
        mask.write_with_encoder(encoder).map_err(|error| match error {
            image::ImageError::IoError(error) => error.into(),
            other => io::Error::other(other).into(),
        })
    })?;
    import(chunk, Kind::Mask, mask.dimensions(), file, assets)
}

/// From occlusion, roughness and metalness.
fn mask(orm: &RgbImage) -> RgbaImage {
    let pixels = orm
        .pixels()
        .flat_map(|&image::Rgb([occlusion, roughness, metalness])| [metalness, occlusion, 0, 255 - roughness]);
    RgbaImage::from_raw(orm.width(), orm.height(), pixels.collect()).expect("there are as many pixels")
}

fn import(
    chunk: &Chunk,
    kind: Kind,
    (width, height): (u32, u32),
    file: String,
    assets: &mut Assets,
) -> Result<Texture, ExportError> {
    let longest = width.max(height).next_power_of_two().clamp(SMALLEST_PX, LARGEST_PX);
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

/// Whether no triangle looks beyond the image, so that its opposite edges must not bleed into each other.
fn is_atlas(chunk: &Chunk) -> bool {
    let fits = |mesh: &Mesh| mesh.uvs.iter().flatten().all(|part| (0.0..=1.0).contains(part));
    fits(&chunk.visual) && chunk.lods.iter().all(|lod| fits(&lod.mesh))
}

fn in_package(file: &str) -> String {
    format!("Runtime/Textures/{file}")
}

fn reader(image: &Image) -> Result<ImageReader<io::BufReader<std::fs::File>>, ExportError> {
    let mut reader = ImageReader::open(&image.path).map_err(|error| at(image.path.display(), &error))?;
    reader.set_format(match image.format {
        ImageFormat::Png => image::ImageFormat::Png,
        ImageFormat::Jpeg => image::ImageFormat::Jpeg,
    });
    reader.no_limits();
    Ok(reader)
}

/// Whatever is wrong with an image is told with its file.
fn unreadable(image: &Image, error: image::ImageError) -> ExportError {
    let error = match error {
        image::ImageError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidData, other),
    };
    at(image.path.display(), &error).into()
}
