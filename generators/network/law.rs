//! The rules of a network.
//!
//! Neither the axis of a passage nor its floor is steeper than allowed. At its ends it keeps the minimum angle to the others, and
//! the floor from one to the other is not too steep either. Where it comes nearer to another passage than their clearance radii
//! and the rock between them, the two are also near along the cave: the path along the cave is at most [`DETOUR`] times the
//! distance through the rock, and at most [`NEARBY`] times the distance to be kept. So passages meet where they join, and
//! nowhere else. Distances are those of centrelines in 3D, tested at the nearest points and at the four ends.

use nalgebra::{Point3, Vector3};

use super::ways::Ways;
use super::{Network, PassagePoint};
use plume_graph::segment::segment_distance;

/// Limit on the path along the cave between places without rock between them, relative to their distance. Two straight
/// passages at a junction keep it from an angle of 47 degrees on.
const DETOUR: f64 = 2.5;
/// The same relative to the distance that their axes should keep.
const NEARBY: f64 = 2.0;

impl Network {
    /// Whether a passage between two stations that are already registered as neighbours keeps the rules.
    pub(super) fn is_lawful(&self, a: usize, b: usize) -> bool {
        self.is_walkable(self.floor(b) - self.floor(a))
            && self.is_walkable(self.position(b) - self.position(a))
            && self.opens(a, b)
            && self.opens(b, a)
            && self.is_clear(a, b)
    }

    /// Where the floor is below a station.
    fn floor(&self, station: usize) -> Point3<f64> {
        let PassagePoint { position, size } = self.passage_point(station);
        position - Vector3::z() * size.section().axis_height_m()
    }

    /// Whether a passage in this direction is not too steep.
    pub(super) fn is_walkable(&self, way: Vector3<f64>) -> bool {
        way.z.abs() <= self.greatest_rise(way.xy().norm())
    }

    /// Maximum rise or fall of a passage over this horizontal distance.
    pub(super) fn greatest_rise(&self, plan_m: f64) -> f64 {
        // Rounding to millimetres can steepen short passages.
        const SLACK_M: f64 = 0.002;
        self.steepest_slope * plan_m + SLACK_M
    }

    /// Whether the passage to `to` keeps the minimum angle to the others at `at`, and parts from them gently.
    fn opens(&self, at: usize, to: usize) -> bool {
        let way = |other: usize| self.floor(other) - self.floor(at);
        let own = way(to);
        let most = self.sharpest * own.norm();
        let mut others = self.neighbors(at).filter(|&other| other != to).map(way);
        others.all(|other| own.dot(&other) <= most * other.norm() && self.parts_gently(own, other))
    }

    /// Whether the floor between two passages that begin at one station, a metre from it, is not too steep. Where one rises and
    /// the other falls, there would be a ledge.
    fn parts_gently(&self, one: Vector3<f64>, other: Vector3<f64>) -> bool {
        // Rounding to millimetres can steepen short passages.
        const SLACK: f64 = 0.005;
        let per_m = |way: Vector3<f64>| way / way.xy().norm();
        let apart = per_m(one) - per_m(other);
        apart.z.abs() <= self.steepest_slope * apart.xy().norm() + SLACK
    }

    fn is_clear(&self, a: usize, b: usize) -> bool {
        let ends = [self.position(a), self.position(b)];
        let width = self.clearance_radius([a, b]);
        let reach = width + self.rules.widest.clearance_radius() + self.rules.rock_m;
        let mut ways: Option<[Ways; 2]> = None;
        for other in self.passages.near(ends, reach).map(|other| other.map(|end| end as usize)) {
            let need = width + self.clearance_radius(other) + self.rules.rock_m;
            let is_joined = other.contains(&a) || other.contains(&b);
            let other_ends = other.map(|end| self.position(end));
            if is_joined || box_gap(ends, other_ends) >= need || segment_distance(ends, other_ends) >= need {
                continue;
            }
            let ways = ways.get_or_insert_with(|| {
                let far = NEARBY * reach;
                [self.ways(a, Some(b), far), self.ways(b, Some(a), far)]
            });
            if !self.is_meeting([a, b], other, need, ways) {
                return false;
            }
        }
        true
    }

    /// Whether two passages nearer than `need` are near because they are connected here.
    fn is_meeting(&self, own: [usize; 2], other: [usize; 2], need: f64, ways: &[Ways; 2]) -> bool {
        let [a, b] = own.map(|end| self.position(end));
        let [u, v] = other.map(|end| self.position(end));
        let length = (b - a).norm();
        let [from_a, from_b] = [ways[0].to_passage(other), ways[1].to_passage(other)];
        let keeps = |apart: f64, along: f64| apart >= need || along <= (DETOUR * apart).min(NEARBY * need);
        let to = |end: usize| ways[0].to(end).min(ways[1].to(end));
        keeps(segment_distance([a, b], [u, v]), from_a.min(from_b))
            && keeps(from_point(a, [u, v]), from_a.min(from_b + length))
            && keeps(from_point(b, [u, v]), from_b.min(from_a + length))
            && keeps(from_point(u, [a, b]), to(other[0]))
            && keeps(from_point(v, [a, b]), to(other[1]))
    }

    fn clearance_radius(&self, [u, v]: [usize; 2]) -> f64 {
        self.passage_point(u).size.clearance_radius().max(self.passage_point(v).size.clearance_radius())
    }
}

/// A lower bound of the distance of two segments: the largest gap between their boxes along an axis.
fn box_gap([a, b]: [&Point3<f64>; 2], [u, v]: [&Point3<f64>; 2]) -> f64 {
    let beyond = u.inf(v) - a.sup(b);
    let before = a.inf(b) - u.sup(v);
    beyond.sup(&before).max()
}

fn from_point(point: &Point3<f64>, segment: [&Point3<f64>; 2]) -> f64 {
    segment_distance([point; 2], segment)
}
