//! Unwraps a chunk: every triangle gets its own place in a square, all at one density.
//!
//! Charts are orthographic projections along six axes: every part of the wall of a cave approximately faces one of them, so
//! no optimisation is needed and the cost is linear. Promised: no two charts are nearer than [`gutter_px`], no texel
//! centre has triangles of two charts, one density for all. Not promised: minimum stretch or waste.

use super::TextureError;
use super::adjacency::neighbours;
use super::chart::{Chart, Scale, seen_area};
use super::charts::charts;
pub use super::pack::gutter_px;
use super::pack::pack;
use super::raster::SUBTEXELS;
use super::settings::{MAX_SIZE_PX, Resolution};
use super::split_overlaps::split_overlaps;
use crate::mesh::{Mesh, QUANTA_PER_M};

/// A mesh cut along the seams of its charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Unwrapped {
    /// The mesh vertex of which each vertex is a copy.
    pub source: Vec<u32>,
    /// Texture coordinates of each vertex, origin at the lower left of the picture, in 0–1.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles of the mesh in its order, with these vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Chart of each triangle.
    pub charts: Vec<u32>,
    /// Number of charts.
    pub chart_count: u32,
    /// Texels per metre in the plane of every chart.
    pub texels_per_m: f32,
    /// Size of the atlas in texels.
    pub size_px: u32,
    /// Share of the atlas covered by charts, 0–1.
    pub utilisation: f32,
}

/// Coverage of the atlas assumed by the first attempt; tuned.
const HOPED_UTILISATION: f64 = 0.66;
/// Factor on the coverage per step of the search.
const STEP: f64 = 0.98;
/// Maximum number of steps: beyond, the coverage would be a tenth of a per cent, almost all gutter.
const MAX_STEPS: i32 = 320;
/// Most steps by which a search may end above its start.
const MAX_RISE: i32 = 12;
/// Densest atlas: one texel per mesh quantum.
const MAX_TEXELS_PER_M: f64 = QUANTA_PER_M as f64;
/// Sides that follow from a density are multiples of this.
const SIZE_STEP_PX: u32 = 64;
/// How many times charts are split again at the density found by packing; remaining overlaps of texel centres are resolved
/// by the rule that the first triangle wins.
const REPACKS: usize = 4;

/// Cuts, flattens and packs `mesh`.
///
/// # Errors
/// [`TextureError::TooSmall`] if the charts do not fit even at a vanishing density.
pub fn unwrap(mesh: &Mesh, resolution: Resolution) -> Result<Unwrapped, TextureError> {
    if mesh.triangles.is_empty() {
        return Ok(Unwrapped::empty(resolution));
    }
    let across = neighbours(mesh.positions.len(), &mesh.triangles);
    let charts = charts(mesh, &across);
    let area_m2 = area_m2(mesh, &charts);
    let mut plan = Plan::new(resolution, area_m2);
    let mut charts = split_overlaps(mesh, &across, charts, plan.scale());
    let mut origins = plan.settle(mesh, &charts)?;
    for _ in 0..REPACKS {
        let count = charts.len();
        charts = split_overlaps(mesh, &across, charts, plan.scale());
        if charts.len() == count {
            break;
        }
        origins = plan.settle(mesh, &charts)?;
    }
    Ok(Unwrapped::new(mesh, &charts, &origins, &plan))
}

fn area_m2(mesh: &Mesh, charts: &[Chart]) -> f64 {
    let area = |chart: &Chart| -> f64 { chart.triangles.iter().map(|&t| seen_area(mesh, t, chart.axis)).sum() };
    charts.iter().map(area).sum::<f64>() / (f64::from(QUANTA_PER_M) * f64::from(QUANTA_PER_M))
}

/// State of the search for the scale.
struct Plan {
    area_m2: f64,
    texels_per_m: f64,
    size_px: u32,
    /// Step of the search that gave the density, from which the next search starts.
    step: i32,
    /// Whether the density is given and the size follows, until the size reaches its limit.
    grows: bool,
}

impl Plan {
    fn new(resolution: Resolution, area_m2: f64) -> Self {
        let area_m2 = area_m2.max(f64::MIN_POSITIVE);
        match resolution {
            Resolution::SizePx(size_px) => Self::of_size(size_px, area_m2),
            Resolution::TexelsPerM(density) => {
                let texels_per_m = f64::from(density);
                let side = texels_per_m * (area_m2 / HOPED_UTILISATION).sqrt();
                let steps = (side / f64::from(SIZE_STEP_PX)).ceil().max(1.0);
                if steps * f64::from(SIZE_STEP_PX) > f64::from(MAX_SIZE_PX) {
                    return Self::of_size(MAX_SIZE_PX, area_m2);
                }
                Self { area_m2, texels_per_m, size_px: steps as u32 * SIZE_STEP_PX, step: 0, grows: true }
            }
        }
    }

    fn of_size(size_px: u32, area_m2: f64) -> Self {
        let mut plan = Self { area_m2, texels_per_m: 0.0, size_px, step: 0, grows: false };
        plan.texels_per_m = plan.density(0);
        plan
    }

    fn scale(&self) -> Scale {
        Scale::new(self.texels_per_m)
    }

    /// The density after `step` steps of the search.
    fn density(&self, step: i32) -> f64 {
        let covered = HOPED_UTILISATION * libm::pow(STEP, f64::from(step));
        let side = f64::from(self.size_px);
        (side * (covered / self.area_m2).sqrt()).min(MAX_TEXELS_PER_M)
    }

    /// Finds the scale at which `charts` can be packed, and their positions.
    fn settle(&mut self, mesh: &Mesh, charts: &[Chart]) -> Result<Vec<[u32; 2]>, TextureError> {
        while self.grows {
            if let Some(origins) = pack(mesh, charts, self.scale(), self.size_px) {
                return Ok(origins);
            }
            self.size_px += (self.size_px / 50).next_multiple_of(SIZE_STEP_PX);
            if self.size_px > MAX_SIZE_PX {
                *self = Self::of_size(MAX_SIZE_PX, self.area_m2);
            }
        }
        self.densest(mesh, charts)
    }

    /// Doubles the stride until packing succeeds, then bisects.
    fn densest(&mut self, mesh: &Mesh, charts: &[Chart]) -> Result<Vec<[u32; 2]>, TextureError> {
        let attempt = |step: i32| pack(mesh, charts, Scale::new(self.density(step)), self.size_px);
        let (mut best, mut fails, mut stride) = (self.step, self.step - MAX_RISE, 1);
        let mut origins = attempt(best);
        while origins.is_none() {
            if best > MAX_STEPS {
                return Err(TextureError::TooSmall { charts: charts.len(), size_px: self.size_px });
            }
            fails = best;
            best += stride;
            stride *= 2;
            origins = attempt(best);
        }
        let mut origins = origins.expect("the loop ends with a packing");
        while best - fails > 1 {
            // Upwards from the first guess in single steps, since a failing packing is the most expensive.
            let higher = if stride == 1 { best - 1 } else { fails + (best - fails) / 2 };
            match attempt(higher) {
                Some(found) => (best, origins) = (higher, found),
                None => fails = higher,
            }
        }
        self.step = best;
        self.texels_per_m = self.density(best);
        Ok(origins)
    }
}

impl Unwrapped {
    fn empty(resolution: Resolution) -> Self {
        let plan = Plan::new(resolution, 0.0);
        Self {
            source: vec![],
            uvs: vec![],
            triangles: vec![],
            charts: vec![],
            chart_count: 0,
            texels_per_m: plan.texels_per_m as f32,
            size_px: plan.size_px,
            utilisation: 0.0,
        }
    }

    fn new(mesh: &Mesh, charts: &[Chart], origins: &[[u32; 2]], plan: &Plan) -> Self {
        let covered = plan.area_m2 * plan.texels_per_m * plan.texels_per_m;
        let mut cut = Self {
            source: vec![],
            uvs: vec![],
            triangles: vec![[0; 3]; mesh.triangles.len()],
            charts: vec![0; mesh.triangles.len()],
            chart_count: charts.len() as u32,
            texels_per_m: plan.texels_per_m as f32,
            size_px: plan.size_px,
            utilisation: (covered / (f64::from(plan.size_px) * f64::from(plan.size_px))) as f32,
        };
        // The copy of each mesh vertex in the current chart.
        let mut copies = vec![(u32::MAX, 0_u32); mesh.positions.len()];
        for (k, (chart, &origin)) in charts.iter().zip(origins).enumerate() {
            for &t in &chart.triangles {
                cut.charts[t as usize] = k as u32;
                cut.triangles[t as usize] = mesh.triangles[t as usize].map(|vertex| {
                    let copy = &mut copies[vertex as usize];
                    if copy.0 != k as u32 {
                        *copy = (k as u32, cut.source.len() as u32);
                        cut.source.push(vertex);
                        cut.uvs.push(uv(chart.place(mesh, vertex, plan.scale()), origin, plan.size_px));
                    }
                    copy.1
                });
            }
        }
        cut
    }
}

fn uv(steps: [i32; 2], origin: [u32; 2], size_px: u32) -> [f32; 2] {
    let side = f64::from(size_px) * f64::from(SUBTEXELS);
    [0, 1].map(|k| ((f64::from(origin[k]) * f64::from(SUBTEXELS) + f64::from(steps[k])) / side) as f32)
}
