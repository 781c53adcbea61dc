//! Stones on the floor.

use super::rock::Floor;
use super::site::{Footprint, Site};
use crate::noise::{Ints, Lanes, Real, Vec3, cells_2d, inlined, soft_max, soft_min, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Rubble: one stone per cell in plan, tilted, half sunk in sediment. Heights are in units of the highest stone.
#[derive(Clone, Copy, Debug)]
pub struct Rubble {
    /// Layer of noise.
    pub layer: u32,
    /// Size of a cell in metres.
    pub cell_m: f32,
    /// Height of the lowest stone, and how much higher the highest is.
    pub rise: [f32; 2],
    /// Rise of the tops per cell at most, along each axis.
    pub tilt: f32,
    /// Rise of the flanks per cell.
    pub flank: f32,
    /// Width of the rounding between top and flank: little for slabs, much for pebbles.
    pub rounding: f32,
}

/// How far below the sediment the ground is where there is no stone.
const SUNK: f32 = 0.35;
/// Width of the fillet of sediment around a stone.
const FILLET: f32 = 0.25;

/// The ground that stones lie in, and where they lie.
#[derive(Clone, Copy, Debug)]
pub struct Sediment<T> {
    /// See [`bent`].
    pub at: Vec3<T>,
    /// Breaks the edges of stones, about ±1.
    pub ragged: T,
    /// How high it lies against the stones.
    pub drift: T,
    /// Its height over the plane of the floor, about ±1.
    pub roll: T,
}

impl<T> Sediment<T> {
    /// The sediment at a site, rolling over `length_m`.
    #[inline(always)]
    pub fn of<S: Simd>(site: &Site<T>, length_m: f32) -> Self
    where
        T: Real<S>,
    {
        let (p, n) = (site.point, site.source);
        let flat = vec3(p.x, p.y, p.z * 0.0);
        let roll = n.fbm(36, flat.scaled(1.0 / length_m), 2, 0.54);
        Self {
            at: bent(site),
            ragged: n.noise(38, flat.scaled(4.2)),
            drift: roll.within(-1.0, 1.0) * 0.30 + 0.05,
            roll,
        }
    }
}

/// The point, moved so that no edge of a stone is straight.
#[inline(always)]
fn bent<S: Simd, T: Real<S>>(site: &Site<T>) -> Vec3<T> {
    site.source.warp(35, site.point, 0.8, 0.14)
}

/// Gravel of two sizes over a floor with its larger stones: fine grain, ripples where it is bare.
#[inline(always)]
pub fn strewn<S: Simd, T: Real<S>>(
    site: &Site<T>,
    floor: &Floor<T>,
    footprint: Footprint,
    density: impl Fn([Lanes<S>; 2]) -> T,
) -> Floor<T> {
    let (p, n) = (site.point, site.source);
    let zero = floor.height * 0.0;
    let at = bent(site);
    let mut gravel = Floor { height: zero, stone: zero, tint: zero };
    for rubble in GRAVEL {
        // A stone of fewer than eight texels is a speck.
        let share = footprint.keep(rubble.cell_m * 0.25);
        if share > 0.0 {
            let stones = rubble.stones(site, at, [zero, zero + 0.1], &density);
            let height = stones.height * (share * 0.22 * rubble.cell_m);
            gravel = higher(gravel, Floor { height, stone: stones.stone * share, ..stones });
        }
    }
    let grain = n.fbm(37, p.scaled(5.5), footprint.octaves(0.18, 3), 0.55);
    let ripple = n.noise(39, vec3(p.x * 2.2 + p.y * 1.4, p.y * 6.0 - p.x * 3.8, p.z * 0.0));
    let bare = -floor.stone + 1.0;
    let on_stone = floor.stone.value().simd_gt(0.3);
    Floor {
        height: floor.height + (gravel.height + ripple * 0.008) * bare + grain * (floor.stone * 0.008 + 0.017),
        stone: floor.stone.max(gravel.stone * 0.7),
        tint: T::pick(on_stone, floor.tint, gravel.tint),
    }
}

/// Pebbles: rounded, of two sizes.
const GRAVEL: [Rubble; 2] = [
    Rubble { layer: 33, cell_m: 0.21, rise: [0.3, 0.7], tilt: 0.8, flank: 4.0, rounding: 0.6 },
    Rubble { layer: 34, cell_m: 0.09, rise: [0.3, 0.7], tilt: 0.8, flank: 4.0, rounding: 0.6 },
];

impl Rubble {
    /// Its height over the sediment and, per stone, its tint. `density` is the share of cells that hold a stone, at most
    /// 1. `ragged` (about ±1) breaks the edges, `drift` is how high sediment lies against the stones.
    #[inline(always)]
    pub fn stones<S: Simd, T: Real<S>>(
        &self,
        site: &Site<T>,
        at: Vec3<T>,
        [ragged, drift]: [T; 2],
        density: impl Fn([Lanes<S>; 2]) -> T,
    ) -> Floor<T> {
        let cell = cells_2d(at.scaled(1.0 / self.cell_m), site.source.layer(self.layer));
        let lot = inlined!(|which: u32| T::constant(cell.random(which)));
        let centre = [cell.centre[0] * self.cell_m, cell.centre[1] * self.cell_m];
        let presence = ((density(centre) - lot(0)) * (1.0 / 0.2)).within(0.0, 1.0);
        let other = Lots::<S>::of(cell.hash);
        let tilt = inlined!(|which: usize| T::constant((other.0[which] - 0.5) * (2.0 * self.tilt)));
        let slope = cell.offset[0] * tilt(0) + cell.offset[1] * tilt(1);
        let rise = lot(1).squared() * self.rise[1] + self.rise[0];
        let top = (slope + rise + SUNK) * presence - SUNK;
        let gap = lot(1) * 0.10 + 0.06;
        let flank = (cell.edge + ragged * 0.09 - gap) * self.flank;
        let over = soft_min(top, flank, self.rounding) - drift;
        let sediment = over * 0.0;
        Floor { height: soft_max(over, sediment, FILLET), stone: over.step(-0.02, 0.30), tint: lot(2) }
    }
}

/// A second set of random numbers of a cell.
struct Lots<S: Simd>([Lanes<S>; 2]);

impl<S: Simd> Lots<S> {
    #[inline(always)]
    fn of(hash: Ints<S>) -> Self {
        let h = hash * 0x6c07_8965;
        let lot = inlined!(|shift: u32| ((h >> shift) & 1023).to_float::<Lanes<S>>() * (1.0 / 1023.0));
        Self([lot(8), lot(19)])
    }
}

/// The higher of two floors at every point.
#[inline(always)]
pub fn higher<S: Simd, T: Real<S>>(a: Floor<T>, b: Floor<T>) -> Floor<T> {
    let first = a.height.value().simd_ge(b.height.value());
    Floor {
        height: T::pick(first, a.height, b.height),
        stone: T::pick(first, a.stone, b.stone),
        tint: T::pick(first, a.tint, b.tint),
    }
}
