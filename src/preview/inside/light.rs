//! Lamps, and the reflection of their light.

use nalgebra::Point3;

use super::camera::{Camera, between, dot, unit};
use crate::field::{Field, Texel};
use crate::placement;
use crate::preview::Subject;
use plume_graph::Graph;

/// Intensity of a lamp per square metre of spacing, cd/m²: as in packages.
const LAMP_CD_PER_M2: f32 = 0.12;
/// Warm white, linear RGB.
const LAMP_COLOR: [f32; 3] = [1.0, 0.86, 0.68];
/// Intensity of the headlamp, cd, and its colour: cooler, to distinguish it from the lamps. Tuned.
const HEAD_CD: f32 = 5.0;
const HEAD_COLOR: [f32; 3] = [0.92, 0.97, 1.0];
/// Share of indirect light of a lamp, reflected by other walls. Tuned.
const BOUNCED: f32 = 0.10;
/// Lamps beyond this are ignored, metres.
const REACH_M: f32 = 60.0;
/// Radius of a lamp, m: its light is constant within.
const LAMP_RADIUS_M: f32 = 0.5;
/// Hardness of shadow edges. Tuned.
const HARDNESS: f32 = 9.0;
const SHADOW_STEPS: usize = 18;
/// Minimum width of highlights. Tuned: with less, wet rock glitters, since there is one ray per pixel.
const LEAST_SPREAD: f32 = 0.06;
/// A lamp that contributes less than this share to a point casts no shadow there. Tuned.
const LEAST_SHARE: f32 = 0.002;

/// A point light.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    at: [f32; 3],
    color: [f32; 3],
    throws_shadows: bool,
}

/// A visible point of the wall.
pub struct Sight {
    /// Its position.
    pub point: [f32; 3],
    /// Unit vector to the camera.
    pub to_eye: [f32; 3],
    /// The wall there.
    pub texel: Texel,
}

/// The lamps of the cave near the camera.
pub fn lamps(subject: &Subject, eye: [f32; 3]) -> Vec<Lamp> {
    let Some(spacing_m) = subject.lamp_spacing_m else {
        return Vec::new();
    };
    let eye = Point3::from(eye.map(f64::from));
    let nodes = subject.graph.nodes.iter().filter(|node| (node.position - eye).norm() < f64::from(REACH_M));
    let near = Graph::new(nodes.cloned().collect(), Vec::new());
    let power = LAMP_CD_PER_M2 * (spacing_m * spacing_m) as f32;
    let lamp = |lamp: placement::Lamp| Lamp {
        at: lamp.position.coords.map(|c| c as f32).into(),
        color: LAMP_COLOR.map(|c| c * power),
        throws_shadows: true,
    };
    placement::lamps(subject.field, &near, spacing_m).into_iter().map(lamp).collect()
}

/// The headlamp. Its shadows are hidden behind the objects that cast them.
pub fn headlamp(camera: &Camera) -> Lamp {
    Lamp { at: camera.lamp(), color: HEAD_COLOR.map(|c| c * HEAD_CD), throws_shadows: false }
}

/// The light from each point to the camera, linear RGB.
pub fn radiance(field: &dyn Field, lamps: &[Lamp], sights: &[Sight]) -> Vec<[f32; 3]> {
    let mut light = vec![[0.0; 3]; sights.len()];
    for lamp in lamps {
        let shares: Vec<f32> = sights.iter().map(|sight| share(lamp, sight)).collect();
        let open = openness(field, lamp, sights, &shares);
        for ((light, sight), open) in light.iter_mut().zip(sights).zip(open) {
            let direct = reflected(lamp, sight);
            let bounced = falloff(lamp, sight.point) * BOUNCED * sight.texel.occlusion;
            for i in 0..3 {
                light[i] += lamp.color[i] * (direct[i] * open + bounced * sight.texel.color[i]);
            }
        }
    }
    light
}

fn falloff(lamp: &Lamp, point: [f32; 3]) -> f32 {
    let away = between(point, lamp.at);
    1.0 / dot(away, away).max(LAMP_RADIUS_M * LAMP_RADIUS_M)
}

/// The share of a lamp's intensity that reaches the wall.
fn share(lamp: &Lamp, sight: &Sight) -> f32 {
    let to_lamp = unit(between(sight.point, lamp.at));
    dot(to_lamp, sight.texel.normal).max(0.0) * falloff(lamp, sight.point)
}

/// Visibility of a lamp from each point, 0–1.
fn openness(field: &dyn Field, lamp: &Lamp, sights: &[Sight], shares: &[f32]) -> Vec<f32> {
    let mut open = vec![1.0; sights.len()];
    if !lamp.throws_shadows {
        return open;
    }
    let mut walks: Vec<(usize, f32)> =
        (0..sights.len()).filter(|&i| shares[i] > LEAST_SHARE).map(|i| (i, 0.08)).collect();
    for _ in 0..SHADOW_STEPS {
        let point = |&(i, t): &(usize, f32)| {
            let sight = &sights[i];
            let to_lamp = unit(between(sight.point, lamp.at));
            std::array::from_fn(|axis| sight.point[axis] + t * to_lamp[axis] + 0.03 * sight.texel.normal[axis])
        };
        let points: Vec<[f32; 3]> = walks.iter().map(point).collect();
        let mut values = field.distances_at(&points).into_iter();
        walks.retain_mut(|(i, t)| {
            let clear = -values.next().unwrap_or(0.0);
            open[*i] = open[*i].min((HARDNESS * clear / *t).max(0.0));
            *t += clear.clamp(0.06, 2.0);
            let away = between(sights[*i].point, lamp.at);
            open[*i] > 0.02 && *t * *t < dot(away, away) * 0.9
        });
    }
    open
}

/// The reflectance from a lamp to the camera: Lambert, and GGX (Walter et al. 2007) with Smith shadowing as simplified by
/// Hammon (2017).
fn reflected(lamp: &Lamp, sight: &Sight) -> [f32; 3] {
    let Texel { normal, color, roughness, .. } = sight.texel;
    let to_lamp = unit(between(sight.point, lamp.at));
    let half = unit(std::array::from_fn(|i| to_lamp[i] + sight.to_eye[i]));
    let lit = dot(normal, to_lamp).max(0.0);
    let seen = dot(normal, sight.to_eye).max(0.05);
    let spread = (roughness * roughness).max(LEAST_SPREAD);
    let facing = dot(normal, half).max(0.0);
    let peak = facing * facing * (spread * spread - 1.0) + 1.0;
    let facets = spread * spread / (std::f32::consts::PI * peak * peak);
    let masked = 0.5 / (2.0 * lit * seen * (1.0 - spread) + (lit + seen) * spread).max(1e-3);
    let grazing = 1.0 - dot(half, sight.to_eye).max(0.0);
    let fresnel = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
    let gloss = facets * masked * fresnel;
    color.map(|c| (c / std::f32::consts::PI + gloss) * lit * falloff(lamp, sight.point))
}
