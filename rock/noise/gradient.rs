//! Gradient noise (Perlin 2002, with hashed corner gradients in arbitrary directions) and sums of it.

use super::lane::{Ints, Lanes, Real};
use super::vector::{Vec3, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Scales to a standard deviation of 0.31, with nearly all values within ±1.
const GAIN: f32 = 1.6;
/// Frequency ratio of successive octaves, off 2 so that their lattices drift apart.
pub const LACUNARITY: f32 = 2.03;

/// A source of noise with independent layers.
#[derive(Clone, Copy, Debug)]
pub struct Source(u32);

impl Source {
    /// The source with this salt, such as one of [`plume_graph::seed::salt`].
    pub fn new(salt: u32) -> Self {
        Self(salt)
    }

    /// The salt of a layer.
    #[inline(always)]
    pub fn layer(self, layer: u32) -> i32 {
        self.0.wrapping_add(layer.wrapping_mul(0x9e37_79b1)) as i32
    }

    /// Gradient noise of wavelength 1, about ±1, standard deviation 0.31.
    #[inline(always)]
    pub fn noise<S: Simd, T: Real<S>>(self, layer: u32, at: Vec3<T>) -> T {
        let salt = self.layer(layer);
        let simd = at.x.value().token();
        simd.vectorize(
            #[inline(always)]
            || noise(at, salt),
        )
    }

    /// Fractional Brownian motion: octaves of [`Source::noise`], each `gain` as high as the one before.
    #[inline(always)]
    pub fn fbm<S: Simd, T: Real<S>>(self, layer: u32, at: Vec3<T>, octaves: u32, gain: f32) -> T {
        let mut sum = self.noise(layer, at);
        let (mut amplitude, mut at) = (gain, next_octave(at));
        for _ in 1..octaves {
            sum = sum + self.noise(layer, at) * amplitude;
            amplitude *= gain;
            at = next_octave(at);
        }
        sum
    }

    /// Sum of octaves of [`Source::noise`] with these amplitudes; octaves after the last that is not 0 are not evaluated.
    #[inline(always)]
    pub fn octaves<S: Simd, T: Real<S>, const N: usize>(self, layer: u32, at: Vec3<T>, amplitudes: [f32; N]) -> T {
        let mut sum = T::zero(at.x.value().token());
        let mut at = at;
        for amplitude in amplitudes {
            if amplitude == 0.0 {
                break;
            }
            sum = sum + self.noise(layer, at) * amplitude;
            at = next_octave(at);
        }
        sum
    }

    /// Ridged multifractal (Musgrave), about 0 to 1.5, with sharp crests.
    #[inline(always)]
    pub fn ridged<S: Simd, T: Real<S>>(self, layer: u32, at: Vec3<T>, octaves: u32, gain: f32) -> T {
        let crest = inlined!(|at: Vec3<T>| (-self.noise(layer, at).soft_abs(0.04) + 1.0).squared());
        let mut last = crest(at);
        let (mut sum, mut amplitude, mut at) = (last, gain, next_octave(at));
        for _ in 1..octaves {
            last = crest(at) * (last * 1.6).within(0.0, 1.0);
            sum = sum + last * amplitude;
            amplitude *= gain;
            at = next_octave(at);
        }
        sum
    }

    /// The point moved by noise of wavelength `length`: up to about `amplitude` sideways, 0.6 of it up and down.
    #[inline(always)]
    pub fn warp<S: Simd, T: Real<S>>(self, layer: u32, at: Vec3<T>, length: f32, amplitude: f32) -> Vec3<T> {
        let q = at.scaled(1.0 / length);
        let push =
            inlined!(|axis: u32, by: f32| { self.noise(layer.wrapping_add(axis << 16), q).within(-1.0, 1.0) * by });
        vec3(at.x + push(1, amplitude), at.y + push(2, amplitude), at.z + push(3, amplitude * 0.6))
    }
}

#[inline(always)]
fn next_octave<S: Simd, T: Real<S>>(at: Vec3<T>) -> Vec3<T> {
    at.turned().scaled(LACUNARITY).shifted(17.3, -9.1, 4.7)
}

/// Mixes cell indices, each already multiplied by its odd constant, into 30 good bits.
#[inline(always)]
pub(super) fn hash<S: Simd>(x: Ints<S>, y: Ints<S>, z: Ints<S>) -> Ints<S> {
    let h = x ^ y ^ z;
    let h = (h ^ (h >> 15)) * 0x2c1b_3c6d;
    let h = (h ^ (h >> 12)) * 0x297a_2d39;
    h ^ (h >> 15)
}

/// The odd constants of [`hash`].
pub(super) const PRIMES: [i32; 3] = [0x8da6_b343_u32 as i32, 0xd816_3841_u32 as i32, 0xcb1a_b31f_u32 as i32];

/// Ten bits of a hash, starting at bit `shift`, as 0..=1023.
#[inline(always)]
pub(super) fn ten_bits<S: Simd>(hash: Ints<S>, shift: u32) -> Lanes<S> {
    ((hash >> shift) & 1023).to_float()
}

#[inline(always)]
fn noise<S: Simd, T: Real<S>>(at: Vec3<T>, salt: i32) -> T {
    let axis = inlined!(|v: Lanes<S>, prime: i32| {
        let whole = v.floor();
        let index = whole.to_int::<Ints<S>>() * prime;
        (v - whole, [index, index + prime])
    });
    let (x, ix) = axis(at.x.value(), PRIMES[0]);
    let (y, iy) = axis(at.y.value(), PRIMES[1]);
    let (z, iz) = axis(at.z.value(), PRIMES[2]);
    let iz = [iz[0] ^ salt, iz[1] ^ salt];
    let fade = inlined!(|t: Lanes<S>| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
    let slope = inlined!(|t: Lanes<S>| t * t * (t * (t - 2.0) + 1.0) * 30.0);
    let (u, v, w) = (fade(x), fade(y), fade(z));
    let (rx, ry, rz) = ([x, x - 1.0], [y, y - 1.0], [z, z - 1.0]);
    // Value and gradient of a corner's plane, in units of 1 / 511.5.
    let corner = inlined!(|i: usize, j: usize, k: usize| {
        let h = hash::<S>(ix[i], iy[j], iz[k]);
        let bits = inlined!(|shift| ten_bits::<S>(h, shift) - 511.5);
        let g = [bits(0), bits(10), bits(20)];
        [g[0] * rx[i] + g[1] * ry[j] + g[2] * rz[k], g[0], g[1], g[2]]
    });
    let lerp = inlined!(|a: [Lanes<S>; 4], b: [Lanes<S>; 4], t: Lanes<S>| -> [Lanes<S>; 4] {
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t]
    });
    let along_x = inlined!(|j: usize, k: usize| {
        let (a, b) = (corner(0, j, k), corner(1, j, k));
        let mut line = lerp(a, b, u);
        line[1] += (b[0] - a[0]) * slope(x);
        line
    });
    let along_y = inlined!(|k: usize| {
        let (a, b) = (along_x(0, k), along_x(1, k));
        let mut plane = lerp(a, b, v);
        plane[2] += (b[0] - a[0]) * slope(y);
        plane
    });
    let (a, b) = (along_y(0), along_y(1));
    let mut all = lerp(a, b, w);
    all[3] += (b[0] - a[0]) * slope(z);
    let scale = GAIN / 511.5;
    T::chain_3(all[0] * scale, [all[1] * scale, all[2] * scale, all[3] * scale], at)
}
