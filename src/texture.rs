//! Bakes any [`crate::field::Surface`] onto any chunk.
//!
//! [`texture`] cuts and flattens the chunk ([`unwrap`]), computes tangents ([`tangent`]), samples the surface once per texel
//! ([`bake`]) and writes the maps on the fly. Everything baked depends on the position in the cave, so the colours of
//! neighbouring chunks match at their border, whatever their atlases.

mod adjacency;
pub mod bake;
mod chart;
mod charts;
pub mod encode;
mod frames;
mod lod;
mod maps;
mod owners;
mod pack;
mod patch;
mod raster;
mod seams;
pub mod settings;
mod split_overlaps;
pub mod tangent;
pub mod unwrap;

use std::io::{self, Write};

use crate::field::Surface;
use crate::mesh::Mesh;
pub use lod::{Level, LodSettings, levels};
pub use maps::{HEIGHT_AMPLITUDE_M, Maps};
pub use settings::{KEPT_MAPS, MapFormats, OwnMap, TextureSettings};

/// A chunk ready for a renderer. Its vertices are those of the mesh, copied along seams.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textured {
    /// Vertices in metres, cave frame.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals of the mesh.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, origin at the lower left of the picture, in 0–1.
    pub uvs: Vec<[f32; 2]>,
    /// MikkTSpace tangents; the bitangent is `w * cross(normal, tangent)`.
    pub tangents: Vec<[f32; 4]>,
    /// Triangles in the order of the mesh.
    pub triangles: Vec<[u32; 3]>,
    /// The mesh vertex of which each vertex is a copy.
    pub source: Vec<u32>,
    /// Chart of each triangle.
    pub charts: Vec<u32>,
    /// Texels per metre in the plane of every chart.
    pub texels_per_m: f32,
    /// Size of every map in pixels.
    pub size_px: u32,
    /// Share of the maps covered by charts, 0–1.
    pub utilisation: f32,
}

/// Why a chunk could not be textured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// The gutters alone exceed the atlas.
    #[error("{charts} charts do not fit into {size_px} px; increase texture.size_px or make smaller chunks")]
    TooSmall {
        /// Number of charts.
        charts: usize,
        /// Side of the atlas.
        size_px: u32,
    },
    /// A map could not be written.
    #[error("cannot write a texture map: {0}")]
    Write(#[from] io::Error),
}

/// Unwraps `mesh`, bakes `surface` onto it and writes the maps to `sinks` while baking.
///
/// The same bytes for the same input on any number of threads.
///
/// # Errors
/// If the charts do not fit, or a sink fails.
pub fn texture<W: Write + Send>(
    mesh: &Mesh,
    surface: &dyn Surface,
    settings: &TextureSettings,
    sinks: Maps<W>,
) -> Result<Textured, TextureError> {
    let mut cut = unwrap::unwrap(mesh, settings.resolution())?;
    let tangents = tangent::tangents(mesh, &mut cut);
    let textured = Textured {
        positions: cut.source.iter().map(|&v| mesh.position_m(v)).collect(),
        normals: cut.source.iter().map(|&v| mesh.normals[v as usize]).collect(),
        uvs: cut.uvs,
        tangents,
        triangles: cut.triangles,
        source: cut.source,
        charts: cut.charts,
        texels_per_m: cut.texels_per_m,
        size_px: cut.size_px,
        utilisation: cut.utilisation,
    };
    bake::bake(&textured, surface, settings.format, sinks)?;
    Ok(textured)
}
