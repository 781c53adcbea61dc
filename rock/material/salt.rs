//! Rock salt of a mine, cut by a roadheader or a continuous miner.
//!
//! First state: the wall as the cutting head left it, shallow bites with the arcs of its picks. Second state: slabs have come off
//! along clay partings, which exposes coarse crystals. Bands of grey, white and orange salt and thin dark anhydrite are folded
//! as in a salt dome; in moist places salt has crystallised again as a white crust. The floor is crushed salt (after Warren,
//! *Evaporites: A Geological Compendium*, 2016, and Hustrulid and Bullock, *Underground Mining Methods*, 2001).
//!
//! Not promised: bites follow a pattern in plan, not the path of a machine.

mod colors;

pub use colors::SaltColors;

use super::coarse::{Coarse, MARKS};
use super::color::{Color, Tone, ramp};
use super::floor::Debris;
use super::rock::{Detail, Form, Paint, Rock, Wall, level_lot};
use super::rubble::Rubble;
use super::site::{Footprint, Site};
use super::{DomainWarp, Look};
use crate::noise::{Real, Value, Vec3, cells_2d, facets, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shape and bands of the salt; defaults tuned by eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Salt {
    /// Strength of the relief; 1 is natural, 0 a smooth drift.
    #[schemars(range(min = 0.0, max = 1.5))]
    pub relief: f32,
    /// How far the walls deviate from the planned drift, in metres.
    #[schemars(range(min = 0.0, max = 1.2))]
    pub wander_m: f32,
    /// Width of a bite of the cutting head, in metres.
    #[schemars(range(min = 0.6, max = 1.5))]
    pub bite_m: f32,
    /// Distance between the grooves of picks, in metres.
    #[schemars(range(min = 0.03, max = 0.10))]
    pub groove_m: f32,
    /// Share of the wall where slabs have come off: about −0.6 none, 0 half, 0.6 all.
    #[schemars(range(min = -0.6, max = 0.6))]
    pub spall: f32,
    /// Mean thickness of the bands, in metres.
    #[schemars(range(min = 0.1, max = 1.0))]
    pub band_m: f32,
    /// How strongly the bands are folded: 0 level beds, 1 as in a salt dome.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub fold: f32,
    /// Density of lumps on the floor: −0.5 clear, 0.5 covered.
    #[schemars(range(min = -0.5, max = 0.5))]
    pub rubble: f32,
    /// Its colours, as linear red, green and blue, each 0 to 1.
    pub colors: SaltColors,
}

impl Default for Salt {
    fn default() -> Self {
        Self {
            relief: 1.0,
            wander_m: 0.2,
            bite_m: 0.9,
            groove_m: 0.05,
            spall: -0.2,
            band_m: 0.22,
            fold: 0.7,
            rubble: -0.12,
            colors: SaltColors::default(),
        }
    }
}

/// Depth of the groove of a pick, metres.
const GROOVE_DEPTH_M: f32 = 0.0035;

impl Salt {
    /// How far a bite is from its middle, squared: 0 there, about 0.3 on the cusps between bites. They are rows in plan, so on a
    /// wall each is an upright hollow.
    #[inline(always)]
    fn bite<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let bite = cells_2d(site.point.scaled(1.0 / self.bite_m), site.source.layer(10));
        bite.offset[0].squared() + bite.offset[1].squared()
    }

    /// Number of the band, with its fraction.
    #[inline(always)]
    fn band<S: Simd>(&self, site: &Site<Value<S>>) -> Value<S> {
        let (p, n) = (site.point, site.source);
        let folded = n.warp(50, p, 5.5, 2.2 * self.fold);
        let folded = n.warp(51, folded, 1.7, 0.5 * self.fold);
        // Beds in a dome stand steeply.
        let up = folded.x * (0.7 * self.fold) + folded.y * (0.3 * self.fold) + folded.z;
        let even = up * (1.0 / self.band_m) + n.noise(52, p.scaled(1.0 / 1.1)) * 0.15;
        // Some bands are thicker than others.
        even + n.noise(53, vec3(even * 0.35, up * 0.0, up * 0.0)) * 1.1
    }
}

const LUMPS: Rubble =
    Rubble { layer: 31, cell_m: 1.0, rise: [0.25, 0.55], tilt: 1.1, flank: 4.0, rounding: 0.10, fillet: 0.12 };
const CRUSHED: Rubble =
    Rubble { layer: 32, cell_m: 0.45, rise: [0.12, 0.32], tilt: 0.8, flank: 2.2, rounding: 0.10, fillet: 0.12 };

impl Rock for Salt {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [10.0, 4.0], reach_m: [self.wander_m, self.wander_m / 3.0] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let (p, n) = (site.point, site.source);
        let ceiling = site.up.step(0.2, 0.8);
        let patches = n.noise(1, p.stretched(0.30, 0.30, 0.45)) + n.noise(2, p.scaled(1.0 / 1.4)) * 0.25;
        let spalled = (patches + ceiling * 0.20 + self.spall).step(-0.04, 0.14);
        let cut = self.bite(site) * -0.16 + n.noise(3, p.scaled(1.0 / 2.6)) * 0.05;
        let slabs = facets(p.stretched(1.0 / 1.2, 1.0 / 1.2, 1.0 / 0.8), 0.7, n.layer(4)) * 0.07 + 0.10;
        let form = mix(cut, slabs, spalled);
        Wall { recess: form * self.relief, cavity: form, state: spalled, band: T::zero(site.simd()) }
    }

    #[inline(always)]
    fn marks<S: Simd>(&self, site: &Site<Value<S>>) -> [Value<S>; MARKS] {
        let (p, n) = (site.point, site.source);
        let none = Value::zero(site.simd());
        let crust = n.noise(66, p.stretched(0.7, 0.7, 0.35)) + n.noise(67, p.scaled(1.0 / 0.7)) * 0.35;
        let worn = n.noise(45, p.scaled(0.8)).step(-0.55, -0.15);
        [self.band(site), crust, worn, none, none, none, none, none, none, none]
    }

    #[inline(always)]
    fn wall_detail<S: Simd>(&self, coarse: &Coarse<S>, footprint: Footprint) -> Detail<S> {
        let (site, spalled) = (&coarse.site, coarse.wall.state);
        let (p, n) = (site.point, site.source);
        let [_, _, worn, ..] = coarse.marks;
        let grain = footprint.fbm(n, 46, p, 0.16, 0.66) * 0.0106;
        let mut recess = grain;
        if spalled.0.simd_gt(0.0).any_true() {
            let crystals = facets(p.turned().scaled(1.0 / 0.09), 1.1, n.layer(41)) * (0.011 * footprint.keep(0.09));
            recess = recess + crystals * spalled;
        }
        if spalled.0.simd_lt(1.0).any_true() {
            let wobble = n.noise(42, p.scaled(1.0 / 0.35)) * 0.03;
            let (_, across) = ((p.z + self.bite(site) * (0.8 * self.bite_m) + wobble) * (1.0 / self.groove_m)).split();
            let groove = across * (-across + 1.0) * (4.0 * GROOVE_DEPTH_M * footprint.keep(self.groove_m));
            recess = recess + groove * (worn * (-spalled + 1.0));
        }
        Detail { recess: recess * self.relief.min(1.0), crack: Value::zero(site.simd()) }
    }

    fn debris(&self) -> Debris {
        Debris {
            swell_m: 4.0,
            sunk_m: 0.0,
            stones: [LUMPS, CRUSHED],
            amount: self.rubble,
            more: 0.0,
            bank: 0.7,
            patches: 0.30,
            patches_per_m: 0.3,
        }
    }

    #[inline(always)]
    fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        let tone = Tone::of(form, site, footprint);
        let (p, n) = (form.point, site.source);
        let crystal = n.noise(71, p.scaled(1.0 / 0.02)) * footprint.keep_noise(0.02);
        let banded = self
            .banded(form, site, footprint, &tone)
            .lit((crystal.step(0.10, 0.26) - (-crystal).step(0.14, 0.30)) * 0.16 + 1.0);
        let [_, crust, ..] = form.marks;
        let crust = (crust + tone.streak * 0.3 + tone.fine * 0.4 + form.relief * 0.2).step(0.48, 0.62);
        let wall = banded
            .tinted(self.colors.crust, crust * (0.75 * look.stain))
            .under(self.crushed(form, &tone), form.upward.step(0.5, 0.9) * 0.6);
        let color = wall.under(self.floor_color(form, &tone), form.floor).lit(tone.shade(form));
        let film = tone.film(form, look, form.floor * 0.3);
        // Crystals that are cleft glisten, powder does not.
        let mean = form.state * -0.12 + crystal * 0.14 + crust * 0.12 + 0.70;
        let dry = tone.dry_roughness(form, mean);
        Paint {
            color: color.lit(film * -0.30 + 1.0),
            roughness: mix(dry, tone.wet_roughness(form) * 0.6 + 0.10, film),
            film,
            pool: Value::zero(site.simd()),
        }
    }
}

impl Salt {
    /// Bands of salt, each with its own colour, and the dark lines between some of them.
    #[inline(always)]
    fn banded<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, footprint: Footprint, tone: &Tone<S>) -> Color<S> {
        let (p, n) = (form.point, site.source);
        let [level, ..] = form.marks;
        let (index, rest) = (level + tone.fine * 0.03).split();
        let edge = rest.step(1.0 - 0.012 / self.band_m, 1.0);
        let lot = |layer: u32| {
            let of = |index| level_lot::<S, Value<S>>(index, n.layer(layer));
            mix(of(index), of(index + 1), edge)
        };
        // Laminae of a year each, where they still can be told apart.
        let laminae = n.noise(73, lamina(p, level * (self.band_m / 0.035))) * footprint.keep(0.035);
        let light = lot(72) + laminae * 0.45 + tone.fine * 0.20;
        let orange = (lot(74) + laminae * 0.25 + tone.broad * 0.08).step(0.66, 1.0);
        let line = footprint.line(rest * self.band_m - 0.02, 0.012) * (lot(75) + tone.broad * 0.1).step(0.45, 0.55);
        ramp(light.step(0.0, 1.0), self.colors.band_dark, self.colors.band_pale)
            .tinted(self.colors.iron_band, orange * 0.70)
            .tinted(self.colors.clay_seam, line * 0.8)
    }

    /// Salt crushed fine: dust on ledges and on the floor.
    #[inline(always)]
    fn crushed<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>) -> Color<S> {
        ramp(tone.ground(form).step(-0.7, 0.8), self.colors.crushed_dark, self.colors.crushed_pale)
    }

    /// Lumps between crushed salt.
    #[inline(always)]
    fn floor_color<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>) -> Color<S> {
        let crushed = self.crushed(form, tone);
        let lump = ramp(tone.stone(form), self.colors.lump_dark, self.colors.lump_pale);
        let dusty = form.dust() * 0.6;
        crushed.under(lump.under(crushed, dusty), form.stone)
    }
}

/// Coordinates in which laminae are stretched along their band.
#[inline(always)]
fn lamina<S: Simd>(p: Vec3<Value<S>>, across: Value<S>) -> Vec3<Value<S>> {
    vec3(across, (p.x + p.z) * 0.8, (p.y - p.z) * 0.8)
}
