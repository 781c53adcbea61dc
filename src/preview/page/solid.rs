//! A low-poly wall of a cave.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::Point3;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::packed;
use crate::field::Reach;
use crate::mesh::{self, ChunkIndex, Grid, Mesh, MeshSettings, QUANTA_PER_M};
use crate::preview::{Furnishing, PreviewError, Subject};
use crate::things::{self, Library, Thing};
use plume_graph::{Aabb, StationId};

/// Number of triangles before simplification. Tuned: about a second on two cores.
const TRIANGLES: f64 = 120_000.0;
/// Range of voxel sizes, metres: finer adds nothing visible, coarser closes passages.
const LEAST_VOXEL_M: f64 = 0.25;
const MOST_VOXEL_M: f64 = 0.6;
/// Simplification error, in voxels.
const ERROR_CELLS: f32 = 0.2;
/// Edge of a chunk in voxels.
const CHUNK_CELLS: f32 = 48.0;

/// The wall, chunk by chunk.
pub struct Solid {
    chunks: Vec<Mesh>,
}

impl Solid {
    /// The wall; `None` if it is too large to be made quickly.
    pub fn of(subject: &Subject, stop: &AtomicBool) -> Result<Option<Self>, PreviewError> {
        let voxel_m = (2.0 * area_m2(subject) / TRIANGLES).sqrt().max(LEAST_VOXEL_M);
        if voxel_m > MOST_VOXEL_M {
            return Ok(None);
        }
        let voxel_m = voxel_m as f32;
        let settings = MeshSettings {
            voxel_m,
            chunk_m: [voxel_m * CHUNK_CELLS; 3],
            simplify_error_m: voxel_m * ERROR_CELLS,
            ..MeshSettings::default()
        };
        let Ok(grid) = Grid::new(subject.field.bounds(), &settings) else {
            return Ok(None);
        };
        let indices: Vec<ChunkIndex> = grid.indices().collect();
        let chunk = |&index: &ChunkIndex| {
            if stop.load(Ordering::Relaxed) {
                return Err(PreviewError::Stopped);
            }
            Ok(mesh::visual_chunk(subject.field, &grid, index, &settings))
        };
        let chunks = indices.par_iter().map(chunk).collect::<Result<Vec<Option<Mesh>>, _>>()?;
        let mut chunks: Vec<Mesh> = chunks.into_iter().flatten().collect();
        if let Some(Furnishing { setting, .. }) = &subject.furnishing {
            let Aabb { min, max } = subject.field.bounds();
            let everywhere = Aabb { min: min.map(f64::from), max: max.map(f64::from) };
            chunks.push(hulls(setting.library, &things::place(setting, everywhere, chunks.iter())));
        }
        Ok(Some(Self { chunks }))
    }

    /// As arrays: positions in steps from a corner, normals in 127ths.
    pub fn to_json(&self) -> Value {
        let positions = || self.chunks.iter().flat_map(|chunk| &chunk.positions);
        let bounds = Aabb::from_points(positions().copied()).unwrap_or_else(|| [0; 3].into());
        let corner = bounds.min;
        let widest = bounds.size()[bounds.longest_axis()];
        // Step size in quanta such that the longest side fits into 16 bits.
        let step = widest / i32::from(u16::MAX) + 1;
        let steps = positions().flat_map(|at| [0, 1, 2].map(|i| ((at[i] - corner[i]) / step) as u16));
        let normals = self.chunks.iter().flat_map(|chunk| &chunk.normals).flatten();
        let quantum_m = 1.0 / f64::from(QUANTA_PER_M);
        json!({
            "corner": corner.map(|quanta| f64::from(quanta) * quantum_m),
            "step": f64::from(step) * quantum_m,
            "positions": packed(steps.flat_map(u16::to_le_bytes)),
            "normals": packed(normals.flat_map(|c| ((c * 127.0).round() as i8).to_le_bytes())),
            "triangles": packed(self.triangles().flatten().flat_map(u32::to_le_bytes)),
        })
    }

    /// The triangles of all chunks, as indices into the vertices of all.
    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let starts = self.chunks.iter().scan(0_u32, |next, chunk| {
            let start = *next;
            *next += chunk.positions.len() as u32;
            Some(start)
        });
        let moved = |(chunk, start): (&Mesh, u32)| -> Vec<[u32; 3]> {
            chunk.triangles.iter().map(|triangle| triangle.map(|corner| corner + start)).collect()
        };
        self.chunks.iter().zip(starts).flat_map(moved)
    }
}

/// The convex hulls of all things that are large enough to be seen, with flat faces.
fn hulls(library: &Library, things: &[Thing]) -> Mesh {
    /// Narrowest thing in metres.
    const LEAST_M: f64 = 0.2;
    let mut all = Mesh::default();
    for thing in things {
        let Some(prototype) = library.named(&thing.prototype) else { continue };
        if prototype.size_m.max() * thing.scale < LEAST_M {
            continue;
        }
        for face in &prototype.hull.faces {
            let corners = face.map(|corner| thing.pose * (prototype.hull.corners[corner as usize] * thing.scale));
            let [a, b, c] = corners;
            let normal = (b - a).cross(&(c - a)).normalize().map(|c| c as f32);
            let first = all.positions.len() as u32;
            let quanta = |at: Point3<f64>| <[f64; 3]>::from(at).map(|c| (c * f64::from(QUANTA_PER_M)).round() as i32);
            all.positions.extend(corners.map(quanta));
            all.normals.extend([<[f32; 3]>::from(normal); 3]);
            all.triangles.push([first, first + 1, first + 2]);
        }
    }
    all
}

/// Approximate area of the wall: every passage as a tube.
fn area_m2(subject: &Subject) -> f64 {
    let around_m = |station: StationId| {
        let Reach { aside_m, up_m, down_m } = subject.passage.reach(&subject.graph[station]);
        PI * f64::from(aside_m + (up_m + down_m) / 2.0)
    };
    let tube = |&[a, b]: &[StationId; 2]| subject.graph.distance_m(a, b) * (around_m(a) + around_m(b)) / 2.0;
    subject.graph.edges.iter().map(tube).sum()
}
