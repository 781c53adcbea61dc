//! Costs of paths through the rock.

use nalgebra::{Point3, Vector2, Vector3};

use super::Karst;
use crate::perlin::Perlin;
use plume_graph::rng::Rng;

/// Height above or below a horizon at which its influence is halved, in metres (tuned).
const HORIZON_REACH_M: f64 = 1.5;
/// Scale of the swell and pinch of passages, in metres.
const WIDTH_SCALE_M: f64 = 30.0;
/// The narrowest passage, in metres.
const WIDTH_LEAST_M: f64 = 1.2;
/// Approximate range of the noise.
const NOISE_REACH: f64 = 0.5;

/// Horizons, fractures and permeability.
///
/// Heights in the rock are relative to the dipping plane through the origin, so that horizons are level.
pub(super) struct HostRock {
    horizons: Vec<f64>,
    /// Descent per metre east and north.
    dip: Vector2<f64>,
    /// Unit vectors of the fractures in the plan.
    fractures: Vec<Vector2<f64>>,
    noise: Perlin,
    scale_m: f64,
    /// Weights of horizons, fractures and permeability.
    weights: [f64; 3],
    slope_max: f64,
    width_m: f64,
    width_variation: f64,
}

impl HostRock {
    pub(super) fn new(settings: &Karst, rng: &mut Rng) -> Self {
        let mut horizons = settings.horizons_m.clone();
        horizons.sort_by(f64::total_cmp);
        let dip = libm::tan(settings.dip_deg.to_radians());
        Self {
            horizons,
            dip: compass(settings.dip_azimuth_deg) * dip,
            fractures: settings.fracture_azimuths_deg.iter().map(|&azimuth| compass(azimuth)).collect(),
            noise: Perlin::new(rng),
            scale_m: settings.permeability_scale_m,
            weights: [settings.horizon_weight, settings.fracture_weight, settings.permeability_weight],
            slope_max: libm::tan(settings.slope_max_deg.to_radians()),
            width_m: settings.width_m,
            width_variation: settings.width_variation,
        }
    }

    /// The lowest and the highest horizon.
    pub(super) fn extremes(&self) -> [f64; 2] {
        [self.horizons[0], self.horizons[self.horizons.len() - 1]]
    }

    pub(super) fn some_horizon(&self, rng: &mut Rng) -> f64 {
        self.horizons[rng.index(self.horizons.len())]
    }

    /// A point moved to the side of the plan towards which the horizons sink.
    pub(super) fn down_dip(&self, [x, y]: [f64; 2], side_m: f64) -> [f64; 2] {
        let edge = 0.45 * side_m;
        if self.dip.x.abs() > self.dip.y.abs() {
            [edge * self.dip.x.signum(), y]
        } else {
            [x, edge * self.dip.y.signum()]
        }
    }

    /// Depth of the dipping plane below the origin here.
    fn sunk(&self, x: f64, y: f64) -> f64 {
        self.dip.x * x + self.dip.y * y
    }

    /// World coordinates of a position relative to the dipping plane.
    pub(super) fn in_world(&self, place: Point3<f64>) -> Point3<f64> {
        Point3::new(place.x, place.y, place.z - self.sunk(place.x, place.y))
    }

    /// Whether an edge is not too steep.
    pub(super) fn is_walkable(&self, way: Vector3<f64>) -> bool {
        let rise = way.z - self.sunk(way.x, way.y);
        rise.abs() <= self.slope_max * way.xy().norm()
    }

    /// Cost of the edge between two positions.
    pub(super) fn cost(&self, a: Point3<f64>, b: Point3<f64>) -> f64 {
        let way = b - a;
        let plan = way.xy();
        let middle = a + 0.5 * way;
        let off = [a, middle, b].map(|place| self.off_horizons(place.z)).iter().sum::<f64>() / 3.0;
        let [horizon, fracture, permeability] = self.weights;
        let dearer = horizon * off + fracture * self.across(plan) + permeability * self.tightness(middle);
        way.norm() * (1.0 + dearer)
    }

    /// 0 on a horizon, 1 far from all of them.
    fn off_horizons(&self, height: f64) -> f64 {
        let away = self.horizons.iter().map(|horizon| (height - horizon).abs()).fold(f64::INFINITY, f64::min);
        away / (away + HORIZON_REACH_M)
    }

    /// 0 along a fracture set, 1 perpendicular to all of them.
    fn across(&self, plan: Vector2<f64>) -> f64 {
        let length = plan.norm();
        let sines = self.fractures.iter().map(|fracture| fracture.perp(&plan).abs() / length);
        sines.fold(1.0, f64::min).min(1.0) * f64::from(u8::from(!self.fractures.is_empty()))
    }

    /// 0 in permeable rock, 1 in tight rock; bodies are inclined, so that they differ between heights.
    pub(super) fn tightness(&self, at: Point3<f64>) -> f64 {
        let noise = self.noise.at((at.x + at.z) / self.scale_m, (at.y - at.z) / self.scale_m);
        (0.5 + 0.5 * noise / NOISE_REACH).clamp(0.0, 1.0)
    }

    /// Width of a passage here.
    pub(super) fn width_m(&self, at: Point3<f64>) -> f64 {
        let swell =
            self.noise.at((at.x - at.z) / WIDTH_SCALE_M + 71.3, (at.y + at.z) / WIDTH_SCALE_M + 17.9) / NOISE_REACH;
        (self.width_m * (1.0 + self.width_variation * swell.clamp(-1.0, 1.0))).max(WIDTH_LEAST_M)
    }
}

/// East and north components of an azimuth.
fn compass(azimuth_deg: f64) -> Vector2<f64> {
    let azimuth = azimuth_deg.to_radians();
    Vector2::new(libm::sin(azimuth), libm::cos(azimuth))
}
