//! Stones as intersections of half-spaces, with worn edges.
//!
//! Breakdown splits along bedding and two sets of joints, so a block starts as a skewed box; the corners and edges that
//! break off in the fall are further planes (Palmer, *Cave Geology*, 2007, on breakdown).

use nalgebra::Vector3;
use plume_graph::rng::Rng;

use super::kind::Shape;

/// Half the length of the prototypes in metres, in the middle of the range of their sizes, so that neither their images nor
/// their edges are stretched by much.
const BLOCK_M: f64 = 0.30;
const COBBLE_M: f64 = 0.12;
const SLAB_M: f64 = 0.24;
/// Width over which edges are worn, in metres. Tuned.
const WORN_M: f32 = 0.012;

/// Distance from the surface beyond which wear is left out, in metres: further than any edge of a voxel that crosses the surface.
const UNWORN_M: f32 = 0.05;

/// An angular block.
pub fn block(rng: &mut Rng) -> Shape {
    angular(rng, BLOCK_M)
}

/// An angular stone as large as a hand or a head.
pub fn cobble(rng: &mut Rng) -> Shape {
    angular(rng, COBBLE_M)
}

/// A flat piece of a bed or of lining.
pub fn slab(rng: &mut Rng) -> Shape {
    let half = Vector3::new(SLAB_M, SLAB_M * rng.between(0.6, 0.95), SLAB_M * rng.between(0.16, 0.26));
    broken(rng, half, 0.08, 6)
}

/// A plate of lining: a piece of a shell as wide as a tube, with rough edges.
pub fn lining(rng: &mut Rng) -> Shape {
    /// Radius of the tube in metres, when the plate has the size of its prototype.
    const TUBE_M: f32 = 0.75;
    let thick_m = rng.between(0.05, 0.075) as f32;
    let half = Vector3::new(SLAB_M, SLAB_M * rng.between(0.55, 0.9), 0.16);
    let outline = broken(rng, half, 0.12, 8);
    Box::new(move |[x, y, z]| {
        // Bent along y only, as the wall of a tube is.
        let up = z + TUBE_M - 0.02;
        let shell = 0.5 * thick_m - (libm::sqrtf(y * y + up * up) - TUBE_M).abs();
        worn_min(outline([x, y, z]), shell)
    })
}

/// A slab of crust with ropes on its upper side, which bend downstream as those of pahoehoe do.
pub fn ropy(rng: &mut Rng) -> Shape {
    /// Distance between two ropes, their height, and how far they bend, in metres.
    const ROPE_M: f32 = 0.075;
    const HIGH_M: f32 = 0.015;
    const BEND_M: f32 = 0.10;
    let slab = slab(rng);
    let phase = rng.between(0.0, 1.0) as f32;
    Box::new(move |[x, y, z]| {
        let across = y / SLAB_M as f32;
        let along = (x + BEND_M * across * across) / ROPE_M + phase;
        let rope = HIGH_M * (1.0 - 2.0 * (along - along.floor() - 0.5).abs());
        let above = if z > 0.0 { (z / 0.03).min(1.0) } else { 0.0 };
        // The steeper sides of ropes are nearer than they are high.
        0.8 * slab([x, y, z + above * (0.5 * HIGH_M - rope)])
    })
}

fn angular(rng: &mut Rng, half_m: f64) -> Shape {
    let half = Vector3::new(half_m, half_m * rng.between(0.62, 0.95), half_m * rng.between(0.42, 0.8));
    broken(rng, half, 0.24, 6)
}

/// A box whose faces lean by up to `skew`, with this many corners and edges broken off.
fn broken(rng: &mut Rng, half: Vector3<f64>, skew: f64, breaks: usize) -> Shape {
    let mut planes = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut normal = Vector3::from_fn(|_, _| rng.between(-skew, skew));
            normal[axis] = sign;
            planes.push((normal.normalize(), half[axis]));
        }
    }
    for _ in 0..breaks {
        let normal = direction(rng);
        // The support of the box in this direction, of which a break takes off a part.
        let corner = normal.abs().dot(&half);
        let smooth = normal.component_mul(&half).norm();
        planes.push((normal, smooth + (corner - smooth) * rng.between(0.05, 0.6)));
    }
    let planes: Vec<([f32; 3], f32)> =
        planes.into_iter().map(|(normal, offset)| (normal.map(|c| c as f32).into(), offset as f32)).collect();
    Box::new(move |point| {
        let depths = planes
            .iter()
            .map(|(normal, offset)| offset - (normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2]));
        let sharp = depths.clone().fold(f32::INFINITY, f32::min);
        // Far from the surface, wear would not be seen.
        if sharp.abs() > UNWORN_M { sharp } else { depths.fold(f32::INFINITY, worn_min) }
    })
}

/// A direction, evenly distributed.
fn direction(rng: &mut Rng) -> Vector3<f64> {
    let (z, around) = (rng.between(-1.0, 1.0), rng.between(0.0, std::f64::consts::TAU));
    let across = (1.0 - z * z).sqrt();
    Vector3::new(across * libm::cos(around), across * libm::sin(around), z)
}

/// The smaller of two distances, rounded where they are nearly equal.
fn worn_min(a: f32, b: f32) -> f32 {
    let near_m = (WORN_M - (a - b).abs()).max(0.0);
    a.min(b) - near_m * near_m * (0.25 / WORN_M)
}
