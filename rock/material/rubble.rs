//! Stones on the floor.

use super::rock::Floor;
use super::site::Site;
use crate::noise::{Ints, Lanes, Real, Vec3, cells_2d, inlined, soft_max, soft_min};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Rubble: one stone per cell in plan, tilted, half sunk in sediment. Heights are relative to the highest stone.
#[derive(Clone, Copy, Debug)]
pub struct Rubble {
    /// Noise layer.
    pub layer: u32,
    /// Size of a cell in metres.
    pub cell_m: f32,
    /// Height of the lowest stone, and range up to the highest.
    pub rise: [f32; 2],
    /// Maximum rise of the tops per cell, along each axis.
    pub tilt: f32,
    /// Rise of the flanks per cell.
    pub flank: f32,
    /// Width of the rounding between top and flank: small for slabs, large for pebbles.
    pub rounding: f32,
    /// Width of the fillet of sediment around a stone.
    pub fillet: f32,
}

/// Depth of the ground below the sediment where there is no stone.
const SUNK: f32 = 0.35;

impl Rubble {
    /// Height over the sediment and, per stone, its tint. `density` is the share of cells with a stone, at most 1. `ragged`
    /// (about ±1) roughens the edges, `drift` is how high sediment is banked up against the stones.
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
        let sediment = T::zero(site.simd());
        Floor { height: soft_max(over, sediment, self.fillet), stone: over.step(-0.02, 0.30), tint: lot(2) }
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
