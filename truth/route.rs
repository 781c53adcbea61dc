//! Paths that a robot can follow: through the middle, smoothed, and held against the floor in every pose.

use std::f64::consts::{PI, TAU};
use std::ops::Add;

use super::floor::Floor;
use super::scout::Scout;
use super::search::{Pose, Rest, Routes, Sense, State};
use super::vector::away;
use super::vehicle::{Class, Fault, Profile};

/// Rounds of smoothing: tuned so that the corners of the search are gone and those of the passages are not.
const ROUNDS: usize = 60;
/// Furthest that smoothing moves a point, in metres.
const MOST_MOVED_M: f64 = 0.25;
/// A turn at which a robot stops and turns on the spot, in radians.
const STOP_RAD: f64 = 1.4;
/// How many points on either side of one that is no good are put back.
const PUT_BACK: usize = 4;
/// Furthest that a height is from that of its neighbours, in metres: more is another floor.
const SAME_FLOOR_M: f64 = 0.3;

/// A path for a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Route {
    /// The poses, about a tenth of a metre apart.
    pub waypoints: Vec<Waypoint>,
    /// The worst class on the way.
    pub class: Class,
}

/// A pose on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Where the robot is, in metres: on the floor, or in the air for a drone.
    pub position_m: [f64; 3],
    /// From +x towards +y, in radians.
    pub heading_rad: f64,
    /// How it is pitched up, in radians.
    pub climb_rad: f64,
    /// How much higher its left is, in radians.
    pub lean_rad: f64,
    /// From the middle to what the robot cannot drive onto, in metres.
    pub clearance_m: f64,
}

impl Route {
    /// The path from a start on the floor by way of places in the air, all in metres, as short as its margins and the middle of the
    /// passages allow.
    ///
    /// # Errors
    /// The number of the first place that cannot be reached from the one before.
    pub fn via(floor: &Floor, robot: &Profile, start_m: [f64; 3], places_m: &[[f64; 3]]) -> Result<Self, usize> {
        let mut scout = Scout::new(floor, robot);
        let mut starts = scout.at_start(start_m);
        let mut way: Vec<State> = Vec::new();
        let mut class = Class::Go;
        for (number, place) in places_m.iter().enumerate() {
            let goals = scout.at_place(*place);
            let routes = Routes::search(&mut *scout.terrain, &starts, &goals, Sense::Ahead, Class::Marginal, &|_| true);
            let goal = routes.goal.ok_or(number)?;
            let leg = routes.way(goal);
            way.extend(&leg[usize::from(!way.is_empty())..]);
            class = class.max(routes.class(goal).unwrap_or_default());
            starts = vec![goal];
        }
        let class = scout.class_with_stops(&way, class);
        Ok(Self::along(&mut scout, &way, class))
    }

    /// The path along a way whose worst class is this.
    pub(super) fn along(scout: &mut Scout, way: &[State], class: Class) -> Self {
        let poses = scout.poses(way);
        Self { waypoints: waypoints(scout, &poses, class), class }
    }

    /// Length in metres.
    pub fn length_m(&self) -> f64 {
        length_m(self.waypoints.iter().map(|waypoint| waypoint.position_m))
    }
}

/// Smooths poses between stops; what would be worse than `class` stays as it was found.
fn waypoints(scout: &mut Scout, poses: &[Pose], class: Class) -> Vec<Waypoint> {
    let mut places: Vec<[f64; 3]> = poses.iter().map(|pose| pose.position_m).collect();
    places.dedup_by(|next, last| next[..2] == last[..2]);
    let mut found = Vec::new();
    for leg in legs(&places) {
        let poses = smooth(scout, leg, class);
        found.extend(poses.into_iter().filter_map(|(pose, rest)| waypoint(scout, &pose, rest?)));
    }
    found
}

impl Scout<'_> {
    /// The class of a way along which the robot also has to stop and turn.
    pub(super) fn class_with_stops(&self, way: &[State], class: Class) -> Class {
        self.steep_stop(way).map_or(class, |_| class.max(Class::Marginal))
    }

    /// Why the robot does not surely turn at one of the stops on a way, and where that is, in metres.
    pub(super) fn steep_stop(&self, way: &[State]) -> Option<(Fault, [f64; 3])> {
        let mut stands = way.to_vec();
        stands.dedup_by_key(|state| state.cell);
        let places: Vec<[f64; 3]> = self.poses(&stands).iter().map(|pose| pose.position_m).collect();
        let fault = |stop: usize| Some((self.terrain.why_no_stop(stands[stop].cell as usize)?, places[stop]));
        stops(&places).find_map(fault)
    }
}

/// The places at which a robot stops and turns on the spot.
fn stops(places: &[[f64; 3]]) -> impl Iterator<Item = usize> {
    let is_stop = |number: &usize| {
        let headings = [number - 1, *number].map(|from| heading(places[from], places[from + 1]));
        turn(headings[0], headings[1]).abs() > STOP_RAD
    };
    (1..places.len().saturating_sub(1)).filter(is_stop)
}

/// The parts of a way between stops, which both have.
fn legs(places: &[[f64; 3]]) -> impl Iterator<Item = &[[f64; 3]]> {
    let last = places.len().saturating_sub(1);
    let stops: Vec<usize> = stops(places).collect();
    let starts: Vec<usize> = [0].into_iter().chain(stops.iter().copied()).collect();
    let ends: Vec<usize> = stops.into_iter().chain([last]).collect();
    starts.into_iter().zip(ends).filter(|(start, end)| start < end).map(|(start, end)| &places[start..=end])
}

/// The poses along a leg, smoothed, and how the robot is there.
fn smooth(scout: &Scout, places: &[[f64; 3]], class: Class) -> Vec<(Pose, Option<Rest>)> {
    let mut points = relaxed(places);
    // What is not good enough is put back a few points at a time, which ends when everything is as it was.
    loop {
        let poses = along(&points);
        let rests: Vec<Option<Rest>> = poses.iter().map(|pose| scout.terrain.rest(pose)).collect();
        let is_bad = |number: &usize| rests[*number].is_none_or(|rest| rest.class > class);
        let moved = |number: &usize| points[*number] != places[*number];
        let bad: Vec<usize> = (0..points.len()).filter(is_bad).collect();
        let around = |number: &usize| number.saturating_sub(PUT_BACK)..(number + PUT_BACK + 1).min(points.len());
        let put_back: Vec<usize> = bad.iter().flat_map(around).filter(moved).collect();
        if put_back.is_empty() {
            return poses.into_iter().zip(rests).collect();
        }
        put_back.into_iter().for_each(|number| points[number] = places[number]);
    }
}

/// Points pulled towards the middle between their neighbours; the ends stay.
fn relaxed(places: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut points = places.to_vec();
    for _ in 0..ROUNDS {
        let before = points.clone();
        for number in 1..points.len().saturating_sub(1) {
            let middle = [0, 1, 2].map(|axis| (before[number - 1][axis] + before[number + 1][axis]) / 2.0);
            let moved = [0, 1, 2].map(|axis| (before[number][axis] + middle[axis]) / 2.0);
            if away([moved[0], moved[1], 0.0], [places[number][0], places[number][1], 0.0]) <= MOST_MOVED_M {
                points[number] = moved;
            }
        }
    }
    points
}

/// Poses at points, each facing from the one before to the one after.
fn along(points: &[[f64; 3]]) -> Vec<Pose> {
    let pose = |number: usize| {
        let [before, after] = [number.saturating_sub(1), (number + 1).min(points.len() - 1)];
        Pose { position_m: points[number], heading_rad: heading(points[before], points[after]) }
    };
    (0..points.len()).map(pose).collect()
}

fn waypoint(scout: &mut Scout, pose: &Pose, rest: Rest) -> Option<Waypoint> {
    let [x, y, _] = pose.position_m;
    let Rest { height_m, climb_rad, lean_rad, .. } = rest;
    let cell = scout.floor.under([x, y, height_m + SAME_FLOOR_M])?;
    let clearance_m = scout.terrain.room_m(cell).into();
    Some(Waypoint { position_m: [x, y, height_m], heading_rad: pose.heading_rad, climb_rad, lean_rad, clearance_m })
}

/// Length in metres of the line through points.
pub(super) fn length_m(points: impl Iterator<Item = [f64; 3]> + Clone) -> f64 {
    points.clone().zip(points.skip(1)).map(|(a, b)| away(a, b)).fold(0.0, f64::add)
}

fn heading(from: [f64; 3], to: [f64; 3]) -> f64 {
    libm::atan2(to[1] - from[1], to[0] - from[0])
}

/// From one heading to another, between −π and π.
fn turn(from_rad: f64, to_rad: f64) -> f64 {
    let turned = to_rad - from_rad + PI;
    turned - (turned / TAU).floor() * TAU - PI
}
