//! Distances between stations along the cave.

use rustc_hash::{FxBuildHasher, FxHashMap};

use super::Network;

/// Stations within range of one, with their distance along the cave in metres.
pub(super) struct Ways {
    found: Vec<(usize, f64)>,
    places: FxHashMap<usize, usize>,
}

impl Ways {
    fn new(from: usize) -> Self {
        // Enough for most searches.
        const USUAL: usize = 24;
        let mut places = FxHashMap::with_capacity_and_hasher(USUAL, FxBuildHasher);
        places.insert(from, 0);
        Self { found: vec![(from, 0.0)], places }
    }

    /// The distance to a station, infinite beyond the range.
    pub(super) fn to(&self, station: usize) -> f64 {
        self.places.get(&station).map_or(f64::INFINITY, |&place| self.found[place].1)
    }

    /// The distance to the nearer end of a passage.
    pub(super) fn to_passage(&self, [u, v]: [usize; 2]) -> f64 {
        self.to(u).min(self.to(v))
    }

    /// Records a path to a station, found from entry `next`. A shorter path around a loop replaces a longer one as long as
    /// nothing was reached by that.
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
    /// The distances from a station up to `reach_m`, not through the passage to the station `but`.
    pub(super) fn ways(&self, from: usize, but: Option<usize>, reach_m: f64) -> Ways {
        let mut ways = Ways::new(from);
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

    /// Whether a junction is within `reach_m` along the cave.
    pub(crate) fn is_near_junction(&self, from: usize, reach_m: f64) -> bool {
        self.degree(from) > 2 || self.neighbors(from).any(|next| self.leads_to_junction([from, next], reach_m))
    }

    /// Whether a junction is within `reach_m` along the passage from one station via the next.
    fn leads_to_junction(&self, [from, next]: [usize; 2], reach_m: f64) -> bool {
        let length = |a: usize, b: usize| (self.position(b) - self.position(a)).norm();
        let (mut before, mut at) = (from, next);
        let mut walked = length(before, at);
        while walked <= reach_m {
            if self.degree(at) > 2 {
                return true;
            }
            // A ring without junctions leads back to the start.
            let Some(on) = self.neighbors(at).find(|&other| other != before && other != from) else { return false };
            walked += length(at, on);
            (before, at) = (at, on);
        }
        false
    }
}
