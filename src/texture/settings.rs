//! Settings of textures.

use std::path::PathBuf;

use plume_exporters::ImageFormat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Maps;

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
    /// File formats of the maps: `mixed`, JPG for the base colour, which loses nothing that can be seen, and PNG for the
    /// rest; or one format for all of them. PNG is lossless; JPG is half as large, and its normals are off by up to 15°;
    /// WebP is lossless, overall as large as PNG (colours a third smaller, normals larger), supported only by glTF, and
    /// needs each whole map in memory.
    pub format: MapFormats,
    /// Whether to also bake a height map, a 16-bit PNG, for renderers with displacement.
    pub height: bool,
    /// A folder with maps of your own for the rock, relative to the recipe: `base_color.png` (sRGB) and, if you like, `normal.png`
    /// (OpenGL, y up) and `roughness.png` (linear), each square and tileable. They replace the colours of the rock and, if there is
    /// such a map, its roughness; normals are added to those of the rock, whose shape remains. Stones and dripstone, which are of
    /// that rock, have them too.
    #[schemars(extend("format" = "path", "minLength" = 1))]
    pub own: Option<PathBuf>,
    /// Side of a tile of these maps in metres. At most 2048 pixels of it are shown.
    #[schemars(range(min = 0.05, max = 100.0))]
    pub own_m: f32,
}

/// A map of the user's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OwnMap {
    /// Colours.
    BaseColor,
    /// Normals in tangent space.
    Normal,
    /// Perceptual roughness.
    Roughness,
}

impl OwnMap {
    /// All of them.
    const ALL: [Self; 3] = [Self::BaseColor, Self::Normal, Self::Roughness];

    /// Its file in the folder that a recipe names.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::BaseColor => "base_color.png",
            Self::Normal => "normal.png",
            Self::Roughness => "roughness.png",
        }
    }

    /// Where a cave folder keeps it.
    pub fn kept_path(self) -> String {
        format!("{KEPT_MAPS}/{}", self.file_name())
    }

    /// Whether a cave folder keeps one there.
    pub fn is_kept_at(path: &str) -> bool {
        Self::ALL.into_iter().any(|map| map.kept_path() == path)
    }
}

/// The folder of a cave folder for maps of the user's own.
pub const KEPT_MAPS: &str = "maps";

impl Default for TextureSettings {
    fn default() -> Self {
        Self {
            density_px_per_m: 128.0,
            size_px: None,
            format: MapFormats::default(),
            height: false,
            own: None,
            own_m: 2.0,
        }
    }
}

/// File formats of the maps of a chunk. Height maps are always PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MapFormats {
    /// JPEG for the base colour, PNG for the rest.
    #[default]
    Mixed,
    /// PNG for all.
    Png,
    /// JPEG for all.
    #[serde(rename = "jpg")]
    Jpeg,
    /// WebP for all.
    #[serde(rename = "webp")]
    WebP,
}

impl MapFormats {
    /// All choices.
    pub const ALL: [Self; 4] = [Self::Mixed, Self::Png, Self::Jpeg, Self::WebP];

    /// Its word in recipes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mixed => "mixed",
            Self::Png => "png",
            Self::Jpeg => "jpg",
            Self::WebP => "webp",
        }
    }

    /// Whether every map of a package is in one of these formats. Height maps are always PNG, and few targets take them.
    pub fn is_among(self, formats: &[ImageFormat]) -> bool {
        let Maps { base_color, normal, orm, roughness, .. } = self.each();
        [base_color, normal, orm, roughness].iter().all(|format| formats.contains(format))
    }

    /// The format of each map.
    pub fn each(self) -> Maps<ImageFormat> {
        let maps = |base_color, rest| Maps {
            base_color,
            normal: rest,
            orm: rest,
            roughness: rest,
            height: Some(ImageFormat::Png),
        };
        match self {
            Self::Mixed => maps(ImageFormat::Jpeg, ImageFormat::Png),
            Self::Png => maps(ImageFormat::Png, ImageFormat::Png),
            Self::Jpeg => maps(ImageFormat::Jpeg, ImageFormat::Jpeg),
            Self::WebP => maps(ImageFormat::WebP, ImageFormat::WebP),
        }
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

    /// The format of each map that these settings ask for.
    pub fn formats(&self) -> Maps<ImageFormat> {
        let each = self.format.each();
        Maps { height: each.height.filter(|_| self.height), ..each }
    }
}
