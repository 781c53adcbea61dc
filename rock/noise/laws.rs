//! Laws for every primitive: exact gradients, and the same bits for every vector width.

use super::*;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd};

const SALT: i32 = 0x5eed;

/// A primitive as a formula over lanes.
trait Primitive {
    const NAME: &'static str;
    /// Share of points that may be on a crease, where the gradient jumps.
    const CREASED: f64;
    fn at<S: Simd, T: Real<S>>(at: Vec3<T>) -> T;
}

macro_rules! primitive {
    ($name:ident, $creased:expr, |$at:ident| $formula:expr) => {
        struct $name;
        impl Primitive for $name {
            const NAME: &'static str = stringify!($name);
            const CREASED: f64 = $creased;
            #[inline(always)]
            fn at<S: Simd, T: Real<S>>($at: Vec3<T>) -> T {
                $formula
            }
        }
    };
}

primitive!(Noise, 0.0, |at| Source::new(1).noise(2, at));
primitive!(Fbm, 0.0, |at| Source::new(1).fbm(2, at, 4, 0.5));
primitive!(Ridged, 0.02, |at| Source::new(1).ridged(2, at.scaled(0.5), 2, 0.5));
primitive!(Facets, 0.01, |at| facets(at, 1.1, SALT));
primitive!(Hollows, 0.03, |at| {
    let drift = Lanes::<S>::splat(at.x.value().token(), 0.5);
    hollows(at, [drift, drift * 0.4, -drift * 0.4], SALT)
});
primitive!(Distance3, 0.02, |at| cells_3d(at, SALT).distance);
primitive!(Edge3, 0.04, |at| cells_3d(at, SALT).edge);
primitive!(Edge2, 0.04, |at| cells_2d(at, SALT).edge);
primitive!(Warped, 0.02, |at| {
    let at = Source::new(3).warp(4, at, 2.0, 0.3);
    soft_min(at.x.step(-4.0, 4.0), (at.y * 0.2).bump(), 0.3) / (at.z.squared() + 1.0).sqrt()
});

/// The value and gradient of a primitive at a point, on this level.
fn jet<P: Primitive, S: Simd>(simd: S, at: [f32; 3]) -> [f32; 4] {
    let lanes = |v: f32| Lanes::<S>::splat(simd, v);
    let axis = |i: usize| Jet::<S> {
        value: lanes(at[i]),
        gradient: std::array::from_fn(|j| lanes(if i == j { 1.0 } else { 0.0 })),
    };
    let jet = P::at(vec3(axis(0), axis(1), axis(2)));
    let [x, y, z] = jet.gradient;
    [jet.value[0], x[0], y[0], z[0]]
}

fn value<P: Primitive, S: Simd>(simd: S, at: [f32; 3]) -> f32 {
    let axis = |i: usize| Value::<S>(Lanes::<S>::splat(simd, at[i]));
    P::at(vec3(axis(0), axis(1), axis(2))).0[0]
}

/// Points scattered over 16 m.
fn points(count: u32) -> impl Iterator<Item = [f32; 3]> {
    let coordinate = |i: u32, axis: u32| {
        let h = (i * 3 + axis).wrapping_mul(0x9e37_79b1) ^ 0x51ed_270b;
        (h.wrapping_mul(0x85eb_ca6b) >> 8) as f32 / 16_777_216.0 * 16.0 - 8.0
    };
    (0..count).map(move |i| [coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)])
}

fn gradient_is_exact<P: Primitive>() {
    const STEP: f32 = 2e-3;
    let wrong = points(400).filter(|&at| {
        dispatched!(simd => {
            let [_, exact @ ..] = jet::<P, _>(simd, at);
            let difference = |axis: usize| {
                let moved = |by: f32| {
                    let mut at = at;
                    at[axis] += by;
                    value::<P, _>(simd, at)
                };
                (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
            };
            let error = |axis: usize| (exact[axis] - difference(axis)).abs();
            let size: f32 = exact.iter().map(|c| c * c).sum::<f32>().sqrt();
            (0..3).any(|axis| error(axis) > 0.03 * size.max(0.3))
        })
    });
    let share = wrong.count() as f64 / 400.0;
    assert!(share <= P::CREASED, "{}: {share} of gradients are wrong", P::NAME);
}

#[cfg(target_arch = "x86_64")]
fn bits_are_the_same_on_every_width<P: Primitive>() {
    let level = Level::new();
    let sse2 = level.as_sse2().expect("part of every x86-64");
    for at in points(100) {
        let narrow = jet::<P, _>(sse2, at).map(f32::to_bits);
        if let Some(avx2) = level.as_avx2() {
            assert_eq!(narrow, jet::<P, _>(avx2, at).map(f32::to_bits), "{} AVX2 {at:?}", P::NAME);
        }
        if let Some(avx512) = level.as_avx512() {
            let wide = jet::<P, _>(avx512, at).map(f32::to_bits);
            assert_eq!(narrow, wide, "{} AVX-512 {at:?}", P::NAME);
        }
        assert_eq!(narrow[0], value::<P, _>(sse2, at).to_bits(), "{} value {at:?}", P::NAME);
    }
}

macro_rules! for_every_primitive {
    ($law:ident) => {
        $law::<Noise>();
        $law::<Fbm>();
        $law::<Ridged>();
        $law::<Facets>();
        $law::<Hollows>();
        $law::<Distance3>();
        $law::<Edge3>();
        $law::<Edge2>();
        $law::<Warped>();
    };
}

#[test]
fn gradients_are_exact() {
    for_every_primitive!(gradient_is_exact);
}

#[cfg(target_arch = "x86_64")]
#[test]
fn widths_agree_bit_for_bit() {
    for_every_primitive!(bits_are_the_same_on_every_width);
}

#[test]
fn noise_is_centred_and_bounded() {
    let values: Vec<f32> = points(4000).map(|at| dispatched!(simd => value::<Noise, _>(simd, at))).collect();
    let mean = values.iter().sum::<f32>() / 4000.0;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>() / 4000.0;
    assert!(mean.abs() < 0.02, "mean {mean}");
    assert!((0.25..0.37).contains(&variance.sqrt()), "standard deviation {}", variance.sqrt());
    assert!(values.iter().all(|v| v.abs() < 1.4));
}

#[test]
fn a_step_is_flat_outside() {
    fn stepped<S: Simd>(simd: S, at: f32, from: f32, to: f32) -> f32 {
        Value::<S>(Lanes::<S>::splat(simd, at)).step(from, to).0[0]
    }
    assert_eq!(dispatched!(simd => stepped(simd, -0.1, 0.0, 0.2)), 0.0);
    assert_eq!(dispatched!(simd => stepped(simd, 0.3, 0.0, 0.2)), 1.0);
    assert_eq!(dispatched!(simd => stepped(simd, 0.3, 0.2, 0.0)), 0.0);
}

/// Correlation of noise with itself, for points a step along X apart: independent of which gradients there are, so that two
/// right implementations agree.
fn correlation(noise: impl Fn([f32; 3]) -> f64, step: f32) -> f64 {
    let pairs: Vec<[f64; 2]> = points(40_000).map(|[x, y, z]| [noise([x, y, z]), noise([x + step, y, z])]).collect();
    let sum = |of: fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>();
    sum(|[a, b]| a * b) / (sum(|[a, _]| a * a) * sum(|[_, b]| b * b)).sqrt()
}

#[test]
fn noise_varies_over_space_as_that_of_the_crate_noise() {
    let other = noise::Perlin::new(1);
    for step in [0.1, 0.25, 0.5, 0.75, 1.0, 1.5] {
        let ours = correlation(|at| dispatched!(simd => f64::from(value::<Noise, _>(simd, at))), step);
        let theirs = correlation(|at| noise::NoiseFn::get(&other, at.map(f64::from)), step);
        assert!((ours - theirs).abs() < 0.03, "{step}: {ours} instead of {theirs}");
    }
}

#[test]
fn no_hollow_is_below_its_feature_point() {
    assert!(points(4000).all(|at| dispatched!(simd => value::<Hollows, _>(simd, at)) >= 0.0));
}
