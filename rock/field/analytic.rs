//! A field from a formula.

use super::{Aabb, Field, Region, ball_round};

/// Step of the central differences that give normals.
const STEP_M: f32 = 1.0 / 64.0;

/// A field given by a function of its value, for examples, tests, and simple shapes such as rooms and shafts.
///
/// One evaluation per point, and six per normal. Not promised: exact normals; they are central differences.
///
/// ```
/// use plume_rock::field::{Aabb, Analytic, Field, Region};
///
/// let ball = Analytic::new(1.0, |[x, y, z]: [f32; 3]| (x * x + y * y + z * z).sqrt() - 5.0);
/// let near = Aabb { min: [-1.0; 3], max: [1.0; 3] };
/// assert_eq!(ball.region(near), Region::Air);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Analytic<F> {
    value: F,
    slope: f32,
}

impl<F: Fn([f32; 3]) -> f32 + Sync> Analytic<F> {
    /// The field with this value at each point, negative in air. `slope` is a Lipschitz constant: no two values differ by
    /// more than `slope` times the distance of their points, in metres. It is 1 for a signed distance.
    pub fn new(slope: f32, value: F) -> Self {
        Self { value, slope }
    }
}

impl<F: Fn([f32; 3]) -> f32 + Sync> Field for Analytic<F> {
    fn region(&self, bounds: Aabb<f32>) -> Region {
        let (centre, radius_m) = ball_round(bounds);
        match (self.value)(centre) {
            far if far > radius_m * self.slope => Region::Rock,
            deep if deep < -radius_m * self.slope => Region::Air,
            _ => Region::Mixed,
        }
    }

    fn distances(&self, _: Aabb<f32>, points: &[[f32; 3]], out: &mut [f32]) {
        for (out, &point) in out.iter_mut().zip(points) {
            *out = (self.value)(point);
        }
    }

    fn normals(&self, _: Aabb<f32>, points: &[[f32; 3]], out: &mut [[f32; 3]]) {
        for (out, &point) in out.iter_mut().zip(points) {
            let descent: [f32; 3] = std::array::from_fn(|axis| {
                let [mut low, mut high] = [point, point];
                low[axis] -= STEP_M;
                high[axis] += STEP_M;
                (self.value)(low) - (self.value)(high)
            });
            let length = descent.map(|c| c * c).iter().sum::<f32>().sqrt();
            *out = if length > 0.0 { descent.map(|c| c / length) } else { [0.0, 0.0, 1.0] };
        }
    }
}
