//! What the user may ask of the textures.

use plume_exporters::ImageFormat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest side of a map in pixels: what the common renderers accept.
pub const MAX_SIZE_PX: u32 = 16_384;

/// Texture maps of a chunk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TextureSettings {
    /// Texels per metre of wall, the same in every chunk; the size of the maps then follows (a multiple of 64 px, at
    /// most 16384, where the density gives way).
    #[schemars(range(min = 4.0, max = 500.0))]
    pub density_px_per_m: f32,
    /// Side of each square map in pixels, for example 1024, 4096 or 16384; the density then follows from the chunk.
    /// Overrides `density_px_per_m`.
    #[schemars(range(min = 256, max = 16384))]
    pub size_px: Option<u32>,
    /// File format of the maps. Every target reads PNG. JPG is smaller and lossy. WebP is lossless, as large as PNG on the
    /// whole (colours a third smaller, normals larger), and read by glTF only. JPG and WebP need each whole map in memory.
    pub format: ImageFormat,
    /// Whether to bake a height map as well, for renderers that displace: a PNG of 16 bits.
    pub height: bool,
}

impl Default for TextureSettings {
    fn default() -> Self {
        Self { density_px_per_m: 80.0, size_px: None, format: ImageFormat::Png, height: false }
    }
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
        self.size_px.map_or(Resolution::TexelsPerM(self.density_px_per_m), Resolution::SizePx)
    }
}
