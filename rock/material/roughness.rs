//! Noise at many points, for what is no rock.

use super::site::{BLOCK, by_axis};
use crate::noise::{Lanes, Source, Value, Vec3, dispatched};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Noise of this wavelength at points, about ±1.
pub fn roughness(source: Source, points: &[[f32; 3]], wavelength_m: f32) -> Vec<f32> {
    let mut out = vec![0.0; points.len()];
    for (points, out) in points.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
        let columns = by_axis(points);
        let mut block = [0.0; BLOCK];
        dispatched!(simd => block_roughness(simd, source, &columns, wavelength_m, &mut block));
        out.copy_from_slice(&block[..out.len()]);
    }
    out
}

#[inline(always)]
fn block_roughness<S: Simd>(
    simd: S,
    source: Source,
    at: &[[f32; BLOCK]; 3],
    wavelength_m: f32,
    out: &mut [f32; BLOCK],
) {
    for lane in (0..BLOCK).step_by(Lanes::<S>::LEN) {
        let lanes = lane..lane + Lanes::<S>::LEN;
        let [x, y, z] = at.each_ref().map(
            #[inline(always)]
            |column| Value::<S>(Lanes::<S>::from_slice(simd, &column[lanes.clone()])),
        );
        let noise = source.fbm(90, Vec3 { x, y, z }.scaled(1.0 / wavelength_m), 2, 0.5);
        noise.0.store_slice(&mut out[lanes]);
    }
}
