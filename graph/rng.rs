//! Draws from a random stream, defined by integer arithmetic and `libm`, so that a seed gives the same everywhere.
//!
//! ```
//! use plume_graph::rng::Rng;
//! use plume_graph::seed::stream;
//!
//! let mut rng = Rng::new(stream(7, "widths", 0));
//! let width_m = rng.between(2.0, 5.0);
//! assert!((2.0..5.0).contains(&width_m));
//! assert_eq!(width_m, Rng::new(stream(7, "widths", 0)).between(2.0, 5.0));
//! ```

use rand::Rng as _;
use rand_pcg::Pcg64;

/// The random source of one attempt.
pub struct Rng(Pcg64);

impl Rng {
    /// Draws from a [`stream`](crate::seed::stream).
    pub fn new(stream: Pcg64) -> Self {
        Self(stream)
    }

    /// A number strictly between 0 and 1.
    pub fn unit(&mut self) -> f64 {
        ((self.0.next_u64() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// A number between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `end`, which is not 0.
    pub fn below(&mut self, end: u64) -> u64 {
        ((u128::from(self.0.next_u64()) * u128::from(end)) >> 64) as u64
    }

    /// An index into a non-empty list of `len` items.
    pub fn index(&mut self, len: usize) -> usize {
        self.below(len as u64) as usize
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// -1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { -1.0 } else { 1.0 }
    }

    /// A draw from the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        let u = self.unit();
        probit(u)
    }
}

/// The inverse of the standard normal distribution function, for `u` in (0, 1).
///
/// Acklam's rational approximation (2003), relative error under 1.2e-9.
pub fn probit(u: f64) -> f64 {
    const LOW: f64 = 0.02425;
    if u < LOW {
        return tail((-2.0 * libm::log(u)).sqrt());
    }
    if u > 1.0 - LOW {
        return -tail((-2.0 * libm::log(1.0 - u)).sqrt());
    }
    let q = u - 0.5;
    q * polynomial(
        &[
            -39.696_830_286_653_76,
            220.946_098_424_520_5,
            -275.928_510_446_968_7,
            138.357_751_867_269,
            -30.664_798_066_147_16,
            2.506_628_277_459_239,
        ],
        q * q,
    ) / polynomial(
        &[
            -54.476_098_798_224_06,
            161.585_836_858_040_9,
            -155.698_979_859_886_6,
            66.801_311_887_719_72,
            -13.280_681_552_885_72,
            1.0,
        ],
        q * q,
    )
}

fn tail(q: f64) -> f64 {
    polynomial(
        &[
            -0.007_784_894_002_430_293,
            -0.322_396_458_041_136_5,
            -2.400_758_277_161_838,
            -2.549_732_539_343_734,
            4.374_664_141_464_968,
            2.938_163_982_698_783,
        ],
        q,
    ) / polynomial(
        &[0.007_784_695_709_041_462, 0.322_467_129_070_039_8, 2.445_134_137_142_996, 3.754_408_661_907_416, 1.0],
        q,
    )
}

fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probit_inverts_the_normal_distribution() {
        for u in [1e-9, 0.001, 0.024, 0.3, 0.5, 0.77, 0.98, 0.999_999] {
            let back = 0.5 * libm::erfc(-probit(u) / std::f64::consts::SQRT_2);
            assert!((back / u - 1.0).abs() < 1e-7, "{u}: {back}");
        }
    }

    #[test]
    fn draws_stay_in_their_range() {
        let mut rng = Rng::new(crate::seed::stream(1, "test", 0));
        for _ in 0..1000 {
            let u = rng.unit();
            assert!(u > 0.0 && u < 1.0);
            assert!(rng.below(7) < 7);
            assert!((2.0..3.0).contains(&rng.between(2.0, 3.0)));
        }
    }
}
