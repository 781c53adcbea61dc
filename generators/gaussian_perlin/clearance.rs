//! The clearance rule: no passage runs through another by accident.
//!
//! Two centrelines keep at least half of both widths and a margin apart, in 3D. Passages that share a node are exempt
//! (angles keep them apart), and so are those one passage apart, which may merge like a small room but never cross.

use nalgebra::Point3;

use super::cave::{Cave, half_width};
use super::tuning::{CROSSING, MARGIN_M, ROUNDING_M};
use plume_graph::segment::segment_distance;

/// The goal of a passage under test.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// No goal.
    Open,
    /// A connector on its way to this station.
    Towards(usize),
    /// The last leg of a connector to this station.
    Joining(usize),
}

impl Cave<'_> {
    /// Whether a passage from a station to `tip` with this half width is clear of all others.
    pub(super) fn is_clear(&self, from: usize, tip: &Point3<f64>, half_width: f64, goal: Goal) -> bool {
        let base = self.position(from);
        let width = self.stations[from].half_width().max(half_width);
        let margin = MARGIN_M + ROUNDING_M;
        self.grid
            .passages_near([base, tip], self.reach_of(width, margin))
            .filter(|passage| !passage.contains(&from))
            .all(|passage| {
                let need = width + self.half_width(passage) + margin;
                let [u, v] = passage.map(|end| self.position(end));
                let apart = segment_distance([base, tip], [u, v]);
                if apart >= need {
                    return true;
                }
                let Some(at_goal) = self.is_at(goal, passage) else {
                    return true;
                };
                let at_base = self.adjoins(from, passage);
                let far_end = match (at_base, at_goal) {
                    (false, false) => return false,
                    (true, true) => return apart >= CROSSING * need,
                    (true, false) => tip,
                    (false, true) => base,
                };
                apart >= CROSSING * need && segment_distance([far_end; 2], [u, v]) >= need
            })
    }

    /// Whether an existing passage fully keeps the rule.
    pub(super) fn is_lawful(&self, a: usize, b: usize) -> bool {
        let ends = [self.position(a), self.position(b)];
        let width = self.half_width([a, b]);
        self.grid
            .passages_near(ends, self.reach_of(width, MARGIN_M))
            .filter(|&passage| !self.adjoins(a, passage) && !self.adjoins(b, passage))
            .all(|passage| {
                let need = width + self.half_width(passage) + MARGIN_M + ROUNDING_M;
                segment_distance(ends, passage.map(|end| self.position(end))) >= need
            })
    }

    /// Whether the passage is one passage away from the connector's end; `None` if it ends there too.
    fn is_at(&self, goal: Goal, passage: [usize; 2]) -> Option<bool> {
        match goal {
            Goal::Open => Some(false),
            Goal::Towards(station) => Some(passage.contains(&station)),
            Goal::Joining(station) if passage.contains(&station) => None,
            Goal::Joining(station) => Some(self.adjoins(station, passage)),
        }
    }

    /// Whether a neighbour of the station is an end of the passage.
    fn adjoins(&self, station: usize, [u, v]: [usize; 2]) -> bool {
        let neighbors = &self.stations[station].neighbors;
        neighbors.iter().any(|&other| other == u || other == v)
    }

    fn half_width(&self, [u, v]: [usize; 2]) -> f64 {
        self.stations[u].half_width().max(self.stations[v].half_width())
    }

    /// Range within which other passages matter to one of this half width.
    fn reach_of(&self, width: f64, margin: f64) -> f64 {
        width + half_width(self.settings.reach_max_m) + margin
    }
}
