//! Where water drips from the roof: along joints, where the rock is wet.

use crate::material::roughness;
use crate::noise::{Source, smooth_step};
use plume_graph::rng::Rng;
use plume_graph::seed::{salt, stream};

/// Distance between joints from which water drips, in metres.
const JOINT_M: f64 = 1.6;

/// The wet joints of a cave.
#[derive(Clone, Debug)]
pub struct Drips {
    /// Unit vector across the joints.
    across: [f64; 2],
    wet: Source,
    bend: Source,
}

/// How wide a joint is wet, and how wet the rock there is, each from none to all.
struct Reach {
    aside_m: [f64; 2],
    wet: [f64; 2],
}

/// Where drops fall.
const DRIPPING: Reach = Reach { aside_m: [0.22, 0.05], wet: [-0.05, 0.35] };
/// What the water has covered with calcite on its way. Tuned by eye.
const CRUSTED: Reach = Reach { aside_m: [0.50, 0.12], wet: [-0.15, 0.20] };

impl Drips {
    /// Those of the cave with this seed.
    pub fn new(seed: u64) -> Self {
        let across_rad = Rng::new(stream(seed, "joint heading", 0)).between(0.0, std::f64::consts::TAU);
        let across = [libm::cos(across_rad), libm::sin(across_rad)];
        let source = |name: &str| Source::new(salt(seed, name));
        Self { across, wet: source("wet joints"), bend: source("joint bends") }
    }

    /// The direction of the joints, from the x axis towards the y axis.
    pub fn heading_rad(&self) -> f64 {
        let [x, y] = self.across;
        libm::atan2(x, -y)
    }

    /// Share of the places near each of these points from which water drips.
    pub fn dripping(&self, points: &[[f32; 3]]) -> Vec<f32> {
        self.shares(&DRIPPING, points)
    }

    /// How thick the crust is at each of these points, from 0 to 1.
    pub fn crusted(&self, points: &[[f32; 3]]) -> Vec<f32> {
        self.shares(&CRUSTED, points)
    }

    fn shares(&self, reach: &Reach, points: &[[f32; 3]]) -> Vec<f32> {
        let (wet, bend) = (roughness(self.wet, points, 5.0), roughness(self.bend, points, 2.5));
        let [across_x, across_y] = self.across;
        let share = |(n, [x, y, _]): (usize, &[f32; 3])| {
            let across = (f64::from(*x) * across_x + f64::from(*y) * across_y + 0.35 * f64::from(bend[n])) / JOINT_M;
            let off_m = (across - across.round()).abs() * JOINT_M;
            (smooth_step(reach.aside_m, off_m) * smooth_step(reach.wet, f64::from(wet[n]))) as f32
        };
        points.iter().enumerate().map(share).collect()
    }
}
