//! Maps of the user's own on any rock: images that can be tiled, projected along the three axes of the cave.
//!
//! Each projection counts the more, the more the wall faces it. The slopes of a map of normals are added to that of the rock
//! as gradients of a surface (Mikkelsen 2020, "Surface gradient-based bump mapping framework", JCGT 9(3)).
//!
//! Promised: the appearance is a function of the point, its normals and the size of a texel, so there is no seam between
//! chunks, and nothing finer than a texel is sampled. The shape is that of the rock. Not promised: that a tile does not show
//! twice where a wall turns from one axis to another.

use std::sync::Arc;

use super::surface::leaning;
use super::{BLOCK, CoarseBlock, DomainWarp, Footprint, Look, Material, Sites, SurfaceSamples};
use crate::noise::{Lanes, dispatched, inlined};
use crate::picture::{Image, Wrap};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Part of a normal along an axis up to which the projection along it does not count. Less than what the longest part of a
/// unit normal has at least (0.577), so that there is always one. Tuned: walls show hardly two tiles at a time.
const UNSEEN: f32 = 0.25;
/// Least part of a normal of a map along its axis, which bounds its slope.
const LEAST_UPRIGHT: f32 = 0.2;

/// Images that can be tiled, instead of the colours of a rock.
#[derive(Debug)]
pub struct OwnMaps {
    /// Base colour, linear RGB.
    pub base_color: Image,
    /// Normals in tangent space, y up; their components from −1 to 1 are 0 to 1 in the image.
    pub normal: Option<Image>,
    /// Perceptual roughness, in the first channel.
    pub roughness: Option<Image>,
    /// Side of a tile in metres.
    pub tile_m: f32,
}

/// A rock with maps of the user's own.
#[derive(Debug)]
pub struct Clad {
    /// The rock.
    pub rock: Arc<dyn Material>,
    /// What it looks like.
    pub maps: Arc<OwnMaps>,
}

impl Material for Clad {
    fn domain_warp(&self) -> DomainWarp {
        self.rock.domain_warp()
    }

    fn is_crusted_by_drips(&self) -> bool {
        self.rock.is_crusted_by_drips()
    }

    fn distances(&self, sites: &Sites, out: &mut [f32]) {
        self.rock.distances(sites, out);
    }

    fn gradients(&self, sites: &Sites, out: &mut [[f32; 3]]) {
        self.rock.gradients(sites, out);
    }

    fn coarse(&self, sites: &Sites, out: &mut CoarseBlock) {
        self.rock.coarse(sites, out);
    }

    fn surface_samples(
        &self,
        block: &CoarseBlock,
        look: &Look,
        footprint: Footprint,
        normals: &[[f32; BLOCK]; 3],
        out: &mut SurfaceSamples,
    ) {
        self.rock.surface_samples(block, look, footprint, normals, out);
        let OwnMaps { base_color, normal, roughness, tile_m } = &*self.maps;
        let width = footprint.texel_m / tile_m;
        let mut bent = out.normal;
        for lane in 0..block.count {
            let at = |columns: &[[f32; BLOCK]; 3]| columns.each_ref().map(|column| column[lane]);
            let views = views(block.point.each_ref().map(|column| column[lane]), at(normals), *tile_m);
            put(&mut out.color, lane, blended(&views, base_color, width));
            if let Some(roughness) = roughness {
                out.roughness[lane] = blended(&views, roughness, width)[0].clamp(0.05, 1.0);
            }
            if let Some(map) = normal {
                put(&mut bent, lane, tilted(at(&out.normal), slope(&views, map, width)));
            }
        }
        if normal.is_some() {
            dispatched!(simd => limit(simd, &bent, normals, &mut out.normal));
        }
        look.tint(&mut out.color);
    }
}

fn put(columns: &mut [[f32; BLOCK]; 3], lane: usize, vector: [f32; 3]) {
    columns.iter_mut().zip(vector).for_each(|(column, value)| column[lane] = value);
}

/// A point as a camera sees it that looks along an axis at the wall.
#[derive(Clone, Copy, Debug)]
struct View {
    /// How much it counts; 1 in all.
    share: f32,
    /// Texture coordinates, v downwards.
    uv: [f32; 2],
    /// The axis to the right, and its direction.
    right: (usize, f32),
    /// The axis upwards.
    up: usize,
}

/// The views of a point with a unit normal along x, y and z.
fn views(point: [f32; 3], normal: [f32; 3], tile_m: f32) -> [View; 3] {
    let weights = normal.map(|part| {
        let seen = (part.abs() - UNSEEN).max(0.0);
        seen * seen
    });
    let all: f32 = weights.iter().sum();
    std::array::from_fn(|axis| {
        // Right and up make a right-handed frame with the way towards the camera.
        let (right, way, up) = [(1, 1.0, 2), (0, -1.0, 2), (0, 1.0, 1)][axis];
        let way = if normal[axis] < 0.0 { -way } else { way };
        let uv = [tiles(way * point[right], tile_m), tiles(-point[up], tile_m)];
        View { share: weights[axis] / all.max(f32::MIN_POSITIVE), uv, right: (right, way), up }
    })
}

/// A coordinate in tiles, within the first one: so far from the origin its fraction still has all of its digits.
fn tiles(coordinate_m: f32, tile_m: f32) -> f32 {
    (f64::from(coordinate_m) / f64::from(tile_m)).rem_euclid(1.0) as f32
}

/// Those views that count.
fn seen(views: &[View; 3]) -> impl Iterator<Item = &View> {
    views.iter().filter(|view| view.share > 0.0)
}

/// What the views show of an image; `width` is that of a texel in texture coordinates.
fn blended(views: &[View; 3], image: &Image, width: f32) -> [f32; 3] {
    let mut mean = [0.0; 3];
    for View { share, uv, .. } in seen(views) {
        let color = image.color(*uv, [Wrap::Repeat; 2], width);
        mean.iter_mut().zip(color).for_each(|(mean, channel)| *mean += share * channel);
    }
    mean
}

/// How a normal is tilted by a map of normals, as a vector to be added to it.
fn slope(views: &[View; 3], map: &Image, width: f32) -> [f32; 3] {
    let mut slope = [0.0; 3];
    for &View { share, uv, right: (right, way), up } in seen(views) {
        let [x, y, z] = map.color(uv, [Wrap::Repeat; 2], width).map(|code| 2.0 * code - 1.0);
        let steepness = share / z.max(LEAST_UPRIGHT);
        slope[right] += steepness * way * x;
        slope[up] += steepness * y;
    }
    slope
}

/// A unit normal with the part of a slope that lies in its plane.
fn tilted(normal: [f32; 3], slope: [f32; 3]) -> [f32; 3] {
    let along = normal[0] * slope[0] + normal[1] * slope[1] + normal[2] * slope[2];
    std::array::from_fn(|axis| normal[axis] + slope[axis] - along * normal[axis])
}

/// Unit normals in the directions of `bent`, as far from those of the mesh as a normal map can hold.
#[inline(always)]
fn limit<S: Simd>(simd: S, bent: &[[f32; BLOCK]; 3], mesh: &[[f32; BLOCK]; 3], out: &mut [[f32; BLOCK]; 3]) {
    for at in (0..BLOCK).step_by(Lanes::<S>::LEN) {
        let lanes = inlined!(|column: &[f32; BLOCK]| Lanes::<S>::from_slice(simd, &column[at..at + Lanes::<S>::LEN]));
        let gradient = [-lanes(&bent[0]), -lanes(&bent[1]), -lanes(&bent[2])];
        let (normal, _) = leaning::<S>(gradient, [lanes(&mesh[0]), lanes(&mesh[1]), lanes(&mesh[2])]);
        for (lanes, to) in normal.into_iter().zip(&mut *out) {
            SurfaceSamples::put::<S>(to, at, lanes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit(v: [f32; 3]) -> [f32; 3] {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| c / length)
    }

    fn normals() -> impl Strategy<Value = [f32; 3]> {
        [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0]
            .prop_filter("too short", |v| v.iter().any(|c| c.abs() > 0.1))
            .prop_map(unit)
    }

    proptest! {
        #[test]
        fn views_count_as_one_and_repeat(
            point in [-9.0_f32..9.0, -9.0_f32..9.0, -9.0_f32..9.0],
            normal in normals(),
        ) {
            let here = views(point, normal, 2.0);
            prop_assert!((here.iter().map(|view| view.share).sum::<f32>() - 1.0).abs() < 1e-5);
            let there = views(point.map(|c| c + 4.0), normal, 2.0);
            for (here, there) in here.iter().zip(there) {
                for (a, b) in here.uv.into_iter().zip(there.uv) {
                    let apart = (a - b).abs();
                    prop_assert!(apart.min(1.0 - apart) < 1e-5, "{a} {b}");
                }
            }
        }

        /// The cross product of right and up points into the air, so no image is mirrored.
        #[test]
        fn views_are_not_mirrored(normal in normals()) {
            for (axis, view) in views([0.0; 3], normal, 1.0).into_iter().enumerate() {
                let (right, way) = view.right;
                let into_air = if (right + 1) % 3 == view.up { way } else { -way };
                prop_assert!(into_air * normal[axis] >= 0.0, "{axis}: {normal:?}");
            }
        }
    }

    #[test]
    fn slopes_do_not_lengthen_normals() {
        let normal = unit([0.2, -0.4, 0.8]);
        let bent = tilted(normal, [0.3, 0.1, -0.7]);
        let along: f32 = bent.iter().zip(normal).map(|(a, b)| a * b).sum();
        assert!((along - 1.0).abs() < 1e-6, "{along}");
    }
}
