//! One step of the paper's walk: a new node on the circle of the previous one.

use nalgebra::Point3;

use super::cave::{Cave, GrowingStation, PassageKind, half_width};
use super::circle::{Circle, Spread, wrapped_rad};
use super::clearance::Goal;
use super::tuning::{DEGREE, DRAWS, MIN_JUNCTION};

/// What to draw.
pub(super) struct Step {
    pub(super) heading_rad: f64,
    pub(super) spread: Spread,
    /// Radius of the new node.
    pub(super) radius: f64,
    pub(super) kind: PassageKind,
    pub(super) level: u32,
    pub(super) floor: Floor,
    pub(super) goal: Goal,
}

/// Elevation of the new node.
#[derive(Clone, Copy)]
pub(super) enum Floor {
    /// On the surface of its level.
    Surface,
    /// As far down as this slope allows, but not below the surface of its level.
    Ramp(f64),
    /// At the elevation of the straight line to a station.
    Straight(usize),
}

impl Cave<'_> {
    /// Grows a node on the circle of `from`; if no section is left, that node dies.
    pub(super) fn step(&mut self, from: usize, step: &Step) -> Option<usize> {
        let mut circle = self.circle(from, step);
        for _ in 0..DRAWS {
            let Some(azimuth_rad) = circle.draw_azimuth_rad(&mut self.rng) else {
                break;
            };
            let position = self.placed(from, azimuth_rad, step);
            if self.accepts(from, &position, step) {
                return Some(self.add_station(GrowingStation {
                    parent: Some(from),
                    heading_rad: azimuth_rad,
                    ..GrowingStation::new(position, step.radius, step.kind, step.level)
                }));
            }
            circle.rule_out(azimuth_rad);
        }
        self.stations[from].alive = false;
        None
    }

    fn circle(&self, from: usize, step: &Step) -> Circle {
        let station = &self.stations[from];
        let center = [station.position.x, station.position.y];
        let mut circle = self.compass.circle(center, station.radius, step.heading_rad, step.spread);
        let behind = 0.5 * self.settings.forbidden_deg * DEGREE;
        for &other in &station.neighbors {
            let arc = if station.parent == Some(other) { behind } else { MIN_JUNCTION };
            circle.forbid(self.azimuth_rad(from, other), arc);
        }
        circle
    }

    fn placed(&self, from: usize, azimuth_rad: f64, step: &Step) -> Point3<f64> {
        let station = &self.stations[from];
        let (radius, at) = (station.radius, &station.position);
        let x = at.x + radius * libm::cos(azimuth_rad);
        let y = at.y + radius * libm::sin(azimuth_rad);
        let z = match step.floor {
            Floor::Surface => self.surface(x, y, step.level),
            Floor::Ramp(slope) => (at.z - radius * slope).max(self.surface(x, y, step.level)),
            Floor::Straight(to) => {
                let part = (radius / self.distance(from, to).max(radius)).min(1.0);
                at.z + (self.position(to).z - at.z) * part
            }
        };
        Point3::new(x, y, z)
    }

    fn accepts(&self, from: usize, position: &Point3<f64>, step: &Step) -> bool {
        let rise = (position.z - self.position(from).z).abs();
        let inside = position.x.abs() <= self.derived.half[0] && position.y.abs() <= self.derived.half[1];
        inside
            && rise <= self.stations[from].radius * self.greatest_slope(step.kind) + 1e-9
            && self.approaches(from, position, step.goal)
            && self.is_clear(from, position, half_width(step.radius), step.goal)
    }

    fn greatest_slope(&self, kind: PassageKind) -> f64 {
        let degrees = match kind {
            PassageKind::Ramp => self.settings.ramp_max_deg,
            _ => self.settings.max_slope_deg,
        };
        libm::tan(degrees * DEGREE)
    }

    /// Whether a connector does not move away from its goal.
    fn approaches(&self, from: usize, position: &Point3<f64>, goal: Goal) -> bool {
        let Goal::Towards(station) = goal else {
            return true;
        };
        let left = (self.position(station).xy() - position.xy()).norm();
        left < self.distance(from, station) + 1.0
    }

    /// Whether a passage at a station in this azimuth keeps the minimum angle to the others there.
    pub(super) fn opens(&self, station: usize, azimuth_rad: f64) -> bool {
        let mut neighbors = self.stations[station].neighbors.iter();
        neighbors.all(|&other| wrapped_rad(self.azimuth_rad(station, other) - azimuth_rad).abs() >= MIN_JUNCTION)
    }

    /// Whether a passage between two stations is not too steep.
    pub(super) fn is_walkable(&self, a: usize, b: usize, kind: PassageKind) -> bool {
        let rise = (self.position(a).z - self.position(b).z).abs();
        rise <= self.distance(a, b) * self.greatest_slope(kind)
    }
}
