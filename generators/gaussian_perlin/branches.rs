//! A branch: steps until its planned length is used up or no direction is left.

use super::cave::{Cave, PassageKind};
use super::circle::{Spread, wrapped_rad};
use super::clearance::Goal;
use super::step::{Floor, Step};
use super::tuning::{BEARING_PULL, DRIFT, NODES_IN_BRANCH, STRAIGHT_FROM};

/// A branch that may grow.
#[derive(Clone, Copy)]
pub(super) struct Bud {
    pub(super) station: usize,
    pub(super) bearing_rad: f64,
    pub(super) trunk: bool,
}

impl Cave<'_> {
    /// Grows a branch and returns its last node, or `None` if there was no room for any node.
    ///
    /// The direction of travel persists, drifts, and returns to the bearing of the branch.
    pub(super) fn grow(&mut self, bud: Bud) -> Option<usize> {
        let (length, main) = self.draw_length(bud.trunk);
        let mean = self.reach_in(length, bud.trunk);
        let kind = match (main, bud.trunk) {
            (true, _) => PassageKind::Main,
            (false, true) => PassageKind::Trunk,
            (false, false) => PassageKind::Spur,
        };
        let spread = if length > STRAIGHT_FROM * mean { Spread::Trunk } else { Spread::Spur };
        let (mut tip, mut bearing_rad, mut heading_rad) = (bud.station, bud.bearing_rad, bud.bearing_rad);
        let mut grown = 0.0;
        while grown < length && self.room() > 0 {
            let radius = self.draw_reach(mean, Some(self.stations[tip].radius));
            let level = self.stations[tip].level;
            let step = Step { heading_rad, spread, radius, kind, level, floor: Floor::Surface, goal: Goal::Open };
            let Some(next) = self.step(tip, &step) else {
                break;
            };
            grown += self.stations[tip].radius;
            tip = next;
            bearing_rad += DRIFT * self.rng.normal();
            bearing_rad = self.bearing_along_wall_rad(tip, bearing_rad);
            heading_rad = self.pulled_heading_rad(tip, bearing_rad);
        }
        if main && tip != bud.station && self.room() > 0 {
            self.stations[tip].kind = PassageKind::Trunk;
        }
        (tip != bud.station).then_some(tip)
    }

    /// The heading onwards from a node, pulled back to the bearing of its branch.
    pub(super) fn pulled_heading_rad(&self, station: usize, bearing_rad: f64) -> f64 {
        let heading_rad = self.stations[station].heading_rad;
        heading_rad + BEARING_PULL * wrapped_rad(bearing_rad - heading_rad)
    }

    fn draw_length(&mut self, trunk: bool) -> (f64, bool) {
        if trunk { self.lengths.trunk(&mut self.rng) } else { (self.lengths.spur(&mut self.rng), false) }
    }

    /// The mean radius in a branch of this length: long spurs are like trunks.
    fn reach_in(&self, length: f64, trunk: bool) -> f64 {
        let usual = if trunk { self.derived.trunk_reach } else { self.derived.spur_reach };
        usual.max(length / NODES_IN_BRANCH).min(self.derived.trunk_reach)
    }

    /// The bearing, turned along the bounds if it would run into them.
    fn bearing_along_wall_rad(&self, station: usize, bearing_rad: f64) -> f64 {
        const INWARD: f64 = 0.35;
        let at = self.position(station);
        let rim = 2.0 * self.derived.trunk_reach;
        let (mut x, mut y) = (libm::cos(bearing_rad), libm::sin(bearing_rad));
        let meets = |at: f64, half: f64, along: f64| at.abs() > half - rim && along * at > 0.0;
        let east_west = meets(at.x, self.derived.half[0], x);
        let north_south = meets(at.y, self.derived.half[1], y);
        if !east_west && !north_south {
            return bearing_rad;
        }
        if east_west {
            x = -INWARD.copysign(at.x);
        }
        if north_south {
            y = -INWARD.copysign(at.y);
        }
        libm::atan2(y, x)
    }
}
