//! How far stations are from one another along the cave.

use rustc_hash::FxHashMap;

use super::Network;

/// Stations within reach of one, with their distance along the cave in metres.
pub(super) struct Ways {
    found: Vec<(usize, f64)>,
    places: FxHashMap<usize, usize>,
}

impl Ways {
    /// The distance to a station, infinite beyond the reach.
    pub(super) fn to(&self, station: usize) -> f64 {
        self.places.get(&station).map_or(f64::INFINITY, |&place| self.found[place].1)
    }

    /// The distance to the nearer end of a passage.
    pub(super) fn to_passage(&self, [u, v]: [usize; 2]) -> f64 {
        self.to(u).min(self.to(v))
    }

    pub(super) fn stations(&self) -> impl Iterator<Item = usize> {
        self.found.iter().map(|(station, _)| *station)
    }

    /// Notes a way to a station that was walked from here at place `next`. A shorter way round a loop counts as long as
    /// nothing was reached by the longer one.
    fn note(&mut self, station: usize, distance: f64, next: usize) {
        let place = *self.places.entry(station).or_insert(self.found.len());
        if place == self.found.len() {
            self.found.push((station, distance));
        } else if place >= next && distance < self.found[place].1 {
            self.found[place].1 = distance;
        }
    }
}

impl Network {
    /// The ways from a station as far as `reach_m`, not through the passage to the station `but`.
    pub(super) fn ways(&self, from: usize, but: Option<usize>, reach_m: f64) -> Ways {
        let mut ways = Ways { found: vec![(from, 0.0)], places: FxHashMap::from_iter([(from, 0)]) };
        let mut next = 0;
        while let Some(&(station, walked)) = ways.found.get(next) {
            next += 1;
            let at = self.position(station);
            for other in self.neighbors(station).filter(|&other| station != from || Some(other) != but) {
                let distance = walked + (self.position(other) - at).norm();
                if distance <= reach_m {
                    ways.note(other, distance, next);
                }
            }
        }
        ways
    }

    /// Whether a junction lies within `reach_m` along the cave.
    pub(in crate::graph::generator) fn is_near_junction(&self, from: usize, reach_m: f64) -> bool {
        self.ways(from, None, reach_m).stations().any(|station| self.degree(station) > 2)
    }
}
