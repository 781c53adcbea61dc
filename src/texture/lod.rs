//! Levels of detail of a textured chunk: fewer and fewer triangles with one set of maps.
//!
//! Promised: every level is a manifold of the same genus with the complete border of its chunk, and any level of a chunk
//! fits any level of its neighbours without cracks, since no border vertex moves and no new edge joins two of them. Every
//! triangle is in one chart and faces the viewer there. The error of a level holds at every point, in both directions. Not
//! promised: that no two triangles intersect, or that tangents are those of MikkTSpace for the coarser triangles.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Textured;
use super::seams::Seams;
use crate::mesh::{Collapser, HausdorffBound, Mesh, StopCriterion};

/// Coarser meshes of each chunk for distant cameras, with the same textures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct LodSettings {
    /// Maximum number of levels below full detail.
    #[schemars(range(min = 0, max = 6))]
    pub levels: u32,
    /// Reduction factor of triangles from level to level. Ends at a level with more than four fifths of the triangles of the
    /// previous one.
    #[schemars(range(min = 1.5, max = 16.0))]
    pub reduction: f32,
}

impl Default for LodSettings {
    fn default() -> Self {
        Self { levels: 3, reduction: 2.0 }
    }
}

/// A coarser level of a textured chunk.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Triangles over the vertices of full detail.
    pub triangles: Vec<[u32; 3]>,
    /// Chart of each triangle.
    pub charts: Vec<u32>,
    /// Hausdorff distance from full detail: an upper bound in both directions, in metres.
    pub error_m: f32,
}

/// A level with a larger share of the triangles of the previous one is not worth its bytes. Tuned.
const MOST_SHARE: f64 = 0.8;

/// The coarser levels of a chunk, where `textured` was made from `mesh`; the finest first.
pub fn levels(mesh: &Mesh, textured: &Textured, settings: &LodSettings) -> Vec<Level> {
    if mesh.triangles.is_empty() || settings.levels == 0 {
        return Vec::new();
    }
    let mut collapser = Collapser::new(mesh, Seams::new(textured, &mesh.border));
    let bound = HausdorffBound::new(mesh);
    let mut levels = Vec::new();
    for _ in 0..settings.levels {
        let before = collapser.mesh.live() as f64;
        let most_triangles = Some((before / f64::from(settings.reduction)) as usize);
        collapser.run(StopCriterion { error_m: 0.0, most_triangles });
        if collapser.mesh.live() as f64 > MOST_SHARE * before {
            break;
        }
        levels.push(level(&bound, textured, &collapser));
    }
    levels
}

fn level(bound: &HausdorffBound, textured: &Textured, collapser: &Collapser<Seams>) -> Level {
    let left = || (0..textured.triangles.len()).filter(|&triangle| collapser.mesh.is_left(triangle));
    let triangles: Vec<[u32; 3]> = left().map(|triangle| collapser.rule.triangles[triangle]).collect();
    let coarse: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|copy| textured.source[copy as usize])).collect();
    Level {
        charts: left().map(|triangle| textured.charts[triangle]).collect(),
        error_m: bound.distance_bound_m(&coarse),
        triangles,
    }
}
