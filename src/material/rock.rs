//! Combines relief, floor and detail of a rock into one field, in the same way for every rock.

use super::color::{Color, Shades};
use super::floor::Debris;
use super::site::{BLOCK, Footprint, Site, Sites, SurfaceSamples};
use super::{DomainWarp, Look, Material};
use crate::noise::{Ints, Jet, Lanes, Real, Value, Vec3, dispatched, inlined, mix, soft_max, soft_min};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Maximum recession of a rock behind the smooth wall, in metres.
pub const RECESS_M: f32 = 0.75;
/// Maximum protrusion into the passage, relative to half the width: a passage never closes.
pub const PROTRUSION: f32 = 0.25;
/// Width of the fillet between wall and floor, in metres.
const FILLET_M: f32 = 0.24;
/// How far above the floor sediment can lie on the foot of a wall, in metres of the field.
const SKIRT_M: f32 = 0.45;
/// Width of the darker zone along the corner between wall and floor, in metres.
const CORNER_M: f32 = 1.0;
/// Steepness of the field over the floor; below 1 because flanks of stones are steep.
const FLOOR_STEEPNESS: f32 = 0.75;

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

/// Detail too fine for the mesh.
#[derive(Clone, Copy, Debug)]
pub struct Detail<T> {
    /// Additional recession of the wall, metres.
    pub recess: T,
    /// 1 in a crack, 0 outside.
    pub crack: T,
}

impl<T> Detail<T> {
    /// No detail.
    #[inline(always)]
    pub fn none<S: Simd>(simd: S) -> Self
    where
        T: Real<S>,
    {
        Self { recess: T::zero(simd), crack: T::zero(simd) }
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
}

impl<S: Simd> Form<S> {
    /// Depth of a hollow with a [`Form::relief`] of 1, in metres. Tuned.
    const RELIEF_M: f32 = 0.014;
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

    /// Finer detail of the wall.
    #[inline(always)]
    fn wall_detail<S: Simd, T: Real<S>>(&self, site: &Site<T>, _wall: &Wall<T>, _footprint: Footprint) -> Detail<T> {
        Detail::none(site.simd())
    }

    /// What is on the floor.
    fn debris(&self) -> Debris {
        Debris::PLAIN
    }

    /// The floor; only its height affects the field.
    #[inline(always)]
    fn floor<S: Simd, T: Real<S>>(&self, site: &Site<T>) -> Floor<T> {
        self.debris().floor(site)
    }

    /// The floor with finer detail.
    #[inline(always)]
    fn floor_detail<S: Simd, T: Real<S>>(&self, site: &Site<T>, floor: &Floor<T>, footprint: Footprint) -> Floor<T> {
        self.debris().detail(site, floor, footprint)
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

/// Share of the relief: all of it in passages at least 3.5 m wide, less in narrower ones.
#[inline(always)]
fn relief_share<S: Simd, T: Real<S>>(half_width: T) -> T {
    (half_width * 0.4 + 0.3).within(0.3, 1.0)
}

/// The field of the wall alone.
#[inline(always)]
fn wall_field<S: Simd, T: Real<S>>(site: &Site<T>, wall: &Wall<T>) -> T {
    let recess = soft_min(wall.recess, T::splat(site.simd(), RECESS_M), 0.15);
    let recess = recess * relief_share(site.half_width);
    site.wall - soft_max(recess, site.half_width * -PROTRUSION, 0.12)
}

/// The field of the floor alone.
#[inline(always)]
fn floor_field<S: Simd, T: Real<S>>(site: &Site<T>, floor: &Floor<T>) -> T {
    let height = floor.height.within(-Site::<T>::DITCH_M, site.ground.highest_m());
    (height - site.height) * FLOOR_STEEPNESS
}

impl<T> Site<T> {
    /// Maximum depth of a ditch in a floor, metres.
    pub const DITCH_M: f32 = 0.15;

    /// Upper bound of [`wall_field`].
    #[inline(always)]
    fn wall_at_most<S: Simd>(&self) -> Lanes<S>
    where
        T: Real<S>,
    {
        self.wall.value() + self.half_width.value() * PROTRUSION
    }

    /// Upper bound of [`floor_field`].
    #[inline(always)]
    fn floor_at_most<S: Simd>(&self) -> Lanes<S>
    where
        T: Real<S>,
    {
        (-self.height.value() + self.ground.highest_m()) * FLOOR_STEEPNESS
    }
}

/// Wall and floor of the sites in one vector; one that is out of range is omitted, which changes no bit.
struct Carved<T> {
    field: T,
    wall: Option<(Wall<T>, T)>,
    floor: Option<(Floor<T>, T)>,
}

#[inline(always)]
fn carve<S: Simd, T: Real<S>, R: Rock>(rock: &R, site: &Site<T>) -> Carved<T> {
    // A separate function, compiled once for both gradients and surface samples.
    site.simd().vectorize(
        #[inline(always)]
        || carve_here(rock, site),
    )
}

#[inline(always)]
fn carve_here<S: Simd, T: Real<S>, R: Rock>(rock: &R, site: &Site<T>) -> Carved<T> {
    let lowest_wall = site.wall.value() - RECESS_M;
    let floor_hidden = site.floor_at_most().simd_le(lowest_wall - SKIRT_M);
    if floor_hidden.all_true() {
        let wall = rock.wall(site);
        let field = wall_field(site, &wall);
        return Carved { field, wall: Some((wall, field)), floor: None };
    }
    let floor = rock.floor(site);
    let over_floor = floor_field(site, &floor);
    let wall_hidden = site.wall_at_most().simd_le(over_floor.value() - FILLET_M);
    if wall_hidden.all_true() {
        return Carved { field: over_floor, wall: None, floor: Some((floor, over_floor)) };
    }
    let wall = rock.wall(site);
    let at_wall = wall_field(site, &wall);
    Carved {
        field: soft_max(at_wall, over_floor, FILLET_M),
        wall: Some((wall, at_wall)),
        floor: Some((floor, over_floor)),
    }
}

#[inline(always)]
fn distances<S: Simd, R: Rock>(simd: S, rock: &R, sites: &Sites, out: &mut [f32]) {
    let mut block = [0.0; BLOCK];
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        let site: Site<Value<S>> = sites.site(simd, at);
        SurfaceSamples::put::<S>(&mut block, at, carve(rock, &site).field.value());
    }
    out.copy_from_slice(&block[..sites.count]);
}

#[inline(always)]
fn gradients<S: Simd, R: Rock>(simd: S, rock: &R, sites: &Sites, out: &mut [[f32; 3]]) {
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        let site: Site<Jet<S>> = sites.site(simd, at);
        let gradient = carve(rock, &site).field.gradient;
        for (lane, out) in out[at..].iter_mut().take(Lanes::<S>::LEN).enumerate() {
            *out = [gradient[0][lane], gradient[1][lane], gradient[2][lane]];
        }
    }
}

/// A gradient under water: a film hides most of the detail, a pool is level.
#[inline(always)]
fn drowned<S: Simd>(fine: [Lanes<S>; 3], shape: [Lanes<S>; 3], paint: &Paint<S>) -> [Lanes<S>; 3] {
    let level = [0.0, 0.0, -FLOOR_STEEPNESS];
    let mut out = fine;
    for i in 0..3 {
        let filmed = fine[i] + (shape[i] - fine[i]) * paint.film.0 * 0.7;
        out[i] = filmed + (-filmed + level[i]) * paint.pool.0;
    }
    out
}

/// The surface at the sites in one vector: its shape without and with detail, and what determines its colour.
#[inline(always)]
fn surface<S: Simd, R: Rock>(rock: &R, site: &Site<Jet<S>>, footprint: Footprint) -> (Jet<S>, Jet<S>, Form<S>) {
    let zero = Jet::zero(site.simd());
    let carved = carve(rock, site);
    let sediment = sediment(&carved);
    let none = Wall { recess: zero, cavity: zero, state: zero, band: zero };
    let (mut wall, mut detail) = (none, Detail::none(site.simd()));
    if let Some((coarse, _)) = carved.wall {
        (wall, detail) = (coarse, rock.wall_detail(site, &coarse, footprint));
    }
    let bare = Floor { height: zero, stone: zero, tint: zero };
    let (mut floor, mut raised) = (bare, zero);
    if let Some((coarse, _)) = carved.floor {
        floor = rock.floor_detail(site, &coarse, footprint);
        raised = floor.height - coarse.height;
    }
    let share = Jet::constant(sediment.0);
    let field = carved.field + raised * FLOOR_STEEPNESS * share - detail.recess * (-share + 1.0);
    let value = inlined!(|number: Jet<S>| Value(number.value));
    let share = sediment;
    // A wall that the floor covers is absent or not, as its neighbours in the vector have it.
    let covered = share.0.simd_ge(1.0);
    let uncovered = inlined!(|number: Jet<S>| Value::pick(covered, Value::zero(site.simd()), value(number)));
    let hollow_wall = uncovered(wall.cavity * 2.0 + detail.recess * 9.0);
    let hollow_floor = value(floor.height * -2.0 + 0.15);
    let deep_wall = uncovered(detail.recess) * (1.0 / Form::<S>::RELIEF_M);
    let deep_floor = (-value(raised) + 0.5 * Form::<S>::RELIEF_M) * (1.0 / Form::<S>::RELIEF_M);
    let form = Form {
        point: Vec3 { x: value(site.point.x), y: value(site.point.y), z: value(site.point.z) },
        upward: share,
        height: value(site.height),
        cavity: mix(hollow_wall, hollow_floor, share),
        relief: mix(deep_wall, deep_floor, share).within(-1.0, 1.0),
        state: value(wall.state) * (-share + 1.0),
        band: uncovered(wall.band),
        crack: value(detail.crack) * (-share + 1.0),
        floor: share,
        stone: value(floor.stone) * share,
        tint: value(floor.tint),
    };
    (carved.field, field, form)
}

/// How much of a surface is sediment: 1 on the floor, 0 on the wall. Sediment also lies on the foot of the wall where that
/// is not too steep.
#[inline(always)]
fn sediment<S: Simd>(carved: &Carved<Jet<S>>) -> Value<S> {
    let simd = carved.field.value.token();
    let (Some((_, wall)), Some((_, floor))) = (&carved.wall, &carved.floor) else {
        return Value::splat(simd, f32::from(u8::from(carved.wall.is_none())));
    };
    let [x, y, z] = carved.field.gradient;
    let level = Value::<S>(-z / (x * x + y * y + z * z).max(1e-12).sqrt()).step(0.50, 0.85);
    let lower = Value(floor.value - wall.value);
    (lower + level * (SKIRT_M - 0.12)).step(-0.06, 0.06)
}

#[inline(always)]
fn surface_samples<S: Simd, R: Rock>(
    simd: S,
    rock: &R,
    sites: &Sites,
    look: &Look,
    footprint: Footprint,
    normals: &[[f32; 3]],
    out: &mut SurfaceSamples,
) {
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        let (shape, field, mut form) = surface(rock, &sites.site(simd, at), footprint);
        let upward = inlined!(|lane: usize| normals[(at + lane).min(sites.count - 1)][2]);
        form.upward = Value(Lanes::<S>::from_fn(simd, upward));
        let paint = rock.paint(&form, &sites.site(simd, at), look, footprint);
        SurfaceSamples::put::<S>(&mut out.value, at, field.value);
        let gradient = drowned(field.gradient, shape.gradient, &paint);
        for (lanes, to) in gradient.into_iter().zip(&mut out.gradient) {
            SurfaceSamples::put::<S>(to, at, lanes);
        }
        let color = [paint.color.x, paint.color.y, paint.color.z];
        for (lanes, to) in color.into_iter().zip(&mut out.color) {
            SurfaceSamples::put::<S>(to, at, lanes.within(0.0, 1.0).0);
        }
        SurfaceSamples::put::<S>(&mut out.roughness, at, paint.roughness.within(0.05, 1.0).0);
        SurfaceSamples::put::<S>(&mut out.occlusion, at, openness(&form, &sites.site(simd, at)).0);
    }
}

/// Ambient occlusion of a point: darker in hollows, where wall and floor meet, and in narrow passages.
#[inline(always)]
fn openness<S: Simd>(form: &Form<S>, site: &Site<Value<S>>) -> Value<S> {
    let hollow = form.cavity.step(-0.1, 1.1) * 0.5;
    // Approximate distance to the other of the two.
    let corner = mix(site.height, -site.wall, form.floor).step(CORNER_M, -0.2) * 0.35;
    let tight = site.half_width.step(1.6, 0.5) * 0.15;
    (-hollow + 1.0) * (-corner + 1.0) * (-tight + 1.0)
}

impl<R: Rock> Material for R {
    fn domain_warp(&self) -> DomainWarp {
        Rock::domain_warp(self)
    }

    fn distances(&self, sites: &Sites, out: &mut [f32]) {
        dispatched!(simd => distances(simd, self, sites, out));
    }

    fn gradients(&self, sites: &Sites, out: &mut [[f32; 3]]) {
        dispatched!(simd => gradients(simd, self, sites, out));
    }

    fn surface_samples(
        &self,
        sites: &Sites,
        look: &Look,
        footprint: Footprint,
        normals: &[[f32; 3]],
        out: &mut SurfaceSamples,
    ) {
        dispatched!(simd => surface_samples(simd, self, sites, look, footprint, normals, out));
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

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::material::{Basalt, Drilled, Ground, Limestone};
    use crate::noise::Source;

    /// A block along a line from the axis of a passage through its wall and down to its floor.
    fn sites() -> Sites {
        let ground = Ground { roughness_m: 0.08, natural: 0.7 };
        let mut sites = Sites::new(ground, Source::new(11));
        let points: Vec<[f32; 3]> = (0..BLOCK).map(|i| [i as f32 * 0.37, i as f32 * -0.21, i as f32 * 0.03]).collect();
        sites.place(&points);
        for lane in 0..BLOCK {
            let along = lane as f32 / BLOCK as f32;
            sites.wall.value[lane] = along * 2.0 - 1.5;
            sites.wall.gradient[0][lane] = 1.0;
            sites.height.value[lane] = 1.5 - along * 1.6;
            sites.height.gradient[2][lane] = 1.0;
            sites.up.value[lane] = 1.0 - along * 2.0;
            sites.half_width.value[lane] = 1.0 + along;
        }
        sites
    }

    fn everything<S: Simd, R: Rock>(simd: S, rock: &R) -> (Vec<u32>, Vec<[u32; 3]>, SurfaceSamples) {
        let sites = sites();
        let mut values = vec![0.0; BLOCK];
        distances(simd, rock, &sites, &mut values);
        let mut slopes = vec![[0.0; 3]; BLOCK];
        gradients(simd, rock, &sites, &mut slopes);
        let mut out = SurfaceSamples::default();
        let (look, footprint) = (Look::default(), Footprint { texel_m: 0.007 });
        surface_samples(simd, rock, &sites, &look, footprint, &[[0.6, 0.0, 0.8]; BLOCK], &mut out);
        let bits = values.into_iter().map(f32::to_bits).collect();
        (bits, slopes.into_iter().map(|slope| slope.map(f32::to_bits)).collect(), out)
    }

    fn widths_agree(rock: &impl Rock) {
        let level = fearless_simd::Level::new();
        let narrow = everything(level.as_sse2().expect("part of every x86-64"), rock);
        if let Some(avx2) = level.as_avx2() {
            assert_eq!(narrow, everything(avx2, rock));
        }
        if let Some(avx512) = level.as_avx512() {
            assert_eq!(narrow, everything(avx512, rock));
        }
    }

    #[test]
    fn rocks_are_the_same_on_every_width() {
        widths_agree(&Basalt::default());
        widths_agree(&Drilled::default());
        widths_agree(&Limestone::default());
    }
}
