//! What surfaces send to a camera: luminance in cd/m² of red, green and blue.
//!
//! Microfacets of GGX with the height-correlated masking of Smith (Heitz 2014) and Schlick's Fresnel term over a Lambertian base, of
//! the maps of the material averaged over the pixel; normals that differ within a pixel make it rougher (Toksvig 2005). Lights are a
//! headlamp, a beam whose intensity falls off like a bell, and the lamps of the scene; each casts exact shadows, by a ray.
//! Light that walls throw at each other is left out, but for a constant: see [`BOUNCE`]. Dust scatters the headlamp's light
//! once, evenly in all directions, and takes light away on both ways; it casts no shadows.

use fearless_simd::{Level, dispatch};
use nalgebra::{Isometry3, Point3, Vector3};
use plume_exporters::scene::Light;

use crate::library::Library;
use crate::maps::{Footprint, Look};
use crate::rig::Lighting;
use crate::world::{Facet, Hit, Surface, World};

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

/// What a ray sees.
pub struct Sight {
    /// Its direction in the scene, of length 1.
    pub ray: Vector3<f64>,
    /// Where it ends.
    pub hit: Hit,
}

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

    /// What comes along rays from the surfaces that they see; `pixel_rad` is the angle of a pixel. Shadows are followed together, which
    /// is fast if the rays are close to each other.
    pub fn received(&self, eye: &Point3<f64>, sights: &[Sight], library: &Library, pixel_rad: f32) -> Vec<Received> {
        let spots = dispatch!(Level::new(), _simd => self.spots(eye, sights, library, pixel_rad));
        let mut direct = vec![[0.0; 3]; spots.len()];
        for source in self.sources() {
            let lit = dispatch!(Level::new(), _simd => lit_by(&spots, &source));
            let starts: Vec<Point3<f64>> = lit.iter().map(|lit| lit.start).collect();
            let shaded = self.world.shaded(&source.place(), &starts);
            for (Lit { spot, light, .. }, _) in lit.into_iter().zip(shaded).filter(|(_, is_shaded)| !is_shaded) {
                (0..3).for_each(|channel| direct[spot][channel] += light[channel]);
            }
        }
        let received = direct.into_iter().zip(&spots).zip(sights);
        let through_dust = |((direct, spot), sight): (([f32; 3], &Spot), &Sight)| {
            self.through_dust(eye, &sight.ray, sight.hit.distance as f32, Received { direct, ambient: spot.ambient })
        };
        received.map(through_dust).collect()
    }

    #[inline(always)]
    fn spots(&self, eye: &Point3<f64>, sights: &[Sight], library: &Library, pixel_rad: f32) -> Vec<Spot> {
        let mut spots = Vec::with_capacity(sights.len());
        let mut last: Option<Facet> = None;
        for Sight { ray, hit } in sights {
            // Neighbours often see the same face.
            let known = last.take().filter(|facet| facet.face == hit.face);
            let facet = last.insert(known.unwrap_or_else(|| self.world.facet(hit.face)));
            let flat = if facet.flat_normal.dot(ray) > 0.0 { -facet.flat_normal } else { facet.flat_normal };
            let place = eye + ray * hit.distance;
            let mut spot = Spot { place, start: place + flat * OFF_M, flat, skin: None, ambient: [0.0; 3] };
            if let Some(maps) = library.maps(facet.kind.material) {
                let (surface, view) = (facet.at(hit.weights), -ray.cast::<f32>());
                let width = hit.distance as f32 * pixel_rad * facet.uv_per_m;
                let look = maps.mean(surface.uv, footprint(&surface, &view, width));
                spot.skin = Some(Skin::of(&surface, &facet.flat_normal, &look, view));
                spot.ambient = look.color.map(|color| color * look.occlusion);
            }
            spots.push(spot);
        }
        spots
    }

    fn sources(&self) -> impl Iterator<Item = Source<'_>> {
        self.headlamp.iter().map(Source::Headlamp).chain(self.lamps.iter().map(|lamp| Source::Lamp(lamp)))
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

/// Where light comes from.
enum Source<'a> {
    Headlamp(&'a Beam),
    Lamp(&'a Light),
}

impl Source<'_> {
    fn place(&self) -> Point3<f64> {
        match self {
            Self::Headlamp(beam) => beam.place,
            Self::Lamp(lamp) => lamp.position,
        }
    }

    /// Illuminance at a place across its light, in lux.
    #[inline(always)]
    fn lux_at(&self, place: &Point3<f64>) -> [f32; 3] {
        match self {
            Self::Headlamp(beam) => {
                let lux = beam.towards(place) / square(distance(&beam.place, place));
                HEADLAMP_COLOR.map(|color| color * lux)
            }
            Self::Lamp(lamp) => {
                let (away, range) = (distance(&lamp.position, place), lamp.range_m as f32);
                // The fall-off of KHR_lights_punctual.
                let window = (1.0 - square(square(away / range))).clamp(0.0, 1.0);
                let lux = lamp.intensity_cd as f32 * window / square(away);
                lamp.color.map(|color| color as f32 * lux)
            }
        }
    }
}

/// A place that a ray sees, and what it does with light.
struct Spot {
    place: Point3<f64>,
    /// A little off it, where rays of shadow start.
    start: Point3<f64>,
    /// Unit normal of the face, towards the viewer.
    flat: Vector3<f64>,
    /// Black if its maps are not in memory.
    skin: Option<Skin>,
    /// Luminance for 1 cd/m² from all sides.
    ambient: [f32; 3],
}

/// A spot that a source lights if nothing is between.
struct Lit {
    /// Number of the spot.
    spot: usize,
    /// Its luminance.
    light: [f32; 3],
    /// Where the ray of shadow starts.
    start: Point3<f64>,
}

/// The spots that a source lights if nothing is between.
#[inline(always)]
fn lit_by(spots: &[Spot], source: &Source) -> Vec<Lit> {
    let mut lit = Vec::with_capacity(spots.len());
    for (number, spot) in spots.iter().enumerate() {
        if let Some(light) = spot.lit_by(source) {
            lit.push(Lit { spot: number, light, start: spot.start });
        }
    }
    lit
}

impl Spot {
    /// Its luminance by a light that nothing shades; `None` if that is nothing.
    #[inline(always)]
    fn lit_by(&self, source: &Source) -> Option<[f32; 3]> {
        let light = source.lux_at(&self.place);
        let to_lamp = source.place() - self.place;
        if light == [0.0; 3] || self.flat.dot(&to_lamp) <= 0.0 {
            return None;
        }
        let incident = self.skin.as_ref()?.reflected(&to_lamp.cast::<f32>().normalize());
        (incident != [0.0; 3]).then(|| [0, 1, 2].map(|channel| incident[channel] * light[channel]))
    }
}

impl Received {
    /// The mean of several rays; those that are missing saw nothing.
    pub fn mean<'a>(of: impl Iterator<Item = &'a Self>, rays: usize) -> Self {
        let mut sum = Self::default();
        for received in of {
            (0..3).for_each(|channel| {
                sum.direct[channel] += received.direct[channel];
                sum.ambient[channel] += received.ambient[channel];
            });
        }
        let share = 1.0 / rays as f32;
        Self { direct: sum.direct.map(|part| part * share), ambient: sum.ambient.map(|part| part * share) }
    }
}

impl Beam {
    /// Its intensity towards a place, in candela.
    #[inline(always)]
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
    #[inline(always)]
    fn of(surface: &Surface, flat_normal: &Vector3<f64>, look: &Look, view: Vector3<f32>) -> Self {
        let front =
            if surface.normal.dot(&view) < 0.0 && flat_normal.cast::<f32>().dot(&view) < 0.0 { -1.0 } else { 1.0 };
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
    #[inline(always)]
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

/// The footprint of a pixel on a surface, which is as wide as this in texture coordinates.
#[inline(always)]
fn footprint(surface: &Surface, view: &Vector3<f32>, width: f32) -> Footprint {
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
