//! Layers: the surface each one lies on, and the ramps between them.

use super::cave::{Cave, PassageKind};
use super::circle::Spread;
use super::clearance::Goal;
use super::step::{Floor, Step};
use super::tuning::{DEGREE, GENTLEST_RAMP, LAYER_SHARE, RAMP_HEADS, RELIEF_GAIN, RELIEF_SCALE_M};

/// Height above the surface at which a ramp counts as arrived, in metres.
const ARRIVED_M: f64 = 0.01;

impl Cave<'_> {
    /// Height of a layer at a point of the plan. It depends on the plan position alone, so loops close without a step.
    pub(super) fn surface(&self, x: f64, y: f64, level: u32) -> f64 {
        let (u, v) = (x / RELIEF_SCALE_M, y / RELIEF_SCALE_M);
        let broad = self.relief.at(u + 7.3 * f64::from(level), v);
        let fine = 0.35 * self.relief.at(2.7 * u + 31.7, 2.7 * v);
        RELIEF_GAIN * self.settings.relief_m * (broad + fine) - self.settings.layer_spacing_m * f64::from(level)
    }

    /// Whether the deepest layer has its share of nodes and another one is to follow.
    pub(super) fn is_layer_due(&self) -> bool {
        let open = f64::from(self.deepest + 1);
        let share = f64::from(self.settings.nodes) * open / f64::from(self.settings.layers);
        self.deepest + 1 < self.settings.layers && self.stations.len() as f64 >= LAYER_SHARE * share
    }

    /// Opens the next layer by a ramp from the deepest one, whose stations begin at `start`; its foot, if there was room
    /// for one.
    pub(super) fn descend(&mut self, start: usize) -> Option<usize> {
        (0..RAMP_HEADS).find_map(|_| {
            let head = start + self.rng.index(self.stations.len() - start);
            let station = &self.stations[head];
            let fits = station.level == self.deepest && station.degree() <= 2 && station.kind != PassageKind::Ramp;
            if !fits {
                return None;
            }
            if self.settings.has_links() { self.sink(head) } else { self.grow_ramp(head) }
        })
    }

    fn grow_ramp(&mut self, head: usize) -> Option<usize> {
        let start = self.stations.len();
        let steepest = self.settings.ramp_max_deg;
        let slope = self.rng.between(GENTLEST_RAMP * steepest, steepest);
        let aside = self.rng.sign() * self.rng.between(40.0, 100.0) * DEGREE;
        let passing = self.stations[head].degree() == 2;
        let bearing_rad = self.stations[head].heading_rad + if passing { aside } else { 0.0 };
        let foot = self.walk_down(head, bearing_rad, libm::tan(slope * DEGREE));
        if foot.is_none() {
            self.truncate(start);
            self.deepest = self.stations[head].level;
        }
        foot
    }

    fn walk_down(&mut self, head: usize, bearing_rad: f64, slope: f64) -> Option<usize> {
        let level = self.stations[head].level + 1;
        let (mut tip, mut heading_rad) = (head, bearing_rad);
        loop {
            let step = Step {
                heading_rad,
                spread: Spread::Trunk,
                radius: self.draw_reach(self.derived.trunk_reach, Some(self.stations[tip].radius)),
                kind: PassageKind::Ramp,
                level,
                floor: Floor::Ramp(slope),
                goal: Goal::Open,
            };
            tip = self.step(tip, &step)?;
            if self.room() == 0 {
                return None;
            }
            let at = self.position(tip);
            if at.z <= self.surface(at.x, at.y, level) + ARRIVED_M {
                return Some(tip);
            }
            heading_rad = self.pulled_heading_rad(tip, bearing_rad);
        }
    }
}
