//! The circle of a node: 360 sections, each with the weight with which the next node is drawn there.
//!
//! The paper's distribution: a wrapped Gaussian around the direction of travel, a Perlin term over the points of the
//! circle, and arcs without children. Two preferred azimuths (fractures) are an addition. Weights are converted to integers
//! before they are summed, so a draw never depends on the order of a float sum.

use std::f64::consts::{PI, TAU};

use super::Distribution;
use super::GaussianPerlin;
use super::tuning::{
    DEGREE, FRACTURE, FRACTURE_KAPPA, LINK_SIGMA, PERLIN_FLOOR, PERLIN_SCALE_M, RULED_OUT, SPUR_SIGMA,
};
use crate::perlin::Perlin;
use plume_graph::rng::Rng;

/// Sections of a circle.
const SECTIONS: usize = 360;
/// Integer weight that stands for 1.
const UNIT_WEIGHT: f64 = (1_u64 << 40) as f64;

type Table = [f64; SECTIONS];

/// How closely a step follows its heading.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Spread {
    Trunk,
    Spur,
    /// A connector, which also follows the fractures less.
    Link,
}

/// Data shared by all circles of a cave.
pub(super) struct Compass {
    noise: Perlin,
    perlin_weight: f64,
    directions: Vec<[f64; 2]>,
    /// Gaussian weights by number of sections from the heading, for each [`Spread`].
    gaussians: [Table; 3],
    fracture: Table,
    fracture_root: Table,
}

impl Compass {
    pub(super) fn new(settings: &GaussianPerlin, rng: &mut Rng) -> Self {
        let sigma_rad = settings.sigma_deg * DEGREE;
        let fracture = fracture(rng);
        Self {
            noise: Perlin::new(rng),
            perlin_weight: match settings.distribution {
                Distribution::Gaussian => 0.0,
                Distribution::Hybrid => settings.perlin_weight,
                Distribution::Perlin => 1.0,
            },
            directions: (0..SECTIONS).map(|s| [libm::cos(middle_rad(s)), libm::sin(middle_rad(s))]).collect(),
            gaussians: [sigma_rad, sigma_rad * SPUR_SIGMA, LINK_SIGMA].map(gaussian),
            fracture,
            fracture_root: fracture.map(f64::sqrt),
        }
    }

    /// The circle of the node at `center` with this `radius`.
    pub(super) fn circle(&self, center: [f64; 2], radius: f64, heading_rad: f64, spread: Spread) -> Circle {
        let gaussian = &self.gaussians[spread as usize];
        let fracture = match spread {
            Spread::Link => &self.fracture_root,
            Spread::Trunk | Spread::Spur => &self.fracture,
        };
        let perlin = self.perlin(center, radius);
        let ahead = section(heading_rad);
        Circle {
            weights: std::array::from_fn(|s| {
                let offset = (s + SECTIONS - ahead) % SECTIONS;
                let weight = (1.0 - self.perlin_weight) * gaussian[offset] + self.perlin_weight * perlin[s];
                (weight * fracture[s] * UNIT_WEIGHT) as u64
            }),
        }
    }

    /// Perlin weights of the points on the circle; they sum to 1.
    fn perlin(&self, [x, y]: [f64; 2], radius: f64) -> Table {
        if self.perlin_weight == 0.0 {
            return [0.0; SECTIONS];
        }
        let points: Table = std::array::from_fn(|s| {
            let [cos, sin] = self.directions[s];
            let value = self.noise.at((x + radius * cos) / PERLIN_SCALE_M, (y + radius * sin) / PERLIN_SCALE_M);
            value.max(PERLIN_FLOOR)
        });
        normalized(points)
    }
}

/// The weights of one circle.
pub(super) struct Circle {
    weights: [u64; SECTIONS],
}

impl Circle {
    /// Excludes everything within `arc` of the azimuth.
    pub(super) fn forbid(&mut self, azimuth_rad: f64, arc_rad: f64) {
        // Sections farther away than this have their middle outside the arc.
        let aside = ((arc_rad / DEGREE) as usize + 2).min(SECTIONS / 2);
        let first = section(azimuth_rad) + SECTIONS - aside;
        for s in (first..=first + 2 * aside).map(|s| s % SECTIONS) {
            if wrapped_rad(middle_rad(s) - azimuth_rad).abs() < arc_rad {
                self.weights[s] = 0;
            }
        }
    }

    /// An azimuth drawn by weight, uniform within its section; `None` if no section is left.
    pub(super) fn draw_azimuth_rad(&self, rng: &mut Rng) -> Option<f64> {
        let total: u64 = self.weights.iter().sum();
        if total == 0 {
            return None;
        }
        let mut left = rng.below(total);
        let drawn = self.weights.iter().position(|&weight| {
            let found = left < weight;
            left = left.saturating_sub(weight);
            found
        })?;
        Some((drawn as f64 + rng.unit()) * DEGREE)
    }

    /// Excludes sections near an azimuth that was drawn and failed.
    pub(super) fn rule_out(&mut self, azimuth_rad: f64) {
        let first = section(azimuth_rad) + SECTIONS - RULED_OUT;
        for s in first..=first + 2 * RULED_OUT {
            self.weights[s % SECTIONS] = 0;
        }
    }
}

/// The angle in [-π, π).
pub(super) fn wrapped_rad(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

fn section(angle_rad: f64) -> usize {
    ((angle_rad.rem_euclid(TAU) / DEGREE) as usize) % SECTIONS
}

fn middle_rad(section: usize) -> f64 {
    (section as f64 + 0.5) * DEGREE
}

/// A Gaussian wrapped around the circle, by number of sections from its mean.
fn gaussian(sigma_rad: f64) -> Table {
    let density = |angle_rad: f64| libm::exp(-0.5 * (angle_rad / sigma_rad) * (angle_rad / sigma_rad));
    normalized(std::array::from_fn(|s| {
        let angle_rad = wrapped_rad(s as f64 * DEGREE);
        density(angle_rad - TAU) + density(angle_rad) + density(angle_rad + TAU)
    }))
}

/// Preference for each azimuth: two sets of parallel fractures, mean 1.
fn fracture(rng: &mut Rng) -> Table {
    let first = rng.between(0.0, PI);
    let second = first + rng.between(55.0 * DEGREE, 90.0 * DEGREE);
    let strength = rng.between(0.4, 1.0);
    let peak = |angle_rad: f64| libm::exp(FRACTURE_KAPPA * (libm::cos(2.0 * angle_rad) - 1.0));
    let raw: Table = std::array::from_fn(|s| {
        let angle_rad = middle_rad(s);
        1.0 + FRACTURE * (peak(angle_rad - first) + strength * peak(angle_rad - second))
    });
    normalized(raw).map(|weight| weight * SECTIONS as f64)
}

fn normalized(table: Table) -> Table {
    let sum: f64 = table.iter().sum();
    table.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compass(distribution: Distribution) -> (Compass, Rng) {
        let mut rng = Rng::new(plume_graph::seed::stream(1, "test", 0));
        let settings = GaussianPerlin { distribution, ..Default::default() };
        (Compass::new(&settings, &mut rng), rng)
    }

    #[test]
    fn a_gaussian_circle_looks_ahead_across_the_wrap() {
        let (compass, mut rng) = compass(Distribution::Gaussian);
        let circle = compass.circle([0.0, 0.0], 4.0, -0.01, Spread::Link);
        for _ in 0..500 {
            let azimuth_rad = circle.draw_azimuth_rad(&mut rng).expect("no arc is forbidden");
            assert!(wrapped_rad(azimuth_rad).abs() < 5.0 * LINK_SIGMA, "{azimuth_rad}");
        }
    }

    #[test]
    fn a_perlin_circle_ignores_the_heading() {
        let (compass, _) = compass(Distribution::Perlin);
        let north = compass.circle([3.0, 4.0], 4.0, 1.0, Spread::Trunk);
        let south = compass.circle([3.0, 4.0], 4.0, 4.0, Spread::Trunk);
        assert_eq!(north.weights, south.weights);
    }

    #[test]
    fn nothing_is_drawn_from_a_forbidden_arc() {
        let (compass, mut rng) = compass(Distribution::Hybrid);
        let mut circle = compass.circle([0.0, 0.0], 4.0, 3.0, Spread::Spur);
        circle.forbid(-3.1, 1.0);
        for _ in 0..500 {
            let azimuth_rad = circle.draw_azimuth_rad(&mut rng).expect("most of the circle is free");
            assert!(wrapped_rad(azimuth_rad + 3.1).abs() > 1.0 - DEGREE);
        }
        circle.forbid(0.0, 4.0);
        assert_eq!(circle.draw_azimuth_rad(&mut rng), None);
    }

    #[test]
    fn a_failed_section_is_not_drawn_again() {
        let (compass, mut rng) = compass(Distribution::Hybrid);
        let mut circle = compass.circle([0.0, 0.0], 4.0, 0.0, Spread::Trunk);
        circle.rule_out(0.001);
        for _ in 0..500 {
            let azimuth_rad = circle.draw_azimuth_rad(&mut rng).expect("most of the circle is free");
            assert!(wrapped_rad(azimuth_rad).abs() >= 7.0 * DEGREE);
        }
    }
}
