//! The field of a cave: smooth passages, warped and roughened by a rock.

use std::sync::Arc;

use super::drips::Drips;
use super::index::Index;
use super::lattice::{self, Lattice, Run};
use super::passage::{BLEND_M, Capsule, Collapse, Heap, PassageSettings, ROCK_M, Range, capsules, collapses, survey};
use super::{Aabb, Columns, Field, MAX_OFFSET_M, Region, Surface, Texel, ball_round};
use crate::material::{
    BLOCK, CHANNELS, CoarseBlock, DomainWarp, Footprint, Ground, Look, Material, PROTRUSION, RECESS_M, Site, Sites,
    SurfaceSamples, by_axis,
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
    heaps: Vec<Heap>,
    drips: Drips,
}

impl CaveField {
    /// The field of this graph; `seed` affects only the rock and where it fell from the roof.
    pub fn new(graph: &Graph, settings: &PassageSettings, material: Arc<dyn Material>, look: Look, seed: u64) -> Self {
        let wander_m = furthest_wander_m(material.domain_warp());
        let mut capsules = capsules(graph, settings, material.domain_warp());
        // Rooms, which follow the passages, are part of them.
        let passages = Index::new(capsules[..graph.edges.len()].to_vec(), ROCK_M);
        let fallen = collapses(graph, settings, material.domain_warp(), seed, |bounds| passages.numbered(bounds));
        let heaps = fallen.iter().map(|Collapse { heap, .. }| *heap).collect();
        capsules.extend(fallen.into_iter().flat_map(|fall| fall.capsules));
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
            heaps,
            drips: Drips::new(seed),
        }
    }

    /// Where water drips from the roof.
    pub fn drips(&self) -> &Drips {
        &self.drips
    }

    /// Where rock lies in heaps, in the order of the graph's edges.
    pub fn heaps(&self) -> &[Heap] {
        &self.heaps
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

    /// Passes on the coarse surface, block by block.
    fn coarse_blocks(
        &self,
        bounds: Aabb<f32>,
        points: &[[f32; 3]],
        block: &mut CoarseBlock,
        mut visit: impl FnMut(usize, &CoarseBlock),
    ) {
        let domain_warp = self.material.domain_warp();
        self.blocks(bounds, points, |start, capsules, sites| {
            dispatched!(simd => survey_jets(simd, capsules, domain_warp, sites));
            self.material.coarse(sites, block);
            if self.material.is_crusted_by_drips() {
                block.raise_state(&self.drips.crusted(&points[start..start + sites.count]));
            }
            visit(start, block);
        });
    }

    /// Appends the coarse surface at positions near each other.
    fn coarse_records(&self) -> impl FnMut(&[[f32; 3]], &mut Vec<[f32; CHANNELS]>) {
        let mut block = CoarseBlock::new(self.ground, self.source);
        move |positions, records| {
            let bounds = Aabb::from_points(positions.iter().copied()).expect("there are positions");
            self.coarse_blocks(bounds, positions, &mut block, |_, block| {
                records.extend((0..block.count).map(|lane| block.record(lane)));
            });
        }
    }

    /// The texels of a block, as many as it has points. `samples` is overwritten.
    fn paint(
        &self,
        texel_m: f32,
        block: &CoarseBlock,
        normals: &[[f32; BLOCK]; 3],
        samples: &mut SurfaceSamples,
        texels: &mut [Texel],
    ) {
        self.material.surface_samples(block, &self.look, Footprint { texel_m }, normals, samples);
        texels.iter_mut().enumerate().for_each(|(lane, texel)| *texel = texel_of(samples, lane));
    }

    /// Moves points along their normals to the wall without detail, and tells how far, in metres.
    fn on_wall(&self, lattice: &mut Lattice, points: Columns, normals: Columns) -> ([Vec<f32>; 3], Vec<f32>) {
        let runs = lattice.runs(points, self.coarse_records());
        let fields = lattice.fields(&runs, points);
        let offsets_m = dispatched!(simd => offsets_m(simd, &fields, normals));
        let moved = [0, 1, 2].map(|axis| dispatched!(simd => moved(simd, points[axis], normals[axis], &offsets_m)));
        (moved, offsets_m)
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

/// The texel of one lane.
fn texel_of(samples: &SurfaceSamples, lane: usize) -> Texel {
    let of = |channels: &[[f32; BLOCK]; 3]| channels.each_ref().map(|channel| channel[lane]);
    Texel {
        color: of(&samples.color),
        normal: of(&samples.normal),
        roughness: samples.roughness[lane],
        occlusion: samples.occlusion[lane],
        height_m: samples.height_m[lane],
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

impl Surface for CaveField {
    fn texels(&self, bounds: Aabb<f32>, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        let mut block = CoarseBlock::new(self.ground, self.source);
        let mut samples = SurfaceSamples::default();
        self.coarse_blocks(bounds, points, &mut block, |start, block| {
            let range = start..start + block.count;
            self.paint(texel_m, block, &by_axis(&normals[range.clone()]), &mut samples, &mut out[range]);
        });
    }

    fn dense_texels(&self, texel_m: f32, points: Columns, normals: Columns, out: &mut [Texel]) {
        let mut lattice = Lattice::new(texel_m);
        let (on_wall, offsets_m) = self.on_wall(&mut lattice, points, normals);
        let mut runs = lattice.runs(on_wall.each_ref().map(Vec::as_slice), self.coarse_records());
        // Points in one cell share its nodes.
        runs.sort_unstable();
        let on_wall = on_wall.each_ref().map(|column| in_order(&runs, column));
        let normals = normals.map(|column| in_order(&runs, column));
        let mut block = CoarseBlock::new(self.ground, self.source);
        let mut samples = SurfaceSamples::default();
        let mut texels = vec![Texel::default(); out.len()];
        for ((n, texels), runs) in texels.chunks_mut(BLOCK).enumerate().zip(lattice::blocks(&runs)) {
            let range = n * BLOCK..n * BLOCK + texels.len();
            block.place(on_wall.each_ref().map(|column| &column[range.clone()]));
            lattice.fill(&runs, &mut block);
            let mut upright = [[0.0; BLOCK]; 3];
            for (to, from) in upright.iter_mut().zip(&normals) {
                to[..texels.len()].copy_from_slice(&from[range.clone()]);
            }
            self.paint(texel_m, &block, &upright, &mut samples, texels);
        }
        let mut rest = &texels[..];
        for run in &runs {
            let (here, after) = rest.split_at(run.len as usize);
            out[run.range()].copy_from_slice(here);
            rest = after;
        }
        out.iter_mut().zip(&offsets_m).for_each(|(texel, offset_m)| texel.height_m += offset_m);
    }
}

/// How far along a unit normal the wall is, by Newton's method from the field and its gradient; metres.
#[inline(always)]
fn offsets_m<S: Simd>(_simd: S, [value, x, y, z]: &[Vec<f32>; 4], normals: Columns) -> Vec<f32> {
    /// Where the wall leans further, the step would lead to another part of it. Tuned.
    const LEAST_FALL: f32 = 0.25;
    let len = normals[0].len();
    let (value, x, y, z) = (&value[..len], &x[..len], &y[..len], &z[..len]);
    let [nx, ny, nz] = normals.map(|column| &column[..len]);
    let mut offsets_m = vec![0.0; len];
    for (at, offset_m) in offsets_m.iter_mut().enumerate() {
        let fall = -(x[at] * nx[at] + y[at] * ny[at] + z[at] * nz[at]);
        *offset_m = (value[at] / fall.max(LEAST_FALL)).clamp(-MAX_OFFSET_M, MAX_OFFSET_M);
    }
    offsets_m
}

/// One coordinate of points moved along their normals.
#[inline(always)]
fn moved<S: Simd>(_simd: S, points: &[f32], normals: &[f32], offsets_m: &[f32]) -> Vec<f32> {
    points.iter().zip(normals).zip(offsets_m).map(|((point, normal), offset_m)| point + normal * offset_m).collect()
}

/// A column in the order of these runs.
fn in_order(runs: &[Run], column: &[f32]) -> Vec<f32> {
    let mut ordered = Vec::with_capacity(column.len());
    for run in runs {
        ordered.extend_from_slice(&column[run.range()]);
    }
    ordered
}
