//! From luminance to the values of a sensor: exposure, noise, and sRGB.
//!
//! A pixel collects electrons in proportion to luminance, with the noise of their number and of reading them (the model of EMVA
//! 1288, without dark current and fixed patterns). Where the longest exposure does not fill it, gain does, and raises the noise;
//! where the highest gain does not, images are dark. Left out: the mosaic of colour filters, motion blur, vignetting, bloom.

use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use rayon::prelude::*;

use crate::noise::Noise;
use crate::rig::Lighting;

/// The mean of the values of an automatically exposed image. Tuned by eye.
const MEAN_VALUE: f32 = 0.3;
/// The time in which the exposure gets all but 1/e of the way to the right one, in seconds. Tuned: cameras take a few frames at 30 Hz.
const SETTLING_S: f64 = 0.1;
/// Every how many pixels are measured, along either axis.
const METERED: usize = 8;
/// Above this share of white, the sensor's response bends instead of ending.
const KNEE: f32 = 0.7;
/// Entries of the table of values.
const TABLE: usize = 4096;

/// The exposure of a camera, which follows its images.
pub struct Exposure {
    lighting: Lighting,
    white_cd_m2: Option<f64>,
    /// How much of the way to the right exposure is taken with each image.
    share: f64,
    values: Vec<u8>,
}

impl Exposure {
    /// Before the first of so many images a second.
    pub fn new(lighting: &Lighting, rate_hz: f64) -> Self {
        let fixed = (lighting.white_cd_m2 > 0.0).then_some(lighting.white_cd_m2);
        let values = (0..=TABLE).map(|n| (255.0 * srgb(n as f64 / TABLE as f64) + 0.5) as u8).collect();
        let share = 1.0 - libm::exp(-1.0 / (rate_hz * SETTLING_S));
        Self { lighting: lighting.clone(), white_cd_m2: fixed, share, values }
    }

    /// Adapts to an image of luminances.
    pub fn meter(&mut self, image: &[[f32; 3]], width: usize) {
        if self.lighting.white_cd_m2 > 0.0 {
            return;
        }
        let rows = image.chunks(width).step_by(METERED);
        let sample: Vec<[f32; 3]> = rows.flat_map(|row| row.iter().step_by(METERED).copied()).collect();
        let (mut low, mut high) = (-40.0, 40.0);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            let is_brighter = self.mean_value(&sample, libm::exp2(middle)) > MEAN_VALUE;
            [low, high] = if is_brighter { [middle, high] } else { [low, middle] };
        }
        let wanted = (0.5 * (low + high)).max(libm::log2(self.lighting.least_white_cd_m2()));
        let before = self.white_cd_m2.map_or(wanted, libm::log2);
        self.white_cd_m2 = Some(libm::exp2(before + self.share * (wanted - before)));
    }

    fn mean_value(&self, sample: &[[f32; 3]], white_cd_m2: f64) -> f32 {
        let scale = 1.0 / white_cd_m2 as f32;
        let sum: u64 = sample.iter().flatten().map(|light| u64::from(self.value(light * scale))).sum();
        sum as f32 / (255.0 * 3.0 * sample.len().max(1) as f32)
    }

    /// The value of a share of white.
    fn value(&self, share: f32) -> u8 {
        let bent =
            if share > KNEE { KNEE + (1.0 - KNEE) * (1.0 - libm::expf((KNEE - share) / (1.0 - KNEE))) } else { share };
        self.values[(bent.clamp(0.0, 1.0) * TABLE as f32 + 0.5) as usize]
    }

    /// The image that the sensor makes; its noise is that of stream `name`, image `number`.
    pub fn develop(&self, image: &[[f32; 3]], width: usize, seed: u64, name: &str, number: u64) -> Vec<[u8; 3]> {
        let white = self.white_cd_m2.unwrap_or(1.0);
        let Lighting { electrons_per_cd_m2, full_well, read_noise, .. } = self.lighting;
        let electrons_per_cd_m2 = electrons_per_cd_m2.min(full_well / white) as f32;
        let read2 = (read_noise * read_noise) as f32;
        let scale = 1.0 / (electrons_per_cd_m2 * white as f32);
        let rows = image.len() / width;
        let mut values = vec![[0; 3]; image.len()];
        values.par_chunks_mut(width).zip(image.par_chunks(width)).enumerate().for_each(|(row, (values, lights))| {
            let mut noise = Noise::new(Rng::new(stream(seed, name, number * rows as u64 + row as u64)));
            for (value, light) in values.as_flattened_mut().iter_mut().zip(lights.as_flattened()) {
                let electrons = light * electrons_per_cd_m2;
                let measured = electrons + noise.normal() * (electrons + read2).sqrt();
                *value = self.value(measured * scale);
            }
        });
        values
    }
}

/// The encoding of IEC 61966-2-1.
fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(light: f32) -> Vec<[f32; 3]> {
        vec![[light; 3]; 64 * 64]
    }

    fn mean_and_deviation(image: &[[u8; 3]]) -> (f64, f64) {
        let values: Vec<f64> = image.iter().flatten().map(|value| f64::from(*value)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / values.len() as f64;
        (mean, square.sqrt())
    }

    #[test]
    fn exposure_follows_the_light() {
        let mut exposure = Exposure::new(
            &Lighting { read_noise: 0.0, full_well: 1e6, electrons_per_cd_m2: 1e9, ..Lighting::default() },
            10.0,
        );
        for light in [5.0, 0.01] {
            (0..40).for_each(|_| exposure.meter(&grey(light), 64));
            let (mean, _) = mean_and_deviation(&exposure.develop(&grey(light), 64, 1, "test", 0));
            assert!((mean - 255.0 * f64::from(MEAN_VALUE)).abs() < 2.0, "{light}: {mean}");
        }
    }

    #[test]
    fn a_fixed_exposure_stays() {
        let mut exposure = Exposure::new(&Lighting { white_cd_m2: 2.0, ..Lighting::default() }, 10.0);
        exposure.meter(&grey(0.01), 64);
        let (mean, _) = mean_and_deviation(&exposure.develop(&grey(0.8), 64, 1, "test", 0));
        assert!((mean - 255.0 * srgb(0.4)).abs() < 1.0, "{mean}");
    }

    /// As much of the way in as much time, whatever the rate.
    #[test]
    fn exposure_settles_in_time() {
        let [slow, fast] = [10.0, 40.0].map(|rate_hz| {
            let mut exposure = Exposure::new(&Lighting::default(), rate_hz);
            exposure.meter(&grey(0.1), 64);
            (0..rate_hz as usize / 10).for_each(|_| exposure.meter(&grey(10.0), 64));
            exposure.white_cd_m2.unwrap()
        });
        assert!((slow / fast - 1.0).abs() < 1e-3, "{slow} {fast}");
    }

    #[test]
    fn what_the_highest_gain_does_not_brighten_stays_dark() {
        let faint = Lighting { electrons_per_cd_m2: 100.0, read_noise: 0.0, ..Lighting::default() };
        let mean = |lighting: &Lighting| {
            let mut exposure = Exposure::new(lighting, 10.0);
            (0..20).for_each(|_| exposure.meter(&grey(0.1), 64));
            mean_and_deviation(&exposure.develop(&grey(0.1), 64, 1, "test", 0)).0
        };
        let [bound, free] =
            [faint.clone(), Lighting { max_gain: 1e6, ..faint.clone() }].map(|lighting| mean(&lighting));
        let right = 255.0 * srgb(0.1 / faint.least_white_cd_m2());
        assert!((bound - right).abs() < 3.0 && free > 2.0 * bound, "{bound} {free} {right}");
    }

    #[test]
    fn darkness_is_noisy() {
        let dark = Lighting { electrons_per_cd_m2: 100.0, ..Lighting::default() };
        let [few, many] = [dark.clone(), Lighting { electrons_per_cd_m2: 1e6, ..dark }].map(|lighting| {
            let mut exposure = Exposure::new(&lighting, 10.0);
            exposure.meter(&grey(0.5), 64);
            mean_and_deviation(&exposure.develop(&grey(0.5), 64, 1, "test", 0)).1
        });
        assert!(few > 3.0 * many, "{few} {many}");
    }
}
