//! Rays and triangles: the watertight test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2013), in
//! double precision.

use nalgebra::{Point3, Vector3};

/// Three corners in metres.
pub type Triangle = [[f32; 3]; 3];

/// A direction, prepared for many triangles.
pub struct Shear {
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Shear {
    /// Along a direction that is not zero.
    pub fn along(direction: &Vector3<f64>) -> Self {
        let z = direction.iamax();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let (x, y) = if direction[z] < 0.0 { (y, x) } else { (x, y) };
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        Self { axes: [x, y, z], shear }
    }

    /// Distance along the direction, and the weights of the second and third corner; triangles count from both sides.
    #[inline(always)]
    pub fn meet(&self, origin: &Point3<f64>, corners: &Triangle) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = corners;
        let (a, b, c) = (self.sheared(origin, a), self.sheared(origin, b), self.sheared(origin, c));
        let of_a = c[0] * b[1] - c[1] * b[0];
        let of_b = a[0] * c[1] - a[1] * c[0];
        let of_c = b[0] * a[1] - b[1] * a[0];
        let is_outside = (of_a < 0.0 || of_b < 0.0 || of_c < 0.0) && (of_a > 0.0 || of_b > 0.0 || of_c > 0.0);
        let whole = of_a + of_b + of_c;
        if is_outside || whole == 0.0 {
            return None;
        }
        let distance = (of_a * a[2] + of_b * b[2] + of_c * c[2]) / whole;
        (distance > 0.0).then_some((distance, [of_b / whole, of_c / whole]))
    }

    /// A corner in a frame in which the ray is the z axis.
    #[inline(always)]
    fn sheared(&self, origin: &Point3<f64>, corner: &[f32; 3]) -> [f64; 3] {
        let [x, y, z] = self.axes;
        let [shear_x, shear_y, shear_z] = self.shear;
        let along = f64::from(corner[z]) - origin[z];
        let [right, up] = [f64::from(corner[x]) - origin[x], f64::from(corner[y]) - origin[y]];
        [right - shear_x * along, up - shear_y * along, shear_z * along]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 1.0], [1.0, 0.1, 1.2], [0.3, 1.0, 0.9], [1.1, 1.2, 1.1]];

    fn exact(corner: [f32; 3]) -> Vector3<f64> {
        Vector3::from(corner.map(f64::from))
    }

    #[test]
    fn a_ray_through_a_shared_edge_meets_one_of_both() {
        let [from, to] = [1, 2].map(|k| exact(CORNERS[k]));
        for n in 0..=1000 {
            let on_edge = from + (to - from) * (f64::from(n) / 1000.0);
            let origin = Point3::new(0.2, 0.4, -3.0);
            let shear = Shear::along(&(on_edge - origin.coords));
            let met = [[0, 1, 2], [2, 1, 3]].map(|face| shear.meet(&origin, &face.map(|k| CORNERS[k])).is_some());
            assert!(met[0] || met[1], "{n}");
        }
    }

    #[test]
    fn distance_and_weights_lead_to_the_same_point() {
        let [a, b, c, _] = CORNERS;
        let (origin, direction) = (Point3::new(0.1, -0.2, -1.0), Vector3::new(0.15, 0.3, 1.1));
        let (distance, [of_b, of_c]) = Shear::along(&direction).meet(&origin, &[a, b, c]).unwrap();
        let on_ray = origin.coords + direction * distance;
        let on_face = exact(a) * (1.0 - of_b - of_c) + exact(b) * of_b + exact(c) * of_c;
        assert!((on_ray - on_face).norm() < 1e-12);
        assert!(Shear::along(&-direction).meet(&origin, &[a, b, c]).is_none(), "it is ahead and not behind");
    }
}
