//! How much of a picture is in each octave of wavelengths.

/// A square picture of one quantity.
pub struct Image {
    pub side: usize,
    pub values: Vec<f64>,
}

/// Octave of wavelengths: from this one to twice it, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Band(pub f64);

impl Band {
    /// Standard deviation of a Gaussian relative to the wavelength that it just lets through.
    const WIDTH: f64 = 0.35 / 1.6;

    /// The octave of a picture with `per_m` samples a metre, without a rim of [`Band::margin`] samples.
    pub fn of(self, image: &Image, per_m: f64, margin: usize) -> Vec<f64> {
        let [fine, coarse] =
            [self.0, 2.0 * self.0].map(|length_m| image.blurred(Self::WIDTH * length_m * per_m, margin));
        fine.into_iter().zip(coarse).map(|(fine, coarse)| fine - coarse).collect()
    }

    /// Reach of the octave in metres.
    pub fn reach_m(self) -> f64 {
        3.0 * Self::WIDTH * 2.0 * self.0
    }
}

impl Image {
    /// Convolved with a Gaussian of this standard deviation in samples; without the rim.
    fn blurred(&self, deviation: f64, margin: usize) -> Vec<f64> {
        let kernel = kernel(deviation, margin);
        let inner = margin..self.side - margin;
        let weighed =
            |sample: &dyn Fn(usize) -> f64| kernel.iter().enumerate().map(|(k, weight)| weight * sample(k)).sum();
        let across: Vec<f64> = (0..self.side)
            .flat_map(|y| inner.clone().map(move |x| (x, y)))
            .map(|(x, y)| weighed(&|k| self.values[y * self.side + x + k - margin]))
            .collect();
        let width = inner.len();
        inner
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| weighed(&|k| across[(y + k - margin) * width + x]))
            .collect()
    }
}

/// A kernel of `2 * reach + 1` samples whose response at every wavelength that samples can hold is that of a Gaussian, even
/// if it is narrower than a sample.
fn kernel(deviation: f64, reach: usize) -> Vec<f64> {
    const STEPS: usize = 256;
    let weight = |n: f64| -> f64 {
        let angles = (0..STEPS).map(|step| (step as f64 + 0.5) * std::f64::consts::PI / STEPS as f64);
        angles.map(|angle| libm::exp(-0.5 * (deviation * angle) * (deviation * angle)) * libm::cos(n * angle)).sum()
    };
    let weights: Vec<f64> = (0..=2 * reach).map(|k| weight(k as f64 - reach as f64)).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// Root of the mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}
