//! Heaps of rubble at the foot of walls: a cone at the angle of repose with stones in its skin, the larger ones at its foot,
//! as talus is sorted (Statham, *A scree slope rockfall model*, 1976). Loose stones come to rest on them.

use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use plume_graph::Aabb;
use plume_graph::rng::Rng;

use super::kind::{Heap, KindRow, Place, Shape};
use super::place::{Candidate, Site, collapse, quantised, step};
use super::rest::about_z;
use super::stone;

/// Radius of the foot in metres.
const FOOT_M: f64 = 0.40;
/// Slope of the sides: angular rubble rests at 33° to 37°.
const REPOSE: f64 = 0.67;
/// How far the foot reaches below the origin, in metres.
const ROOT_M: f64 = 0.10;
/// Radius within which the top is rounded off, in metres.
const TOP_M: f64 = 0.10;
/// Room that every heap has for itself beside its widest, in metres.
const APART_M: f64 = 0.6;
/// Least upward component of the normal of the floor below the middle.
const LEVEL: f64 = 0.9;
/// Least height over the floor in which there is a heap, in metres.
const CLEARANCE_M: f64 = 1.4;
/// Heaps per cell where most has fallen, relative to the share of the floor that stones cover. Tuned.
const HEAPED: f64 = 14.0;
/// Steepest floor relative to the reach of a heap: on a steeper one it would hang over.
const STEEPEST: f64 = 0.5;

/// A heap of angular blocks.
pub fn talus(rng: &mut Rng) -> Shape {
    heap(rng, 90, [0.035, 0.15])
}

/// Blasted rock: finer, and of more even size.
pub fn muck(rng: &mut Rng) -> Shape {
    heap(rng, 130, [0.03, 0.09])
}

/// A stone in the skin of a heap.
struct Rock {
    shape: Shape,
    /// From the heap to the stone.
    pose: Isometry3<f64>,
    /// Nothing of it is further from its middle, in metres.
    reach_m: f32,
}

/// A cone with this many stones, whose widths follow a power law in this range, in metres.
fn heap(rng: &mut Rng, stones: u32, width_m: [f64; 2]) -> Shape {
    /// Exponent of the number of stones wider than D.
    const EXPONENT: f64 = 1.8;
    let width = |share: f64| {
        let [low, high] = width_m.map(|width| libm::pow(width, -EXPONENT));
        libm::pow(low + (high - low) * share, -1.0 / EXPONENT)
    };
    let rocks: Vec<Rock> = (0..stones)
        .map(|_| {
            let width_m = width(rng.between(0.0, 1.0));
            // The larger a stone, the further it has rolled.
            let size = (width_m - 0.03) / 0.12;
            let out = rng.between(0.0, 1.0).sqrt() * (1.0 - 0.6 * size) + 0.6 * size;
            let around = rng.between(0.0, std::f64::consts::TAU);
            let radius_m = out * (FOOT_M - 0.45 * width_m);
            let at = Vector3::new(radius_m * libm::cos(around), radius_m * libm::sin(around), side_m(radius_m));
            let turned = about_z(rng.between(0.0, std::f64::consts::TAU)) * stone::tumbled(rng);
            Rock {
                shape: stone::rubble(rng, 0.5 * width_m),
                pose: Isometry3::from_parts(Translation3::from(at - Vector3::z() * 0.1 * width_m), turned).inverse(),
                reach_m: (0.95 * width_m) as f32,
            }
        })
        .collect();
    let fall = 1.0 / (1.0 + REPOSE * REPOSE).sqrt();
    Box::new(move |[x, y, z]| {
        let radius_m = libm::sqrtf(x * x + y * y);
        let below = (side_m(f64::from(radius_m)) - f64::from(z)) * fall;
        let cone = (below as f32).min(z + ROOT_M as f32).min(FOOT_M as f32 - radius_m);
        rocks.iter().fold(cone, |inside, rock| inside.max(rock.depth([x, y, z])))
    })
}

impl Rock {
    fn depth(&self, point: [f32; 3]) -> f32 {
        let own = self.pose * Point3::from(point.map(f64::from));
        let own: [f32; 3] = own.map(|c| c as f32).into();
        let away_m = libm::sqrtf(own.iter().map(|c| c * c).sum()) - self.reach_m;
        if away_m > 0.0 { -away_m } else { (self.shape)(own) }
    }
}

/// Height of the cone at a distance from its axis, in metres: rounded off at the top.
fn side_m(radius_m: f64) -> f64 {
    let rounded = (radius_m * radius_m + TOP_M * TOP_M).sqrt();
    REPOSE * (FOOT_M - rounded)
}

impl<'a> Site<'a> {
    /// Heaps whose middles are in these bounds, beside what stands there. Each has a cell of the map for itself, so that none
    /// depends on others.
    pub fn heaps(&self, around: Aabb<f64>, standing: &[Candidate<'a>]) -> Vec<Candidate<'a>> {
        let heap = |row: &'static KindRow| match row.place {
            Place::Heaped(heap) => Some((row, heap)),
            _ => None,
        };
        let mut heaps: Vec<Candidate> =
            self.rows().filter_map(heap).flat_map(|(row, heap)| self.heaped(row, heap, around)).collect();
        heaps.retain(|heap| {
            standing.iter().all(|other| (heap.at - other.at).xy().norm() > heap.reach_m() + other.reach_m())
        });
        heaps
    }

    fn heaped(&self, row: &'static KindRow, heap: Heap, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let side_m = heap.width_m[1] + APART_M;
        // Nearer to the middle of its cell than to that of any other.
        let inwards = |along_m: f64| {
            let cell = (along_m / side_m).floor() + 0.5;
            (cell + (along_m / side_m - cell) * APART_M / side_m) * side_m
        };
        let (mut found, mut there) = (Vec::new(), Vec::new());
        for (mut lots, x, y) in self.cells(row, side_m, around) {
            let (x, y) = (inwards(x), inwards(y));
            let share = lots.unit();
            let width_m = quantised(lots.between(heap.width_m[0], heap.width_m[1]));
            let yaw_rad = std::f64::consts::TAU * lots.unit();
            let Some(prototype) = lots.one_of(self.setting.library.of(row)) else { continue };
            let hits = self.walls.hits(x, y);
            let pairs = hits.windows(2).map(|pair| [pair[0], pair[1]]);
            let open = pairs.filter(|[floor, above]| floor.normal.z > LEVEL && above.z - floor.z > CLEARANCE_M);
            for [floor, _] in lots.one_per_storey(open, |[floor, _]| floor.z) {
                let scale = width_m / prototype.width_m();
                let at = Point3::new(x, y, floor.z);
                let reach_m = prototype.reach_m * scale;
                let Some(drop_m) = self.drop_m(at, reach_m).filter(|drop_m| *drop_m < STEEPEST * reach_m) else {
                    continue;
                };
                let candidate = Candidate {
                    id: lots.id(floor.z),
                    row,
                    prototype,
                    scale,
                    yaw_rad,
                    at,
                    embedding_m: (drop_m - 0.8 * ROOT_M * scale).max(0.0),
                    stands: true,
                    rank: width_m,
                };
                if !self.corridor.is_within(at, reach_m) {
                    found.push(candidate);
                    there.push(share);
                }
            }
        }
        let places: Vec<Point3<f64>> = found.iter().map(|candidate| candidate.at).collect();
        let zone = collapse(self.setting, &places);
        let is_there = |n: usize| there[n] < HEAPED * self.settings.cover * step(0.0, 0.35, zone[n]);
        found.into_iter().enumerate().filter(|(n, _)| is_there(*n)).map(|(_, candidate)| candidate).collect()
    }

    /// How far the floor around a place is below it at most, in metres; `None` if nothing of it is there.
    fn drop_m(&self, at: Point3<f64>, reach_m: f64) -> Option<f64> {
        let rim = (0..8).map(|n| {
            let around = std::f64::consts::TAU * f64::from(n) / 8.0;
            at + Vector3::new(libm::cos(around), libm::sin(around), 0.0) * reach_m
        });
        // Where there is no floor there is the wall.
        let floors = rim.filter_map(|place| self.walls.floor_below(place + Vector3::z() * reach_m));
        floors.map(|floor| at.z - floor).reduce(f64::max)
    }
}
