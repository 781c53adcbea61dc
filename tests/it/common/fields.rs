//! Simple fields with a known shape.

use plume::field::{Aabb, Analytic, Field, Region};

/// A ball of air.
pub fn sphere(centre: [f32; 3], radius_m: f32) -> impl Field {
    Analytic::new(1.0, move |p| distance(p, centre) - radius_m)
}

/// A round passage between two points.
#[derive(Clone, Copy)]
pub struct Capsule {
    pub ends: [[f32; 3]; 2],
    pub radius_m: f32,
}

/// Depth of the blend between passages, in metres.
const BLEND_M: f32 = 1.0;
/// Wavelength of the roughness in metres.
const WAVE_M: f32 = 2.5;

/// Passages blended into each other, rough by up to `rough_m`, which must be less than the blend is deep: further out
/// there is rock.
pub fn passages(capsules: Vec<Capsule>, rough_m: f32, seed: u32) -> impl Field {
    assert!(rough_m < BLEND_M);
    let value = move |p: [f32; 3]| {
        let sum: f32 = capsules
            .iter()
            .map(|capsule| (BLEND_M - capsule_distance(capsule, p)).max(0.0))
            .map(|w| (w * w) * (w * w))
            .sum();
        let smooth = BLEND_M - sum.sqrt().sqrt();
        // Roughness is only evaluated near the wall.
        let rough = (rough_m > 0.0 && smooth.abs() <= rough_m).then(|| value_noise(p.map(|c| c / WAVE_M), seed));
        smooth + rough.unwrap_or(0.0) * rough_m
    };
    Analytic::new(4.0 + 3.0 * rough_m, value)
}

/// Two rails along x and `rungs` across, 8 m apart: `rungs - 1` loops. With its bounds.
pub fn ladder(rungs: usize, rough_m: f32, seed: u32) -> (impl Field, Aabb<f32>) {
    let length = 8.0 * (rungs - 1) as f32;
    let passage = |a, b| Capsule { ends: [a, b], radius_m: 1.5 };
    let mut capsules = vec![passage([0.0, 0.0, 0.0], [length, 0.0, 0.0]), passage([0.0, 9.0, 1.0], [length, 9.0, 1.0])];
    for rung in 0..rungs {
        let x = 8.0 * rung as f32;
        capsules.push(passage([x, 0.0, 0.0], [x, 9.0, 1.0]));
    }
    let bounds = Aabb { min: [-4.0; 3], max: [length + 4.0, 13.0, 5.0] };
    (passages(capsules, rough_m, seed), bounds)
}

/// Balls of air by radius and centre, far apart. With their bounds.
pub fn bubbles(balls: &[(f32, [f32; 3])]) -> (impl Field + use<>, Aabb<f32>) {
    let end = |axis: usize, side: f32| {
        let ends = balls.iter().map(|(radius, centre)| side * centre[axis] + radius);
        side * ends.fold(f32::MIN, f32::max)
    };
    let min = std::array::from_fn(|axis| end(axis, -1.0));
    let bounds = Aabb { min, max: std::array::from_fn(|axis| end(axis, 1.0)) };
    let balls = balls.to_vec();
    let value = move |p: [f32; 3]| {
        let depths = balls.iter().map(|&(radius, centre)| distance(p, centre) - radius);
        depths.fold(f32::MAX, f32::min)
    };
    (Analytic::new(1.0, value), bounds)
}

/// A room with flat walls, whose corners are `-half_m` and `half_m`.
pub fn room(half_m: [f32; 3]) -> impl Field {
    let value = move |p: [f32; 3]| {
        let depths = (0..3).map(|i| p[i].abs() - half_m[i]);
        depths.fold(f32::MIN, f32::max)
    };
    Analytic::new(1.0, value)
}

/// A field whose normals point the wrong way.
pub struct WrongNormals<F>(pub F);

impl<F: Field> Field for WrongNormals<F> {
    fn region(&self, bounds: Aabb<f32>) -> Region {
        self.0.region(bounds)
    }

    fn distances(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [f32]) {
        self.0.distances(bounds, points, out);
    }

    fn normals(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [[f32; 3]]) {
        self.0.normals(bounds, points, out);
        for normal in out {
            *normal = normal.map(|c| -c);
        }
    }
}

/// White noise at lattice points inside a box, rock around it: as ragged as a field on a lattice can be.
pub fn white_noise(voxel_m: f32, cells: i32, seed: u32) -> (impl Field, Aabb<f32>) {
    let value = move |p: [f32; 3]| {
        let index = p.map(|c| (c / voxel_m).round() as i32);
        let inside = index.iter().all(|&i| (0..cells).contains(&i));
        if inside { hash(index, seed) * 2.0 - 1.0 + 1e-6 } else { 1.0 }
    };
    let bounds = Aabb { min: [0.0; 3], max: [cells as f32 * voxel_m; 3] };
    (Analytic::new(f32::INFINITY, value), bounds)
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f32>().sqrt()
}

fn capsule_distance(capsule: &Capsule, p: [f32; 3]) -> f32 {
    let [a, b] = capsule.ends;
    let (mut along, mut length) = (0.0, 0.0);
    for i in 0..3 {
        along += (p[i] - a[i]) * (b[i] - a[i]);
        length += (b[i] - a[i]) * (b[i] - a[i]);
    }
    let t = (along / length).clamp(0.0, 1.0);
    distance(p, std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)) - capsule.radius_m
}

/// Between -1 and 1, with smooth slopes.
fn value_noise(p: [f32; 3], seed: u32) -> f32 {
    let cell = p.map(|c| c.floor() as i32);
    let t: [f32; 3] = std::array::from_fn(|i| p[i] - cell[i] as f32);
    let t = t.map(|t| t * t * (3.0 - 2.0 * t));
    (0..8)
        .map(|corner: i32| {
            let at: [i32; 3] = std::array::from_fn(|i| corner >> i & 1);
            let weight: f32 = (0..3).map(|i| if at[i] == 1 { t[i] } else { 1.0 - t[i] }).product();
            weight * (hash(std::array::from_fn(|i| cell[i] + at[i]), seed) * 2.0 - 1.0)
        })
        .sum()
}

/// Between 0 and 1.
fn hash(p: [i32; 3], seed: u32) -> f32 {
    let mut h = seed;
    for c in p {
        h = (h ^ c as u32).wrapping_mul(0x9E37_79B1);
        h = (h ^ h >> 15).wrapping_mul(0x85EB_CA77);
        h ^= h >> 13;
    }
    (h >> 8) as f32 / (1 << 24) as f32
}
