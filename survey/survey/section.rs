//! Sections of passages from measured distances to walls (LRUD).
//!
//! The width of the passage is left plus right, the height up plus down; its axis moves to the middle, sideways relative to
//! the passage, and up or down so that the floor is where it was measured. A station with several cross-sections takes the
//! greatest width, the highest ceiling and the lowest floor, so that all of them fit.
//!
//! A missing side is taken to be like the other one; a missing width, ceiling or floor is interpolated along the passages
//! ([`spread`](super::spread)). A width or height of zero counts as missing, since somebody got through. In a part with only
//! widths or only heights, passages are as high as wide. In a part with neither, stations have no section.
//!
//! If a ceiling or floor was measured up or down a shaft that a leg follows, the leg makes the shaft, and the passage that
//! leads there must not get that high: such a distance counts as missing.

use std::path::Path;

use nalgebra::{Point3, Vector2, Vector3};

use super::spread::{Ways, spread};
use super::{Survey, Walls};
use crate::ReadError;
use plume_graph::{Section, Shape};

/// Largest plausible distance to a wall, in metres. The largest known chamber, Sarawak, is 600 m long.
const MAX_WALL_M: f64 = 1000.0;
/// Share of a passage's height below its axis, with the floor at the default `floor_drop` of 0.5.
const BELOW_AXIS: f64 = 1.0 / 3.0;
/// Minimum height of passages, the default `width_min_m`, which the axis must allow for.
const LEAST_HEIGHT_M: f64 = 1.4;
/// Minimum distance of two stations in plan, in metres, for left and right to be defined.
const LEAST_VIEW_M: f64 = 0.1;

/// A leg steeper than this (rise over run) is a shaft: 63°. Tuned.
const SHAFT_SLOPE: f64 = 2.0;
/// A ceiling farther away than this share of a shaft's height was measured in the shaft. Tuned.
const SHAFT_SHARE: f64 = 0.5;

/// A passage at a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    pub(super) section: Section,
    /// From the station to the axis.
    pub(super) middle: Vector3<f64>,
}

/// Refuses implausible distances.
pub(super) fn check(walls: &[Walls], path: &Path) -> Result<(), ReadError> {
    let distances = walls.iter().flat_map(|walls| [walls.left_m, walls.right_m, walls.up_m, walls.down_m]);
    match distances.flatten().find(|distance| !(0.0..=MAX_WALL_M).contains(distance)) {
        None => Ok(()),
        Some(wall_m) => {
            let message = format!("has a station {wall_m} m from a wall, which must be 0 to {MAX_WALL_M} m");
            Err(ReadError::whole(path, message, "check the unit of left, right, up and down"))
        }
    }
}

/// The passage at each station as far as it is known, and how many of the stations with legs were interpolated.
pub(super) fn rooms(survey: &Survey, welds: &[usize], lines: &[[usize; 2]]) -> (Vec<Option<Room>>, usize) {
    let places: Vec<Point3<f64>> = survey.stations.iter().map(|station| station.position).collect();
    let measured = measured(survey, welds, &shafts(&places, lines));
    let ways = Ways::new(&places, lines);
    let spread_of = |value: fn(&Measured) -> Option<f64>| {
        let values: Vec<Option<f64>> = measured.iter().map(value).collect();
        spread(&ways, &values)
    };
    let widths = spread_of(|station| station.width_m);
    let ups = spread_of(|station| station.up_m);
    let downs = spread_of(|station| station.down_m);
    let room = |station: usize| room(widths[station], ups[station], downs[station], measured[station].aside);
    let rooms: Vec<Option<Room>> = (0..measured.len()).map(room).collect();

    let mut on_line = vec![false; measured.len()];
    lines.iter().flatten().for_each(|&end| on_line[end] = true);
    let is_interpolated =
        |&station: &usize| on_line[station] && rooms[station].is_some() && !measured[station].is_whole();
    let interpolated = (0..measured.len()).filter(is_interpolated).count();
    (rooms, interpolated)
}

/// The measurements at a station.
#[derive(Clone, Copy, Debug, Default)]
struct Measured {
    width_m: Option<f64>,
    /// From the station to the middle between left and right.
    aside: Vector2<f64>,
    up_m: Option<f64>,
    down_m: Option<f64>,
}

impl Measured {
    fn is_whole(&self) -> bool {
        self.width_m.is_some() && self.up_m.is_some() && self.down_m.is_some()
    }

    /// Extends to another cross-section.
    fn add(&mut self, walls: &Walls, survey: &Survey) {
        let sides = walls.left_m.or(walls.right_m).zip(walls.right_m.or(walls.left_m));
        if let Some((left, right)) = sides.filter(|(left, right)| left + right > self.width_m.unwrap_or(0.0)) {
            self.width_m = Some(left + right);
            self.aside = to_the_left(walls, survey) * (0.5 * (left - right));
        }
        self.up_m = farther(self.up_m, walls.up_m);
        self.down_m = farther(self.down_m, walls.down_m);
    }

    /// Without measurements in a shaft, and without a height of zero.
    fn of_passage(self, shaft: Shaft) -> Self {
        let outside = |shaft_m: f64| move |far_m: &f64| shaft_m == 0.0 || *far_m < SHAFT_SHARE * shaft_m;
        let (up_m, down_m) = (self.up_m.filter(outside(shaft.up_m)), self.down_m.filter(outside(shaft.down_m)));
        if up_m == Some(0.0) && down_m == Some(0.0) {
            return Self { up_m: None, down_m: None, ..self };
        }
        Self { up_m, down_m, ..self }
    }
}

/// How far steep legs lead up and down from a station.
#[derive(Clone, Copy, Debug, Default)]
struct Shaft {
    up_m: f64,
    down_m: f64,
}

fn shafts(places: &[Point3<f64>], lines: &[[usize; 2]]) -> Vec<Shaft> {
    let mut shafts = vec![Shaft::default(); places.len()];
    for &[a, b] in lines {
        let way = places[b] - places[a];
        if way.z.abs() > SHAFT_SLOPE * way.xy().norm() {
            let [low, high] = if way.z > 0.0 { [a, b] } else { [b, a] };
            shafts[low].up_m = shafts[low].up_m.max(way.z.abs());
            shafts[high].down_m = shafts[high].down_m.max(way.z.abs());
        }
    }
    shafts
}

fn farther(one_m: Option<f64>, other_m: Option<f64>) -> Option<f64> {
    one_m.into_iter().chain(other_m).reduce(f64::max)
}

fn measured(survey: &Survey, welds: &[usize], shafts: &[Shaft]) -> Vec<Measured> {
    let mut measured = vec![Measured::default(); survey.stations.len()];
    for walls in &survey.walls {
        measured[welds[walls.station]].add(walls, survey);
    }
    measured.into_iter().zip(shafts).map(|(station, &shaft)| station.of_passage(shaft)).collect()
}

/// The unit vector to the left in plan; `None` when looking up or down a shaft.
fn to_the_left(walls: &Walls, survey: &Survey) -> Vector2<f64> {
    let [from, to] = walls.looking.map(|station| survey.stations[station].position);
    let ahead = (to - from).xy();
    let length_m = ahead.norm();
    if length_m < LEAST_VIEW_M {
        return Vector2::zeros();
    }
    Vector2::new(-ahead.y, ahead.x) / length_m
}

fn room(width_m: Option<f64>, up_m: Option<f64>, down_m: Option<f64>, aside: Vector2<f64>) -> Option<Room> {
    let half_m = width_m.map(|width| 0.5 * width).or(up_m).or(down_m)?;
    let (up_m, down_m) = (up_m.unwrap_or(half_m), down_m.unwrap_or(half_m));
    let height_m = up_m + down_m;
    let width_m = width_m.unwrap_or(height_m);
    if width_m.min(height_m) < 0.001 {
        return None;
    }
    let rise = BELOW_AXIS * height_m.max(LEAST_HEIGHT_M) - down_m;
    Some(Room {
        section: Section { width_m, height_m, shape: Shape::Cave },
        middle: Vector3::new(aside.x, aside.y, rise),
    })
}

#[cfg(test)]
mod tests {
    use super::super::SurveyStation;
    use super::*;

    /// Three stations northwards, 10 m apart, with these walls at the middle one.
    fn middle_room(walls: [Option<f64>; 4]) -> Option<Room> {
        let [left_m, right_m, up_m, down_m] = walls;
        let station = |y: f64| SurveyStation::at(Point3::new(0.0, y, 0.0));
        let walls = vec![Walls { station: 1, looking: [0, 2], left_m, right_m, up_m, down_m }];
        let stations = vec![station(0.0), station(10.0), station(20.0)];
        let survey = Survey { stations, walls, ..Survey::default() };
        rooms(&survey, &[0, 1, 2], &[[0, 1], [1, 2]]).0[1]
    }

    #[test]
    fn the_axis_moves_to_the_middle_and_the_floor_stays() {
        let room = middle_room([Some(3.0), Some(1.0), Some(5.0), Some(1.0)]).expect("measured");
        assert_eq!(room.section, Section { width_m: 4.0, height_m: 6.0, shape: Shape::Cave });
        assert_eq!(room.middle, Vector3::new(-1.0, 0.0, 1.0));
    }

    #[test]
    fn a_shaft_followed_by_a_leg_is_not_a_ceiling() {
        let places = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 1.0, 12.0]];
        let stations = places.map(|place| SurveyStation::at(place.into())).to_vec();
        let walls = |station: usize, up_m: f64| Walls {
            station,
            looking: [0, 1],
            left_m: Some(1.0),
            right_m: Some(1.0),
            up_m: Some(up_m),
            down_m: Some(1.0),
        };
        let survey = Survey { stations, walls: vec![walls(0, 2.0), walls(1, 11.0)], ..Survey::default() };
        let (rooms, interpolated) = rooms(&survey, &[0, 1, 2], &[[0, 1], [1, 2]]);
        let heights = rooms.into_iter().map(|room| room.expect("the walls are known").section.height_m);
        assert_eq!((heights.collect::<Vec<_>>(), interpolated), (vec![3.0; 3], 2));
    }

    #[test]
    fn missing_sides_mirror_the_other_or_height_equals_width() {
        let room = middle_room([None, Some(1.5), None, None]).expect("the width is known");
        assert_eq!((room.section.width_m, room.section.height_m, room.middle.x), (3.0, 3.0, 0.0));
        let room = middle_room([None, None, Some(2.0), Some(0.0)]).expect("the height is known");
        assert_eq!((room.section.width_m, room.section.height_m), (2.0, 2.0));
        assert_eq!(middle_room([Some(0.0); 4]), None);
        assert_eq!(middle_room([None; 4]), None);
    }
}
