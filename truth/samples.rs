//! Points spread evenly over triangles.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::vector::{cross, dot, minus};

/// A point on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Number of the triangle.
    pub triangle: usize,
    /// Where it is, in metres.
    pub at_m: [f32; 3],
}

/// Points on triangles, so many per square metre: corners in metres, three indices a triangle, and what the random places follow
/// from.
///
/// Every run of triangles gets as many as its area is due, within one.
pub fn samples<'a>(
    corners: &'a [[f32; 3]],
    indices: &'a [u32],
    per_m2: f64,
    seed: [u8; 32],
) -> impl Iterator<Item = Sample> + 'a {
    let mut random = Pcg64::from_seed(seed);
    let mut due = unit(&mut random);
    indices.as_chunks::<3>().0.iter().enumerate().flat_map(move |(triangle, of)| {
        let [a, b, c] = of.map(|corner| corners[corner as usize].map(f64::from));
        let [to_b, to_c] = [minus(b, a), minus(c, a)];
        let across = cross(to_b, to_c);
        due += 0.5 * dot(across, across).sqrt() * per_m2;
        let count = due.floor();
        due -= count;
        let sample = |_| {
            let [mut u, mut v] = [unit(&mut random), unit(&mut random)];
            if u + v > 1.0 {
                [u, v] = [1.0 - u, 1.0 - v];
            }
            let at_m = [0, 1, 2].map(|axis| (a[axis] + u * to_b[axis] + v * to_c[axis]) as f32);
            Sample { triangle, at_m }
        };
        (0..count as usize).map(sample).collect::<Vec<_>>()
    })
}

/// Between 0 and 1.
fn unit(random: &mut Pcg64) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
