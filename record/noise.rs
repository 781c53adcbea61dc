//! Noise that costs little: sums of uniform numbers.

use plume_graph::rng::Rng;

/// Draws of one stream.
pub struct Noise(Rng);

/// Uniform numbers in a draw of the standard normal distribution.
const TERMS: u32 = 12;
const BITS: u32 = 16;

impl Noise {
    /// Draws from a stream.
    pub fn new(rng: Rng) -> Self {
        Self(rng)
    }

    /// About a draw from the standard normal distribution: the sum of twelve uniform numbers, which is never beyond six. For
    /// the millions of pixels of an image; sensors with few numbers draw exact ones.
    pub fn normal(&mut self) -> f32 {
        let lanes = u64::from(u64::BITS / BITS);
        let sum: u64 = (0..u64::from(TERMS) / lanes)
            .map(|_| {
                let word = self.0.below(u64::MAX);
                (0..lanes).map(|lane| word >> (lane * u64::from(BITS)) & 0xffff).sum::<u64>()
            })
            .sum();
        sum as f32 / 65535.0 - 0.5 * TERMS as f32
    }
}

#[cfg(test)]
mod tests {
    use plume_graph::seed::stream;

    use super::*;

    #[test]
    fn it_has_the_moments_of_the_normal_distribution() {
        let mut noise = Noise::new(Rng::new(stream(1, "test", 0)));
        let draws: Vec<f64> = (0..200_000).map(|_| f64::from(noise.normal())).collect();
        let moment = |power: i32| {
            draws.iter().map(|x| (0..power).fold(1.0, |product, _| product * x)).sum::<f64>() / draws.len() as f64
        };
        assert!(moment(1).abs() < 0.01 && (moment(2) - 1.0).abs() < 0.01, "{} {}", moment(1), moment(2));
        assert!(moment(3).abs() < 0.03 && (moment(4) - 2.9).abs() < 0.06, "{} {}", moment(3), moment(4));
    }
}
