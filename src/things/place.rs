//! Finds the things of a chunk.
//!
//! Every cell of a grid over the map has one candidate of each kind: where it is, how large, and a number by which it is
//! there or not, all hashed from the cell. What depends on the place thins them out, and of two that would overlap the larger
//! remains, whether or not something larger still takes its place (Matérn's second process): so a candidate depends on others
//! within [`MARGIN_M`] only, and no chunk on what another one decided.

use nalgebra::{Isometry3, Point3, Translation3, Vector2, Vector3};

use super::ground::{Hit, Walls};
use super::kind::{Hang, KINDS, KindRow, Place, Scatter};
use super::library::{Library, Prototype};
use super::rest::{Bed, about_z};
use super::shelf::roughness;
use super::{Thing, ThingSettings, WHEEL_M};
use crate::field::CaveField;
use crate::mesh::Mesh;
use crate::noise::Source;
use plume_graph::seed::salt;
use plume_graph::{Aabb, Graph};

/// How far around a chunk its things depend on, in metres.
pub const MARGIN_M: f64 = 2.0;
/// Steepest floor on which stones come to lie: upward component of its normal.
const LEVEL: f64 = 0.78;
/// Flattest ceiling or floor to which dripstone clings.
const CLINGING: f64 = 0.45;
/// Ratio of successive sizes, so that few meshes serve a cave in targets that do not scale them.
const SIZE_STEP: f64 = 1.189_207_115_002_721;
/// How deep stones lie in the floor, relative to their height.
const EMBEDDING: f64 = 0.05;
/// Mean of [`Scatter`]'s density over the floors of the sample caves, by which `cover` is met. Tuned.
const MEAN_DENSITY: f64 = 0.16;
/// Distance between joints from which water drips, in metres.
const JOINT_M: f64 = 1.6;

/// What the things of a cave follow from, beside its walls.
pub struct Setting<'a> {
    /// The prototypes.
    pub library: &'a Library,
    /// The settings.
    pub settings: &'a ThingSettings,
    /// Name of the rock.
    pub rock: &'a str,
    /// The field.
    pub field: &'a CaveField,
    /// The graph.
    pub graph: &'a Graph,
    /// The seed of the cave.
    pub seed: u64,
}

/// The things whose origins are in `chunk`, given its wall and those of its neighbours; sorted by identity.
pub fn place<'a>(setting: &Setting, chunk: Aabb<f64>, walls: impl Iterator<Item = &'a Mesh>) -> Vec<Thing> {
    if setting.settings.cover <= 0.0 {
        return Vec::new();
    }
    let walls = Walls::new(walls, chunk.padded(MARGIN_M + 1.0));
    let site = Site { setting, corridor: Corridor::new(setting, chunk), walls };
    let around = chunk.padded(MARGIN_M);
    let dripstone = site.dripstone(around);
    let rooted = site.rooted(&dripstone);
    let dripstone: Vec<Candidate> =
        dripstone.into_iter().zip(rooted).filter(|(_, rooted)| *rooted).map(|(candidate, _)| candidate).collect();
    let mut standing: Vec<Candidate> = dripstone.iter().filter(|candidate| candidate.stands).cloned().collect();
    let hanging: Vec<Candidate> = dripstone.into_iter().filter(|candidate| !candidate.stands).collect();
    let standing_count = standing.len();
    standing.extend(site.stones(around));
    let kept = without_overlaps(&standing);
    let mut things: Vec<Thing> = hanging.iter().map(Candidate::as_it_is).collect();
    for (index, candidate) in standing.iter().enumerate().filter(|(index, _)| kept[*index]) {
        let thing = if index < standing_count { Some(candidate.as_it_is()) } else { site.at_rest(candidate) };
        things.extend(thing);
    }
    things.retain(|thing| owns(&chunk, thing.pose.translation.vector));
    things.sort_by_key(|thing| thing.id);
    // Two ledges of one storey may have the same.
    things.dedup_by_key(|thing| thing.id);
    things
}

/// Half open, so that a thing on a border has one chunk.
fn owns(chunk: &Aabb<f64>, at: Vector3<f64>) -> bool {
    (0..3).all(|axis| chunk.min[axis] <= at[axis] && at[axis] < chunk.max[axis])
}

/// A thing that may be there.
#[derive(Clone)]
struct Candidate<'a> {
    id: u64,
    row: &'static KindRow,
    prototype: &'a Prototype,
    scale: f64,
    yaw_rad: f64,
    /// Where it touches the wall.
    at: Point3<f64>,
    /// How far it is moved into the wall.
    embedding_m: f64,
    /// Whether it is on the floor.
    stands: bool,
    /// Of two that overlap the one with the larger rank remains.
    rank: f64,
}

/// Least depth of the rim of dripstone in the rock, in metres: the triangles of the wall are about as far from the field.
const LEAST_DEPTH_M: f32 = -0.02;

impl Candidate<'_> {
    /// Points on the rim of each end that is to be in the rock.
    fn ends(&self) -> Vec<[f32; 3]> {
        let thing = self.as_it_is();
        let middle = thing.pose.translation.vector;
        let corners = self.prototype.hull.corners.iter().map(|corner| thing.pose * (corner * self.scale));
        let half_m = 0.5 * self.prototype.size_m.z * self.scale;
        let is_end = |at: &Point3<f64>| match self.row.place {
            Place::Joined => (at.z - middle.z).abs() > 0.9 * half_m,
            Place::Ceiling(_) => at.z > middle.z,
            _ => at.z < middle.z,
        };
        corners.filter(is_end).map(|at| [at.x as f32, at.y as f32, at.z as f32]).collect()
    }

    fn width_m(&self) -> f64 {
        self.prototype.width_m() * self.scale
    }

    /// Upright, where it is.
    fn as_it_is(&self) -> Thing {
        let into = if self.stands { -self.embedding_m } else { self.embedding_m };
        let position = Translation3::new(self.at.x, self.at.y, self.at.z + into);
        self.thing(Isometry3::from_parts(position, about_z(self.yaw_rad)))
    }

    fn thing(&self, pose: Isometry3<f64>) -> Thing {
        Thing {
            id: self.id,
            kind: self.row.name.to_owned(),
            prototype: self.prototype.name.clone(),
            scale: self.scale,
            pose,
            embedding_m: self.embedding_m,
        }
    }
}

/// Which candidates are overlapped by none that has a larger rank.
fn without_overlaps(candidates: &[Candidate]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&a, &b| candidates[a].at.x.total_cmp(&candidates[b].at.x));
    let widest_m = candidates.iter().map(Candidate::width_m).fold(0.0, f64::max);
    let mut kept = vec![true; candidates.len()];
    for (n, &one) in order.iter().enumerate() {
        let a = &candidates[one];
        let near = order[n + 1..].iter().take_while(|&&other| candidates[other].at.x - a.at.x < widest_m);
        for &other in near {
            let b = &candidates[other];
            if (a.at - b.at).norm() < 0.55 * (a.width_m() + b.width_m()) {
                let loser = if (a.rank, a.id) < (b.rank, b.id) { one } else { other };
                kept[loser] = false;
            }
        }
    }
    kept
}

/// Where things are placed.
struct Site<'a> {
    setting: &'a Setting<'a>,
    corridor: Corridor,
    walls: Walls,
}

impl<'a> Site<'a> {
    fn rows(&self) -> impl Iterator<Item = &'static KindRow> + use<> {
        let rock = self.setting.rock.to_owned();
        KINDS.iter().filter(move |row| row.is_in(&rock))
    }

    /// Loose stones that may lie in these bounds.
    fn stones(&self, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let mut all = Vec::new();
        for row in self.rows() {
            if let Place::Floor(scatter) = row.place {
                all.extend(self.scattered(row, scatter, around));
            }
        }
        all
    }

    fn scattered(&self, row: &'static KindRow, scatter: Scatter, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let side_m = 1.05 * scatter.width_m[1];
        let at_mean =
            self.setting.settings.cover * scatter.share * side_m * side_m / scatter.mean_area_m2() / MEAN_DENSITY;
        let mut found = Vec::new();
        for (mut lots, x, y) in self.cells(row, side_m, around) {
            let there = lots.unit();
            if there > at_mean * Density::MOST {
                continue;
            }
            let width_m = quantised(scatter.width(lots.unit()));
            let yaw_rad = std::f64::consts::TAU * lots.unit();
            let Some(prototype) = lots.one_of(self.setting.library.of(row)) else { continue };
            let hits = self.walls.hits(x, y);
            for (n, hit) in hits.iter().enumerate().filter(|(_, hit)| hit.normal.z > LEVEL) {
                let scale = width_m / prototype.width_m();
                let candidate = Candidate {
                    id: lots.id(hit.z),
                    row,
                    prototype,
                    scale,
                    yaw_rad,
                    at: Point3::new(x, y, hit.z),
                    embedding_m: EMBEDDING * prototype.size_m.z * scale,
                    stands: true,
                    rank: width_m,
                };
                let height_m = prototype.size_m.z * scale - candidate.embedding_m;
                if height_m > WHEEL_M && self.corridor.is_within(candidate.at, 0.6 * width_m) {
                    continue;
                }
                let clearance_m = hits.get(n + 1).map_or(0.0, |above| above.z - hit.z);
                found.push((candidate, clearance_m, there / at_mean));
            }
        }
        let places: Vec<Point3<f64>> = found.iter().map(|(candidate, ..)| candidate.at).collect();
        let density = Density::new(self.setting, &places);
        let is_there = |n: usize, clearance_m: f64, there: f64| there < density.at(n, clearance_m);
        let numbered = found.into_iter().enumerate();
        numbered
            .filter(|(n, (_, clearance_m, there))| is_there(*n, *clearance_m, *there))
            .map(|(_, (c, ..))| c)
            .collect()
    }

    /// What hangs from the ceiling in these bounds, and what stands or stood below it, without overlaps among what hangs.
    fn dripstone(&self, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let mut all = Vec::new();
        for row in self.rows() {
            if let Place::Ceiling(hang) = row.place {
                let hanging = self.hanging(row, hang, around);
                let roots: Vec<Candidate> = hanging.iter().map(|drip| drip.candidate.clone()).collect();
                let (apart, rooted) = (without_overlaps(&roots), self.rooted(&roots));
                for (_, drip) in hanging.into_iter().enumerate().filter(|(n, _)| apart[*n] && rooted[*n]) {
                    all.extend(self.grown(drip, hang));
                }
            }
        }
        all
    }

    fn hanging(&self, row: &'static KindRow, hang: Hang, around: Aabb<f64>) -> Vec<Drip<'a>> {
        let side_m = 1.0 / hang.per_m2.sqrt();
        let mut found = Vec::new();
        for (mut lots, x, y) in self.cells(row, side_m, around) {
            let there = lots.unit();
            let (length, yaw_rad) = (lots.normal(), std::f64::consts::TAU * lots.unit());
            let Some(prototype) = lots.one_of(self.setting.library.of(row)) else { continue };
            let hits = self.walls.hits(x, y);
            for pair in hits.windows(2) {
                let [floor, ceiling] = [pair[0], pair[1]];
                if floor.normal.z <= 0.0 || ceiling.normal.z > -CLINGING {
                    continue;
                }
                let clearance_m = ceiling.z - floor.z;
                let length_m =
                    (hang.median_m * libm::exp(hang.sigma * length)).min(hang.longest_m).min(0.9 * clearance_m);
                let scale = quantised(length_m) / prototype.length_m();
                let at = Point3::new(x, y, ceiling.z);
                let embedding_m = prototype.sunk_m(scale, ceiling.normal);
                let candidate = Candidate {
                    id: lots.id(ceiling.z),
                    row,
                    prototype,
                    scale,
                    yaw_rad,
                    at,
                    embedding_m,
                    stands: false,
                    rank: scale,
                };
                found.push(Drip { candidate, floor, there, lots: lots.clone() });
            }
        }
        let places: Vec<Point3<f64>> = found.iter().map(|drip| drip.candidate.at).collect();
        let wetness = wetness(self.setting, &places);
        let amount = self.setting.settings.dripstone;
        let numbered = found.into_iter().enumerate();
        numbered.filter(|(n, drip)| drip.there < amount * wetness[*n]).map(|(_, drip)| drip).collect()
    }

    /// A stalactite with its stalagmite, or their column; nothing if it leaves too little headroom.
    fn grown(&self, drip: Drip<'a>, hang: Hang) -> Vec<Candidate<'a>> {
        let Drip { candidate, floor, mut lots, .. } = drip;
        let clearance_m = candidate.at.z - floor.z;
        let length_m = candidate.scale * candidate.prototype.length_m();
        let foot = Point3::new(candidate.at.x, candidate.at.y, floor.z);
        let is_low = clearance_m - length_m < self.setting.settings.headroom_m;
        if is_low && self.corridor.is_within(foot, 0.3) {
            return Vec::new();
        }
        let (drips, height) = (lots.unit() < hang.dripping, lots.between(0.5, 1.7));
        if !drips || length_m < 0.08 || floor.normal.z < CLINGING {
            return vec![candidate];
        }
        let height_m = quantised((height * length_m).min(0.85 * clearance_m));
        let joins = length_m + height_m > 0.8 * clearance_m && clearance_m < MOST_COLUMN_M;
        let below = if joins {
            self.below(&mut lots, &Place::Joined, foot, floor, clearance_m)
        } else {
            self.below(&mut lots, &Place::UnderDrip, foot, floor, height_m)
        };
        match below {
            Some(column) if joins => vec![column],
            Some(stalagmite) => vec![candidate, stalagmite],
            None => vec![candidate],
        }
    }

    /// What stands at a foot with this height.
    fn below(
        &self,
        lots: &mut Lots,
        place: &Place,
        foot: Point3<f64>,
        floor: Hit,
        height_m: f64,
    ) -> Option<Candidate<'a>> {
        let row = self.rows().find(|row| std::mem::discriminant(&row.place) == std::mem::discriminant(place))?;
        let prototype = lots.one_of(self.setting.library.of(row))?;
        let scale = height_m / prototype.height_m();
        let width_m = prototype.width_m() * scale;
        if width_m < LEAST_STALAGMITE_M || self.corridor.is_within(foot, 0.6 * width_m) {
            return None;
        }
        let middle_m = if matches!(place, Place::Joined) { 0.5 * height_m } else { 0.0 };
        Some(Candidate {
            // Another one than that of what hangs above it.
            id: !lots.id(floor.z),
            row,
            prototype,
            scale,
            yaw_rad: std::f64::consts::TAU * lots.unit(),
            at: foot + Vector3::z() * middle_m,
            embedding_m: prototype.sunk_m(scale, floor.normal),
            stands: true,
            // Stones make room for it.
            rank: f64::INFINITY,
        })
    }

    /// Which of them have their ends in the rock all round.
    fn rooted(&self, candidates: &[Candidate]) -> Vec<bool> {
        let rings: Vec<Vec<[f32; 3]>> = candidates.iter().map(Candidate::ends).collect();
        let mut depths = self.setting.field.scattered(&rings.concat()).into_iter();
        let is_deep = |depth: f32| depth > LEAST_DEPTH_M;
        // Every depth is taken, so that the next ring starts with its own.
        let is_rooted = |ring: Vec<[f32; 3]>| depths.by_ref().take(ring.len()).map(is_deep).fold(true, |a, b| a && b);
        rings.into_iter().map(is_rooted).collect()
    }

    fn at_rest(&self, candidate: &Candidate) -> Option<Thing> {
        /// Turns that are tried until a stone stays. Tuned: the first four find nine tenths of what any finds.
        const TURNS: u32 = 4;
        /// The golden angle, by which turns are spread.
        const TURN_RAD: f64 = 2.399_963_229_728_653;
        let Candidate { prototype, scale, yaw_rad, at, .. } = *candidate;
        let bed = Bed::new(&prototype.hull, scale, &self.walls, at);
        let turned = |turn: u32| bed.rest(yaw_rad + f64::from(turn) * TURN_RAD);
        let mut pose = (0..TURNS).find_map(turned)?;
        pose.translation.vector.z -= candidate.embedding_m;
        Some(candidate.thing(pose))
    }

    /// The place of the candidate of each cell of a grid of this kind.
    fn cells(&self, row: &KindRow, side_m: f64, around: Aabb<f64>) -> impl Iterator<Item = (Lots, f64, f64)> + use<> {
        let [low, high] =
            [around.min, around.max].map(|corner| [0, 1].map(|axis| (corner[axis] / side_m).floor() as i32));
        let salt = u64::from(salt(self.setting.seed, row.name));
        let cells = (low[1]..=high[1]).flat_map(move |y| (low[0]..=high[0]).map(move |x| [x, y]));
        cells.map(move |[x, y]| {
            let mut lots = Lots::new(salt, [x, y]);
            let place = [x, y].map(|cell| (f64::from(cell) + lots.unit()) * side_m);
            (lots, place[0], place[1])
        })
    }
}

/// Tallest column in metres: the hull of a taller one would be too far in the open.
const MOST_COLUMN_M: f64 = 2.0;
/// Least width of a stalagmite in metres (Curl, *Minimum diameter stalagmites*, 1973).
const LEAST_STALAGMITE_M: f64 = 0.03;

/// Something that hangs and may have a counterpart.
struct Drip<'a> {
    candidate: Candidate<'a>,
    floor: Hit,
    there: f64,
    lots: Lots,
}

impl Prototype {
    /// How far it hangs below its origin, in metres.
    fn length_m(&self) -> f64 {
        -self.hull.corners.iter().map(|corner| corner.z).fold(f64::INFINITY, f64::min)
    }

    /// The height of what stands, in metres: a column is around its origin, and both its ends are in the rock.
    fn height_m(&self) -> f64 {
        match self.row.place {
            Place::Joined => 0.92 * self.size_m.z,
            _ => self.hull.corners.iter().map(|corner| corner.z).fold(0.0, f64::max),
        }
    }

    /// How far it is moved into a slope so that its whole root is in the rock, in metres.
    fn sunk_m(&self, scale: f64, normal: Vector3<f64>) -> f64 {
        /// How far roots reach beyond the origin.
        const ROOT_M: f64 = 0.036;
        let slope = normal.xy().norm() / normal.z.abs();
        (scale * (0.5 * self.width_m() * slope - ROOT_M)).max(0.0)
    }
}

impl Scatter {
    /// The width that this share of stones is narrower than.
    fn width(&self, share: f64) -> f64 {
        let [low, high] = self.width_m.map(|width| libm::pow(width, -self.exponent));
        libm::pow(low + (high - low) * share, -1.0 / self.exponent)
    }

    /// Mean of the covered area of a stone.
    fn mean_area_m2(&self) -> f64 {
        let p = self.exponent;
        let ends = |power: f64| libm::pow(self.width_m[1], power) - libm::pow(self.width_m[0], power);
        let mean_square = p / (2.0 - p) * ends(2.0 - p) / -ends(-p);
        0.7 * mean_square
    }
}

fn quantised(size: f64) -> f64 {
    let steps = (libm::log(size) / libm::log(SIZE_STEP)).round();
    libm::pow(SIZE_STEP, steps)
}

/// Density of stones relative to the mean: more at the foot of walls and in zones of collapse.
struct Density {
    wall_m: Vec<f64>,
    zone: Vec<f64>,
}

impl Density {
    /// Upper bound.
    const MOST: f64 = 0.10 + 2.2 + 3.0;
    /// Height over the floor at which the distance to the wall is measured, in metres, and the largest such distance.
    const PROBE_M: f64 = 0.6;

    fn new(setting: &Setting, places: &[Point3<f64>]) -> Self {
        let single = |place: &Point3<f64>, up: f64| [place.x as f32, place.y as f32, (place.z + up) as f32];
        let probes: Vec<[f32; 3]> = places.iter().map(|place| single(place, Self::PROBE_M)).collect();
        let zones: Vec<[f32; 3]> = places.iter().map(|place| single(place, 0.0)).collect();
        let source = Source::new(salt(setting.seed, "collapse"));
        Self {
            wall_m: setting
                .field
                .scattered(&probes)
                .into_iter()
                .map(|distance| f64::from(-distance).max(0.0))
                .collect(),
            zone: roughness(source, &zones, 11.0).into_iter().map(f64::from).collect(),
        }
    }

    /// At a place over which the ceiling is this high.
    fn at(&self, place: usize, clearance_m: f64) -> f64 {
        let by_wall = 2.2 * libm::exp(-self.wall_m[place] / 0.35);
        let collapse = 3.0 * step(0.12, 0.4, self.zone[place]) * step(1.2, 2.4, clearance_m);
        0.10 + by_wall + collapse
    }
}

fn step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Share of places from which water drips: along joints, where the rock is wet.
fn wetness(setting: &Setting, places: &[Point3<f64>]) -> Vec<f64> {
    let points: Vec<[f32; 3]> = places.iter().map(|at| [at.x as f32, at.y as f32, at.z as f32]).collect();
    let noise = |name: &str, length_m: f32| roughness(Source::new(salt(setting.seed, name)), &points, length_m);
    let (wet, bend) = (noise("wet joints", 5.0), noise("joint bends", 2.5));
    let heading = std::f64::consts::TAU * Lots::new(u64::from(salt(setting.seed, "joint heading")), [0, 0]).unit();
    let (sine, cosine) = (libm::sin(heading), libm::cos(heading));
    let share = |(n, at): (usize, &Point3<f64>)| {
        let across = (at.x * cosine + at.y * sine + 0.35 * f64::from(bend[n])) / JOINT_M;
        let off_m = (across - across.round()).abs() * JOINT_M;
        (1.0 - step(0.05, 0.22, off_m)) * step(-0.05, 0.35, f64::from(wet[n]))
    };
    places.iter().enumerate().map(share).collect()
}

/// The way along the passages that is kept free.
struct Corridor {
    half_m: f64,
    lines: Vec<[Point3<f64>; 2]>,
}

impl Corridor {
    /// Height difference beyond which a passage is another one, in metres.
    const STOREY_M: f64 = 4.0;

    fn new(setting: &Setting, chunk: Aabb<f64>) -> Self {
        let half_m = setting.settings.corridor_m / 2.0;
        let near = chunk.padded(MARGIN_M + half_m + 1.0);
        let lines = setting.graph.edges.iter().map(|edge| edge.map(|station| setting.graph[station].position));
        let touches = |[a, b]: &[Point3<f64>; 2]| {
            let around = Aabb { min: <[f64; 3]>::from(*a), max: <[f64; 3]>::from(*a) }.including((*b).into());
            let tall = Aabb {
                min: [around.min[0], around.min[1], around.min[2] - Self::STOREY_M],
                max: [around.max[0], around.max[1], around.max[2] + Self::STOREY_M],
            };
            tall.intersects(&near)
        };
        Self { half_m, lines: if half_m > 0.0 { lines.filter(touches).collect() } else { Vec::new() } }
    }

    /// Whether something of this radius at a place on the floor would be in the way.
    fn is_within(&self, at: Point3<f64>, radius_m: f64) -> bool {
        self.lines.iter().any(|[a, b]| {
            let along = b - a;
            let flat: Vector2<f64> = along.xy();
            let share = if flat.norm_squared() > 0.0 { (at - a).xy().dot(&flat) / flat.norm_squared() } else { 0.0 };
            let nearest = a + along * share.clamp(0.0, 1.0);
            (at - nearest).xy().norm() < self.half_m + radius_m && (at.z - nearest.z).abs() < Self::STOREY_M
        })
    }
}

/// Random numbers of a cell (SplitMix64; Steele, Lea and Flood 2014).
#[derive(Clone)]
struct Lots {
    id: u64,
    state: u64,
}

impl Lots {
    fn new(salt: u64, [x, y]: [i32; 2]) -> Self {
        let mut lots = Self { id: 0, state: salt };
        for cell in [x, y] {
            lots.state = lots.next() ^ u64::from(cell as u32);
        }
        lots.id = lots.next();
        lots
    }

    /// The identity of the candidate at this height: a cell of the map has one per storey.
    fn id(&self, z: f64) -> u64 {
        Self { state: self.id ^ (z.floor() as i64 as u64), ..self.clone() }.next()
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Between 0 and 1.
    fn unit(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn one_of<'a, T>(&mut self, all: &'a [T]) -> Option<&'a T> {
        all.get((self.unit() * all.len() as f64) as usize)
    }

    /// From the standard normal distribution.
    fn normal(&mut self) -> f64 {
        plume_graph::rng::probit(self.unit())
    }
}
