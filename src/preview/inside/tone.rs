//! Tone mapping: from light to pixels.

/// Target mean of a picture, linear. Tuned: a cave is dark.
const MIDDLE: f32 = 0.085;
/// Keeps the logarithm of darkness finite.
const DARKEST: f32 = 1e-4;

/// The exposure that brings the geometric mean of a picture to a middle grey, like an eye adapted to the dark.
pub fn exposure(light: &[[f32; 3]]) -> f32 {
    let logs = light.iter().map(|&rgb| f64::from(libm::logf(luminance(rgb).max(DARKEST))));
    let mean = logs.sum::<f64>() / light.len().max(1) as f64;
    MIDDLE / libm::expf(mean as f32)
}

/// A pixel of 8-bit sRGB. Highlights are compressed filmically (Narkowicz' fit of the ACES curve, 2016).
pub fn pixel(light: [f32; 3], exposure: f32) -> [u8; 3] {
    light.map(|channel| {
        let x = channel * exposure;
        let film = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
        (srgb(film.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8
    })
}

fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
