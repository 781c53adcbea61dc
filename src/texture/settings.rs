//! Settings of textures.

use plume_exporters::ImageFormat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest side of a map in pixels: the limit of common renderers.
pub const MAX_SIZE_PX: u32 = 16_384;

/// Texture maps of a chunk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TextureSettings {
    /// Texels per metre of wall, the same in every chunk; the size of the maps follows from it (a multiple of 64 px, at
    /// most 16384, for which the density is reduced).
    #[schemars(range(min = 4.0, max = 500.0))]
    pub density_px_per_m: f32,
    /// Side of each square map in pixels, for example 1024, 4096 or 16384; the density follows from it. Overrides
    /// `density_px_per_m`.
    #[schemars(range(min = 256, max = 16384))]
    pub size_px: Option<u32>,
    /// File format of the maps. Every target supports PNG. JPG is smaller and lossy. WebP is lossless, overall as large as PNG
    /// (colours a third smaller, normals larger), and supported only by glTF. JPG and WebP need each whole map in memory.
    pub format: ImageFormat,
    /// Whether to also bake a height map, a 16-bit PNG, for renderers with displacement.
    pub height: bool,
}

impl Default for TextureSettings {
    fn default() -> Self {
        Self { density_px_per_m: 80.0, size_px: None, format: ImageFormat::Png, height: false }
    }
}

/// What determines the scale of an atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// A fixed side of the atlas, with the largest density that can be packed.
    SizePx(u32),
    /// A fixed density, with the smallest side that can be packed.
    TexelsPerM(f32),
}

impl TextureSettings {
    /// The scale of these settings.
    pub fn resolution(&self) -> Resolution {
        self.size_px.map_or(Resolution::TexelsPerM(self.density_px_per_m), Resolution::SizePx)
    }
}
