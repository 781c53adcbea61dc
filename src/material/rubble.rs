//! Stones on the floor.

use super::rock::Floor;
use super::site::Site;
use crate::noise::{Ints, Lanes, Real, Vec3, cells_2d, inlined, soft_min};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Rubble: one slab per cell in plan, tilted, with steep flanks and a gap to its neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Rubble {
    /// Layer of noise.
    pub layer: u32,
    /// Size of a cell in metres.
    pub cell_m: f32,
    /// Height of the lowest slab, and how much higher the highest is, in metres.
    pub height_m: [f32; 2],
    /// Slope of the tops at most, along each axis.
    pub tilt: f32,
    /// Slope of the flanks.
    pub steepness: f32,
}

impl Rubble {
    /// Its height and, per stone, its tint. `density` is the share of cells that hold a stone, at most 1; whatever is
    /// constant over a stone in it keeps the stone whole.
    #[inline(always)]
    pub fn stones<S: Simd, T: Real<S>>(
        &self,
        site: &Site<T>,
        at: Vec3<T>,
        density: impl Fn([Lanes<S>; 2]) -> T,
    ) -> Floor<T> {
        let cell = cells_2d(at.scaled(1.0 / self.cell_m), site.source.layer(self.layer));
        let lot = inlined!(|which: u32| T::constant(cell.random(which)));
        let centre = [cell.centre[0] * self.cell_m, cell.centre[1] * self.cell_m];
        let presence = ((density(centre) - lot(0)) * (1.0 / 0.12)).within(0.0, 1.0);
        let other = Lots::<S>::of(cell.hash);
        let tilt = inlined!(|which: usize| T::constant((other.0[which] - 0.5) * (2.0 * self.tilt)));
        let slope = (cell.offset[0] * tilt(0) + cell.offset[1] * tilt(1)) * self.cell_m;
        let rise = lot(1).squared() * self.height_m[1] + self.height_m[0];
        let top = slope + rise * presence;
        let flank = (cell.edge - 0.03 - lot(1) * 0.06) * (self.cell_m * self.steepness);
        let height = soft_min(top, flank, self.cell_m * 0.12).at_least(0.0);
        let height = T::pick(presence.value().simd_gt(0.0), height, height * 0.0);
        let stone = (height * (8.0 / self.cell_m)).at_most(1.0);
        Floor { height, stone, tint: lot(2) }
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
