//! What surfaces send to a camera: luminance in cd/m² of red, green and blue.
//!
//! Microfacets of GGX with the height-correlated masking of Smith (Heitz 2014) and Schlick's Fresnel term over a Lambertian base, of
//! the maps of the material averaged over the pixel; normals that differ within a pixel make it rougher (Toksvig 2005). Lights are a
//! headlamp, a beam whose intensity falls off like a bell, and the lamps of the scene; each casts exact shadows, by a ray.
//! Light that walls throw at each other is left out, but for a constant: see [`BOUNCE`]. Dust scatters the headlamp's light
//! once, evenly in all directions, and takes light away on both ways; it casts no shadows.

use nalgebra::{Isometry3, Point3, Vector3};
use plume_exporters::scene::Light;

use crate::maps::{Footprint, Look, Maps};
use crate::rig::Lighting;
use crate::world::{Hit, Surface, World};

/// Share of the mean luminance of an image that falls on everything in it: the walls around a point in a passage fill its
/// sky, and about a third of what they send is seen from the camera. Tuned by hand.
const BOUNCE: f32 = 0.3;
/// Light of a white LED, linear.
const HEADLAMP_COLOR: [f32; 3] = [1.0, 0.97, 0.9];
/// How far from a surface rays of shadow start, so that they do not meet it, in metres.
const OFF_M: f64 = 1e-3;
/// Reflection of water and stone seen straight.
const F0: f32 = 0.04;
/// Lights are never closer than this, in metres.
const NEAREST_M: f32 = 0.02;

/// The lights around a camera at a moment.
pub struct Lights<'a> {
    world: &'a World,
    lighting: &'a Lighting,
    headlamp: Option<Beam>,
    lamps: Vec<&'a Light>,
}

/// A headlamp.
struct Beam {
    place: Point3<f64>,
    ahead: Vector3<f64>,
    intensity_cd: f32,
    sharpness: f32,
}

/// For each light, the face that last threw a shadow: neighbours often are in the same one.
pub struct Shadows(Vec<Option<u32>>);

/// What a pixel gets: by the lights, and how much it would get of light from all sides.
#[derive(Clone, Copy, Debug, Default)]
pub struct Received {
    /// Luminance by the lights, in cd/m².
    pub direct: [f32; 3],
    /// Luminance for 1 cd/m² from all sides.
    pub ambient: [f32; 3],
}

impl<'a> Lights<'a> {
    /// The lights for a body at a pose.
    pub fn at(world: &'a World, lighting: &'a Lighting, scene_from_body: &Isometry3<f64>) -> Self {
        let half = 0.5 * lighting.headlamp_beam_deg.to_radians();
        let headlamp = (lighting.headlamp_cd > 0.0).then(|| Beam {
            place: scene_from_body * Point3::from(lighting.headlamp_position_m),
            ahead: scene_from_body.rotation * Vector3::x(),
            intensity_cd: lighting.headlamp_cd as f32,
            sharpness: (std::f64::consts::LN_2 / (1.0 - libm::cos(half))) as f32,
        });
        let lamps = if lighting.cave_lamps { world.lamps.iter().collect() } else { Vec::new() };
        Self { world, lighting, headlamp, lamps }
    }

    /// No shadows yet.
    pub fn shadows(&self) -> Shadows {
        Shadows(vec![None; self.lamps.len() + usize::from(self.headlamp.is_some())])
    }

    /// What comes along a ray of length 1 from a surface; `pixel_rad` is the angle of a pixel.
    pub fn received(
        &self,
        eye: &Point3<f64>,
        ray: &Vector3<f64>,
        hit: &Hit,
        maps: &Maps,
        pixel_rad: f32,
        shadows: &mut Shadows,
    ) -> Received {
        let surface = self.world.surface(hit);
        let flat = if surface.flat_normal.dot(ray) > 0.0 { -surface.flat_normal } else { surface.flat_normal };
        let place = eye + ray * hit.distance;
        let view = -ray.cast::<f32>();
        let look = maps.mean(surface.uv, footprint(&surface, &view, hit.distance as f32, pixel_rad));
        let skin = Skin::of(&surface, &look, view);
        let start = place + flat * OFF_M;
        let mut direct = [0.0; 3];
        for ((lamp, light), shadow) in self.shining_at(&place).zip(&mut shadows.0) {
            if light == [0.0; 3] {
                continue;
            }
            let to_lamp = lamp - place;
            let is_behind = flat.dot(&to_lamp) <= 0.0;
            let incident = skin.reflected(&to_lamp.cast::<f32>().normalize());
            if is_behind || incident == [0.0; 3] {
                continue;
            }
            let thrown_by = self.world.any(&start, &(lamp - start), 1.0, *shadow);
            if thrown_by.is_some() {
                *shadow = thrown_by;
                continue;
            }
            (0..3).for_each(|channel| direct[channel] += incident[channel] * light[channel]);
        }
        let ambient = look.color.map(|color| color * look.occlusion);
        self.through_dust(eye, ray, hit.distance as f32, Received { direct, ambient })
    }

    /// The lamps, and the illuminance of each at a place across its light, in lux.
    fn shining_at(&self, place: &Point3<f64>) -> impl Iterator<Item = (Point3<f64>, [f32; 3])> {
        let headlamp = self.headlamp.iter().map(|beam| {
            let lux = beam.towards(place) / square(distance(&beam.place, place));
            (beam.place, HEADLAMP_COLOR.map(|color| color * lux))
        });
        let place = *place;
        let lamps = self.lamps.iter().map(move |light| {
            let (away, range) = (distance(&light.position, &place), light.range_m as f32);
            // The fall-off of KHR_lights_punctual.
            let window = (1.0 - square(square(away / range))).clamp(0.0, 1.0);
            let lux = light.intensity_cd as f32 * window / square(away);
            (light.position, light.color.map(|color| color as f32 * lux))
        });
        headlamp.chain(lamps)
    }

    fn through_dust(&self, eye: &Point3<f64>, ray: &Vector3<f64>, way_m: f32, received: Received) -> Received {
        let dust = self.lighting.dust_per_m as f32;
        if dust == 0.0 {
            return received;
        }
        // As long as the way from the lamp: it is close to the camera.
        let left = libm::expf(-2.0 * dust * way_m);
        let haze = self.headlamp.as_ref().map_or(0.0, |beam| beam.haze(eye, ray, way_m, dust));
        let mut direct = received.direct.map(|light| light * left);
        (0..3).for_each(|channel| direct[channel] += haze * HEADLAMP_COLOR[channel]);
        Received { direct, ambient: received.ambient.map(|light| light * left) }
    }

    /// The luminance of a pixel, if the mean of its image is `mean`.
    pub fn luminance(&self, received: &Received, mean: [f32; 3]) -> [f32; 3] {
        let stray = self.lighting.ambient_cd_m2 as f32;
        [0, 1, 2].map(|k| received.direct[k] + received.ambient[k] * (stray + BOUNCE * mean[k]))
    }
}

impl Beam {
    /// Its intensity towards a place, in candela.
    fn towards(&self, place: &Point3<f64>) -> f32 {
        let towards = place - self.place;
        let cosine = (towards.dot(&self.ahead) / towards.norm().max(1e-9)) as f32;
        self.intensity_cd * libm::expf(-self.sharpness * (1.0 - cosine))
    }

    /// What dust throws back along a ray: the integral of intensity over the square of the distance, by steps that are finer
    /// where the lamp is near.
    fn haze(&self, eye: &Point3<f64>, ray: &Vector3<f64>, way_m: f32, dust: f32) -> f32 {
        const STEPS: usize = 12;
        let mut sum = 0.0;
        let edge = |step: usize| way_m * square(step as f32 / STEPS as f32);
        for step in 0..STEPS {
            let (near, far) = (edge(step), edge(step + 1));
            let middle = 0.5 * (near + far);
            let place = eye + ray * f64::from(middle);
            let away = distance(&self.place, &place);
            sum += (far - near) * self.towards(&place) * libm::expf(-dust * (middle + away)) / square(away);
        }
        sum * dust / (4.0 * std::f32::consts::PI)
    }
}

/// A surface, seen from a side.
struct Skin {
    normal: Vector3<f32>,
    view: Vector3<f32>,
    color: [f32; 3],
    /// Square of GGX's α.
    alpha2: f32,
    cos_view: f32,
}

impl Skin {
    fn of(surface: &Surface, look: &Look, view: Vector3<f32>) -> Self {
        let front = if surface.normal.dot(&view) < 0.0 && surface.flat_normal.cast::<f32>().dot(&view) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let (tangent, handedness) = surface.tangent;
        let across = surface.normal.cross(&tangent) * handedness;
        let [x, y, z] = look.normal;
        let length = libm::sqrtf(x * x + y * y + z * z).clamp(0.05, 1.0);
        let bent = (tangent * x + across * y + surface.normal * z) * (front / length);
        // A bent normal may look away from a viewer who sees the face.
        let towards = bent.dot(&view);
        let normal = if towards < 0.02 { (bent + view * (0.02 - towards)).normalize() } else { bent };
        let alpha = square(look.roughness.max(0.05));
        let spread = 2.0 * (1.0 - length) / length;
        let alpha2 = (alpha * alpha + spread).min(1.0);
        Self { normal, view, color: look.color, alpha2, cos_view: normal.dot(&view).max(1e-3) }
    }

    /// Luminance for a lux across its light from this direction.
    fn reflected(&self, light: &Vector3<f32>) -> [f32; 3] {
        let cos_light = self.normal.dot(light);
        if cos_light <= 0.0 {
            return [0.0; 3];
        }
        let half = (light + self.view).normalize();
        let (nh, vh) = (self.normal.dot(&half).max(0.0), self.view.dot(&half).max(0.0));
        let a2 = self.alpha2;
        let facets = a2 / (std::f32::consts::PI * square(nh * nh * (a2 - 1.0) + 1.0));
        let masking = |one: f32, other: f32| one * (other * other * (1.0 - a2) + a2).sqrt();
        let seen = 0.5 / (masking(cos_light, self.cos_view) + masking(self.cos_view, cos_light)).max(1e-6);
        let grazing = 1.0 - vh;
        let fresnel = F0 + (1.0 - F0) * square(square(grazing)) * grazing;
        let specular = facets * seen * fresnel;
        self.color.map(|color| ((1.0 - fresnel) * color / std::f32::consts::PI + specular) * cos_light)
    }
}

/// The footprint of a pixel on a surface.
fn footprint(surface: &Surface, view: &Vector3<f32>, distance_m: f32, pixel_rad: f32) -> Footprint {
    let width = distance_m * pixel_rad * surface.uv_per_m;
    let cosine = surface.normal.dot(view).abs().max(0.05);
    let along = view - surface.normal * surface.normal.dot(view);
    let (tangent, handedness) = surface.tangent;
    let across = surface.normal.cross(&tangent) * handedness;
    let place = [along.dot(&tangent), along.dot(&across)];
    let length = (square(place[0]) + square(place[1])).sqrt().max(1e-6);
    Footprint { width, length: place.map(|part| part / length * (width / cosine)) }
}

fn distance(from: &Point3<f64>, to: &Point3<f64>) -> f32 {
    ((to - from).norm() as f32).max(NEAREST_M)
}

fn square(x: f32) -> f32 {
    x * x
}
