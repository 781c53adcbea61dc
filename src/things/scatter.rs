//! Stones on the floor: how many there are where, and what they lie on.

use nalgebra::{Isometry3, Point3, Translation3};

use super::Thing;
use super::facets::{Facets, beyond_m};
use super::kind::{KindRow, Place, Scatter};
use super::place::{Candidate, Site, owns, quantised, without_overlaps};
use super::rest::{Bed, GOLDEN_ANGLE_RAD, LEAST_LEVEL, about_z, long_edges};
use crate::field::{CaveField, Heap};
use crate::noise::smooth_step;
use plume_graph::Aabb;

/// Steepest floor over which stones are let down: upward component of its normal below the middle.
const LEVEL: f64 = 0.78;
/// Width in metres of stones that lie on a single triangle of the floor.
const SMALL_M: f64 = 0.15;
/// Side of the cells that have a candidate each, relative to the largest width. Tuned: half of the boulders tried come to rest.
const CELL: f64 = 0.6;
/// How deep stones are sunk, in metres: all alike, so that those that lie on others sink with them.
const EMBEDDING_M: f64 = 0.008;
/// How deep a corner or an edge may be in the rock before a stone is sunk, in metres: triangles are about as far from the field.
const MOST_DEPTH_M: f32 = 0.02;
/// Mean of [`Scatter`]'s density over the floors of the sample caves, by which `cover` is met. Tuned.
const MEAN_DENSITY: f64 = 0.04;

impl<'a> Site<'a> {
    /// Loose stones in a chunk and around it, beside what stands there. Kinds follow each other from large to small, and a
    /// stone lies on the wall or on larger kinds.
    pub fn stones(&self, chunk: Aabb<f64>, standing: &[Candidate<'a>]) -> Vec<Thing> {
        let loose = |row: KindRow<'a>| match row.place {
            Place::Floor(scatter) => Some((row, scatter.hardened(self.setting.settings.difficulty))),
            _ => None,
        };
        let mut kinds: Vec<(KindRow<'a>, Scatter)> = self.rows().filter_map(loose).collect();
        kinds.sort_by(|(_, a), (_, b)| b.width_m[1].total_cmp(&a.width_m[1]));
        let (mut lying, mut things) = (Facets::default(), Vec::new());
        for (n, (row, scatter)) in kinds.iter().enumerate() {
            let margin_m: f64 = kinds[n..].iter().map(|(_, kind)| kind.width_m[1]).sum();
            let bounds = chunk.padded(margin_m);
            let candidates = self.scattered(*row, *scatter, bounds.padded(scatter.width_m[1]));
            let at_rest: Vec<(Candidate, Isometry3<f64>)> = candidates
                .into_iter()
                .filter_map(|mut candidate| {
                    let pose = self.rest(&candidate, &lying)?;
                    // Of two floors over each other, stones may come to lie on one and the same boulder.
                    candidate.at.z = pose.translation.z;
                    Some((candidate, pose))
                })
                .collect();
            let free = self.is_out_of_the_rock(&at_rest);
            let at_rest: Vec<_> =
                at_rest.into_iter().zip(free).filter(|(_, free)| *free).map(|(stone, _)| stone).collect();
            let mut beside = standing.to_vec();
            beside.extend(at_rest.iter().map(|(candidate, _)| candidate.clone()));
            let kept = without_overlaps(&beside);
            for ((candidate, pose), _) in at_rest.iter().zip(&kept[standing.len()..]).filter(|(_, kept)| **kept) {
                if owns(&bounds, candidate.at.coords) {
                    lying.add(&candidate.prototype.hull, candidate.scale, pose);
                    things.push(candidate.thing(Translation3::new(0.0, 0.0, -EMBEDDING_M) * pose));
                }
            }
        }
        things
    }

    /// Candidates of a kind of loose stones, where the floor is level enough.
    pub fn scattered(&self, row: KindRow<'a>, scatter: Scatter, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let side_m = CELL * scatter.width_m[1];
        let widths = Widths::of(&scatter);
        let at_mean = self.settings.cover * scatter.share * side_m * side_m / widths.mean_area_m2() / MEAN_DENSITY;
        let heaps = Heaps::around(self.setting.field, &around);
        let shapes = self.setting.library.of(&row);
        let mut found = Vec::new();
        for (mut lots, x, y) in self.cells(&row, side_m, around) {
            // Most candidates are dropped here, before anything is looked up.
            let there = lots.unit() / at_mean;
            let is_bare = |heaped: f64| there > Density::most(heaped);
            if is_bare(1.0) || is_bare(0.0) && is_bare(heaps.on_map(x, y)) {
                continue;
            }
            let hits = self.walls.hits(x, y);
            if hits.is_empty() {
                continue;
            }
            let width_m = quantised(widths.at(lots.unit()));
            let yaw_rad = std::f64::consts::TAU * lots.unit();
            let Some(prototype) = lots.one_of(shapes) else { continue };
            let least = if width_m < SMALL_M { LEAST_LEVEL } else { LEVEL };
            let level = hits.iter().filter(|hit| hit.normal.z > least);
            for hit in lots.one_per_storey(level, |hit| hit.z) {
                let scale = width_m / prototype.width_m();
                let candidate = Candidate {
                    id: lots.id(hit.z),
                    row,
                    prototype,
                    scale,
                    yaw_rad,
                    at: Point3::new(x, y, hit.z),
                    embedding_m: EMBEDDING_M,
                    stands: true,
                    rank: width_m,
                };
                let height_m = prototype.size_m.z * scale - candidate.embedding_m;
                if height_m > self.settings.step_m && self.corridor.is_within(candidate.at, candidate.reach_m()) {
                    continue;
                }
                found.push((candidate, there));
            }
        }
        let places: Vec<Point3<f64>> = found.iter().map(|(candidate, ..)| candidate.at).collect();
        let density = Density::new(self.setting.field, &heaps, &places);
        let numbered = found.into_iter().enumerate();
        numbered.filter(|(n, (_, there))| *there < density.at(*n)).map(|(_, (candidate, _))| candidate).collect()
    }

    /// Where a candidate comes to rest on the wall and on what lies there.
    fn rest(&self, candidate: &Candidate, lying: &Facets) -> Option<Isometry3<f64>> {
        /// Turns that are tried until a stone stays, of one narrower than [`LARGE_M`] and of others. Tuned: the first three find
        /// nine tenths of what any finds; large stones are few, and are what one sees.
        const TURNS: [u64; 2] = [3, 12];
        /// Width from which on stones are large, in metres.
        const LARGE_M: f64 = 0.3;
        /// Highest pile in metres.
        const PILE_M: f64 = 1.5;
        let Candidate { prototype, scale, yaw_rad, at, .. } = *candidate;
        let tops = lying.hits(at.x, at.y).into_iter().map(|hit| hit.z).filter(|z| *z < at.z + PILE_M);
        let on = Point3::new(at.x, at.y, tops.fold(at.z, f64::max));
        let bed = Bed::new(&prototype.hull, scale, on, |reach_m| {
            let mut floor = self.walls.floor_near(on, reach_m, beyond_m(reach_m));
            // Nor does a stone lie within the side of a much larger one.
            floor.extend(lying.floor_near(on, reach_m, PILE_M));
            floor
        });
        let lies = &prototype.lies;
        // Of two sides the one that is more stable, so that most stones lie flat.
        let sides = lies.len().max(1) as u64;
        let first = (candidate.id % sides).min((candidate.id >> 32) % sides);
        let turns = TURNS[usize::from(candidate.rank > LARGE_M)];
        (0..turns).find_map(|turn| {
            let side = lies.get(((first + turn) % sides) as usize)?;
            bed.rest(about_z(yaw_rad + turn as f64 * GOLDEN_ANGLE_RAD) * side)
        })
    }

    /// Which of them have no corner or long edge in the rock, such as that of a wall that leans over them.
    fn is_out_of_the_rock(&self, stones: &[(Candidate, Isometry3<f64>)]) -> Vec<bool> {
        let points = |(stone, pose): &(Candidate, Isometry3<f64>)| {
            let hull = &stone.prototype.hull;
            let middles = long_edges(hull, stone.scale).map(|edge| hull.middle_of(edge));
            let points = hull.corners.iter().copied().chain(middles);
            points.map(|point| (pose * (point * stone.scale)).map(|c| c as f32).into()).collect()
        };
        let depths = self.depths(stones.iter().map(points).collect());
        depths.iter().map(|points| points.iter().all(|depth| *depth < MOST_DEPTH_M)).collect()
    }
}

impl Scatter {
    /// With more of the large stones.
    fn hardened(self, difficulty: f64) -> Self {
        /// Share of the exponent that is lost at most. Tuned: half of the boulders are then wider than 0.6 m.
        const MOST: f64 = 0.4;
        Self { exponent: self.exponent * (1.0 - MOST * difficulty), ..self }
    }
}

/// A power law of the widths of stones.
struct Widths {
    /// Powers of the least and of the largest width.
    powers: [f64; 2],
    exponent: f64,
}

impl Widths {
    fn of(scatter: &Scatter) -> Self {
        let exponent = scatter.exponent;
        Self { powers: scatter.width_m.map(|width| libm::pow(width, -exponent)), exponent }
    }

    /// The width that this share of stones is narrower than.
    fn at(&self, share: f64) -> f64 {
        let [low, high] = self.powers;
        libm::pow(low + (high - low) * share, -1.0 / self.exponent)
    }

    /// Mean of the covered area of a stone.
    fn mean_area_m2(&self) -> f64 {
        /// Samples of the distribution. The closed form has a pole at an exponent of 2.
        const SAMPLES: u32 = 256;
        let widths = (0..SAMPLES).map(|n| self.at((f64::from(n) + 0.5) / f64::from(SAMPLES)));
        0.7 * widths.map(|width| width * width).sum::<f64>() / f64::from(SAMPLES)
    }
}

/// Density of stones relative to the mean: more at the foot of walls and on heaps.
struct Density {
    wall_m: Vec<f64>,
    /// From 0 to 1 in the middle of a heap.
    heaped: Vec<f64>,
}

impl Density {
    /// Far from walls and heaps, and what those add.
    const OPEN: f64 = 0.10;
    const AT_WALL: f64 = 2.2;
    const ON_HEAP: f64 = 3.0;
    /// Height over the floor at which the distance to the wall is measured, in metres, and the largest such distance.
    const PROBE_M: f64 = 0.6;

    fn new(field: &CaveField, heaps: &Heaps, places: &[Point3<f64>]) -> Self {
        let probes: Vec<[f32; 3]> =
            places.iter().map(|at| [at.x, at.y, at.z + Self::PROBE_M].map(|c| c as f32)).collect();
        Self {
            wall_m: field.scattered(&probes).into_iter().map(|distance| f64::from(-distance).max(0.0)).collect(),
            heaped: places.iter().map(|place| heaps.at(place)).collect(),
        }
    }

    /// At most, so high on a heap.
    fn most(heaped: f64) -> f64 {
        Self::OPEN + Self::AT_WALL + Self::ON_HEAP * heaped
    }

    /// At a place.
    fn at(&self, place: usize) -> f64 {
        Self::OPEN + Self::AT_WALL * libm::exp(-self.wall_m[place] / 0.35) + Self::ON_HEAP * self.heaped[place]
    }
}

/// The heaps in and around a box.
struct Heaps(Vec<Heap>);

impl Heaps {
    fn around(field: &CaveField, around: &Aabb<f64>) -> Self {
        let is_near = |heap: &&Heap| around.padded(f64::from(2.0 * heap.radius_m)).contains(heap.at.map(f64::from));
        Self(field.heaps().iter().filter(is_near).copied().collect())
    }

    /// How near a place is to the middle of a heap on its storey, from 0 to 1.
    fn at(&self, place: &Point3<f64>) -> f64 {
        /// Height difference in metres beyond which a heap is one of another storey.
        const STOREY_M: f64 = 2.5;
        let near = self.0.iter().filter(|heap| (f64::from(heap.at[2]) - place.z).abs() < STOREY_M);
        near.map(|heap| heaped(heap, place.x, place.y)).fold(0.0, f64::max)
    }

    /// The same on any storey.
    fn on_map(&self, x: f64, y: f64) -> f64 {
        self.0.iter().map(|heap| heaped(heap, x, y)).fold(0.0, f64::max)
    }
}

/// How near a place of the map is to the middle of a heap, from 0 to 1.
fn heaped(heap: &Heap, x: f64, y: f64) -> f64 {
    /// Distances from the middle, relative to the radius, between which a heap thins out. Tuned.
    const THINNING: [f64; 2] = [0.6, 1.2];
    let [heap_x, heap_y, _] = heap.at.map(f64::from);
    let away_m = libm::hypot(x - heap_x, y - heap_y);
    1.0 - smooth_step(THINNING, away_m / f64::from(heap.radius_m))
}
