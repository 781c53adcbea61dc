//! Basalt of a lava tube.
//!
//! First state: the lining, glazed when the tube drained, with horizontal flow ledges, remelt drips and cooling cracks.
//! Second state: spall, where the lining has fallen off and exposes the fractured flow behind it. The floor is ash with
//! angular slabs (after Larson, *Illustrated Glossary of Lava Tube Features*, 1993).

mod colors;

pub use colors::BasaltColors;

use super::coarse::{Coarse, MARKS};
use super::color::{Color, Tone, ramp};
use super::floor::Debris;
use super::rock::{Detail, Floor, Form, Paint, Rock, Wall, level_lot};
use super::rubble::Rubble;
use super::site::{Footprint, Site};
use super::{DomainWarp, Look};
use crate::noise::{Jet, Real, Value, Vec3, cells_3d, facets, inlined, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shape of the basalt; defaults tuned by eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Basalt {
    /// Strength of the relief; 1 is natural, 0 a smooth tube.
    #[schemars(range(min = 0.0, max = 1.5))]
    pub relief: f32,
    /// How far the walls deviate from the smooth passage, in metres.
    #[schemars(range(min = 0.0, max = 1.2))]
    pub wander_m: f32,
    /// Share of the lining that has fallen off: about −0.6 none, 0 half, 0.6 all.
    #[schemars(range(min = -0.6, max = 0.6))]
    pub spall: f32,
    /// Distance between flow ledges, in metres.
    #[schemars(range(min = 0.4, max = 1.5))]
    pub ledge_m: f32,
    /// Density of slabs on the floor: −0.5 clear, 0.5 covered.
    #[schemars(range(min = -0.5, max = 0.5))]
    pub rubble: f32,
    /// Its colours, as linear red, green and blue, each 0 to 1.
    pub colors: BasaltColors,
}

impl Default for Basalt {
    fn default() -> Self {
        Self { relief: 1.0, wander_m: 0.6, spall: -0.02, ledge_m: 0.7, rubble: 0.06, colors: BasaltColors::default() }
    }
}

impl Basalt {
    /// Flow levels: each has its own recess, a belly, and an edge over the level below.
    #[inline(always)]
    fn levels<S: Simd, T: Real<S>>(level: T, salt: i32, sharp: f32, reach: f32, belly: f32) -> T {
        let (index, rest) = level.split();
        let (a, b): (T, T) = (level_lot(index, salt), level_lot(index + 1, salt));
        (mix(a, b, rest.step(sharp, 1.0)) - 0.5) * reach - rest * (-rest + 1.0) * belly
    }

    #[inline(always)]
    fn lining<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        let per_m = 1.0 / self.ledge_m;
        let ledge_level = site.height * per_m + n.noise(10, p.scaled(1.0 / 3.2)) * 0.55;
        let ledges = Self::levels(ledge_level, n.layer(11), 0.58, 0.52, 0.26);
        let roll_level = site.height * (1.8 * per_m) + n.noise(12, p.scaled(1.0 / 2.3)) * 1.1;
        let rolling = (n.noise(13, p.scaled(0.5)) + 0.35).within(0.0, 1.0);
        let rolls = Self::levels(roll_level, n.layer(14), 0.30, 0.17, 0.14) * rolling;
        let lines = n.noise(15, p.stretched(0.55, 0.55, 2.4)) * 0.06;
        let bench = (n.noise(16, p.scaled(0.25)) * 0.35 + 0.22).at_least(0.0);
        let bench = bench * (site.height + n.noise(18, p.scaled(1.0 / 1.1)) * 0.08).step(0.80, 0.50);
        ledges + rolls + lines - bench
    }

    /// Ropes of pahoehoe, 0 in the creases between them and about 0.7 on top. They lie across the flow, so noise stretched
    /// along each of four directions is blended by the angle to the flow.
    #[inline(always)]
    fn ropes<S: Simd, T: Real<S>>(site: &Site<T>) -> T {
        let (n, flow) = (site.source, site.flow);
        let p = n.warp(55, site.point, 0.9, 0.22);
        // Sine and cosine of twice the azimuth: ropes are the same up and down the flow.
        let cosine = flow.x.squared() - flow.y.squared();
        let sine = flow.x * flow.y * 2.0;
        let diagonal = std::f32::consts::FRAC_1_SQRT_2;
        let directions =
            [(cosine, 1.0, 0.0), (sine, diagonal, diagonal), (-cosine, 0.0, 1.0), (-sine, -diagonal, diagonal)];
        let mut ropes = T::zero(site.simd());
        for (likeness, x, y) in directions {
            let share = likeness.at_least(0.0).squared();
            if share.value().simd_gt(0.0).any_true() {
                let at = vec3((p.x * x + p.y * y) * (1.0 / 0.16), (p.y * x - p.x * y) * (1.0 / 0.80), p.z * 0.5);
                ropes = ropes + n.noise(56, at).soft_abs(0.05) * share;
            }
        }
        ropes
    }

    #[inline(always)]
    fn spalled<S: Simd, T: Real<S>>(site: &Site<T>) -> T {
        let n = site.source;
        let w = Self::shattered(site);
        let large = facets(w.stretched(1.0 / 1.3, 1.0 / 1.3, 1.0 / 0.95), 1.1, n.layer(21));
        let small = facets(Self::joints(w), 1.1, n.layer(22));
        large * 0.25 + small * 0.08 + 0.24
    }

    /// The point, displaced so that no edge of a fracture block is straight.
    #[inline(always)]
    fn shattered<S: Simd, T: Real<S>>(site: &Site<T>) -> Vec3<T> {
        site.source.warp(20, site.point, 0.9, 0.10)
    }

    /// Coordinates of the smaller fracture blocks.
    #[inline(always)]
    fn joints<S: Simd, T: Real<S>>(at: Vec3<T>) -> Vec3<T> {
        at.stretched(1.0 / 0.46, 1.0 / 0.46, 1.0 / 0.40).turned()
    }
}

/// Distance between vesicles, metres.
const VESICLE_M: f32 = 0.045;

const SLABS: Rubble =
    Rubble { layer: 31, cell_m: 1.25, rise: [0.35, 0.65], tilt: 1.2, flank: 7.0, rounding: 0.10, fillet: 0.10 };
const BLOCKS: Rubble =
    Rubble { layer: 32, cell_m: 0.55, rise: [0.15, 0.4], tilt: 0.8, flank: 3.2, rounding: 0.10, fillet: 0.10 };

impl Rock for Basalt {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [5.0, 2.1], reach_m: [self.wander_m, self.wander_m / 3.0] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let (p, n) = (site.point, site.source);
        let ceiling = site.up.step(0.15, 0.75);
        let patches = n.noise(1, p.scaled(1.0 / 5.5)) + n.noise(2, p.scaled(1.0 / 1.9)) * 0.35;
        let spall = (patches + ceiling * 0.35 + self.spall).step(-0.05, 0.25);
        let undulation = n.fbm(3, p.scaled(1.0 / 3.0), 2, 0.574) * 0.26;
        let mut form = T::zero(site.simd());
        if spall.value().simd_lt(1.0).any_true() {
            form = form + self.lining(site) * (-spall + 1.0);
        }
        if spall.value().simd_gt(0.0).any_true() {
            form = form + Self::spalled(site) * spall;
        }
        let recess = (undulation + form) * self.relief;
        Wall { recess, cavity: form, state: spall, band: T::zero(site.simd()) }
    }

    /// Distance from the middle of a pull-apart crack, metres. The lining was pulled apart while it was still soft, so cracks
    /// wind, and neither branch nor cross.
    #[inline(always)]
    fn level<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        n.noise(44, n.warp(43, p, 0.6, 0.10).stretched(0.55, 0.55, 0.30)) * 1.3
    }

    #[inline(always)]
    fn marks<S: Simd>(&self, site: &Site<Value<S>>) -> [Value<S>; MARKS] {
        let (p, n) = (site.point, site.source);
        let patch = n.noise(40, p.scaled(1.0 / 1.7));
        let rims = (n.noise(46, p.scaled(1.1)) + 0.2).within(0.0, 0.8);
        let frothy = n.noise(52, p.scaled(1.0 / 1.2)).step(-0.05, 0.30);
        let oxidation = n.noise(66, p.stretched(0.32, 0.32, 1.1));
        let bloom = n.noise(67, p.scaled(1.25));
        let ropy = n.noise(54, p.scaled(1.0 / 3.0)).step(-0.05, 0.20);
        let shattered = Self::shattered(site);
        let shift = [shattered.x - p.x, shattered.y - p.y, shattered.z - p.z];
        [patch, rims, frothy, oxidation, bloom, ropy, shift[0], shift[1], shift[2], n.noise(45, p.scaled(0.9)) * 1.5]
    }

    #[inline(always)]
    fn wall_detail<S: Simd>(&self, coarse: &Coarse<S>, footprint: Footprint) -> Detail<S> {
        let (site, spall) = (&coarse.site, coarse.wall.state);
        let (p, n) = (site.point, site.source);
        let [patch, rims, frothy, _, _, _, dx, dy, dz, bend] = coarse.marks;
        let mut detail = Detail::none(site.simd());
        if spall.0.simd_lt(1.0).any_true() {
            let ceiling = Value(site.up.value).step(0.15, 0.75);
            let drip = (patch + ceiling * 0.4 + 0.15).within(0.0, 1.0);
            let cells = cells_3d(p.stretched(7.5, 7.5, 3.6), n.layer(42));
            let drops = cells.distance;
            // The glaze crazed as it cooled, except where it still dripped.
            let crazed = footprint.line(cells.edge * (1.0 / 5.5), 0.006) * rims.step(0.15, 0.55) * (-drip + 1.0);
            let crack = footprint.line(coarse.level, 0.02) * patch.step(0.05, -0.30);
            let (_, saw) = (site.height * 13.0 + Jet::constant(bend.0)).split();
            let rim = saw * (-saw + 1.0) * (rims * -0.040);
            let grain = footprint.fbm(n, 47, p.stretched(1.0, 1.0, 1.8), 0.2, 0.56) * 0.019;
            let lines = n.noise(48, p.stretched(1.5, 1.5, 19.0)) * (0.014 * footprint.keep(0.05));
            let drops = (drops.squared() - 0.3) * (drip * 0.030);
            let fine = rim + lines + grain + drops + crazed * 0.004 + crack * 0.03;
            detail.recess = fine * (-spall + 1.0);
            detail.crack = Value(crack.value).max(Value(crazed.value)) * (-spall + 1.0);
        }
        let frothy = frothy * (spall * 0.7 + 0.3) * footprint.keep(VESICLE_M * 0.6);
        if frothy.0.simd_gt(0.0).any_true() {
            let away = cells_3d(p.scaled(1.0 / VESICLE_M), n.layer(53)).distance;
            let vesicle = (-away * (1.0 / 0.42) + 1.0).at_least(0.0);
            detail.recess = detail.recess + vesicle * (frothy * 0.009);
        }
        if spall.0.simd_gt(0.0).any_true() {
            let shift = inlined!(|by: Value<S>| Jet::constant(by.0));
            let w = vec3(p.x + shift(dx), p.y + shift(dy), p.z + shift(dz));
            let edges = cells_3d(Self::joints(w), n.layer(22)).edge;
            let chips = facets(w.scaled(1.0 / 0.17), 1.1, n.layer(49)) * (0.032 * footprint.keep(0.17));
            let rough = footprint.fbm(n, 50, p, 0.17, 0.55);
            let split = Value(rough.value).step(-0.30, 0.40);
            detail.recess = detail.recess + (chips + rough * 0.022) * spall;
            let crack = footprint.line(Value(edges.value) * 0.44, 0.028);
            detail.crack = detail.crack + crack * split * spall;
        }
        detail
    }

    fn debris(&self) -> Debris {
        Debris {
            swell_m: 2.6,
            sunk_m: 0.02,
            stones: [SLABS, BLOCKS],
            amount: self.rubble,
            more: 0.04,
            bank: 0.75,
            patches: 0.45,
            patches_per_m: 0.28,
        }
    }

    #[inline(always)]
    fn floor_detail<S: Simd>(&self, coarse: &Coarse<S>, floor: &Floor<Jet<S>>, footprint: Footprint) -> Floor<Jet<S>> {
        let site = &coarse.site;
        let strewn = self.debris().detail(coarse, floor, footprint);
        let [_, _, _, _, _, ropy, ..] = coarse.marks;
        let ropy = (-floor.stone + 1.0) * ropy;
        if ropy.value().simd_le(0.0).all_true() {
            return strewn;
        }
        let height =
            floor.height + Self::ropes(site) * 0.05 + footprint.fbm(site.source, 37, site.point, 0.11, 0.60) * 0.010;
        Floor {
            height: mix(strewn.height, height, ropy),
            stone: mix(strewn.stone, Jet::splat(site.simd(), 0.8), ropy),
            tint: mix(strewn.tint, Jet::splat(site.simd(), 0.3), ropy),
        }
    }

    #[inline(always)]
    fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        let tone = Tone::of(form, site, footprint);
        let dry = self.wall_color(form, look, &tone);
        let color = dry.under(self.floor_color(form, &tone), form.floor);
        let dust = form.upward.step(0.55, 0.95) * (tone.broad * 0.4 + 0.55).within(0.0, 1.0) * 0.30;
        let color = color.tinted(self.colors.dust, dust).lit(tone.shade(form));
        let film = tone.film(form, look, form.floor * 0.21 + 0.04);
        let glazed = (-form.state + 1.0) * (-form.floor + 1.0) * tone.patch.step(-0.1, 0.4);
        let dry = tone.dry_roughness(form, glazed * -0.28 + 0.80);
        Paint {
            color: color.lit(film * -0.45 + 1.0),
            roughness: mix(dry, tone.wet_roughness(form), film),
            film,
            pool: Value::zero(site.simd()),
        }
    }
}

impl Basalt {
    #[inline(always)]
    fn wall_color<S: Simd>(&self, form: &Form<S>, look: &Look, tone: &Tone<S>) -> Color<S> {
        let colors = &self.colors;
        let light = (tone.broad * 0.55 + tone.fine * 0.62).step(-0.6, 0.65);
        let lining = ramp(light, colors.lining_dark, colors.lining_pale);
        let light = (tone.broad * 0.45 + tone.fine * 0.65).step(-0.55, 0.6);
        let spall = ramp(light, colors.spall_dark, colors.spall_pale);
        // Oxidation follows the flow levels.
        let [_, _, _, level, bloom, ..] = form.marks;
        let red = (level + tone.fine * 0.8 + form.cavity * 0.2).step(0.38, 0.58);
        // Air reached the back of the lining through its broken edge.
        let edge = form.state * (-form.state + 1.0) * 4.0;
        let ochre = (tone.streak + tone.fine * 0.6 + level * -0.4).step(0.55, 0.75) * tone.side;
        // Sulphates crystallise where water evaporates: in cracks, and in hollows of the roof.
        let roof = form.upward.step(0.1, -0.6);
        let bloom = (bloom + tone.fine * 0.6 + form.relief * 0.35 + form.crack * 0.3).step(0.55, 0.75) * roof;
        lining
            .under(spall, form.state * 0.8)
            .tinted(colors.oxide, red * (edge * 0.6 + form.state * 0.25 + 0.15) * (0.68 * look.stain))
            .tinted(colors.ochre, ochre * (0.25 * look.stain))
            .tinted(colors.sulphate, bloom * (0.50 * look.stain))
            .lit(form.crack * -0.65 + 1.0)
    }

    #[inline(always)]
    fn floor_color<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>) -> Color<S> {
        let colors = &self.colors;
        let light = tone.ground(form);
        let ash = ramp(light.step(-0.5, 0.6), colors.ash_dark, colors.ash_pale);
        let stone = ramp(tone.stone(form), colors.stone_dark, colors.stone_pale);
        let dusty = form.dust() * 0.6;
        ash.under(stone.under(ash, dusty), form.stone)
    }
}
