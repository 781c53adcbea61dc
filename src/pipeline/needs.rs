//! How large a cave will be on the disk, estimated from its graph before there is a mesh.
//!
//! Only the disk: PNG and JPG stream, so the memory of a chunk does not grow with the area of its maps.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use plume_exporters::ImageFormat;

use super::things::TEXEL_RATIO;
use super::{PipelineError, station_bounds};
use crate::field::Reach;
use crate::mesh::{ChunkIndex, Grid};
use crate::recipe::Recipe;
use crate::store::Stage;
use crate::texture::settings::{MAX_SIZE_PX, Resolution};
use plume_graph::{Graph, StationId};

/// Area of the rough wall relative to that of a smooth tube with the same sections. Fitted to the samples.
const ROUGH: f64 = 1.1;
/// Pixels of a map per texel on the wall, where charts are large. Fitted to the samples.
const PX_PER_TEXEL: f64 = 1.35;
/// Gutters round charts double the pixels at this density, in texels per metre. Fitted to the samples.
const GUTTERS_PX_PER_M: f64 = 23.0;
/// Bytes of all meshes per square metre of wall with voxels of 1 m; finer voxels need more by this power. Fitted to the
/// samples.
const MESH_BYTES_PER_M2: f64 = 560.0;
const MESH_POWER: f64 = -0.7;
/// Bytes of the meshes of all shapes of things, and their area in square metres. Measured on limestone, which has most.
const SHAPE_BYTES: f64 = 0.9e6;
const SHAPES_M2: f64 = 11.0;
/// Distance between points at which a passage is sampled for the chunks that it crosses, in metres.
const STEP_M: f64 = 2.0;

/// What a cave will need, about: within a factor of two for the samples. Meshes that keep every triangle need more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Needs {
    /// Area of the wall, in square metres.
    pub area_m2: f64,
    /// Number of chunks with a wall.
    pub chunks: usize,
    /// Size of all meshes on the disk, in bytes.
    pub mesh_bytes: f64,
    /// Size of all maps on the disk, in bytes.
    pub map_bytes: f64,
}

impl Needs {
    /// The needs of the cave that follows from `recipe` and `graph`.
    pub fn estimate(recipe: &Recipe, graph: &Graph) -> Self {
        let (area_m2, chunks) = (area_m2(recipe, graph), chunks(recipe, graph));
        let voxel_m = f64::from(recipe.mesh().voxel_m);
        let mesh_bytes = area_m2 * MESH_BYTES_PER_M2 * libm::pow(voxel_m, MESH_POWER);
        let most_px = chunks as f64 * squared(f64::from(MAX_SIZE_PX));
        let px = match recipe.texture().resolution() {
            Resolution::SizePx(size_px) => chunks as f64 * squared(f64::from(size_px)),
            Resolution::TexelsPerM(density) => (area_m2 * px_per_m2(f64::from(density))).min(most_px),
        };
        let (shape_bytes, shape_px) = match recipe.things().cover > 0.0 {
            true => (SHAPE_BYTES, SHAPES_M2 * px_per_m2(f64::from(TEXEL_RATIO * recipe.texture().density_px_per_m))),
            false => (0.0, 0.0),
        };
        let (mesh_bytes, px) = (mesh_bytes + shape_bytes, px + shape_px);
        Self { area_m2, chunks, mesh_bytes, map_bytes: px * bytes_per_px(recipe) }
    }

    /// Refuses a cave whose stages up to `last` would exceed the limit of its recipe.
    ///
    /// # Errors
    /// [`PipelineError::TooLarge`].
    pub fn refuse_excess(&self, recipe: &Recipe, last: Stage) -> Result<(), PipelineError> {
        let map_bytes = if last == Stage::Texture { self.map_bytes } else { 0.0 };
        let bytes = if matches!(last, Stage::Graph | Stage::Preview) { 0.0 } else { self.mesh_bytes + map_bytes };
        let limit_gb = recipe.output().max_gb;
        if bytes <= limit_gb * 1e9 {
            return Ok(());
        }
        Err(PipelineError::TooLarge {
            what: self.what(recipe, last),
            needed_gb: rounded(bytes / 1e9),
            limit_gb,
            remedy: self.remedy(recipe, last).unwrap_or_else(|| "raise mesh.voxel_m, make a smaller cave".to_owned()),
        })
    }

    fn what(&self, recipe: &Recipe, last: Stage) -> String {
        let meshes = format!("meshes with voxels of {} m", recipe.mesh().voxel_m);
        let on = format!("on about {} m² of wall", grouped(rounded(self.area_m2)));
        match recipe.texture().resolution() {
            _ if last != Stage::Texture => format!("{meshes} {on}"),
            Resolution::TexelsPerM(density) => format!("{meshes} and textures of {density} px/m {on}"),
            Resolution::SizePx(size_px) => {
                let chunks = rounded(self.chunks as f64);
                format!("{meshes} and textures of {size_px} px in about {} chunks {on}", grouped(chunks))
            }
        }
    }

    /// The setting of textures with which the cave fits, if there is one.
    fn remedy(&self, recipe: &Recipe, last: Stage) -> Option<String> {
        let free_px = (recipe.output().max_gb * 1e9 - self.mesh_bytes) / bytes_per_px(recipe);
        if last != Stage::Texture || free_px <= 0.0 {
            return None;
        }
        let (key, most, least) = match recipe.texture().resolution() {
            Resolution::TexelsPerM(_) => ("density_px_per_m", density_of(free_px / self.area_m2), 4.0),
            Resolution::SizePx(_) => ("size_px", (free_px / self.chunks as f64).sqrt(), 256.0),
        };
        (most >= least).then(|| format!("lower texture.{key} to {}", most.floor()))
    }
}

/// Pixels of the maps per square metre of wall at a density in texels per metre.
fn px_per_m2(density: f64) -> f64 {
    PX_PER_TEXEL * density * (density + GUTTERS_PX_PER_M)
}

/// The inverse of [`px_per_m2`].
fn density_of(px_per_m2: f64) -> f64 {
    (squared(GUTTERS_PX_PER_M / 2.0) + px_per_m2 / PX_PER_TEXEL).sqrt() - GUTTERS_PX_PER_M / 2.0
}

/// Bytes of all maps of a chunk per pixel of one of them. Measured on limestone, 80 texels per metre.
fn bytes_per_px(recipe: &Recipe) -> f64 {
    let formats = recipe.texture().formats();
    let one = |format, png: f64, jpg: f64| if format == ImageFormat::Jpeg { jpg } else { png };
    one(formats.base_color, 0.82, 0.29)
        + one(formats.normal, 1.17, 0.73)
        + one(formats.orm, 0.63, 0.39)
        + one(formats.roughness, 0.29, 0.23)
        + if formats.height.is_some() { HEIGHT_BYTES_PER_PX } else { 0.0 }
}

/// Bytes of a height map per pixel.
const HEIGHT_BYTES_PER_PX: f64 = 1.0;

fn area_m2(recipe: &Recipe, graph: &Graph) -> f64 {
    let girth_m = |station: StationId| {
        let Reach { aside_m, up_m, down_m } = recipe.passage().reach(&graph[station]);
        PI * f64::from(aside_m + (up_m + down_m) / 2.0)
    };
    let area_m2 = |&[a, b]: &[StationId; 2]| graph.distance_m(a, b) * (girth_m(a) + girth_m(b)) / 2.0;
    ROUGH * graph.edges.iter().map(area_m2).sum::<f64>()
}

/// Number of chunks that passages touch. 0 if there is no grid, which is reported where meshes are made.
fn chunks(recipe: &Recipe, graph: &Graph) -> usize {
    let bounds = station_bounds(graph, recipe.passage().width_per_radius);
    let Some(Ok(grid)) = bounds.map(|bounds| Grid::new(bounds, recipe.mesh())) else { return 0 };
    let first = grid.chunk_bounds(ChunkIndex([0; 3]));
    let chunk_of = |point: [f64; 3]| -> [i64; 3] {
        std::array::from_fn(|axis| {
            let [min, max] = [first.min[axis], first.max[axis]].map(f64::from);
            ((point[axis] - min) / (max - min)).floor() as i64
        })
    };
    let mut touched = BTreeSet::new();
    for &[a, b] in &graph.edges {
        let [start, end] = [a, b].map(|station| graph[station].position);
        let Reach { aside_m, up_m, down_m } = recipe.passage().reach(&graph[a]);
        let [aside_m, up_m, down_m] = [aside_m, up_m, down_m].map(f64::from);
        let steps = (graph.distance_m(a, b) / STEP_M).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let [x, y, z] = start.coords.lerp(&end.coords, step as f64 / steps as f64).into();
            touched.extend(
                [[-aside_m, 0.0, 0.0], [aside_m, 0.0, 0.0], [0.0, -aside_m, 0.0], [0.0, aside_m, 0.0]]
                    .into_iter()
                    .chain([[0.0, 0.0, up_m], [0.0, 0.0, -down_m]])
                    .map(|[dx, dy, dz]| chunk_of([x + dx, y + dy, z + dz])),
            );
        }
    }
    touched.len()
}

fn squared(x: f64) -> f64 {
    x * x
}

/// To two digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// A number with thousands separators.
fn grouped(x: f64) -> String {
    let digits = format!("{x:.0}");
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}
