//! Distances between stations in numbers of passages.

use super::cave::GrowingStation;
use super::tuning::HOPS_COUNTED;

/// Distances along the cave from one station, recomputed without clearing memory.
#[derive(Default)]
pub(super) struct Hops {
    round: u32,
    /// Round in which a station was reached, and in how many hops.
    reached: Vec<(u32, u32)>,
    queue: Vec<usize>,
}

impl Hops {
    /// Counts outwards from a station.
    pub(super) fn count(&mut self, from: usize, stations: &[GrowingStation]) {
        self.round += 1;
        self.reached.resize(stations.len().max(self.reached.len()), (0, 0));
        self.reached[from] = (self.round, 0);
        self.queue.clear();
        self.queue.push(from);
        let mut next = 0;
        while let Some(&station) = self.queue.get(next) {
            next += 1;
            let hops = self.reached[station].1 + 1;
            if hops >= HOPS_COUNTED {
                return;
            }
            for &other in &stations[station].neighbors {
                if self.reached[other].0 != self.round {
                    self.reached[other] = (self.round, hops);
                    self.queue.push(other);
                }
            }
        }
    }

    /// Hops to a station, at most the counted maximum.
    pub(super) fn to(&self, station: usize) -> u32 {
        match self.reached.get(station) {
            Some(&(round, hops)) if round == self.round => hops,
            _ => HOPS_COUNTED,
        }
    }
}
