//! The floor of a rock: sediment with stones of two sizes and gravel.

use super::coarse::Coarse;
use super::rock::Floor;
use super::rubble::{Rubble, higher};
use super::site::{Footprint, Ground, Site};
use crate::noise::{Jet, Lanes, Mask, Real, Source, Value, Vec3, inlined, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// What is on the floor of a rock. The share of the ground covered by stones is a sum: a base amount, more at the foot of
/// the wall, and patches.
#[derive(Clone, Copy, Debug)]
pub struct Debris {
    /// Wavelength of the sediment's undulation, metres.
    pub swell_m: f32,
    /// Depth of the sediment below the plane of the floor, metres.
    pub sunk_m: f32,
    /// The large stones and the small ones.
    pub stones: [Rubble; 2],
    /// Density of stones: −0.5 clear, 0.5 covered.
    pub amount: f32,
    /// Additional density of stones large enough for the mesh.
    pub more: f32,
    /// Additional density at the foot of the wall.
    pub bank: f32,
    /// Additional density in patches.
    pub patches: f32,
    /// Reciprocal of the size of a patch.
    pub patches_per_m: f32,
}

impl Debris {
    /// Mud with a few blocks and cobbles. Tuned by eye.
    pub const PLAIN: Self = Self {
        swell_m: 3.0,
        sunk_m: 0.0,
        stones: [
            Rubble { layer: 31, cell_m: 1.2, rise: [0.35, 0.65], tilt: 0.7, flank: 5.0, rounding: 0.3, fillet: 0.2 },
            Rubble { layer: 32, cell_m: 0.5, rise: [0.15, 0.4], tilt: 0.5, flank: 2.4, rounding: 0.3, fillet: 0.2 },
        ],
        amount: 0.0,
        more: 0.05,
        bank: 0.7,
        patches: 0.4,
        patches_per_m: 0.3,
    };

    /// The shape of the floor, with no wavelength below 0.4 m.
    #[inline(always)]
    pub fn floor<S: Simd, T: Real<S>>(&self, site: &Site<T>, sediment: &Sediment<T>) -> Floor<T> {
        let edges = [sediment.ragged, sediment.roll.within(-1.0, 1.0) * 0.30 + 0.05];
        let [large, small] = self.stones;
        let large = large.stones(
            site,
            sediment.at,
            edges,
            #[inline(always)]
            |c| self.density(site, self.patch(site.source, c)) * 0.75 + self.more,
        );
        let small = small.stones(
            site,
            sediment.at.shifted(3.3, 1.7, 0.0),
            edges,
            #[inline(always)]
            |c| self.density(site, self.patch(site.source, c)) + self.more,
        );
        let stones = higher(large, small);
        let roll = sediment.roll * (0.09 * site.ground.natural);
        Floor { height: stones.height * stone_height(site) + roll - self.sunk_m, ..stones }
    }

    /// The floor with gravel and grain.
    #[inline(always)]
    pub fn detail<S: Simd>(&self, coarse: &Coarse<S>, floor: &Floor<Jet<S>>, footprint: Footprint) -> Floor<Jet<S>> {
        // Gravel is so small that its patch is the same all over a stone. Water gathers it in hollows.
        let lenses = coarse.sediment.ragged * 0.22 - coarse.sediment.roll * 0.30;
        strewn(coarse, floor, footprint, self.density(&coarse.site, coarse.patch) * 0.8 + lenses + 0.30)
    }

    /// How stony the ground is, about ±1, in patches.
    #[inline(always)]
    pub fn patch<S: Simd>(&self, source: Source, at: [Lanes<S>; 2]) -> Value<S> {
        let [x, y] = at.map(
            #[inline(always)]
            |x| Value::<S>(x * self.patches_per_m),
        );
        source.noise(30, vec3(x, y, Value::zero(x.0.token())))
    }

    #[inline(always)]
    fn density<S: Simd, T: Real<S>>(&self, site: &Site<T>, patch: Value<S>) -> T {
        let amount = self.amount - 0.3 * (1.0 - site.ground.natural);
        bank(site) * self.bank + T::constant(patch.0 * self.patches) + amount
    }
}

/// 1 at the foot of the wall, 0 in the driving lane.
#[inline(always)]
fn bank<S: Simd, T: Real<S>>(site: &Site<T>) -> T {
    (site.wall / site.half_width).step(-0.62, -0.08)
}

/// Height of stones at a site, metres.
#[inline(always)]
fn stone_height<S: Simd, T: Real<S>>(site: &Site<T>) -> T {
    let share = (site.half_width * 0.6 - 0.1).within(0.2, 1.0);
    (bank(site) * share * (Ground::BANK - 1.0) + 1.0) * site.ground.roughness_m
}

/// The ground around stones, and the coordinates of stones.
#[derive(Clone, Copy, Debug)]
pub struct Sediment<T> {
    /// The point, displaced so that no edge of a stone is straight.
    pub at: Vec3<T>,
    /// Roughens the edges of stones, about ±1.
    pub ragged: T,
    /// Undulation of the sediment, about ±1; it is banked up against stones where it is high.
    pub roll: T,
}

impl<T> Sediment<T> {
    /// The sediment at a site, undulating with the wavelength `length_m`.
    #[inline(always)]
    pub fn of<S: Simd>(site: &Site<T>, length_m: f32) -> Self
    where
        T: Real<S>,
    {
        let (p, n) = (site.point, site.source);
        let flat = vec3(p.x, p.y, T::zero(site.simd()));
        Self {
            at: n.warp(35, p, 0.8, 0.14),
            ragged: n.noise(38, flat.scaled(4.2)),
            roll: n.fbm(36, flat.scaled(1.0 / length_m), 2, 0.54),
        }
    }

    /// Another sediment where the mask holds.
    #[inline(always)]
    pub fn unless<S: Simd>(self, mask: Mask<S>, other: &Self) -> Self
    where
        T: Real<S>,
    {
        let pick = inlined!(|here: T, there: T| T::pick(mask, there, here));
        Self {
            at: vec3(pick(self.at.x, other.at.x), pick(self.at.y, other.at.y), pick(self.at.z, other.at.z)),
            ragged: pick(self.ragged, other.ragged),
            roll: pick(self.roll, other.roll),
        }
    }
}

/// Gravel on a floor with its larger stones; grain, and ripples on bare ground.
#[inline(always)]
fn strewn<S: Simd>(coarse: &Coarse<S>, floor: &Floor<Jet<S>>, footprint: Footprint, density: Jet<S>) -> Floor<Jet<S>> {
    let Coarse { site, sediment, .. } = coarse;
    let (p, n) = (site.point, site.source);
    let zero = Jet::zero(site.simd());
    let mut gravel = Floor { height: zero, stone: zero, tint: zero };
    for rubble in GRAVEL {
        // Stones of fewer than four texels would be specks.
        let share = footprint.keep(rubble.cell_m * 0.5);
        if share > 0.0 {
            // Small stones lie everywhere, since nothing moves all of them to the walls.
            let stones = rubble.stones(
                site,
                sediment.at,
                [zero, zero + 0.05],
                #[inline(always)]
                |_| density + (SPREAD_M / rubble.cell_m - 1.0).clamp(0.0, 0.35),
            );
            let height = stones.height * (share * HEIGHT_PER_CELL * rubble.cell_m);
            gravel = higher(gravel, Floor { height, stone: stones.stone * share, ..stones });
        }
    }
    let grain = footprint.fbm(n, 37, p, 0.18, 0.58);
    let ripple = n.noise(39, vec3(p.x * 2.2 + p.y * 1.4, p.y * 6.0 - p.x * 3.8, zero));
    let bare = -floor.stone + 1.0;
    let on_stone = floor.stone.value().simd_gt(0.3);
    Floor {
        height: floor.height + (gravel.height + ripple * 0.008) * bare + grain * (gravel.stone * -0.005 + 0.011),
        stone: floor.stone.max(gravel.stone),
        tint: Jet::pick(on_stone, floor.tint, gravel.tint),
    }
}

/// Size of cell below which stones also lie where larger ones do not. Tuned.
const SPREAD_M: f32 = 0.05;
/// Height of a gravel stone of the least [`Rubble::rise`], relative to its cell. Tuned.
const HEIGHT_PER_CELL: f32 = 0.19;

/// Gravel from cobbles down to what fine textures just show: angular chips among rounded pebbles.
const GRAVEL: [Rubble; 4] = [
    Rubble { layer: 33, cell_m: 0.21, rise: [0.3, 0.7], tilt: 0.8, flank: 4.0, rounding: 0.35, fillet: 0.10 },
    Rubble { layer: 34, cell_m: 0.09, rise: [0.3, 0.7], tilt: 0.9, flank: 4.0, rounding: 0.25, fillet: 0.08 },
    Rubble { layer: 28, cell_m: 0.042, rise: [0.4, 0.6], tilt: 0.9, flank: 3.5, rounding: 0.20, fillet: 0.08 },
    Rubble { layer: 29, cell_m: 0.019, rise: [0.4, 0.6], tilt: 0.8, flank: 3.5, rounding: 0.20, fillet: 0.08 },
];
