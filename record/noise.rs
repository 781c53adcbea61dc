//! Noise that costs little: a number of tosses of a coin.

use plume_graph::rng::Rng;

/// Draws of one stream.
pub struct Noise(Rng);

/// Tosses in a draw of the standard normal distribution.
const TOSSES: u32 = 48;
/// The other bits of a word: a uniform number, which fills the gap between two numbers of heads.
const BITS: u32 = u64::BITS - TOSSES;
/// Deviation of both together, of which a toss has a variance of 1/4, and the uniform number 1/12: √(48 / 4 + 1 / 12).
const DEVIATION: f32 = 3.476_109;

impl Noise {
    /// Draws from a stream.
    pub fn new(rng: Rng) -> Self {
        Self(rng)
    }

    /// About a draw from the standard normal distribution, which is never beyond eight. For the millions of pixels of an image; sensors
    /// with few numbers draw exact ones.
    pub fn normal(&mut self) -> f32 {
        let word = self.0.below(u64::MAX);
        let heads = (word >> BITS).count_ones() as f32;
        let between = (word as u32 & ((1 << BITS) - 1)) as f32 / (1 << BITS) as f32;
        (heads + between - 0.5 * (TOSSES + 1) as f32) * (1.0 / DEVIATION)
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
        assert!(moment(3).abs() < 0.03 && (moment(4) - 2.96).abs() < 0.06, "{} {}", moment(3), moment(4));
    }
}
