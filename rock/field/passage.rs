//! The smooth passages: tapered capsules along the edges of a graph, rooms where passages meet, and a floor.
//!
//! Blending is a fourth-power sum of each capsule's influence within [`BLEND_M`], taken in the order of the graph. A capsule
//! further away adds exactly nothing, so omitting it changes no bit.

mod collapse;

pub use collapse::Heap;
pub(super) use collapse::{Collapse, ROCK_M, collapses};

use std::array::from_fn;

use super::Aabb;
use crate::material::{BLOCK, DomainWarp, Sites, Stored, SurfaceSamples};
use crate::noise::{Lanes, Real, Source, Vec3, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use plume_graph::clearance::PassageSize;
use plume_graph::{Graph, Node, Section, Shape, StationId};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Range of a passage's influence from its wall, in metres; the smooth distance saturates there.
pub const BLEND_M: f32 = 1.1;

/// From a graph to the smooth shape of its passages.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct PassageSettings {
    /// Width of a passage relative to the radius of its station.
    #[schemars(range(min = 0.1, max = 4.0))]
    pub width_per_radius: f32,
    /// Minimum width of a passage before its walls are rough and stones lie in it, in metres. The free width is smaller: `plume
    /// certify` measures what a robot has.
    #[schemars(range(min = 0.8, max = 10.0))]
    pub width_min_m: f32,
    /// Height of the full section relative to its width; the floor cuts off its lower part.
    #[schemars(range(min = 0.4, max = 2.5))]
    pub height_ratio: f32,
    /// Depth of the floor below the axis, relative to half the height: 1 keeps the round bottom.
    #[schemars(range(min = 0.2, max = 0.95))]
    pub floor_drop: f32,
    /// Flatness of the floor: 0 undulating and strewn with stones, 1 a drivable plane.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub floor_flatness: f32,
    /// Height of stones in the middle of the floor, in metres; up to four times that at the foot of a wall.
    #[schemars(range(min = 0.0, max = 0.3))]
    pub floor_roughness_m: f32,
    /// Width of a room where three or more passages meet, relative to the width of its station; 1 makes no rooms.
    #[schemars(range(min = 1.0, max = 3.0))]
    pub room_factor: f32,
    /// How often the roof fell: heaps of rock under a higher ceiling in natural passages, and muck at the faces of drifts. 1 is
    /// natural, 0 none.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub collapse: f32,
}

impl Default for PassageSettings {
    fn default() -> Self {
        let passage_size = PassageSize::default();
        Self {
            width_per_radius: passage_size.width_per_radius as f32,
            width_min_m: passage_size.width_min_m as f32,
            height_ratio: passage_size.height_ratio as f32,
            floor_drop: passage_size.floor_drop as f32,
            floor_flatness: 0.3,
            floor_roughness_m: 0.08,
            room_factor: passage_size.room_factor as f32,
            collapse: 1.0,
        }
    }
}

/// Clearance radii of the smooth passage, in metres. Rooms and rock may extend or reduce it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// To either side.
    pub aside_m: f32,
    /// Up to the ceiling.
    pub up_m: f32,
    /// Down to the floor.
    pub down_m: f32,
}

impl PassageSettings {
    /// Extents of the passage at a station.
    pub fn reach(&self, node: &Node) -> Reach {
        let Profile { half_width, half_height, drop, .. } = Profile::at(node, self);
        Reach { aside_m: half_width, up_m: half_height, down_m: drop }
    }

    /// The same as the graph crate needs it.
    pub fn passage_size(&self) -> PassageSize {
        PassageSize {
            width_per_radius: self.width_per_radius.into(),
            width_min_m: self.width_min_m.into(),
            height_ratio: self.height_ratio.into(),
            floor_drop: self.floor_drop.into(),
            room_factor: self.room_factor.into(),
        }
    }
}

/// Section of a passage at a station.
#[derive(Clone, Copy)]
struct Profile {
    half_width: f32,
    half_height: f32,
    /// Depth of the floor below the axis.
    drop: f32,
    /// 0 elliptic, 1 nearly rectangular.
    square: f32,
}

impl Profile {
    fn at(node: &Node, settings: &PassageSettings) -> Self {
        match node.section {
            Some(Section { width_m, height_m, shape: Shape::Drift }) => Self::drift(width_m as f32, height_m as f32),
            Some(Section { width_m, height_m, shape: Shape::Cave }) => {
                Self::measured(width_m as f32, height_m as f32, settings)
            }
            None => Self::cave(node.radius as f32, settings),
        }
    }

    fn cave(radius: f32, settings: &PassageSettings) -> Self {
        let half_width = (radius * settings.width_per_radius).max(settings.width_min_m) / 2.0;
        let half_height = half_width * settings.height_ratio;
        Self { half_width, half_height, drop: half_height * settings.floor_drop, square: 0.0 }
    }

    /// A mined drift: the full height is clear, so the section extends below the floor.
    fn drift(width: f32, height: f32) -> Self {
        let half_height = height / (1.0 + Self::DRIFT_DROP);
        let drop = half_height * Self::DRIFT_DROP;
        Self { half_width: width / 2.0, half_height, drop, square: 1.0 }
    }

    /// A natural passage of known size: the height is measured from the floor.
    fn measured(width: f32, height: f32, settings: &PassageSettings) -> Self {
        let half_height = height.max(settings.width_min_m) / (1.0 + settings.floor_drop);
        let half_width = width.max(settings.width_min_m) / 2.0;
        Self { half_width, half_height, drop: half_height * settings.floor_drop, square: 0.0 }
    }

    const DRIFT_DROP: f32 = Section::DRIFT_DROP as f32;

    fn widened(self, factor: f32) -> Self {
        Self { half_width: self.half_width * factor, half_height: self.half_height * factor.sqrt(), ..self }
    }
}

/// A passage from one station to the next, or a room, which is a capsule of zero length.
#[derive(Clone, Debug)]
pub(super) struct Capsule {
    start: [f32; 3],
    span: [f32; 3],
    /// 1 / length², 0 for a room.
    inverse: f32,
    half_width: [f32; 2],
    /// Depth of the floor below the axis at both ends.
    drop: [f32; 2],
    /// Width over height at both ends.
    squash: [f32; 2],
    square: f32,
    /// Unit vector down the passage; 0 in a room.
    flow: [f32; 3],
    /// Share of the rock's domain warp that applies to it, 0–1.
    warp_weight: f32,
}

/// Every capsule of a graph: passages in the order of its edges, then rooms in the order of its nodes.
pub(super) fn capsules(graph: &Graph, settings: &PassageSettings, domain_warp: DomainWarp) -> Vec<Capsule> {
    let profiles: Vec<Profile> = graph.nodes.iter().map(|node| Profile::at(node, settings)).collect();
    let degrees = graph.degrees();
    let profile = |station: StationId| profiles[station.index()];
    let passage = |ends: &[StationId; 2]| Capsule::new(ends.map(|end| &graph[end]), ends.map(profile), domain_warp);
    let passages = graph.edges.iter().map(passage);
    let is_room = |&station: &StationId| degrees[station.index()] >= 3 && graph[station].section.is_none();
    let lone = |&station: &StationId| degrees[station.index()] == 0;
    let rooms = graph.stations().filter(is_room).map(|station| {
        let room = profile(station).widened(settings.room_factor);
        Capsule::new([&graph[station]; 2], [room; 2], domain_warp)
    });
    let pockets = graph
        .stations()
        .filter(lone)
        .map(|station| Capsule::new([&graph[station]; 2], [profile(station); 2], domain_warp));
    passages.chain(rooms).chain(pockets).collect()
}

impl Capsule {
    fn new(ends: [&Node; 2], profiles: [Profile; 2], domain_warp: DomainWarp) -> Self {
        let [start, end] = ends.map(|node| node.position.coords.map(|c| c as f32));
        let span = end - start;
        let length_squared = span.norm_squared();
        Self {
            start: start.into(),
            span: span.into(),
            inverse: if length_squared > 1e-6 { 1.0 / length_squared } else { 0.0 },
            half_width: profiles.map(|profile| profile.half_width),
            drop: profiles.map(|profile| profile.drop),
            squash: profiles.map(|profile| profile.half_width / profile.half_height),
            square: profiles[0].square.min(profiles[1].square),
            flow: downstream(span.into()),
            warp_weight: warp_weight(profiles, domain_warp),
        }
    }

    /// A box that holds its wall.
    pub fn bounds(&self) -> Aabb<f32> {
        let wide = self.widest_m();
        let reach = [wide, wide, wide / self.flattest()];
        Aabb {
            min: from_fn(|i| self.start[i] + self.span[i].min(0.0) - reach[i]),
            max: from_fn(|i| self.start[i] + self.span[i].max(0.0) + reach[i]),
        }
    }

    /// The minimum of width over height.
    fn flattest(&self) -> f32 {
        self.squash[0].min(self.squash[1])
    }

    /// Half the width at the wider end, metres.
    pub fn widest_m(&self) -> f32 {
        self.half_width[0].max(self.half_width[1])
    }

    /// Bounds for all points within `radius` of `centre`, in rock that moves points by up to `wander_m`.
    pub fn near(&self, centre: [f32; 3], radius: f32, wander_m: f32) -> Range {
        let radius = radius + self.warp_weight * wander_m;
        let away: [f32; 3] = std::array::from_fn(|i| centre[i] - self.start[i]);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let share = (dot(away, self.span) * self.inverse).clamp(0.0, 1.0);
        let off: [f32; 3] = std::array::from_fn(|i| away[i] - share * self.span[i]);
        let distance = dot(off, off).sqrt();
        let spread = radius * self.inverse.sqrt();
        let along = |share: f32| {
            let share = share.clamp(0.0, 1.0);
            let drop = self.drop[0] + share * (self.drop[1] - self.drop[0]);
            self.start[2] + share * self.span[2] - drop
        };
        let floors = [along(share - spread), along(share + spread)];
        let [narrow, wide] = [self.half_width[0].min(self.half_width[1]), self.widest_m()];
        // The fourth-power norm is at least 2^-1/4 of the Euclidean one.
        let shrink = self.flattest().min(1.0) * (1.0 - 0.16 * self.square);
        Range {
            nearest: (distance - radius).max(0.0) * shrink - wide - Self::ROUNDING_M,
            furthest: (distance + radius) * self.squash[0].max(self.squash[1]).max(1.0) - narrow + Self::ROUNDING_M,
            floor_low: floors[0].min(floors[1]) - Self::ROUNDING_M,
            floor_high: floors[0].max(floors[1]) + Self::ROUNDING_M,
            widest: wide,
        }
    }

    /// Allowance for rounding and for the softened centre of a section.
    const ROUNDING_M: f32 = 0.02;
}

/// The direction of flow along an edge of a graph: downhill; between stations at the same height, towards the one with the
/// lower id, which is nearer to where most generators begin.
fn downstream(span: [f32; 3]) -> [f32; 3] {
    let length = span.iter().map(|c| c * c).sum::<f32>().sqrt();
    if length < 1e-3 {
        return [0.0; 3];
    }
    let sign = if span[2] < 0.0 { 1.0 } else { -1.0 };
    span.map(|c| c * sign / length)
}

/// The share of the domain warp that keeps every axis in air: a passage is pushed aside by at most [`SWAY`] of its half
/// width (or height), and rock then protrudes by at most [`crate::material::PROTRUSION`] of it.
fn warp_weight(profiles: [Profile; 2], domain_warp: DomainWarp) -> f32 {
    let narrow = profiles.map(|profile| profile.half_width.min(profile.half_height));
    let furthest = domain_warp.reach_m[0] + domain_warp.reach_m[1];
    let straightness = 1.0 - 0.6 * profiles[0].square;
    (SWAY * narrow[0].min(narrow[1]) / furthest.max(1e-3)).min(1.0) * straightness
}

/// See [`warp_weight`].
const SWAY: f32 = 0.45;

/// Bounds of a capsule for a ball of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    /// Lower bound of the distance to its wall, negative inside.
    pub nearest: f32,
    /// Upper bound of that distance.
    pub furthest: f32,
    /// Lowest height of its floor.
    pub floor_low: f32,
    /// Highest height of its floor.
    pub floor_high: f32,
    /// Half its width at the wider end.
    pub widest: f32,
}

/// Fills in the passage data for the points of a block.
#[inline(always)]
pub(super) fn survey<S: Simd, T: Stored<S>>(
    simd: S,
    capsules: &[&Capsule],
    domain_warp: DomainWarp,
    sites: &mut Sites,
) {
    for at in (0..BLOCK).step_by(Lanes::<S>::LEN) {
        let point: Vec3<T> = T::point(simd, &sites.point, at);
        let push = push(point, domain_warp, sites.source);
        let mut sums = Sums::none(simd);
        for capsule in capsules {
            sums.add(capsule, point, push);
        }
        sums.store(sites, at);
    }
}

/// The domain warp of the rock here, metres.
#[inline(always)]
fn push<S: Simd, T: Real<S>>(point: Vec3<T>, domain_warp: DomainWarp, source: Source) -> Vec3<T> {
    let [long, short] = domain_warp.length_m;
    let far = source.warp(0x100, point, long, domain_warp.reach_m[0]);
    let near = source.warp(0x101, far, short, domain_warp.reach_m[1]);
    vec3(near.x - point.x, near.y - point.y, near.z - point.z)
}

/// Sums over capsules, weighted by the fourth power of their influence.
struct Sums<T> {
    weight: T,
    height: T,
    up: T,
    half_width: T,
    flow: [T; 3],
}

impl<T> Sums<T> {
    /// Keeps the means finite where no passage has influence.
    const FAINT: f32 = 1e-9;

    #[inline(always)]
    fn none<S: Simd>(simd: S) -> Self
    where
        T: Real<S>,
    {
        let zero = T::zero(simd);
        Self { weight: zero, height: zero, up: zero, half_width: zero + Self::FAINT, flow: [zero; 3] }
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, capsule: &Capsule, point: Vec3<T>, push: Vec3<T>)
    where
        T: Real<S>,
    {
        let [x, y, z] = capsule.start;
        let push = push.scaled(capsule.warp_weight);
        let away = vec3(point.x - x + push.x, point.y - y + push.y, point.z - z + push.z);
        let share = (away.along(capsule.span) * capsule.inverse).within(0.0, 1.0);
        let [dx, dy, dz] = capsule.span;
        let off = vec3(away.x - share * dx, away.y - share * dy, away.z - share * dz);
        let squash = share * (capsule.squash[1] - capsule.squash[0]) + capsule.squash[0];
        let rise = off.z * squash;
        let half_width = share * (capsule.half_width[1] - capsule.half_width[0]) + capsule.half_width[0];
        let flat = off.x.squared() + off.y.squared();
        let round = (flat + rise.squared() + 1e-4).sqrt();
        let section = if capsule.square > 0.0 {
            let square = (flat.squared() + rise.squared().squared() + 1e-6).sqrt().sqrt();
            mix(round, square, T::splat(round.value().token(), capsule.square))
        } else {
            round
        };
        let felt = (half_width - section + BLEND_M).at_least(0.0);
        let weight = felt.squared().squared();
        let drop = share * (capsule.drop[1] - capsule.drop[0]) + capsule.drop[0];
        let height = point.z - z - share * dz + drop;
        self.weight = self.weight + weight;
        self.height = self.height + weight * height;
        self.up = self.up + weight * (rise / round);
        self.half_width = self.half_width + weight * half_width;
        let constant_weight = T::constant(weight.value());
        for (sum, along) in self.flow.iter_mut().zip(capsule.flow) {
            *sum = *sum + constant_weight * along;
        }
    }

    #[inline(always)]
    fn store<S: Simd>(self, sites: &mut Sites, at: usize)
    where
        T: Stored<S>,
    {
        let total = self.weight + Self::FAINT;
        sites.wall.store(at, -self.weight.sqrt().sqrt() + BLEND_M);
        sites.height.store(at, self.height / total);
        sites.up.store(at, self.up / total);
        sites.half_width.store(at, self.half_width / total);
        for (sum, to) in self.flow.into_iter().zip(&mut sites.flow) {
            SurfaceSamples::put::<S>(to, at, sum.value() / total.value());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The graph crate assumes the passage sizes of the field.
    #[test]
    fn passages_have_one_default_size() {
        let (field, graph) = (PassageSettings::default().passage_size(), PassageSize::default());
        let sizes = |passage_size: PassageSize| {
            let PassageSize { width_per_radius, width_min_m, height_ratio, floor_drop, room_factor } = passage_size;
            [width_per_radius, width_min_m, height_ratio, floor_drop, room_factor]
        };
        for (field, graph) in sizes(field).into_iter().zip(sizes(graph)) {
            assert!((field - graph).abs() < 1e-6, "{field} {graph}");
        }
    }
}
