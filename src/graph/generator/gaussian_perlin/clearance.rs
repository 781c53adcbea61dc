//! The clearance law: no passage runs through another by accident.
//!
//! Two passages keep as much rock between them as half their widths and a margin, measured between their centrelines in
//! space. Passages that share a node are exempt (angles keep them apart), and so are those one passage apart, which
//! may meet like a small room but never cross.

use nalgebra::{Point3, Vector3};

use super::cave::{Cave, half_width};
use super::tuning::{CROSSING, MARGIN_M, ROUNDING_M};

/// What a passage under test is on its way to.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// Nowhere in particular.
    Open,
    /// A connector to this station, not there yet.
    Towards(usize),
    /// The last leg of a connector to this station.
    Joining(usize),
}

impl Cave<'_> {
    /// Whether a passage from a station to `tip`, half as wide as `half_width`, is free of all others.
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

    /// Whether an existing passage keeps the law in full.
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

    /// Whether the passage is one passage away from where the connector ends; `None` if it ends there too.
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

    /// How far off passages can matter to one of this half width.
    fn reach_of(&self, width: f64, margin: f64) -> f64 {
        width + half_width(self.settings.reach_max_m) + margin
    }
}

/// Least distance between two segments (Ericson, Real-Time Collision Detection, 2005, §5.1.9).
pub(in crate::graph::generator) fn segment_distance(first: [&Point3<f64>; 2], second: [&Point3<f64>; 2]) -> f64 {
    const SHORT: f64 = 1e-12;
    let along: Vector3<f64> = first[1] - first[0];
    let other: Vector3<f64> = second[1] - second[0];
    let between = first[0] - second[0];
    let (a, e) = (along.norm_squared(), other.norm_squared());
    let (b, c, f) = (along.dot(&other), along.dot(&between), other.dot(&between));
    let on_first = |s: f64| {
        if a > SHORT { (s / a).clamp(0.0, 1.0) } else { 0.0 }
    };
    let slant = a * e - b * b;
    let mut s = if slant > SHORT { ((b * f - c * e) / slant).clamp(0.0, 1.0) } else { 0.0 };
    let mut t = if e > SHORT { (b * s + f) / e } else { 0.0 };
    if t < 0.0 {
        (s, t) = (on_first(-c), 0.0);
    } else if t > 1.0 {
        (s, t) = (on_first(b - c), 1.0);
    } else if e <= SHORT {
        s = on_first(-c);
    }
    (between + along * s - other * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(first: [[f64; 3]; 2], second: [[f64; 3]; 2]) -> f64 {
        let [a, b] = first.map(Point3::from);
        let [c, d] = second.map(Point3::from);
        segment_distance([&a, &b], [&c, &d])
    }

    #[test]
    fn distances_of_segments() {
        let x = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        assert_eq!(distance(x, [[1.0, -1.0, 3.0], [1.0, 1.0, 3.0]]), 3.0);
        assert_eq!(distance(x, [[5.0, 4.0, 0.0], [5.0, 9.0, 0.0]]), 5.0);
        assert_eq!(distance(x, [[1.0, 2.0, 0.0], [3.0, 2.0, 0.0]]), 2.0);
        assert_eq!(distance(x, [[1.0, 2.0, 0.0]; 2]), 2.0);
        assert_eq!(distance([[1.0, 2.0, 0.0]; 2], x), 2.0);
        assert_eq!(distance([[0.0; 3]; 2], [[3.0, 4.0, 0.0]; 2]), 5.0);
    }
}
