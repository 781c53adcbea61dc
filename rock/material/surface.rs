//! Combines wall, floor and detail of a rock into one field and its appearance, in the same way for every rock.

use super::coarse::{Coarse, CoarseBlock, CoarseTone};
use super::floor::Sediment;
use super::rock::{Detail, Floor, Form, PROTRUSION, Paint, RECESS_M, Rock, Wall};
use super::site::{BLOCK, Footprint, Site, Sites, SurfaceSamples};
use super::{DomainWarp, Look, Material};
use crate::noise::{Jet, Lanes, Real, Value, Vec3, dispatched, inlined, mix, soft_max, soft_min};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Width of the fillet between wall and floor, in metres.
const FILLET_M: f32 = 0.24;
/// How far above the floor sediment can lie on the foot of a wall, in metres of the field.
const SKIRT_M: f32 = 0.45;
/// How far from a site another may be that is interpolated from it, in metres of the field: twice the diagonal of the widest
/// lattice, since the field of a smooth wall is at most that steep.
const NEARBY_M: f32 = 0.45;
/// How far a bound may be off by rounding, in metres: what is left out must be out of range as it would be evaluated, because the
/// other points of a vector decide whether it is.
const ROUNDING_M: f32 = 1e-3;
/// Width of the darker zone along the corner between wall and floor, in metres.
const CORNER_M: f32 = 1.0;
/// Steepness of the field over the floor; below 1 because flanks of stones are steep.
const FLOOR_STEEPNESS: f32 = 0.75;

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

/// The field without detail.
#[inline(always)]
fn carve<S: Simd, T: Real<S>, R: Rock>(rock: &R, site: &Site<T>) -> T {
    let lowest_wall = site.wall.value() - RECESS_M;
    if site.floor_at_most().simd_le(lowest_wall - FILLET_M - ROUNDING_M).all_true() {
        return wall_field(site, &rock.wall(site));
    }
    let over_floor = floor_field(site, &rock.floor(site, &Sediment::of(site, rock.debris().swell_m)));
    if site.wall_at_most().simd_le(over_floor.value() - FILLET_M - ROUNDING_M).all_true() {
        return over_floor;
    }
    soft_max(wall_field(site, &rock.wall(site)), over_floor, FILLET_M)
}

/// The coarse surface. What is out of range at a site, and therefore at all nearby, is replaced by a bound.
#[inline(always)]
fn coarse<S: Simd, R: Rock>(rock: &R, site: &Site<Jet<S>>) -> Coarse<S> {
    let zero = Jet::zero(site.simd());
    let lowest_wall = site.wall.value() - RECESS_M;
    let no_floor = site.floor_at_most().simd_le(lowest_wall - SKIRT_M - NEARBY_M);
    let mut sediment = Sediment { at: site.point, ragged: zero, roll: zero };
    let mut over_floor = (-site.height + site.ground.highest_m()) * FLOOR_STEEPNESS;
    if !no_floor.all_true() {
        sediment = Sediment::of(site, rock.debris().swell_m).unless(no_floor, &sediment);
        over_floor = Jet::pick(no_floor, over_floor, floor_field(site, &rock.floor(site, &sediment)));
    }
    let no_wall = site.wall_at_most().simd_le(over_floor.value - SKIRT_M - NEARBY_M);
    let mut wall = Wall { recess: zero, cavity: zero, state: zero, band: zero };
    let mut at_wall = site.wall + site.half_width * PROTRUSION;
    if !no_wall.all_true() {
        wall = rock.wall(site).unless(no_wall, &wall);
        at_wall = Jet::pick(no_wall, at_wall, wall_field(site, &wall));
    }
    let still = site.values();
    Coarse {
        site: *site,
        field: soft_max(at_wall, over_floor, FILLET_M),
        wall_field: at_wall,
        wall: wall.values(),
        sediment,
        patch: rock.debris().patch(site.source, [site.point.x.value, site.point.y.value]),
        level: rock.level(site),
        tone: CoarseTone::of(&still),
        marks: rock.marks(&still),
    }
}

#[inline(always)]
fn coarse_block<S: Simd, R: Rock>(simd: S, rock: &R, sites: &Sites, out: &mut CoarseBlock) {
    out.place_sites(sites);
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        out.store(at, &coarse(rock, &sites.site(simd, at)));
    }
}

#[inline(always)]
fn distances<S: Simd, R: Rock>(simd: S, rock: &R, sites: &Sites, out: &mut [f32]) {
    let mut block = [0.0; BLOCK];
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        let site: Site<Value<S>> = sites.site(simd, at);
        SurfaceSamples::put::<S>(&mut block, at, carve(rock, &site).value());
    }
    out.copy_from_slice(&block[..sites.count]);
}

#[inline(always)]
fn gradients<S: Simd, R: Rock>(simd: S, rock: &R, sites: &Sites, out: &mut [[f32; 3]]) {
    for at in (0..sites.count).step_by(Lanes::<S>::LEN) {
        let site: Site<Jet<S>> = sites.site(simd, at);
        let gradient = carve(rock, &site).gradient;
        for (lane, out) in out[at..].iter_mut().take(Lanes::<S>::LEN).enumerate() {
            *out = [gradient[0][lane], gradient[1][lane], gradient[2][lane]];
        }
    }
}

/// A gradient under water: a film hides some of the detail, a pool is level.
#[inline(always)]
fn drowned<S: Simd>(fine: [Lanes<S>; 3], shape: [Lanes<S>; 3], paint: &Paint<S>) -> [Lanes<S>; 3] {
    let level = [0.0, 0.0, -FLOOR_STEEPNESS];
    let mut out = fine;
    for i in 0..3 {
        let filmed = fine[i] + (shape[i] - fine[i]) * paint.film.0 * 0.55;
        out[i] = filmed + (-filmed + level[i]) * paint.pool.0;
    }
    out
}

/// The surface in one vector: its shape without and with detail, and what determines its colour. Wall or floor are omitted
/// where they are hidden in all lanes, which changes no bit.
#[inline(always)]
fn surface<S: Simd, R: Rock>(rock: &R, coarse: &Coarse<S>, footprint: Footprint) -> (Jet<S>, Jet<S>, Form<S>) {
    let Coarse { site, wall, sediment, .. } = coarse;
    let zero = Jet::zero(site.simd());
    let mut shape = coarse.wall_field;
    let mut share = Value::zero(site.simd());
    let mut floor = Floor { height: zero, stone: zero, tint: zero };
    let mut raised = zero;
    let floor_hidden = site.floor_at_most().simd_le(coarse.wall_field.value - SKIRT_M - ROUNDING_M);
    if !floor_hidden.all_true() {
        floor = rock.floor(site, sediment);
        let over_floor = floor_field(site, &floor);
        shape = soft_max(coarse.wall_field, over_floor, FILLET_M);
        share = covered(shape, coarse.wall_field, over_floor);
        if share.0.simd_gt(0.0).any_true() {
            let fine = rock.floor_detail(coarse, &floor, footprint);
            raised = fine.height - floor.height;
            floor = fine;
        }
    }
    let mut detail = Detail::none(site.simd());
    if share.0.simd_lt(1.0).any_true() {
        detail = rock.wall_detail(coarse, footprint);
    }
    let field = shape + raised * (share * FLOOR_STEEPNESS) - detail.recess * (-share + 1.0);
    let value = inlined!(|number: Jet<S>| Value(number.value));
    let hollow_wall = wall.cavity * 2.0 + value(detail.recess) * 9.0;
    let hollow_floor = value(floor.height * -2.0 + 0.15);
    let deep_wall = value(detail.recess) * (1.0 / Form::<S>::RELIEF_M);
    let deep_floor = (-value(raised) + 0.5 * Form::<S>::RELIEF_M) * (1.0 / Form::<S>::RELIEF_M);
    // A wall that the floor covers is absent or not, as its neighbours in the vector have it.
    let mixed =
        inlined!(|wall: Value<S>, floor: Value<S>| Value::pick(share.0.simd_ge(1.0), floor, mix(wall, floor, share)));
    let form = Form {
        point: Vec3 { x: value(site.point.x), y: value(site.point.y), z: value(site.point.z) },
        upward: share,
        height: value(site.height),
        cavity: mixed(hollow_wall, hollow_floor),
        relief: mixed(deep_wall, deep_floor).within(-1.0, 1.0),
        state: wall.state * (-share + 1.0),
        band: mixed(wall.band, Value::zero(site.simd())),
        crack: detail.crack * (-share + 1.0),
        floor: share,
        stone: value(floor.stone) * share,
        tint: value(floor.tint),
        tone: coarse.tone,
        marks: coarse.marks,
    };
    (shape, field, form)
}

/// How much of a surface is sediment: 1 on the floor, 0 on the wall. Sediment also lies on the foot of the wall where that
/// is not too steep.
#[inline(always)]
fn covered<S: Simd>(shape: Jet<S>, wall: Jet<S>, floor: Jet<S>) -> Value<S> {
    let [x, y, z] = shape.gradient;
    let level = Value::<S>(-z / (x * x + y * y + z * z).max(1e-12).sqrt()).step(0.50, 0.85);
    let lower = Value(floor.value - wall.value);
    (lower + level * (SKIRT_M - 0.12)).step(-0.06, 0.06)
}

#[inline(always)]
fn surface_samples<S: Simd, R: Rock>(
    simd: S,
    rock: &R,
    block: &CoarseBlock,
    look: &Look,
    footprint: Footprint,
    normals: &[[f32; BLOCK]; 3],
    out: &mut SurfaceSamples,
) {
    for at in (0..block.count).step_by(Lanes::<S>::LEN) {
        let coarse = block.load(simd, at);
        let (shape, field, mut form) = surface(rock, &coarse, footprint);
        let along = inlined!(|axis: usize| Lanes::<S>::from_slice(simd, &normals[axis][at..at + Lanes::<S>::LEN]));
        let mesh_normal = [along(0), along(1), along(2)];
        form.upward = Value(mesh_normal[2]);
        let site = coarse.site.values();
        let paint = rock.paint(&form, &site, look, footprint);
        let fine = along_wall::<S>(field.gradient, shape.gradient);
        let gradient = drowned(fine, shape.gradient, &paint);
        let (normal, steepness) = leaning::<S>(gradient, mesh_normal);
        SurfaceSamples::put::<S>(&mut out.height_m, at, field.value / steepness);
        for (lanes, to) in normal.into_iter().zip(&mut out.normal) {
            SurfaceSamples::put::<S>(to, at, lanes);
        }
        let color = [paint.color.x, paint.color.y, paint.color.z];
        for (lanes, to) in color.into_iter().zip(&mut out.color) {
            SurfaceSamples::put::<S>(to, at, lanes.within(0.0, 1.0).0);
        }
        SurfaceSamples::put::<S>(&mut out.roughness, at, averaged_roughness(&paint, footprint).within(0.05, 1.0).0);
        SurfaceSamples::put::<S>(&mut out.occlusion, at, openness(&form, &site).0);
    }
}

/// The gradient of a surface with detail, without the change of the detail into the rock: detail displaces the wall by its
/// value there, so only its slope along the wall tilts the surface.
#[inline(always)]
fn along_wall<S: Simd>(fine: [Lanes<S>; 3], shape: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let product = inlined!(|a: [Lanes<S>; 3], b: [Lanes<S>; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    let share = -product(fine, shape) / product(shape, shape).max(1e-6) + 1.0;
    [fine[0] + share * shape[0], fine[1] + share * shape[1], fine[2] + share * shape[2]]
}

/// Variance of the slopes that a texel averages, per metre of its size. Tuned on wet rock at 128 texels a metre: with more,
/// wet rock does not glisten from near; with less, the smaller mip levels of its maps, which average normals and roughness
/// apart, glitter more.
const AVERAGED_SLOPES_PER_M: f32 = 0.145;
/// Most of that variance, for coarse textures.
const MOST_AVERAGED_SLOPES: f32 = 0.01;

/// The roughness of all that a texel averages, as the lobe of its microfacets convolved with the distribution of its slopes
/// (Kaplanyan, Hill, Patney and Lefohn 2016, "Filtering distributions of normals for shading antialiasing"). Level water is
/// smooth. The same for every texel of a size, whatever its chart.
#[inline(always)]
fn averaged_roughness<S: Simd>(paint: &Paint<S>, footprint: Footprint) -> Value<S> {
    let slopes = (AVERAGED_SLOPES_PER_M * footprint.texel_m).min(MOST_AVERAGED_SLOPES);
    let lobe = paint.roughness.squared().squared();
    (lobe + (-paint.pool + 1.0) * (2.0 * slopes)).sqrt().sqrt()
}

/// Tangent of the largest angle from the mesh normal that a normal map can hold: 60°.
const MOST_TANGENT: f32 = 1.732_050_8;
/// Gradient magnitude below which the field tells no distance.
const LEAST_STEEPNESS: f32 = 0.25;

/// The unit normal of a surface with this gradient of its field, limited to the allowed angle from the mesh normal, and the
/// magnitude of the gradient.
#[inline(always)]
pub(super) fn leaning<S: Simd>(gradient: [Lanes<S>; 3], mesh_normal: [Lanes<S>; 3]) -> ([Lanes<S>; 3], Lanes<S>) {
    let length = inlined!(|v: [Lanes<S>; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt());
    let steepness = length(gradient);
    let scale = -Lanes::<S>::splat(steepness.token(), 1.0) / steepness.max(1e-6);
    let normal = [gradient[0] * scale, gradient[1] * scale, gradient[2] * scale];
    let cosine = normal[0] * mesh_normal[0] + normal[1] * mesh_normal[1] + normal[2] * mesh_normal[2];
    // More than 0, so that there is a normal even where this one points into the rock.
    let sine = (-cosine * cosine + 1.0).max(1e-6).sqrt();
    let lacking = (sine * (1.0 / MOST_TANGENT) - cosine).max(0.0);
    let lean = inlined!(|axis: usize| normal[axis] + lacking * mesh_normal[axis]);
    let leaning = [lean(0), lean(1), lean(2)];
    let shorten = Lanes::<S>::splat(steepness.token(), 1.0) / length(leaning);
    // A field without a gradient has the normal of its mesh, since only that is left of `leaning`.
    ([leaning[0] * shorten, leaning[1] * shorten, leaning[2] * shorten], steepness.max(LEAST_STEEPNESS))
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

    fn is_crusted_by_drips(&self) -> bool {
        Rock::is_crusted_by_drips(self)
    }

    fn distances(&self, sites: &Sites, out: &mut [f32]) {
        dispatched!(simd => distances(simd, self, sites, out));
    }

    fn gradients(&self, sites: &Sites, out: &mut [[f32; 3]]) {
        dispatched!(simd => gradients(simd, self, sites, out));
    }

    fn coarse(&self, sites: &Sites, out: &mut CoarseBlock) {
        dispatched!(simd => coarse_block(simd, self, sites, out));
    }

    fn surface_samples(
        &self,
        block: &CoarseBlock,
        look: &Look,
        footprint: Footprint,
        normals: &[[f32; BLOCK]; 3],
        out: &mut SurfaceSamples,
    ) {
        dispatched!(simd => surface_samples(simd, self, block, look, footprint, normals, out));
        look.tint(&mut out.color);
    }
}
