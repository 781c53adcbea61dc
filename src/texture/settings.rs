//! What the user may ask of the textures.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest side of a map in pixels: what the common renderers accept.
pub const MAX_SIZE_PX: u32 = 16_384;

/// Texture maps of a chunk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TextureSettings {
    /// Side of each square map in pixels; the density follows from the chunk. Not used when `density_px_per_m` is set.
    #[schemars(range(min = 256, max = 16384))]
    pub size_px: u32,
    /// Texels per metre of wall, the same in every chunk; the size of the maps then follows (a multiple of 64 px, at
    /// most 16384, where the density gives way). 0: use `size_px`.
    #[schemars(range(min = 0.0, max = 500.0))]
    pub density_px_per_m: f32,
    /// File format of the maps. JPG is smaller and lossy, and needs each whole map in memory; MuJoCo reads PNG only.
    pub format: ImageFormat,
}

impl Default for TextureSettings {
    fn default() -> Self {
        Self {
            size_px: 1024,
            density_px_per_m: 0.0,
            format: ImageFormat::Png,
        }
    }
}

/// File format of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImageFormat {
    /// Lossless, fast filters.
    #[default]
    Png,
    /// Quality 90, no chroma subsampling.
    Jpg,
}

/// What fixes the scale of an atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// The side of the atlas; the largest density that packs follows.
    SizePx(u32),
    /// The density; the smallest side that packs follows.
    TexelsPerM(f32),
}

impl TextureSettings {
    /// The scale these settings ask for.
    pub fn resolution(&self) -> Resolution {
        if self.density_px_per_m > 0.0 {
            return Resolution::TexelsPerM(self.density_px_per_m);
        }
        Resolution::SizePx(self.size_px)
    }
}
