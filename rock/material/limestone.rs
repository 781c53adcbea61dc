//! Limestone of a karst cave.
//!
//! First state: bedded rock, stepped along one dip through the whole cave, with solution pockets, joints and scallops
//! (Curl 1974). Second state: flowstone, draped by gravity. The floor is mud with puddles and embedded cobbles.

mod colors;

pub use colors::LimestoneColors;

use super::coarse::{Coarse, MARKS};
use super::color::{Color, Tone, ramp};
use super::floor::Debris;
use super::rock::{Detail, Floor, Form, Paint, Rock, Wall, level_lot};
use super::rubble::Rubble;
use super::site::{Footprint, Site};
use super::{DomainWarp, Look};
use crate::noise::{Jet, Real, Source, Value, cells_2d, cells_3d, facets, hollows, inlined, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shape of the limestone; defaults tuned by eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Limestone {
    /// Strength of the relief; 1 is natural, 0 a smooth tube.
    #[schemars(range(min = 0.0, max = 1.5))]
    pub relief: f32,
    /// How far the walls deviate from the smooth passage, in metres.
    #[schemars(range(min = 0.0, max = 1.2))]
    pub wander_m: f32,
    /// Share of the wall covered by flowstone: about −0.6 none, 0 half, 0.6 all.
    #[schemars(range(min = -0.6, max = 0.6))]
    pub flowstone: f32,
    /// Mean thickness of a bed, in metres.
    #[schemars(range(min = 0.4, max = 1.5))]
    pub bed_m: f32,
    /// Dip of the beds, in degrees from the horizontal.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub dip_deg: f32,
    /// Dip direction of the beds, in degrees from x towards y.
    #[schemars(range(min = 0.0, max = 360.0))]
    pub dip_azimuth_deg: f32,
    /// Direction of the joints, in degrees from x towards y.
    #[schemars(range(min = 0.0, max = 180.0))]
    pub joint_azimuth_deg: f32,
    /// Density of stones on the floor: −0.5 clear, 0.5 covered.
    #[schemars(range(min = -0.5, max = 0.5))]
    pub rubble: f32,
    /// Its colours, as linear red, green and blue, each 0 to 1.
    pub colors: LimestoneColors,
}

impl Default for Limestone {
    fn default() -> Self {
        Self {
            relief: 1.0,
            wander_m: 0.75,
            flowstone: -0.2,
            bed_m: 0.62,
            dip_deg: 11.0,
            dip_azimuth_deg: 328.0,
            joint_azimuth_deg: 60.0,
            rubble: -0.05,
            colors: LimestoneColors::default(),
        }
    }
}

/// A bed, and the position of a point in it.
struct Bed<T> {
    /// Hardness of the bed at the point, 0–1.
    hardness: T,
    /// Height in the bed, 0 bottom to 1 top.
    rest: T,
    /// Openness of the parting above it, 0–1.
    parting: T,
    /// Where the joints of the bed lie, relative to their spacing.
    joints: [T; 2],
    /// How clearly its laminae show, 0–1.
    platy: T,
}

impl Limestone {
    /// Normal of the beds, upwards.
    fn pole(&self) -> [f32; 3] {
        let (dip, azimuth) = (self.dip_deg.to_radians(), self.dip_azimuth_deg.to_radians());
        let across = libm::sinf(dip);
        [across * libm::cosf(azimuth), across * libm::sinf(azimuth), libm::cosf(dip)]
    }

    /// The bed at this [`Rock::level`].
    #[inline(always)]
    fn bed<S: Simd, T: Real<S>>(n: Source, level: T) -> Bed<T> {
        let (index, rest) = level.split();
        let lot = inlined!(|index, layer| level_lot::<S, T>(index, n.layer(layer)));
        // Each bed begins at an individual height, so that partings are unevenly spaced.
        let edge = lot(index, 14) * 0.28 - 0.14;
        let rest_here = rest - edge * (rest * (-rest + 1.0) * 4.0);
        let hardness = mix(lot(index, 12), lot(index + 1, 12), rest_here.step(0.52, 1.0));
        Bed {
            hardness,
            rest: rest_here,
            parting: lot(index, 15).squared(),
            joints: [lot(index, 52), lot(index, 53)],
            platy: lot(index, 58).step(0.35, 0.75),
        }
    }

    /// Coordinates across and along the joints, metres.
    #[inline(always)]
    fn jointed<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> [T; 2] {
        let p = site.point;
        let azimuth = self.joint_azimuth_deg.to_radians();
        let (sine, cosine) = (libm::sinf(azimuth), libm::cosf(azimuth));
        [p.x * -sine + p.y * cosine, p.x * cosine + p.y * sine]
    }

    /// Distance to the nearest crack, metres. Cracks follow the two sets of joints, and end at the partings of their bed,
    /// where those of the next one are offset.
    #[inline(always)]
    fn crack_distance<S: Simd>(&self, site: &Site<Jet<S>>, bend: Value<S>, bed: &Bed<Jet<S>>) -> Jet<S> {
        /// Mean distances between the cracks of a set, metres.
        const SPACING_M: [f32; 2] = [0.9, 1.5];
        let [across, along] = self.jointed(site);
        let bend = Jet::constant(bend.0);
        let distance = inlined!(|at: Jet<S>, set: usize| {
            let (_, place) = ((at + bend) * (1.0 / SPACING_M[set]) + bed.joints[set]).split();
            let off = (place - 0.5) * SPACING_M[set];
            off.max(-off)
        });
        distance(across, 0).min(distance(along, 1))
    }

    /// 1 in the seams between the laminae of a bed, which are unevenly thick and do not all show.
    #[inline(always)]
    fn laminae<S: Simd>(&self, n: Source, level: Jet<S>, bed: &Bed<Jet<S>>, footprint: Footprint) -> Jet<S> {
        let (index, rest) = (level * (self.bed_m / LAMINA_M)).split();
        let lot = inlined!(|layer: u32| level_lot::<S, Jet<S>>(index, n.layer(layer)));
        let seam = (rest - lot(59) * 0.7 - 0.15) * LAMINA_M;
        footprint.line(seam, 0.009) * (lot(60) * bed.platy)
    }

    /// Recess by running water: a notch along the foot of the walls, with an overhang, where a stream stood at that height for
    /// long; and a channel along the middle of the roof, made by the same water when it filled the passage.
    #[inline(always)]
    fn carved<S: Simd, T: Real<S>>(site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        let level = site.height - n.noise(18, p.scaled(1.0 / 9.0)) * 0.45;
        let notch =
            level.step(0.25, 0.75) * level.step(1.10, 0.82) * n.noise(19, p.scaled(1.0 / 6.0)).step(-0.20, 0.15);
        let channel = ((-site.up + 1.0) * (1.0 / 0.10)).bump() * n.noise(20, p.scaled(1.0 / 7.0)).step(-0.05, 0.20);
        notch * 0.30 + channel * 0.38
    }

    /// 0 on a joint, about ±1 away from it.
    #[inline(always)]
    fn joints<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        let [across, along] = self.jointed(site);
        let bend = n.noise(16, p.scaled(0.5)) * 0.12;
        let at = vec3(across * (1.0 / 2.6) + bend, along * (1.0 / 11.0), p.z * 0.125);
        n.noise(17, at)
    }
}

const BLOCKS: Rubble =
    Rubble { layer: 31, cell_m: 1.2, rise: [0.35, 0.65], tilt: 1.2, flank: 5.5, rounding: 0.12, fillet: 0.10 };
const COBBLES: Rubble =
    Rubble { layer: 32, cell_m: 0.5, rise: [0.15, 0.4], tilt: 0.8, flank: 2.6, rounding: 0.15, fillet: 0.12 };

/// Mean thickness of laminae, metres.
const LAMINA_M: f32 = 0.075;
/// Mean width of the plates into which drying mud cracks, metres.
const PLATE_M: f32 = 0.15;
/// How much steeper scallops are on their upstream side (Curl 1974). Tuned.
const SCALLOP_SKEW: f32 = 0.55;

impl Rock for Limestone {
    fn domain_warp(&self) -> DomainWarp {
        DomainWarp { length_m: [6.0, 2.4], reach_m: [self.wander_m, self.wander_m / 3.0] }
    }

    #[inline(always)]
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T> {
        let (p, n) = (site.point, site.source);
        let ceiling = site.up.step(0.2, 0.8);
        let undulation = n.fbm(1, p.scaled(1.0 / 3.6), 2, 0.54) * 0.24;
        let bed = Self::bed(n, self.level(site));
        let show = n.noise(13, p.stretched(0.25, 0.25, 0.5)).step(-0.60, 0.05) * 0.55 + 0.45;
        let belly = bed.rest * (-bed.rest + 1.0) * 0.16;
        let beds = ((bed.hardness - 0.5) * 0.66 - belly) * show;
        let pocket = cells_3d(n.warp(2, p, 1.5, 0.2).stretched(1.0 / 2.0, 1.0 / 1.5, 1.0 / 1.3), n.layer(3));
        let pocket = (-pocket.distance.squared() + 0.30) * (ceiling * 0.28 + 0.24);
        let fissure = self.joints(site);
        let joint = (fissure * 5.0).bump() * (ceiling * 0.55 + 0.16);
        // Water comes out of joints and runs down, so flowstone forms only near joints.
        let cover = (fissure * 3.0).bump() * 0.9 - 0.40 - ceiling * 0.5 + n.noise(5, p.stretched(1.0, 1.0, 0.2)) * 0.4;
        let flow = (cover + self.flowstone).step(0.0, 0.42) * site.height.step(0.0, 0.5);
        let rock = beds + pocket + joint;
        let carved = Self::carved(site);
        let mut form = rock + carved;
        if flow.value().simd_gt(0.0).any_true() {
            let curtain = n.noise(6, p.stretched(2.2, 2.2, 0.30)).soft_abs(0.06) * -0.15;
            let drape = curtain + n.noise(7, p.stretched(2.5, 2.5, 0.7)) * 0.04 - 0.10;
            form = mix(form, drape + beds * 0.25, flow);
        }
        Wall { recess: (undulation + form) * self.relief, cavity: rock, state: flow, band: bed.hardness }
    }

    #[inline(always)]
    fn level<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        let (p, n) = (site.point, site.source);
        let rise = p.along(self.pole()) * (1.0 / self.bed_m);
        rise + n.noise(10, p.scaled(0.25)) * 0.22 + n.noise(11, p.scaled(1.0 / 1.2)) * 0.06
    }

    #[inline(always)]
    fn marks<S: Simd>(&self, site: &Site<Value<S>>) -> [Value<S>; MARKS] {
        let (p, n) = (site.point, site.source);
        let none = Value::zero(site.simd());
        let open = n.noise(50, p.stretched(0.7, 0.7, 1.4)).step(-0.25, 0.45);
        let scalloped = n.noise(40, p.scaled(1.0 / 3.4)).step(-0.25, 0.15);
        // Interrupted: the mask is about as long as a bed is thick.
        let cracked = n.noise(45, p.scaled(1.0 / 0.9)).step(0.05, 0.50);
        let bend = n.noise(43, p.scaled(1.6)) * 0.06;
        let curtain = n.noise(66, p.stretched(2.2, 2.2, 0.35));
        let calcite = n.noise(67, p.scaled(1.0 / 1.3));
        let dried = n.noise(54, p.scaled(1.0 / 2.5)).step(0.0, 0.25);
        [open, scalloped, cracked, bend, curtain, calcite, dried, none, none, none]
    }

    #[inline(always)]
    fn wall_detail<S: Simd>(&self, coarse: &Coarse<S>, footprint: Footprint) -> Detail<S> {
        let (site, flow) = (&coarse.site, coarse.wall.state);
        let (p, n) = (site.point, site.source);
        let mut detail = Detail::none(site.simd());
        if flow.0.simd_lt(1.0).any_true() {
            let [open, scalloped, cracked, bend, ..] = coarse.marks;
            let bed = Self::bed(n, coarse.level);
            let grain = footprint.fbm(n, 46, p, 0.13, 0.58) * 0.017;
            // Seams weather unevenly.
            let ragged = coarse.level + grain * (0.8 / self.bed_m);
            let parting = footprint.line((bed.rest - 0.86) * self.bed_m + grain * 0.8, 0.032) * open;
            let groove = parting * (bed.parting * 0.05 + 0.012);
            let laminae = self.laminae(n, ragged, &bed, footprint) * (open * 0.6 + 0.4);
            let mut scallops = Jet::zero(site.simd());
            if scalloped.0.simd_gt(0.0).any_true() {
                let drift = inlined!(|along: Jet<S>| along.value() * SCALLOP_SKEW);
                let drift = [drift(site.flow.x), drift(site.flow.y), drift(site.flow.z)];
                let at = p.stretched(1.0 / 0.30, 1.0 / 0.30, 1.0 / 0.24);
                scallops = (-hollows(at, drift, n.layer(42)) + 0.30) * (scalloped * 0.095);
            }
            // Interpolated, so a little more than 1 in some places.
            let broken = (-scalloped + 1.0).at_least(0.0) * (0.022 * footprint.keep(0.14));
            let mut chips = Jet::zero(site.simd());
            if broken.0.simd_gt(0.0).any_true() {
                chips = facets(p.turned().scaled(1.0 / 0.14), 1.0, n.layer(57)) * broken;
            }
            let crack = footprint.line(self.crack_distance(site, bend, &bed), 0.018) * cracked;
            let ribs = n.ridged(47, p.stretched(2.2, 2.2, 3.2), 2, 0.54) * -0.026;
            let open = groove + laminae * 0.007 + crack * 0.015;
            detail.recess = (scallops + open + chips + grain + ribs) * (-flow + 1.0);
            let dark = Value((parting * bed.parting).value).max(Value(laminae.value) * 0.5);
            detail.crack = Value(crack.value).max(dark) * (-flow + 1.0);
        }
        if flow.0.simd_gt(0.0).any_true() {
            let gours = n.noise(48, p.stretched(5.0, 5.0, 26.0)).soft_abs(0.06) * (-0.014 * footprint.keep(0.04));
            let grain = footprint.fbm(n, 49, p.stretched(1.0, 1.0, 0.55), 0.11, 0.5) * 0.005;
            let flutes = n.noise(51, p.stretched(7.0, 7.0, 0.7)).soft_abs(0.05) * (-0.03 * footprint.keep(0.10));
            detail.recess = detail.recess + (gours + flutes + grain) * flow;
        }
        detail
    }

    fn is_crusted_by_drips(&self) -> bool {
        true
    }

    fn debris(&self) -> Debris {
        Debris {
            swell_m: 3.2,
            sunk_m: 0.0,
            stones: [BLOCKS, COBBLES],
            amount: self.rubble,
            more: 0.06,
            bank: 0.7,
            patches: 0.40,
            patches_per_m: 0.3,
        }
    }

    #[inline(always)]
    fn floor_detail<S: Simd>(&self, coarse: &Coarse<S>, floor: &Floor<Jet<S>>, footprint: Footprint) -> Floor<Jet<S>> {
        let strewn = self.debris().detail(coarse, floor, footprint);
        let (p, n) = (coarse.site.point, coarse.site.source);
        let [_, _, _, _, _, _, dried, ..] = coarse.marks;
        let dried = (-strewn.stone + 1.0) * dried;
        if dried.value().simd_le(0.0).all_true() {
            return strewn;
        }
        let edge = cells_2d(n.warp(55, p, 0.12, 0.02).scaled(1.0 / PLATE_M), n.layer(56)).edge * PLATE_M;
        let crack = footprint.line(edge, 0.014);
        // Plates of mud curl up at their rims as they dry.
        let curl = (-edge * (1.0 / 0.045) + 1.0).at_least(0.0).squared() * 0.006;
        Floor { height: strewn.height + (curl - crack * 0.007) * dried, ..strewn }
    }

    #[inline(always)]
    fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        let tone = Tone::of(form, site, footprint);
        let wall = self.wall_color(form, site, look, &tone);
        let color = wall.under(self.floor_color(form, &tone), form.floor);
        let color = color.lit(tone.shade(form));
        let level = tone.patch * 0.06 + (look.humidity * 0.12 - 0.09) - form.height;
        let damp = (level + 0.05).step(0.0, 0.06) * form.floor;
        let pool = level.step(0.0, 0.012) * form.floor * (look.humidity * 10.0).min(1.0);
        let film = tone.film(form, look, form.state * -0.10 + form.floor * 0.6);
        let film = film.max(damp * 0.5).max(pool);
        // Flowstone has little relief, but finer and coarser crystals.
        let crystals = tone.grain * form.state * -0.35;
        let dry = tone.dry_roughness(form, form.state * -0.22 + crystals + 0.78);
        let color = color.lit(film * -0.50 + 1.0);
        Paint {
            color: vec3(color.x, color.y * (film * -0.02 + 1.0), color.z * (film * -0.06 + 1.0)),
            roughness: mix(dry, mix(tone.wet_roughness(form), Value::splat(site.simd(), 0.10), pool), film),
            film,
            pool,
        }
    }
}

impl Limestone {
    #[inline(always)]
    fn wall_color<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, tone: &Tone<S>) -> Color<S> {
        let colors = &self.colors;
        let (p, n) = (form.point, site.source);
        let side = tone.side;
        // Each bed has its own grey; broad patches only vary it.
        let shade = (form.band - 0.5) * -1.2 + tone.fine * 0.82 + tone.broad * 0.15 - form.cavity * 0.30;
        let rock = ramp(shade.step(-0.7, 0.75), colors.bed_dark, colors.bed_pale);
        let marl = form.band.step(0.60, 0.80) * 0.7;
        let iron = (tone.streak + tone.fine * 0.7 + form.cavity * 0.3).step(0.38, 0.66) * side;
        let [_, _, _, _, curtain, calcite, ..] = form.marks;
        let manganese = (curtain + tone.fine * 0.8 + form.relief * 0.25 + form.cavity * 0.4).step(0.50, 0.66);
        let calcite = (calcite + tone.fine * 0.9 - form.cavity * 0.5).step(0.54, 0.70);
        let tide = (tone.broad * 0.25 + tone.fine * 0.18 + 0.75 - form.height).step(0.0, 0.06);
        let mut color = rock
            .under(rock.lit(Value::splat(site.simd(), 0.58)), marl)
            .tinted(colors.iron, iron * (0.70 * look.stain))
            .tinted(colors.manganese, manganese * (0.56 * look.stain))
            .tinted(colors.calcite, calcite * (0.45 * look.stain));
        let clayey = tone.patch.step(0.0, 0.3) * (-form.state + 1.0);
        if clayey.0.simd_gt(0.0).any_true() {
            // Clay that a film of water drew together into spots and worms as it dried (vermiculations).
            let spots = (n.noise(69, p.scaled(1.0 / 0.09)) + form.relief * 0.15).step(0.12, 0.24);
            color = color.tinted(colors.clay, spots * clayey * (0.76 * look.stain));
        }
        let flow = (form.state + tone.fine * 0.12).step(0.22, 0.45) * 0.9;
        if flow.0.simd_gt(0.0).any_true() {
            let banding = tone.streak + n.noise(68, p.stretched(11.0, 11.0, 1.2)) * 0.3;
            let flowstone = ramp(banding.step(-0.1, 0.7), colors.flowstone_pale, colors.flowstone_dark);
            color = color.under(flowstone, flow);
        }
        color
            .lit(form.crack * -0.55 + 1.0)
            .tinted(colors.silt, (form.upward + tone.fine * 0.20).step(0.66, 0.90) * (form.relief * 0.35 + 0.5))
            .tinted(colors.flood_mud, tide * (form.relief * 0.35 + 0.62))
    }

    #[inline(always)]
    fn floor_color<S: Simd>(&self, form: &Form<S>, tone: &Tone<S>) -> Color<S> {
        let colors = &self.colors;
        let light = tone.ground(form);
        let mud = ramp(light.step(-0.7, 0.8), colors.mud_dark, colors.mud_pale);
        let stone = ramp(tone.stone(form), colors.stone_dark, colors.stone_pale);
        let dusty = form.dust() * 0.65;
        mud.under(stone.under(mud, dusty), form.stone)
    }
}
