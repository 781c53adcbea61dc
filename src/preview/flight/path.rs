//! The path of a flight.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

use crate::field::{CaveField, Field};
use crate::preview::inside::{Pose, is_air, raised};
use crate::preview::{PreviewError, Subject};
use plume_graph::{Graph, StationId};

/// Distance between the points of a path, metres.
const STEP_M: f64 = 0.25;
/// Corners are rounded over this many points to either side, twice.
const ROUNDED: usize = 5;
/// The camera looks this far ahead, metres.
const AHEAD_M: f64 = 3.0;
/// Share of the slope of the path that the camera follows. Tuned: less than all looks calm.
const NODDING: f64 = 0.6;

/// Camera positions, at most [`STEP_M`] apart.
pub struct Path {
    points: Vec<Point3<f64>>,
}

impl Path {
    /// The path from the first station to the one furthest away along passages.
    pub fn longest(subject: &Subject) -> Result<Self, PreviewError> {
        let stations = furthest(subject.graph);
        let axis: Vec<Point3<f64>> = stations.iter().map(|&station| subject.graph[station].position).collect();
        let axis = resampled(&axis);
        let round = rounded(&rounded(&axis));
        let eye = |(round, axis): (&Point3<f64>, &Point3<f64>)| eye(subject.field, *round, *axis);
        let eyes: Vec<Point3<f64>> = round.iter().zip(&axis).filter_map(eye).collect();
        if eyes.is_empty() {
            return Err(PreviewError::NoAir);
        }
        let calm = rounded(&eyes);
        let points = calm.iter().zip(&eyes).map(|(calm, eye)| if in_air(subject.field, *calm) { *calm } else { *eye });
        Ok(Self { points: points.collect() })
    }

    /// Approximate length of the path in metres.
    pub fn length_m(&self) -> f64 {
        (self.points.len() - 1) as f64 * STEP_M
    }

    /// The pose after this many metres.
    pub fn pose(&self, along_m: f64) -> Pose {
        let eye = self.at(along_m);
        // At the end the direction stays.
        let from = self.at(along_m.min(self.length_m() - AHEAD_M));
        let way = self.at(along_m.min(self.length_m() - AHEAD_M) + AHEAD_M) - from;
        let level = libm::hypot(way.x, way.y);
        Pose {
            eye: eye.coords.map(|c| c as f32).into(),
            yaw_rad: libm::atan2(way.y, way.x) as f32,
            pitch_rad: (NODDING * libm::atan2(way.z, level)) as f32,
        }
    }

    fn at(&self, along_m: f64) -> Point3<f64> {
        let place = (along_m / STEP_M).clamp(0.0, (self.points.len() - 1) as f64);
        let first = place as usize;
        let next = (first + 1).min(self.points.len() - 1);
        self.points[first] + (self.points[next] - self.points[first]) * (place - first as f64)
    }
}

/// Stations on the shortest path to the station furthest from the first.
fn furthest(graph: &Graph) -> Vec<StationId> {
    let neighbors = graph.neighbors();
    let mut way_m = vec![f64::INFINITY; graph.nodes.len()];
    let mut before: Vec<Option<StationId>> = vec![None; graph.nodes.len()];
    // Lengths are not negative, so the order of their bits is their order.
    let first = StationId::new(0);
    let mut queue = BinaryHeap::from([(Reverse(0_u64), Reverse(first))]);
    way_m[first.index()] = 0.0;
    while let Some((Reverse(bits), Reverse(station))) = queue.pop() {
        if f64::from_bits(bits) > way_m[station.index()] {
            continue;
        }
        for &other in &neighbors[station] {
            let through = way_m[station.index()] + graph.distance_m(station, other);
            if through < way_m[other.index()] {
                way_m[other.index()] = through;
                before[other.index()] = Some(station);
                queue.push((Reverse(through.to_bits()), Reverse(other)));
            }
        }
    }
    let reached = graph.stations().filter(|station| way_m[station.index()].is_finite());
    let last = reached.rev().max_by(|a, b| way_m[a.index()].total_cmp(&way_m[b.index()])).unwrap_or(first);
    let mut stations: Vec<StationId> = std::iter::successors(Some(last), |station| before[station.index()]).collect();
    stations.reverse();
    stations
}

fn resampled(corners: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut points = vec![corners[0]];
    for pair in corners.windows(2) {
        let way = pair[1] - pair[0];
        let count = libm::ceil(way.norm() / STEP_M).max(1.0);
        points.extend((1..=count as usize).map(|i| pair[0] + way * (i as f64 / count)));
    }
    points
}

/// The mean of the neighbours of each point; the ends stay.
fn rounded(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mean = |i: usize| {
        let reach = ROUNDED.min(i).min(points.len() - 1 - i);
        let around = &points[i - reach..=i + reach];
        let sum = around.iter().fold(Vector3::zeros(), |sum, point| sum + point.coords);
        Point3::from(sum / around.len() as f64)
    };
    (0..points.len()).map(mean).collect()
}

/// The camera of a robot on the floor under a point of the rounded path, or under the axis if the former is in rock.
fn eye(field: &CaveField, round: Point3<f64>, axis: Point3<f64>) -> Option<Point3<f64>> {
    let over = |point: Point3<f64>| {
        let [x, y, z]: [f32; 3] = point.coords.map(|c| c as f32).into();
        // Stones and undulation are on top of the floor.
        let ground = (0..8).map(|step| [x, y, field.floor_z([x, y, z]) + 0.05 * step as f32]);
        let ground = ground.into_iter().find(|&point| is_air(field, point))?;
        Some(Point3::from(raised(field, ground).map(f64::from)))
    };
    let fits = |eye: &Point3<f64>| in_air(field, *eye);
    over(round).filter(fits).or_else(|| over(axis).filter(fits)).or_else(|| Some(axis).filter(fits))
}

fn in_air(field: &dyn Field, point: Point3<f64>) -> bool {
    is_air(field, point.coords.map(|c| c as f32).into())
}
