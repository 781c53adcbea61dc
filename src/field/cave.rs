//! The field of a cave: smooth passages, warped and roughened by a rock.

use std::sync::Arc;

use super::index::Index;
use super::passage::{BLEND_M, Capsule, PassageSettings, Range, capsules, survey};
use super::{Aabb, Field, MAX_OFFSET_M, Region, Surface, Texel, ball_round};
use crate::material::{
    BLOCK, DomainWarp, Footprint, Ground, Look, Material, PROTRUSION, RECESS_M, Site, Sites, SurfaceSamples,
};
use crate::noise::{Jet, Source, Value, dispatched};
use fearless_simd::Simd;
use plume_graph::Graph;
use plume_graph::seed;

/// A cave to be sampled: a graph, the shape of its passages, a rock and its look.
#[derive(Debug)]
pub struct CaveField {
    index: Index,
    material: Arc<dyn Material>,
    look: Look,
    ground: Ground,
    source: Source,
    /// How far the domain warp of the rock can move a point, metres.
    wander_m: f32,
    bounds: Aabb<f32>,
}

impl CaveField {
    /// The field of this graph; `seed` affects only the rock.
    pub fn new(graph: &Graph, settings: &PassageSettings, material: Arc<dyn Material>, look: Look, seed: u64) -> Self {
        let wander_m = furthest_wander_m(material.domain_warp());
        let capsules = capsules(graph, settings, material.domain_warp());
        let walls = capsules.iter().map(|capsule| capsule.bounds().padded(RECESS_M + wander_m));
        let bounds = walls.reduce(Aabb::union).unwrap_or_else(|| [0.0; 3].into());
        Self {
            index: Index::new(capsules, BLEND_M + wander_m),
            material,
            look,
            ground: Ground { roughness_m: settings.floor_roughness_m, natural: 1.0 - settings.floor_flatness },
            source: Source::new(seed::salt(seed, "rock")),
            wander_m,
            bounds,
        }
    }

    /// A box outside which everything is rock.
    pub fn bounds(&self) -> Aabb<f32> {
        self.bounds
    }

    /// Height of the floor under a point in a passage, before stones and undulation; metres, cave frame.
    pub fn floor_z(&self, point: [f32; 3]) -> f32 {
        let mut floor = point[2];
        let domain_warp = self.material.domain_warp();
        self.blocks(point.into(), &[point], |_, capsules, sites| {
            dispatched!(simd => survey_values(simd, capsules, domain_warp, sites));
            floor = point[2] - sites.height.value[0];
        });
        floor
    }

    /// The field at arbitrary finite points, in their order.
    pub fn scattered(&self, points: &[[f32; 3]]) -> Vec<f32> {
        // Points near each other share the search for passages.
        let cell = |&point: &usize| points[point].map(|coordinate| (coordinate / TOGETHER_M).floor() as i64);
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_cached_key(cell);
        let mut distances = vec![0.0; points.len()];
        for together in order.chunk_by(|one, other| cell(one) == cell(other)) {
            let near: Vec<[f32; 3]> = together.iter().map(|&point| points[point]).collect();
            together.iter().zip(self.distances_at(&near)).for_each(|(&point, distance)| distances[point] = distance);
        }
        distances
    }

    /// Splits points into blocks, finds the capsules that influence each block, and passes both on.
    fn blocks<'a>(
        &'a self,
        bounds: Aabb<f32>,
        points: &'a [[f32; 3]],
        mut visit: impl FnMut(usize, &[&Capsule], &mut Sites),
    ) {
        let near = self.index.near(bounds);
        let mut sites = Sites::new(self.ground, self.source);
        let mut felt = Vec::with_capacity(near.len());
        for (n, block) in points.chunks(BLOCK).enumerate() {
            let around = Aabb::from_points(block.iter().copied()).expect("a block has points");
            let (centre, radius) = ball_round(around);
            felt.clear();
            felt.extend(
                near.iter().copied().filter(|capsule| capsule.near(centre, radius, self.wander_m).nearest < BLEND_M),
            );
            sites.place(block);
            visit(n * BLOCK, &felt, &mut sites);
        }
    }
}

/// Edge of the cells whose points are evaluated together, in metres. Tuned.
const TOGETHER_M: f32 = 4.0;

/// The largest displacement of a point by the domain warp, metres.
fn furthest_wander_m(domain_warp: DomainWarp) -> f32 {
    // Up to one unit along x and y, 0.6 along z.
    const LONGEST: f32 = 1.5363;
    (domain_warp.reach_m[0] + domain_warp.reach_m[1]) * LONGEST
}

/// An upper bound of how far the fillet between wall and floor, and all rounding, can move the surface; metres.
const MARGIN_M: f32 = 0.1;
const UP: [f32; 3] = [0.0, 0.0, 1.0];
/// Cosine of the largest angle from the mesh normal that a normal map can hold.
const LEAST_COSINE: f32 = 0.5;

#[inline(always)]
fn survey_values<S: Simd>(simd: S, near: &[&Capsule], domain_warp: DomainWarp, sites: &mut Sites) {
    survey::<S, Value<S>>(simd, near, domain_warp, sites);
}

#[inline(always)]
fn survey_jets<S: Simd>(simd: S, near: &[&Capsule], domain_warp: DomainWarp, sites: &mut Sites) {
    survey::<S, Jet<S>>(simd, near, domain_warp, sites);
}

fn fourth_power(x: f32) -> f32 {
    let squared = x * x;
    squared * squared
}

fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (length > 1e-6).then(|| v.map(|c| c / length))
}

/// Gradient magnitude of the field. Where it is nearly zero the distance is meaningless.
fn steepness(gradient: [f32; 3]) -> f32 {
    const LEAST: f32 = 0.25;
    gradient.iter().map(|c| c * c).sum::<f32>().sqrt().max(LEAST)
}

/// The texel of one lane, with its normal limited to the allowed angle from that of the mesh.
fn texel_of(surface_samples: &SurfaceSamples, lane: usize, mesh_normal: [f32; 3]) -> Texel {
    let of = |channels: &[[f32; BLOCK]; 3]| channels.each_ref().map(|channel| channel[lane]);
    let gradient = of(&surface_samples.gradient);
    let normal = unit(gradient.map(|c| -c)).unwrap_or(mesh_normal);
    let cosine: f32 = (0..3).map(|i| normal[i] * mesh_normal[i]).sum();
    let lacking = (LEAST_COSINE - cosine).max(0.0);
    let leaning = std::array::from_fn(|i| normal[i] + lacking * mesh_normal[i]);
    Texel {
        color: of(&surface_samples.color),
        normal: unit(leaning).unwrap_or(mesh_normal),
        roughness: surface_samples.roughness[lane],
        occlusion: surface_samples.occlusion[lane],
        height_m: surface_samples.value[lane] / steepness(gradient),
    }
}

impl Field for CaveField {
    fn region(&self, bounds: Aabb<f32>) -> Region {
        let (centre, radius) = ball_round(bounds);
        let ranges: Vec<Range> = self
            .index
            .near(bounds)
            .into_iter()
            .map(|capsule| capsule.near(centre, radius, self.wander_m))
            .filter(|range| range.nearest < BLEND_M)
            .collect();
        let wall = |distance: fn(&Range) -> f32| {
            let sum: f32 = ranges.iter().map(|range| (BLEND_M - distance(range)).max(0.0)).map(fourth_power).sum();
            BLEND_M - sum.sqrt().sqrt()
        };
        let floor_low = ranges.iter().map(|range| range.floor_low).fold(f32::INFINITY, f32::min);
        let floor_high = ranges.iter().map(|range| range.floor_high).fold(f32::NEG_INFINITY, f32::max);
        if wall(|range| range.nearest) > RECESS_M + MARGIN_M {
            return Region::Rock;
        }
        if bounds.max[2] < floor_low - Site::<()>::DITCH_M - MARGIN_M {
            return Region::Rock;
        }
        let widest = ranges.iter().map(|range| range.widest).fold(0.0, f32::max);
        let clear = wall(|range| range.furthest) < -(PROTRUSION * widest + MARGIN_M);
        if clear && bounds.min[2] > floor_high + self.ground.highest_m() + MARGIN_M {
            return Region::Air;
        }
        Region::Mixed
    }

    fn distances(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [f32]) {
        let domain_warp = self.material.domain_warp();
        self.blocks(bounds, points, |start, capsules, sites| {
            dispatched!(simd => survey_values(simd, capsules, domain_warp, sites));
            self.material.distances(sites, &mut out[start..start + sites.count]);
        });
    }

    fn normals(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [[f32; 3]]) {
        let domain_warp = self.material.domain_warp();
        self.blocks(bounds, points, |start, capsules, sites| {
            dispatched!(simd => survey_jets(simd, capsules, domain_warp, sites));
            let out = &mut out[start..start + sites.count];
            self.material.gradients(sites, out);
            for normal in out {
                *normal = unit(normal.map(|c| -c)).unwrap_or(UP);
            }
        });
    }
}

/// Points moved along their normals, metres.
fn moved(points: &[[f32; 3]], normals: &[[f32; 3]], offsets_m: &[f32]) -> Vec<[f32; 3]> {
    let along = |((point, normal), offset_m): ((&[f32; 3], &[f32; 3]), &f32)| {
        std::array::from_fn(|axis| point[axis] + normal[axis] * offset_m)
    };
    points.iter().zip(normals).zip(offsets_m).map(along).collect()
}

impl Surface for CaveField {
    fn offsets(&self, bounds: Aabb<f32>, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [f32]) {
        let within = |offset_m: f32| offset_m.clamp(-MAX_OFFSET_M, MAX_OFFSET_M);
        let mut at_mesh = vec![0.0; points.len()];
        self.distances(bounds, points, &mut at_mesh);
        // The field rises by about a metre a metre; the secant through two of its values knows better.
        for (offset_m, value) in out.iter_mut().zip(&at_mesh) {
            *offset_m = within(*value);
        }
        let mut beyond = vec![0.0; points.len()];
        self.distances(bounds.padded(MAX_OFFSET_M), &moved(points, normals, out), &mut beyond);
        for (offset_m, (start, end)) in out.iter_mut().zip(at_mesh.iter().zip(&beyond)) {
            let fall = start - end;
            if fall * *offset_m > 0.25 * *offset_m * *offset_m {
                *offset_m = within(*offset_m * start / fall);
            }
        }
    }

    fn texels(&self, bounds: Aabb<f32>, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        let domain_warp = self.material.domain_warp();
        let mut surface_samples = SurfaceSamples::default();
        self.blocks(bounds, points, |start, capsules, sites| {
            dispatched!(simd => survey_jets(simd, capsules, domain_warp, sites));
            let normals = &normals[start..start + sites.count];
            self.material.surface_samples(sites, &self.look, Footprint { texel_m }, normals, &mut surface_samples);
            for (lane, texel) in out[start..start + sites.count].iter_mut().enumerate() {
                *texel = texel_of(&surface_samples, lane, normals[lane]);
            }
        });
    }
}
