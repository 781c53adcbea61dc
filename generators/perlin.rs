//! Gradient noise in the plan (Perlin 2002), with sixteen gradients and a shuffled table.

use std::f64::consts::TAU;

use plume_graph::rng::Rng;

/// A noise field over the plane: 0 on the integer lattice, within ±0.75 elsewhere, period 256.
pub(super) struct Perlin {
    order: [u8; 256],
    gradients: [[f64; 2]; 16],
}

impl Perlin {
    pub(super) fn new(rng: &mut Rng) -> Self {
        let mut order = std::array::from_fn(|i| i as u8);
        for last in (1..order.len()).rev() {
            order.swap(last, rng.index(last + 1));
        }
        let gradients = std::array::from_fn(|i| {
            let angle = i as f64 * TAU / 16.0;
            [libm::cos(angle), libm::sin(angle)]
        });
        Self { order, gradients }
    }

    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let (cx, cy) = (x.floor(), y.floor());
        let (fx, fy) = (x - cx, y - cy);
        let (ix, iy) = (cx as i64, cy as i64);
        let (u, v) = (fade(fx), fade(fy));
        let near = lerp(u, self.corner(ix, iy, fx, fy), self.corner(ix + 1, iy, fx - 1.0, fy));
        let far = lerp(u, self.corner(ix, iy + 1, fx, fy - 1.0), self.corner(ix + 1, iy + 1, fx - 1.0, fy - 1.0));
        lerp(v, near, far)
    }

    fn corner(&self, ix: i64, iy: i64, dx: f64, dy: f64) -> f64 {
        let row = i64::from(self.order[(ix & 255) as usize]);
        let hash = self.order[((row + iy) & 255) as usize];
        let [gx, gy] = self.gradients[usize::from(hash & 15)];
        gx * dx + gy * dy
    }
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + t * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_0_on_the_lattice_periodic_continuous_and_within_its_range() {
        let perlin = Perlin::new(&mut Rng::new(plume_graph::seed::stream(1, "test", 0)));
        let mut greatest: f64 = 0.0;
        for step in 0..20_000 {
            let (x, y) = (f64::from(step) / 16.0 - 300.0, f64::from(step) / 64.0 + 0.25);
            let value = perlin.at(x, y);
            assert_eq!(perlin.at(x.floor(), y.floor()), 0.0);
            assert!((perlin.at(x + 256.0, y - 256.0) - value).abs() < 1e-9);
            assert!((perlin.at(x + 1e-6, y + 1e-6) - value).abs() < 1e-5);
            greatest = greatest.max(value.abs());
        }
        assert!((0.4..0.75).contains(&greatest), "{greatest}");
    }
}
