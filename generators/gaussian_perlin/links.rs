//! Deliberate links between neighbouring layers: counted, spaced, and within a range of slopes.
//!
//! A link goes straight down from a station at a random slope until it meets the surface of the layer below, and along
//! that surface to a passage. Near 90 degrees that is a shaft. If links are counted, nothing else joins layers.

use nalgebra::{Point3, Vector2};

use super::GaussianPerlin;
use super::cave::{Cave, GrowingStation, Link, PassageKind};
use super::clearance::Goal;
use super::hops::Hops;
use super::tuning::{DEGREE, GENTLEST_RAMP, LINK_GOALS, LINK_SHARE, RAMP_HEADS, SHAFT, SINK_ROUNDS};
use crate::ramp::{Course, Slopes, way_down};
use plume_graph::millimetres;

impl GaussianPerlin {
    /// Whether passages between layers are counted and kept within a range of slopes, beyond the limits of ramps.
    pub(super) fn has_links(&self) -> bool {
        /// Maximum slope of ramps that are grown like other passages.
        const STEEPEST_WALK_DEG: f64 = 60.0;
        let asked = self.links > 1 || self.ramp_min_deg > 0.0 || self.ramp_max_deg > STEEPEST_WALK_DEG;
        self.layers > 1 && asked
    }

    /// Range of slopes of links, in radians.
    fn link_slopes(&self) -> Slopes {
        Slopes::of_degrees(self.ramp_min_deg.max(GENTLEST_RAMP * self.ramp_max_deg), self.ramp_max_deg)
    }
}

impl Cave<'_> {
    /// The upper layer of a pair that lacks links and is ready for one; the deepest layer, which starts at `start`, is ready
    /// once part of it exists.
    pub(super) fn unlinked(&self, start: usize) -> Option<u32> {
        let share = f64::from(self.settings.nodes) / f64::from(self.settings.layers);
        let is_ready = (self.stations.len() - start) as f64 >= LINK_SHARE * share;
        let ready = if is_ready { self.deepest } else { self.deepest.saturating_sub(1) };
        (0..ready).find(|&upper| self.links_below(upper).len() < self.settings.links as usize)
    }

    /// Whether every pair of layers has its links.
    pub(super) fn is_linked(&self) -> bool {
        (0..self.settings.layers - 1).all(|upper| self.links_below(upper).len() >= self.settings.links as usize)
    }

    fn links_below(&self, upper: u32) -> &[Link] {
        self.links.get(upper as usize).map_or(&[], Vec::as_slice)
    }

    /// Links a layer to a passage of the one below.
    pub(super) fn link(&mut self, upper: u32, hops: &mut Hops) -> bool {
        (0..RAMP_HEADS).any(|_| {
            let head = self.rng.index(self.stations.len());
            let station = &self.stations[head];
            let fits = station.level == upper && station.degree() <= 2 && station.kind != PassageKind::Ramp;
            fits && self.link_from(head, hops)
        })
    }

    fn link_from(&mut self, head: usize, hops: &mut Hops) -> bool {
        let start = self.stations.len();
        let Some(foot) = self.sink(head) else { return false };
        hops.count(foot, &self.stations);
        let lowest = self.stations[foot].level;
        let mut goals: Vec<(u64, usize)> = (self.grid.stations_near(self.position(foot), self.derived.join_distance))
            .filter(|&goal| self.stations[goal].level == lowest && self.is_joinable(foot, goal))
            .map(|goal| ((self.distance(foot, goal) * 1e6) as u64, goal))
            .collect();
        goals.sort_unstable();
        let joined = goals.iter().take(LINK_GOALS).any(|&(_, goal)| self.connect(foot, goal));
        if !joined {
            self.links[lowest as usize - 1].pop();
            self.truncate(start);
        }
        joined
    }

    /// Goes down from a station to the surface of the next layer; the station there, if there was room.
    pub(super) fn sink(&mut self, head: usize) -> Option<usize> {
        let slopes = self.settings.link_slopes();
        let slope_rad = self.rng.between(slopes.least_rad, slopes.greatest_rad);
        let aside = self.rng.sign() * self.rng.between(40.0, 100.0) * DEGREE;
        let passing = self.stations[head].degree() == 2;
        let bearing_rad = self.stations[head].heading_rad + if passing { aside } else { 0.0 };
        let foot = self.landing(head, bearing_rad, slope_rad);
        let step_m = self.draw_reach(self.derived.trunk_reach, Some(self.stations[head].radius));
        let way = way_down([*self.position(head), foot], Course::Straight, &slopes, step_m)?;
        let level = self.stations[head].level;
        let is_open = slope_rad >= SHAFT || self.opens(head, bearing_rad);
        if !is_open || way.len() > self.room() || !self.is_spaced(level, [way[0], foot]) {
            return None;
        }
        let (start, deepest) = (self.stations.len(), self.deepest);
        let Some(landed) = self.dig(head, &way, bearing_rad) else {
            self.truncate(start);
            self.deepest = deepest;
            return None;
        };
        self.links.resize((level as usize + 1).max(self.links.len()), Vec::new());
        self.links[level as usize].push([way[0], foot]);
        Some(landed)
    }

    /// Where a straight line of this slope approximately meets the layer below.
    fn landing(&self, head: usize, bearing_rad: f64, slope_rad: f64) -> Point3<f64> {
        let (from, level) = (self.position(head), self.stations[head].level + 1);
        let along = Vector2::new(libm::cos(bearing_rad), libm::sin(bearing_rad));
        let mut at = from.xy();
        for _ in 0..SINK_ROUNDS {
            let drop = from.z - self.surface(at.x, at.y, level);
            at = from.xy() + along * (drop / libm::tan(slope_rad));
        }
        Point3::new(at.x, at.y, self.surface(at.x, at.y, level)).map(millimetres)
    }

    /// Whether a link keeps its distance from the others of its layers.
    fn is_spaced(&self, upper: u32, link: Link) -> bool {
        self.links_below(upper).iter().all(|other| {
            let apart = |end: usize| (link[end].xy() - other[end].xy()).norm();
            apart(0).min(apart(1)) >= self.settings.link_spacing_m
        })
    }

    /// Adds stations along a line; the last one, if all are within bounds and clear.
    fn dig(&mut self, head: usize, way: &[Point3<f64>], bearing_rad: f64) -> Option<usize> {
        let level = self.stations[head].level + 1;
        let leg = (way[1] - way[0]).norm();
        let radius = leg.max(self.settings.reach_min_m).min(self.settings.reach_max_m);
        let mut tip = head;
        for position in &way[1..] {
            let station = GrowingStation {
                parent: Some(tip),
                heading_rad: bearing_rad,
                ..GrowingStation::new(*position, radius, PassageKind::Ramp, level)
            };
            let inside = position.x.abs() <= self.derived.half[0] && position.y.abs() <= self.derived.half[1];
            if !inside || !self.is_clear(tip, position, station.half_width(), Goal::Open) {
                return None;
            }
            tip = self.add_station(station);
        }
        Some(tip)
    }
}
