//! Cellular noise (Worley 1996): distances to feature points, one per lattice cell, and planes attached to them.
//!
//! The outer loops are over cells, the inner ones over lanes; the other order does not vectorise.

use super::gradient::{PRIMES, hash, ten_bits};
use super::lane::{Ints, Lanes, Mask, Real};
use super::vector::Vec3;
use fearless_simd::prelude::*;
use fearless_simd::{Select, Simd};

/// Result of [`cells_3d`].
#[derive(Clone, Copy, Debug)]
pub struct Cell3<T> {
    /// Distance to the nearest feature point.
    pub distance: T,
    /// Distance to the plane between the two nearest feature points.
    pub edge: T,
}

/// Result of [`cells_2d`].
#[derive(Clone, Copy, Debug)]
pub struct Cell2<S: Simd, T> {
    /// Distance to the border of the cell.
    pub edge: T,
    /// Horizontal offset from the feature point.
    pub offset: [T; 2],
    /// Horizontal position of the feature point.
    pub centre: [Lanes<S>; 2],
    /// Hash of the cell.
    pub hash: Ints<S>,
}

impl<S: Simd, T> Cell2<S, T> {
    /// A random number in 0..1 per cell and `which` in 0..3.
    #[inline(always)]
    pub fn random(&self, which: u32) -> Lanes<S> {
        let h = self.hash * 0x2545_f491;
        ten_bits::<S>(h ^ (h >> 13), which * 10) * (1.0 / 1024.0)
    }
}

/// Voronoi cells of size 1 in space.
#[inline(always)]
pub fn cells_3d<S: Simd, T: Real<S>>(at: Vec3<T>, salt: i32) -> Cell3<T> {
    let simd = at.x.value().token();
    simd.vectorize(
        #[inline(always)]
        || find_3d(at, salt),
    )
}

/// Voronoi cells of size 1 in plan; `at.z` is ignored.
#[inline(always)]
pub fn cells_2d<S: Simd, T: Real<S>>(at: Vec3<T>, salt: i32) -> Cell2<S, T> {
    let simd = at.x.value().token();
    simd.vectorize(
        #[inline(always)]
        || find_2d(at, salt),
    )
}

/// Hollows with cusps between them: the smallest over feature points of the squared distance, skewed along `drift` so that
/// each hollow is steeper on the side where `drift` comes from. 0 at the bottom, about 0.6 on a cusp.
#[inline(always)]
pub fn hollows<S: Simd, T: Real<S>>(at: Vec3<T>, drift: [Lanes<S>; 3], salt: i32) -> T {
    let simd = at.x.value().token();
    simd.vectorize(
        #[inline(always)]
        || hollows_here(at, drift, salt),
    )
}

/// Soft facets, about ±1: a blend of one plane per cell of size 1, tilted at most by `tilt` along each axis.
#[inline(always)]
pub fn facets<S: Simd, T: Real<S>>(at: Vec3<T>, tilt: f32, salt: i32) -> T {
    let simd = at.x.value().token();
    simd.vectorize(
        #[inline(always)]
        || facets_here(at, tilt, salt),
    )
}

/// The 27 cells around a point: its position in its own cell, and the index of that cell times the hash primes.
struct Block<S: Simd> {
    place: [Lanes<S>; 3],
    index: [Ints<S>; 3],
    salt: i32,
}

/// Feature points lie in the middle 80 % of their cells.
const JITTER_3D: f32 = 0.8;

impl<S: Simd> Block<S> {
    #[inline(always)]
    fn around<T: Real<S>>(at: Vec3<T>, salt: i32) -> Self {
        let [x, y, z] = [at.x.value(), at.y.value(), at.z.value()];
        let [fx, fy, fz] = [x.floor(), y.floor(), z.floor()];
        Self {
            place: [x - fx, y - fy, z - fz],
            index: [
                fx.to_int::<Ints<S>>() * PRIMES[0],
                fy.to_int::<Ints<S>>() * PRIMES[1],
                fz.to_int::<Ints<S>>() * PRIMES[2],
            ],
            salt,
        }
    }

    /// Hash of the cell at an offset, and the vector from its feature point to the point.
    #[inline(always)]
    fn cell(&self, offset: [i32; 3]) -> (Ints<S>, [Lanes<S>; 3]) {
        let shifted = inlined!(|i: usize| self.index[i] + offset[i].wrapping_mul(PRIMES[i]));
        // Salted after the shift, so that a cell has the same hash in the block of each of its neighbours.
        let h = hash::<S>(shifted(0), shifted(1), shifted(2) ^ self.salt);
        let away = inlined!(|i: usize, shift: u32| {
            let corner = offset[i] as f32 + (1.0 - JITTER_3D) / 2.0;
            self.place[i] - ten_bits::<S>(h, shift) * (JITTER_3D / 1023.0) - corner
        });
        (h, [away(0, 0), away(1, 10), away(2, 20)])
    }
}

/// Offsets of the 27 cells around a cell.
#[inline(always)]
fn neighbour(i: i32) -> [i32; 3] {
    [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]
}

#[inline(always)]
fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn choose<S: Simd, const N: usize>(mask: Mask<S>, yes: [Lanes<S>; N], no: [Lanes<S>; N]) -> [Lanes<S>; N] {
    let mut chosen = no;
    for i in 0..N {
        chosen[i] = mask.select(yes[i], no[i]);
    }
    chosen
}

#[inline(always)]
fn find_3d<S: Simd, T: Real<S>>(at: Vec3<T>, salt: i32) -> Cell3<T> {
    let block = Block::around(at, salt);
    let far = Lanes::<S>::splat(at.x.value().token(), 9.0);
    let (mut first, mut second) = (far, far);
    let (mut to_first, mut to_second) = ([far; 3], [far; 3]);
    for i in 0..27 {
        let (_, away) = block.cell(neighbour(i));
        let d = dot::<S>(away, away);
        let nearest = d.simd_lt(first);
        let next = d.simd_lt(second);
        to_second = choose::<S, 3>(nearest, to_first, choose::<S, 3>(next, away, to_second));
        second = nearest.select(first, next.select(d, second));
        to_first = choose::<S, 3>(nearest, away, to_first);
        first = nearest.select(d, first);
    }
    let distance = first.max(1e-12).sqrt();
    let [x, y, z] = to_first;
    let unit = [x / distance, y / distance, z / distance];
    let [u, v, w] = to_second;
    let between = [u - x, v - y, w - z];
    let length = dot::<S>(between, between).max(1e-12).sqrt();
    let edge = (second - first) * 0.5 / length;
    Cell3 {
        distance: T::chain_3(distance, unit, at),
        edge: T::chain_3(edge, [between[0] / length, between[1] / length, between[2] / length], at),
    }
}

/// How flat a hollow can be at most where it is drawn out, so that none is lower than its feature point. Tuned.
const LEAST_SKEW: f32 = 0.3;

#[inline(always)]
fn hollows_here<S: Simd, T: Real<S>>(at: Vec3<T>, drift: [Lanes<S>; 3], salt: i32) -> T {
    let block = Block::around(at, salt);
    let far = Lanes::<S>::splat(at.x.value().token(), 9.0);
    let (mut least, mut slope) = (far, [far; 3]);
    for i in 0..27 {
        let (_, away) = block.cell(neighbour(i));
        let (squared, skew) = (dot::<S>(away, away), dot::<S>(away, drift) + 1.0);
        let skewed = skew.simd_gt(LEAST_SKEW);
        let skew = skew.max(LEAST_SKEW);
        let depth = squared * skew;
        let lower = depth.simd_lt(least);
        let along = inlined!(|axis: usize| away[axis] * skew * 2.0 + skewed.select(squared * drift[axis], far * 0.0));
        least = lower.select(depth, least);
        slope = choose::<S, 3>(lower, [along(0), along(1), along(2)], slope);
    }
    T::chain_3(least, slope, at)
}

#[inline(always)]
fn facets_here<S: Simd, T: Real<S>>(at: Vec3<T>, tilt: f32, salt: i32) -> T {
    let block = Block::around(at, salt);
    let zero = Lanes::<S>::splat(at.x.value().token(), 0.0);
    let (mut sum, mut weights) = (zero, zero + 1e-9);
    let (mut sum_slope, mut weights_slope) = ([zero; 3], [zero; 3]);
    for i in 0..27 {
        let (h, away) = block.cell(neighbour(i));
        let t = (-dot::<S>(away, away) * (1.0 / 1.5) + 1.0).max(0.0);
        let (t2, h2) = (t * t, h * 0x1657_33b1);
        let (t4, h2) = (t2 * t2, h2 ^ (h2 >> 13));
        // The 14th power: lower ones round the edges between facets, higher ones are too sharp for the lattice of textures.
        let t12 = t4 * t4 * t4;
        let weight = t12 * t2;
        let weight_slope = t12 * t * (14.0 * -2.0 / 1.5);
        let tilted = inlined!(|shift: u32| (ten_bits::<S>(h2, shift) * (2.0 / 1023.0) - 1.0) * tilt);
        let plane = [tilted(0), tilted(10), tilted(20)];
        let rise = ten_bits::<S>(h2 * 0x05eb_ca6b, 21) * (2.0 / 1023.0) - 1.0;
        let height = rise + dot::<S>(plane, away);
        sum += weight * height;
        weights += weight;
        for i in 0..3 {
            sum_slope[i] += weight_slope * away[i] * height + weight * plane[i];
            weights_slope[i] += weight_slope * away[i];
        }
    }
    let value = sum / weights;
    let slope = [
        (sum_slope[0] - value * weights_slope[0]) / weights,
        (sum_slope[1] - value * weights_slope[1]) / weights,
        (sum_slope[2] - value * weights_slope[2]) / weights,
    ];
    T::chain_3(value, slope, at)
}

/// Feature points in plan lie in the middle 72 % of their cells, so that nine cells nearly always suffice.
const JITTER_2D: f32 = 0.72;

#[inline(always)]
fn find_2d<S: Simd, T: Real<S>>(at: Vec3<T>, salt: i32) -> Cell2<S, T> {
    let simd = at.x.value().token();
    let [x, y] = [at.x.value(), at.y.value()];
    let [fx, fy] = [x.floor(), y.floor()];
    let index = [fx.to_int::<Ints<S>>() * PRIMES[0], fy.to_int::<Ints<S>>() * PRIMES[1]];
    let far = Lanes::<S>::splat(simd, 9.0);
    let salt = Ints::<S>::splat(simd, salt);
    let (mut first, mut to_first, mut cell_hash) = (far, [far; 2], salt);
    let mut points = [[far; 2]; 9];
    for (n, point) in points.iter_mut().enumerate() {
        let (i, j) = (n as i32 % 3 - 1, n as i32 / 3 - 1);
        let h = hash::<S>(index[0] + i.wrapping_mul(PRIMES[0]), index[1] + j.wrapping_mul(PRIMES[1]), salt);
        let margin = (1.0 - JITTER_2D) / 2.0;
        let dx = x - fx - ten_bits::<S>(h, 0) * (JITTER_2D / 1023.0) - (i as f32 + margin);
        let dy = y - fy - ten_bits::<S>(h, 10) * (JITTER_2D / 1023.0) - (j as f32 + margin);
        *point = [dx, dy];
        let d = dx * dx + dy * dy;
        let nearest = d.simd_lt(first);
        first = nearest.select(d, first);
        to_first = choose::<S, 2>(nearest, *point, to_first);
        cell_hash = nearest.select(h, cell_hash);
    }
    let (edge, slope) = nearest_bisector::<S>(&points, to_first);
    let zero = Lanes::<S>::splat(simd, 0.0);
    let one = zero + 1.0;
    Cell2 {
        edge: T::chain_3(edge, [slope[0], slope[1], zero], at),
        offset: [T::chain_3(to_first[0], [one, zero, zero], at), T::chain_3(to_first[1], [zero, one, zero], at)],
        centre: [x - to_first[0], y - to_first[1]],
        hash: cell_hash,
    }
}

/// Distance to the nearest line halfway between the nearest point and another, and its slope.
#[inline(always)]
fn nearest_bisector<S: Simd>(points: &[[Lanes<S>; 2]; 9], first: [Lanes<S>; 2]) -> (Lanes<S>, [Lanes<S>; 2]) {
    let one = Lanes::<S>::splat(first[0].token(), 1.0);
    // The distance to a line is `excess / (2 length)`: compared by squares, so that only the nearest takes a root.
    let (mut excess, mut squared, mut across) = (one * 9.0, one, [one; 2]);
    for point in points {
        let n = [point[0] - first[0], point[1] - first[1]];
        let length_squared = n[0] * n[0] + n[1] * n[1];
        let further = (point[0] + first[0]) * n[0] + (point[1] + first[1]) * n[1];
        // Never holds for the nearest itself: both sides are 0.
        let nearer = (further * further * squared).simd_lt(excess * excess * length_squared);
        excess = nearer.select(further, excess);
        squared = nearer.select(length_squared, squared);
        across = choose::<S, 2>(nearer, n, across);
    }
    let length = squared.sqrt();
    (excess * 0.5 / length, [across[0] / length, across[1] / length])
}
