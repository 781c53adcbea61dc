//! Heaps of rubble at the foot of walls: a cone just below the angle of repose, on which loose stones come to rest and cover it.
//!
//! The cone is convex, so that it collides as it looks; the stones of its skin are things of their own, with hulls of their own.

use nalgebra::{Point3, Vector3};
use plume_graph::rng::Rng;
use plume_graph::seed::salt;

use super::along::{self, Way};
use super::kind::{Heap, KindRow, Place, Shape};
use super::lots::Lots;
use super::place::{Candidate, Site, collapse, quantised_down, step};

/// Radius of the foot in metres.
const FOOT_M: f64 = 0.42;
/// Slope of the sides. Angular rubble rests at 33° to 37°; on 29° stones stay in Bullet.
const SLOPE: f64 = 0.55;
/// How far the foot reaches below the origin, in metres.
const ROOT_M: f64 = 0.10;
/// Radius within which the top is rounded off, in metres.
const TOP_M: f64 = 0.10;
/// Distance of the middle of a heap from the wall on which it leans, relative to its reach.
const LEANING: f64 = 0.5;
/// How far its middle is in the wall at most, relative to its reach, where the way leaves little room.
const IN_WALL: f64 = 0.4;
/// Distance of a heap from the way in metres.
const CLEAR_M: f64 = 0.03;
/// Distance from the wall at which the height of the floor is taken, in metres.
const AT_FOOT_M: f64 = 0.2;
/// Least depth of the foot in the rock, in metres: the triangles of the wall are about as far from the field.
const LEAST_DEPTH_M: f32 = -0.02;
/// How far a heap may be sunk so that its foot is in a floor that slopes, relative to its reach.
const MOST_SUNK: f64 = 0.3;
/// Heaps where most has fallen, per part of a passage and side, relative to the share of the floor that stones cover. Tuned.
const HEAPED: f64 = 14.0;

/// The core of a heap: a cone with a rounded top.
pub fn heap(_: &mut Rng) -> Shape {
    let fall = (1.0 / (1.0 + SLOPE * SLOPE).sqrt()) as f32;
    Box::new(move |[x, y, z]| {
        let radius_m = libm::sqrtf(x * x + y * y);
        let below = (side_m(f64::from(radius_m)) as f32 - z) * fall;
        below.min(z + ROOT_M as f32).min(FOOT_M as f32 - radius_m)
    })
}

/// Height of the cone at a distance from its axis, in metres: rounded off at the top.
fn side_m(radius_m: f64) -> f64 {
    let rounded = (radius_m * radius_m + TOP_M * TOP_M).sqrt();
    SLOPE * (FOOT_M - rounded)
}

/// Whether a place on the map is on one of these heaps.
pub(super) fn is_on(heaps: &[Candidate], at: Point3<f64>) -> bool {
    let is_near =
        |heap: &Candidate| (heap.at - at).xy().norm() < heap.reach_m() && (heap.at.z - at.z).abs() < heap.reach_m();
    heaps.iter().any(is_near)
}

impl<'a> Site<'a> {
    /// Heaps at the foot of the walls of these passages, clear of what stands there. Heaps may run into each other.
    pub fn heaps(&self, ways: &[Way], standing: &[Candidate<'a>]) -> Vec<Candidate<'a>> {
        let heap = |row: &'static KindRow| match row.place {
            Place::Heaped(heap) => Some((row, heap)),
            _ => None,
        };
        let mut heaps = Vec::new();
        for (row, heap) in self.rows().filter_map(heap) {
            for way in ways {
                heaps.extend(self.fallen(row, heap, way));
            }
        }
        heaps.retain(|heap: &Candidate| {
            standing.iter().all(|other| (heap.at - other.at).xy().norm() > heap.reach_m() + other.reach_m())
        });
        self.footed(heaps)
    }

    /// The heaps of a passage: one on either side of each part of it, where enough has fallen.
    fn fallen(&self, row: &'static KindRow, heap: Heap, way: &Way) -> Vec<Candidate<'a>> {
        let parts = way.parts(heap.width_m[1]);
        let part_m = way.length_m / f64::from(parts);
        let places = (0..parts).flat_map(|number| [-1.0, 1.0].map(|side| (number, side)));
        let (mut found, mut there) = (Vec::new(), Vec::new());
        for (number, side) in places {
            let key =
                u64::from(salt(self.setting.seed, row.name)) | u64::from(2 * number + u32::from(side > 0.0)) << 32;
            let mut lots = Lots::new(key, way.key);
            let share = lots.unit();
            let along_m = (f64::from(number) + lots.between(0.2, 0.8)) * part_m;
            if let Some(candidate) = self.at_wall(row, heap, (way, along_m, side), &mut lots) {
                found.push(candidate);
                there.push(share);
            }
        }
        let places: Vec<Point3<f64>> = found.iter().map(|candidate| candidate.at).collect();
        let zone = collapse(self.setting, &places);
        let is_there = |n: usize| there[n] < HEAPED * self.settings.cover * step(-0.1, 0.35, zone[n]);
        found.into_iter().enumerate().filter(|(n, _)| is_there(*n)).map(|(_, candidate)| candidate).collect()
    }

    /// A heap that leans on a wall, as wide as the way leaves room for.
    fn at_wall(
        &self,
        row: &'static KindRow,
        heap: Heap,
        (way, along_m, side): (&Way, f64, f64),
        lots: &mut Lots,
    ) -> Option<Candidate<'a>> {
        let (width_m, yaw_rad) = (lots.between(heap.width_m[0], heap.width_m[1]), std::f64::consts::TAU * lots.unit());
        let prototype = lots.one_of(self.setting.library.of(row))?;
        let wall_m = self.aside(way, along_m, side, &along::FOOT_M)?;
        let clear_m = 0.5 * self.settings.corridor_m + CLEAR_M;
        let room_m = (wall_m - clear_m) / (1.0 - IN_WALL);
        let relative = prototype.reach_m / prototype.width_m();
        let width_m = width_m.min(room_m / relative);
        if width_m < heap.width_m[0] {
            return None;
        }
        let scale = quantised_down(width_m) / prototype.width_m();
        let reach_m = prototype.reach_m * scale;
        let across = way.right * side;
        let [floor, _] = self.column(way.at(along_m) + across * (wall_m - AT_FOOT_M))?;
        let middle = way.at(along_m) + across * (wall_m - LEANING * reach_m).max(clear_m + reach_m);
        let at = Point3::new(middle.x, middle.y, floor);
        let drop_m = self.drop_m(at, reach_m);
        (!self.corridor.is_within(at, reach_m)).then(|| Candidate {
            id: lots.id(0.0),
            row,
            prototype,
            scale,
            yaw_rad,
            at,
            embedding_m: (drop_m - 0.8 * ROOT_M * scale).max(0.0),
            stands: true,
            rank: width_m,
        })
    }

    /// How far the floor around a place is below it at most, in metres.
    fn drop_m(&self, at: Point3<f64>, reach_m: f64) -> f64 {
        let floors = rim(at, reach_m).filter_map(|place| self.walls.floor_below(place + Vector3::z() * reach_m));
        let drops = floors.map(|floor| at.z - floor);
        // Further down is another passage.
        drops.filter(|drop_m| *drop_m < reach_m).fold(0.0, f64::max)
    }

    /// The heaps whose foot is in the rock all round, and that are not sunk into it by much.
    fn footed(&self, heaps: Vec<Candidate<'a>>) -> Vec<Candidate<'a>> {
        let foot = |heap: &Candidate| -> Vec<[f32; 3]> {
            let below_m = heap.embedding_m + ROOT_M * heap.scale;
            let foot = Point3::new(heap.at.x, heap.at.y, heap.at.z - below_m);
            rim(foot, FOOT_M * heap.scale).map(|at| at.coords.map(|c| c as f32).into()).collect()
        };
        let depths = self.depths(heaps.iter().map(foot).collect());
        let is_footed = |(heap, depths): &(Candidate, Vec<f32>)| {
            heap.embedding_m < MOST_SUNK * heap.reach_m() && depths.iter().all(|depth| *depth > LEAST_DEPTH_M)
        };
        heaps.into_iter().zip(depths).filter(is_footed).map(|(heap, _)| heap).collect()
    }
}

/// Points around a place.
fn rim(at: Point3<f64>, radius_m: f64) -> impl Iterator<Item = Point3<f64>> {
    (0..12).map(move |n| {
        let around = std::f64::consts::TAU * f64::from(n) / 12.0;
        at + Vector3::new(libm::cos(around), libm::sin(around), 0.0) * radius_m
    })
}
