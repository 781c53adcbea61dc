//! Mixes colours in vector lanes, as linear RGB.

use super::Look;
use super::rock::{Form, Paint};
use super::site::{Footprint, Site};
use crate::noise::{Real, Value, Vec3, inlined, mix, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A constant colour: linear red, green and blue, each 0–1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Rgb(#[schemars(inner(range(min = 0.0, max = 1.0)))] pub [f32; 3]);

/// The colours of a rock as settings, each with its default. Defaults are tuned by eye.
macro_rules! palette {
    ($(#[$about:meta])* $name:ident { $($(#[$meaning:meta])* $key:ident: $default:expr,)* }) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize, ::serde::Deserialize, ::schemars::JsonSchema)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$meaning])* pub $key: $crate::material::Rgb,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $crate::material::Rgb($default),)* }
            }
        }
    };
}
pub(super) use palette;

/// A colour per lane.
pub type Color<S> = Vec3<Value<S>>;

/// Interpolates from one colour at 0 to another at 1.
#[inline(always)]
pub fn ramp<S: Simd>(t: Value<S>, Rgb(low): Rgb, Rgb(high): Rgb) -> Color<S> {
    vec3(t * (high[0] - low[0]) + low[0], t * (high[1] - low[1]) + low[1], t * (high[2] - low[2]) + low[2])
}

impl<S: Simd> Color<S> {
    /// Covers it with another colour, from 0 (not) to 1 (fully).
    #[inline(always)]
    pub fn under(self, cover: Self, share: Value<S>) -> Self {
        vec3(mix(self.x, cover.x, share), mix(self.y, cover.y, share), mix(self.z, cover.z, share))
    }

    /// Covers it with a constant colour, from 0 (not) to 1 (fully).
    #[inline(always)]
    pub fn tinted(self, Rgb(tint): Rgb, share: Value<S>) -> Self {
        let simd = share.0.token();
        let channel = inlined!(|i: usize| Value::splat(simd, tint[i]));
        self.under(vec3(channel(0), channel(1), channel(2)), share)
    }

    /// Brighter or darker.
    #[inline(always)]
    pub fn lit(self, by: Value<S>) -> Self {
        vec3(self.x * by, self.y * by, self.z * by)
    }
}

/// Colours of a rock without stains: the darkest and the lightest of wall and floor.
#[derive(Clone, Copy, Debug)]
pub struct Shades {
    /// Colours of the wall.
    pub wall: [[f32; 3]; 2],
    /// Colours of the floor.
    pub floor: [[f32; 3]; 2],
}

impl Shades {
    /// Grey rock, brown mud. Tuned by eye.
    pub const GREY: Self =
        Self { wall: [[0.10, 0.10, 0.10], [0.28, 0.27, 0.26]], floor: [[0.08, 0.07, 0.06], [0.18, 0.15, 0.12]] };

    /// Varies in patches, and is darker in cracks, hollows and wet places.
    #[inline(always)]
    pub fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        let simd = site.simd();
        let tone = Tone::of(form, site, footprint);
        let light = (tone.broad + tone.fine * 0.5).step(-0.7, 0.8);
        let ([wall_dark, wall_pale], [floor_dark, floor_pale]) = (self.wall.map(Rgb), self.floor.map(Rgb));
        let wall = ramp(light, wall_dark, wall_pale).lit(form.crack * -0.6 + 1.0);
        let color = wall.under(ramp(light, floor_dark, floor_pale), form.floor).lit(tone.shade(form));
        let film = tone.film(form, look, Value::zero(simd));
        Paint {
            color: color.lit(film * -0.45 + 1.0),
            roughness: mix(tone.dry_roughness(form, Value::splat(simd, 0.80)), tone.wet_roughness(form), film),
            film,
            pool: Value::zero(simd),
        }
    }
}

/// Variations shared by the colours of all rocks.
#[derive(Clone, Copy, Debug)]
pub struct Tone<S: Simd> {
    /// A decimetre and less, about ±1; lighter where the wall protrudes.
    pub fine: Value<S>,
    /// About a metre, about ±1.
    pub broad: Value<S>,
    /// The finest, about ±1.
    pub grain: Value<S>,
    /// Water runs: vertically stretched patches, about ±1.
    pub streak: Value<S>,
    /// Two metres, about ±1.
    pub patch: Value<S>,
    /// 1 on a vertical wall, 0 on floors and ceilings.
    pub side: Value<S>,
}

impl<S: Simd> Tone<S> {
    /// The variations at a point.
    #[inline(always)]
    pub fn of(form: &Form<S>, site: &Site<Value<S>>, footprint: Footprint) -> Self {
        let (p, n) = (form.point, site.source);
        let grain = n.noise(61, p.scaled(1.0 / 0.014)) * footprint.keep_noise(0.014);
        let fine = footprint.fbm(n, 62, p, 0.13, 0.62) * 0.52 - form.relief * 0.36;
        let streak = form.tone.streak + n.noise(64, p.stretched(9.0, 9.0, 0.6)) * 0.3;
        Self {
            fine: fine + grain * 0.25 - form.cavity.within(-1.0, 1.0) * 0.18,
            broad: form.tone.broad,
            grain,
            streak,
            patch: form.tone.patch,
            side: -form.upward.max(-form.upward) + 1.0,
        }
    }

    /// Lightness of loose ground, about ±1: hollows are dark.
    #[inline(always)]
    pub fn ground(&self, form: &Form<S>) -> Value<S> {
        self.fine * 0.50 + self.grain * 0.26 - form.relief * 0.45 + self.broad * 0.40
    }

    /// Lightness of stones, about 0 to 1: each has its own, and is mottled.
    #[inline(always)]
    pub fn stone(&self, form: &Form<S>) -> Value<S> {
        (form.tint + self.fine * 0.30 + self.grain * 0.20).within(0.0, 1.2)
    }

    /// Irregular dirt, more in hollows.
    #[inline(always)]
    pub fn shade(&self, form: &Form<S>) -> Value<S> {
        let hollow = form.cavity.step(0.0, 0.9) * -0.45 + 1.0;
        hollow * (self.fine * 0.28 + self.grain * 0.14 + 1.0)
    }

    /// Film of water, 0–1; reduced by `repelled`. The share of the wall under a film is 0.6 times the humidity.
    #[inline(always)]
    pub fn film(&self, form: &Form<S>, look: &Look, repelled: Value<S>) -> Value<S> {
        // Quantile of the wetness: fitted to its distribution over the walls of all rocks.
        let driest_wet = 0.85 - 0.93 * look.humidity.sqrt();
        let wetness = self.streak + form.cavity * 0.35 - repelled;
        let wet = (wetness - driest_wet).step(-0.13, 0.07);
        wet * (self.side * 0.35 + 0.65) * (look.humidity * 10.0).min(1.0)
    }

    /// Roughness of dry rock: crests are worn, hollows hold dust, grains differ, and each stone has its own.
    #[inline(always)]
    pub fn dry_roughness(&self, form: &Form<S>, mean: Value<S>) -> Value<S> {
        let stone = (form.tint - 0.5) * form.stone * 0.16;
        (mean + form.relief * 0.34 - self.fine * 0.30 - self.grain * 0.22 + stone).within(0.42, 1.0)
    }

    /// Roughness of rock under a full film: crests stick out of it.
    #[inline(always)]
    pub fn wet_roughness(&self, form: &Form<S>) -> Value<S> {
        (self.fine * 0.05 - form.relief * 0.07 + 0.20).within(0.08, 0.34)
    }
}
