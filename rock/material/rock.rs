//! What a rock is: formulas for its wall, its floor, their detail and their colour.

use super::coarse::{Coarse, CoarseTone, MARKS};
use super::color::{Color, Shades};
use super::floor::{Debris, Sediment};
use super::site::{Footprint, Site};
use super::{DomainWarp, Look};
use crate::noise::{Ints, Jet, Lanes, Mask, Real, Value, Vec3, inlined};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Maximum recession of a rock behind the smooth wall, in metres.
pub const RECESS_M: f32 = 0.75;
/// Maximum protrusion into the passage, relative to half the width: a passage never closes.
pub const PROTRUSION: f32 = 0.25;

/// The shape of the wall.
#[derive(Clone, Copy, Debug)]
pub struct Wall<T> {
    /// Recession of the wall, metres.
    pub recess: T,
    /// The same without its longest undulation: determines where dirt and water collect.
    pub cavity: T,
    /// State of the rock: 0 the first, 1 the second.
    pub state: T,
    /// A number in 0–1 with a meaning specific to the rock, such as the hardness of the bed.
    pub band: T,
}

impl<S: Simd> Wall<Jet<S>> {
    /// The wall without gradients.
    #[inline(always)]
    pub(super) fn values(&self) -> Wall<Value<S>> {
        let value = inlined!(|number: Jet<S>| Value(number.value));
        Wall {
            recess: value(self.recess),
            cavity: value(self.cavity),
            state: value(self.state),
            band: value(self.band),
        }
    }
}

impl<T> Wall<T> {
    /// Another wall where the mask holds.
    #[inline(always)]
    pub(super) fn unless<S: Simd>(self, mask: Mask<S>, other: &Self) -> Self
    where
        T: Real<S>,
    {
        let pick = inlined!(|here: T, there: T| T::pick(mask, there, here));
        Self {
            recess: pick(self.recess, other.recess),
            cavity: pick(self.cavity, other.cavity),
            state: pick(self.state, other.state),
            band: pick(self.band, other.band),
        }
    }
}

/// Detail too fine for the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Detail<S: Simd> {
    /// Additional recession of the wall, metres.
    pub recess: Jet<S>,
    /// 1 in a crack, 0 outside.
    pub crack: Value<S>,
}

impl<S: Simd> Detail<S> {
    /// No detail.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        Self { recess: Jet::zero(simd), crack: Value::zero(simd) }
    }
}

/// The shape of the floor.
#[derive(Clone, Copy, Debug)]
pub struct Floor<T> {
    /// Height above the plane of the floor, metres.
    pub height: T,
    /// 1 on a stone, 0 between stones.
    pub stone: T,
    /// A random number in 0–1 per stone.
    pub tint: T,
}

/// Everything that determines a colour.
#[derive(Clone, Copy, Debug)]
pub struct Form<S: Simd> {
    /// The point.
    pub point: Vec3<Value<S>>,
    /// Upward component of the normal.
    pub upward: Value<S>,
    /// Height above the plane of the floor, metres.
    pub height: Value<S>,
    /// Depth in a hollow, about −1 to 1.
    pub cavity: Value<S>,
    /// Depth in a hollow of the finest relief: −1 on an edge, 1 in a gap.
    pub relief: Value<S>,
    /// See [`Wall::state`].
    pub state: Value<S>,
    /// See [`Wall::band`].
    pub band: Value<S>,
    /// See [`Detail::crack`].
    pub crack: Value<S>,
    /// 1 on the floor, 0 on the wall.
    pub floor: Value<S>,
    /// See [`Floor::stone`].
    pub stone: Value<S>,
    /// See [`Floor::tint`].
    pub tint: Value<S>,
    /// Variations that every rock has.
    pub tone: CoarseTone<S>,
    /// See [`Rock::marks`].
    pub marks: [Value<S>; MARKS],
}

impl<S: Simd> Form<S> {
    /// Depth of a hollow with a [`Form::relief`] of 1, in metres. Tuned.
    pub(super) const RELIEF_M: f32 = 0.014;

    /// How much dust lies here, 0–1: more in hollows.
    #[inline(always)]
    pub(super) fn dust(&self) -> Value<S> {
        (self.relief + 0.5).within(0.1, 0.9)
    }
}

/// Colour and gloss.
#[derive(Clone, Copy, Debug)]
pub struct Paint<S: Simd> {
    /// Base colour, linear RGB.
    pub color: Color<S>,
    /// Perceptual roughness, 0–1.
    pub roughness: Value<S>,
    /// Thickness of the water film, 0–1, which fills the finest relief.
    pub film: Value<S>,
    /// 1 where water stands level.
    pub pool: Value<S>,
}

/// Maximum steepness of the field near the wall: its change relative to the distance of two points. Tuned.
pub const STEEPEST: f32 = 12.0;
/// Maximum jump, in metres: stones on the floor jump by up to 3 cm where their cells meet. Tuned.
pub const JUMP_M: f32 = 0.05;

/// A rock as formulas over vector lanes. [`Rock::domain_warp`] and [`Rock::wall`] suffice; the rest has defaults.
///
/// Requirements, so that a mesh can represent its wall:
/// - The field has no jump of [`JUMP_M`] or more: the results of [`Rock::wall`] and [`Rock::floor`] are continuous over
///   space. A value of a bed or a cell must fade out towards its border, or match that of the next one there.
/// - It is nowhere steeper than [`STEEPEST`], for all settings within their ranges.
/// - No wavelength below 0.4 m: finer detail belongs in [`Rock::wall_detail`] and [`Rock::floor_detail`].
///
/// `field_laws.rs` searches for jumps and steep places along many lines near the wall.
pub trait Rock: std::fmt::Debug + Send + Sync {
    /// The domain warp.
    fn domain_warp(&self) -> DomainWarp;
    /// The wall.
    fn wall<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Wall<T>;

    /// A number along which the detail of the wall is laid out, such as the height in its beds. Varies slowly, see
    /// [`Coarse`].
    #[inline(always)]
    fn level<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> T {
        T::zero(site.simd())
    }

    /// Numbers of the rock's own that vary slowly, for its detail and its colour, such as where there are cracks.
    #[inline(always)]
    fn marks<S: Simd>(&self, site: &Site<Value<S>>) -> [Value<S>; MARKS] {
        [Value::zero(site.simd()); MARKS]
    }

    /// Finer detail of the wall.
    #[inline(always)]
    fn wall_detail<S: Simd>(&self, coarse: &Coarse<S>, _footprint: Footprint) -> Detail<S> {
        Detail::none(coarse.site.simd())
    }

    /// Whether its second state forms where water drips from the roof, as flowstone does.
    fn is_crusted_by_drips(&self) -> bool {
        false
    }

    /// What is on the floor.
    fn debris(&self) -> Debris {
        Debris::PLAIN
    }

    /// The floor; only its height affects the field.
    #[inline(always)]
    fn floor<S: Simd, T: Real<S>>(&self, site: &Site<T>, sediment: &Sediment<T>) -> Floor<T> {
        self.debris().floor(site, sediment)
    }

    /// The floor with finer detail.
    #[inline(always)]
    fn floor_detail<S: Simd>(&self, coarse: &Coarse<S>, floor: &Floor<Jet<S>>, footprint: Footprint) -> Floor<Jet<S>> {
        self.debris().detail(coarse, floor, footprint)
    }

    /// The range of colours of wall and floor.
    fn shades(&self) -> Shades {
        Shades::GREY
    }

    /// The colour.
    #[inline(always)]
    fn paint<S: Simd>(&self, form: &Form<S>, site: &Site<Value<S>>, look: &Look, footprint: Footprint) -> Paint<S> {
        self.shades().paint(form, site, look, footprint)
    }
}

/// A random number in 0–1 per level.
#[inline(always)]
pub(super) fn level_lot<S: Simd, T: Real<S>>(level: Ints<S>, salt: i32) -> T {
    let h = (level * 0x27d4_eb2d) ^ salt;
    let h = (h ^ (h >> 15)) * 0x2c1b_3c6d;
    let h = (h ^ (h >> 13)) * 0x297a_2d39;
    T::constant(((h >> 7) & 1023).to_float::<Lanes<S>>() * (1.0 / 1023.0))
}
