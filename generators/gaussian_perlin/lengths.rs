//! Branch lengths: log-normal, as in real caves, and stratified so that even a few branches follow the distribution.

use super::tuning::{LENGTH_SIGMA, NODES_PER_BRANCH, SPUR_PART, TRUNK_SPREAD};
use plume_graph::rng::{Rng, probit};

/// A block of planned lengths, refilled when used up. Trunks draw from its long end, spurs from the rest.
pub(super) struct Lengths {
    block: usize,
    mean_m: f64,
    planned: Vec<f64>,
    /// Whether nothing was drawn as a trunk from this block.
    fresh: bool,
}

impl Lengths {
    pub(super) fn new(nodes: u32, mean_m: f64) -> Self {
        let branches = (f64::from(nodes) / NODES_PER_BRANCH).round();
        Self { block: branches.clamp(6.0, 40.0) as usize, mean_m, planned: Vec::new(), fresh: true }
    }

    /// The length of a trunk in metres, and whether it is the main branch of its block.
    pub(super) fn trunk(&mut self, rng: &mut Rng) -> (f64, bool) {
        self.refill(rng);
        let last = self.planned.len() - 1;
        if self.fresh {
            self.fresh = false;
            return (self.planned.remove(last), true);
        }
        let back = rng.normal().abs() * self.planned.len() as f64 * TRUNK_SPREAD;
        (self.planned.remove(last - last.min(back as usize)), false)
    }

    /// The length of a spur in metres.
    pub(super) fn spur(&mut self, rng: &mut Rng) -> f64 {
        self.refill(rng);
        let place = rng.unit() * self.planned.len() as f64 * SPUR_PART;
        self.planned.remove(place as usize)
    }

    fn refill(&mut self, rng: &mut Rng) {
        if !self.planned.is_empty() {
            return;
        }
        let block = self.block as f64;
        self.planned =
            (0..self.block).map(|i| libm::exp(LENGTH_SIGMA * probit((i as f64 + rng.unit()) / block))).collect();
        let scale = self.mean_m * block / self.planned.iter().sum::<f64>();
        self.planned.iter_mut().for_each(|length| *length *= scale);
        self.fresh = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_has_the_requested_mean_and_starts_with_its_longest_trunk() {
        let mut rng = Rng::new(plume_graph::seed::stream(3, "test", 0));
        let mut lengths = Lengths::new(50, 10.0);
        let (longest, main) = lengths.trunk(&mut rng);
        assert!(main);
        let rest: Vec<f64> = (1..14).map(|_| lengths.spur(&mut rng)).collect();
        assert!(rest.iter().all(|&length| length < longest));
        let mean = (longest + rest.iter().sum::<f64>()) / 14.0;
        assert!((mean - 10.0).abs() < 1e-9);
    }
}
