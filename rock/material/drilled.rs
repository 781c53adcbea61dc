//! Rock of a mine, excavated by drilling and blasting.
//!
//! First state: the rock broke along its joints, in planar faces with steps between them (overbreak). Second state: it broke
//! along the line of drill holes, whose far halves remain in the wall as half barrels. The floor is muck, graded for traffic
//! in the middle (after Hustrulid, *Blasting Principles for Open Pit Mining*, 1999, chapter on wall control).
//!
//! Not promised: holes follow the floor and the middle of the roof, not a drilling plan.

mod colors;

pub use colors::DrilledColors;

use super::coarse::{Coarse, MARKS};
use super::color::{Color, Tone, ramp};
use super::floor::Debris;
use super::rock::{Detail, Form, Paint, Rock, Wall, level_lot};
use super::rubble::Rubble;
use super::site::{Footprint, Site};
use super::{DomainWarp, Look};
use crate::noise::{Jet, Real, Value, facets, inlined, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shape and kind of the blasted rock; defaults tuned by eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Drilled {
    /// Which rock the mine is in.
    pub lithology: Lithology,
    /// Strength of the relief; 1 is natural, 0 a smooth drift.
    #[schemars(range(min = 0.0, max = 1.5))]
    pub relief: f32,
    /// How far the walls deviate from the planned drift, in metres.
    #[schemars(range(min = 0.0, max = 1.2))]
    pub wander_m: f32,
    /// Share of the wall that broke along joints instead of drill holes: about −0.6 none, 0 half, 0.6 all.
    #[schemars(range(min = -0.6, max = 0.6))]
    pub overbreak: f32,
    /// Distance between joints, in metres.
    #[schemars(range(min = 0.6, max = 2.0))]
    pub joint_m: f32,
    /// Direction of the main joints, in degrees from x towards y.
    #[schemars(range(min = 0.0, max = 180.0))]
    pub joint_azimuth_deg: f32,
    /// Distance between drill holes, in metres.
    #[schemars(range(min = 0.4, max = 1.5))]
    pub hole_m: f32,
    /// Density of muck on the floor: −0.5 clear, 0.5 covered.
    #[schemars(range(min = -0.5, max = 0.5))]
    pub rubble: f32,
    /// Its colours, as linear red, green and blue, each 0 to 1. Of granite, ore and coal, those of the chosen lithology are used.
    pub colors: DrilledColors,
}

/// The rock of a mine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Lithology {
    /// Grey granite with pale veins.
    Granite,
    /// Dark host rock with quartz veins and rusty sulphides.
    Ore,
    /// Black coal between bands of grey mudstone.
    Coal,
}

impl Default for Drilled {
    fn default() -> Self {
        Self {
            lithology: Lithology::Granite,
            relief: 1.0,
            wander_m: 0.25,
            overbreak: 0.05,
            joint_m: 1.1,
            joint_azimuth_deg: 35.0,
            hole_m: 0.8,
            rubble: -0.05,
            colors: DrilledColors::default(),
        }
    }
}

/// Radius of a drill hole, metres.
const HOLE_RADIUS_M: f32 = 0.035;
/// Normals of the joint sets for an azimuth of 0, the third nearly level.
const JOINTS: [[f32; 3]; 3] = [[0.97, 0.10, 0.22], [-0.16, 0.95, -0.27], [0.12, -0.20, 0.97]];
/// Distance of the joints of each set, relative to [`Drilled::joint_m`].
const SPACINGS: [f32; 3] = [1.0, 1.35, 0.8];

impl Drilled {
    /// Recess of the faces between joints: level in each block, with a step to the next.
    #[inline(always)]
    fn blocks<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        let azimuth = self.joint_azimuth_deg.to_radians();
        let (sine, cosine) = (libm::sinf(azimuth), libm::cosf(azimuth));
        let turned = vec3(p.x * cosine + p.y * sine, p.y * cosine - p.x * sine, p.z);
        let mut recess = T::zero(site.simd());
        for (set, normal) in JOINTS.into_iter().enumerate() {
            let layer = 10 + 3 * set as u32;
            let bend = n.noise(layer, p.scaled(1.0 / 3.0)) * 0.12;
            let (index, rest) = (turned.along(normal) * (1.0 / (self.joint_m * SPACINGS[set])) + bend).split();
            let lot = inlined!(|index| level_lot::<S, T>(index, n.layer(layer + 1)));
            recess = recess + (mix(lot(index), lot(index + 1), rest.step(0.83, 1.0)) - 0.5) * 0.24;
        }
        recess
    }

    /// 1 on the axis of a half barrel, 0 outside. `drift` is how far holes deviate, `seen` is positive where half of the hole
    /// may remain.
    #[inline(always)]
    fn barrels<S: Simd>(&self, site: &Site<Jet<S>>, [drift, seen]: [Value<S>; 2], footprint: Footprint) -> Jet<S> {
        let roof = site.up.value().simd_gt(0.62);
        let sideways = (-site.up.squared() + 1.0).at_least(0.0).sqrt() * site.half_width;
        let around = Jet::pick(roof, sideways, site.height);
        let (index, place) = ((around + Jet::constant(drift.0)) * (1.0 / self.hole_m)).split();
        let seen = level_lot::<S, Value<S>>(index, site.source.layer(44)) * 0.7 - 0.35 + seen;
        footprint.line((place - 0.5) * self.hole_m, HOLE_RADIUS_M) * seen.step(-0.02, 0.10)
    }
}

const LUMPS: Rubble =
    Rubble { layer: 31, cell_m: 0.9, rise: [0.30, 0.70], tilt: 1.2, flank: 4.2, rounding: 0.08, fillet: 0.10 };
const MUCK: Rubble =
    Rubble { layer: 32, cell_m: 0.42, rise: [0.20, 0.45], tilt: 1.0, flank: 2.3, rounding: 0.08, fillet: 0.10 };

impl Rock for Drilled {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [8.0, 3.0], reach_m: [self.wander_m, self.wander_m / 3.0] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let (p, n) = (site.point, site.source);
        let patches = n.noise(1, p.scaled(1.0 / 4.0)) + n.noise(2, p.scaled(1.0 / 1.5)) * 0.3;
        let ceiling = site.up.step(0.2, 0.8);
        let broken = (patches + self.overbreak + ceiling * 0.15).step(-0.08, 0.22);
        let small = facets(p.scaled(1.0 / 0.45), 1.0, n.layer(6)) * 0.04;
        let faces = self.blocks(site) + facets(p.scaled(1.0 / 0.9).turned(), 1.0, n.layer(4)) * 0.13 + small;
        let trimmed = facets(p.scaled(1.0 / 1.1), 0.9, n.layer(5)) * 0.06 + small * 0.4;
        let form = mix(trimmed, faces + 0.10, broken);
        Wall { recess: form * self.relief, cavity: form, state: broken, band: T::zero(site.simd()) }
    }

    #[inline(always)]
    fn marks<S: Simd>(&self, site: &Site<Value<S>>) -> [Value<S>; MARKS] {
        let (p, n) = (site.point, site.source);
        let none = Value::zero(site.simd());
        let w = n.warp(40, p, 0.7, 0.06);
        let drift = n.noise(43, p.scaled(0.25)) * 0.12;
        let seen = n.noise(45, p.scaled(0.4));
        let rust = n.noise(66, p.stretched(0.6, 0.6, 0.25));
        let lime = n.noise(67, p.stretched(1.6, 1.6, 0.25));
        let bent = n.warp(68, p, 2.5, 0.35);
        let [vein, other] = match self.lithology {
            Lithology::Granite => [n.noise(72, bent.scaled(0.16)) * 4.0, none],
            Lithology::Ore => [n.noise(72, bent.stretched(0.20, 0.20, 0.35)) * 3.0, n.noise(73, bent.scaled(1.4))],
            Lithology::Coal => [bent.z * (1.0 / 0.55) + n.noise(74, p.scaled(0.2)) * 0.5, none],
        };
        [w.x - p.x, w.y - p.y, w.z - p.z, drift, seen, rust, lime, vein, other, none]
    }

    #[inline(always)]
    fn wall_detail<S: Simd>(&self, coarse: &Coarse<S>, footprint: Footprint) -> Detail<S> {
        let (site, broken) = (&coarse.site, coarse.wall.state);
        let (p, n) = (site.point, site.source);
        let [dx, dy, dz, drift, seen, ..] = coarse.marks;
        let shift = inlined!(|by: Value<S>| Jet::constant(by.0));
        let w = vec3(p.x + shift(dx), p.y + shift(dy), p.z + shift(dz));
        let chips = facets(w.scaled(1.0 / 0.26), 1.1, n.layer(41)) * (0.030 * footprint.keep(0.26));
        let splinters = facets(w.turned().scaled(1.0 / 0.085), 1.1, n.layer(42)) * (0.012 * footprint.keep(0.085));
        let grain = footprint.fbm(n, 46, p, 0.14, 0.66) * 0.0134;
        let mut recess = (chips + splinters) * (broken * 0.6 + 0.4) + grain;
        let mut crack = Value::zero(site.simd());
        if broken.0.simd_lt(1.0).any_true() {
            let barrel = self.barrels(site, [drift, seen], footprint) * (-broken + 1.0);
            recess = recess * (-barrel + 1.0) + barrel * (HOLE_RADIUS_M * 0.8);
            crack = Value(barrel.value) * 0.25;
        }
        Detail { recess: recess * self.relief.min(1.0), crack }
    }

    fn debris(&self) -> Debris {
        Debris {
            swell_m: 4.0,
            sunk_m: 0.0,
            stones: [LUMPS, MUCK],
            amount: self.rubble,
            more: 0.0,
            bank: 0.85,
            patches: 0.35,
            patches_per_m: 0.3,
        }
    }

    #[inline(always)]
    fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        let tone = Tone::of(form, site, footprint);
        let rock = self.rock_color(form, site, footprint, &tone);
        let [_, _, _, _, _, rust, lime, ..] = form.marks;
        let rust = (tone.streak + tone.fine * 0.5 + rust * 0.6).step(0.45, 0.85);
        let lime = (lime + tone.fine * 0.4 - form.cavity * 0.2).step(0.50, 0.80);
        let wall = rock
            .tinted(self.colors.rust, rust * tone.side * (0.45 * look.stain))
            .tinted(self.colors.lime, lime * tone.side * (0.35 * look.stain))
            .lit(form.crack * -0.45 + 1.0);
        // Dust of drilling and blasting settles on ledges.
        let dust = form.upward.step(0.45, 0.9) * (tone.broad * 0.3 + 0.5);
        let wall = wall.under(self.fines(form, &tone, rock), dust);
        let color = wall.under(self.muck(form, &tone, rock), form.floor).lit(tone.shade(form));
        let film = tone.film(form, look, form.floor * 0.15);
        let dry = tone.dry_roughness(form, Value::splat(site.simd(), self.mean_roughness()));
        Paint {
            color: color.lit(film * -0.45 + 1.0),
            roughness: mix(dry, tone.wet_roughness(form), film),
            film,
            pool: Value::zero(site.simd()),
        }
    }
}

impl Drilled {
    fn mean_roughness(&self) -> f32 {
        match self.lithology {
            Lithology::Granite => 0.82,
            Lithology::Ore => 0.76,
            Lithology::Coal => 0.62,
        }
    }

    /// Fresh rock.
    #[inline(always)]
    fn rock_color<S: Simd>(
        &self,
        form: &Form<S>,
        site: &Site<Value<S>>,
        footprint: Footprint,
        tone: &Tone<S>,
    ) -> Color<S> {
        let (p, n) = (form.point, site.source);
        let colors = &self.colors;
        let light = tone.broad * 0.10 + tone.fine * 0.40;
        let [_, _, _, _, _, _, _, vein, other, _] = form.marks;
        // Muck is mixed, so no vein runs through it.
        let whole = -form.floor + 1.0;
        match self.lithology {
            Lithology::Granite => {
                let crystals = n.noise(71, p.scaled(1.0 / 0.022)) * footprint.keep_noise(0.022);
                let pale = crystals.step(0.08, 0.30) * 0.36;
                let dark = (-crystals).step(0.14, 0.36) * 0.46;
                let vein = footprint.line(vein, 0.05) * whole;
                ramp(light.step(-0.8, 0.8), colors.granite_dark, colors.granite_pale)
                    .tinted(colors.granite_feldspar, pale)
                    .tinted(colors.granite_mica, dark)
                    .tinted(colors.granite_vein, vein * 0.8)
            }
            Lithology::Ore => {
                let quartz = footprint.line(vein, 0.08) * whole;
                let sulphide = (other + quartz * 0.5 + tone.fine * 0.5).step(0.35, 0.60);
                ramp(light.step(-0.8, 0.8), colors.ore_dark, colors.ore_pale)
                    .tinted(colors.ore_sulphide, sulphide * 0.65)
                    .tinted(colors.ore_quartz, quartz * 0.85)
            }
            Lithology::Coal => {
                let (index, _) = vein.split();
                let mudstone = level_lot::<S, Value<S>>(index, n.layer(75)).step(0.70, 0.72);
                let bright = n.noise(76, p.stretched(1.5, 1.5, 30.0)) * footprint.keep(0.033);
                let coal = ramp((light + bright * 0.8).step(-0.8, 0.8), colors.coal_dark, colors.coal_pale);
                coal.under(ramp(light.step(-0.8, 0.8), colors.mudstone_dark, colors.mudstone_pale), mudstone)
            }
        }
    }

    /// Dust and mud: rock ground fine, lighter where it is dry.
    #[inline(always)]
    fn fines<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>, rock: Color<S>) -> Color<S> {
        let light = tone.ground(form);
        let ground = ramp(light.step(-0.7, 0.8), self.colors.fines_dark, self.colors.fines_pale);
        ground.under(rock, Value::splat(form.relief.0.token(), 0.35))
    }

    /// Muck: broken rock between fines.
    #[inline(always)]
    fn muck<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>, rock: Color<S>) -> Color<S> {
        let fines = self.fines(form, tone, rock);
        let stone = rock.lit(form.tint * 1.2 + 0.50);
        let dusty = form.dust() * 0.4;
        fines.under(stone.under(fines, dusty), form.stone)
    }
}
