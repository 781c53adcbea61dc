use nalgebra::{Matrix3, Vector3};

/// Squared distances to a set of planes, weighted by area: Garland and Heckbert's error quadric (*Surface
/// simplification using quadric error metrics*, 1997).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Quadric {
    /// Upper triangle of Σ w n nᵀ: xx, xy, xz, yy, yz, zz.
    square: [f64; 6],
    /// Σ w d n, for planes n·x + d = 0.
    linear: Vector3<f64>,
    /// Σ w d².
    constant: f64,
    /// Σ w.
    weight: f64,
}

/// Planes count as parallel below this share of the determinant of a corner. Tuned.
const FLATTEST: f64 = 1e-4 / 27.0;

impl Quadric {
    /// The plane of a triangle, weighted by its area; empty if it has none.
    pub(super) fn of_triangle([a, b, c]: [Vector3<f64>; 3]) -> Self {
        let area = (b - a).cross(&(c - a));
        let double = area.norm();
        if double == 0.0 {
            return Self::default();
        }
        let (n, weight) = (area / double, double * 0.5);
        let d = -n.dot(&a);
        let square = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z];
        Self { square: square.map(|s| s * weight), linear: n * (d * weight), constant: d * d * weight, weight }
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (a, b) in self.square.iter_mut().zip(other.square) {
            *a += b;
        }
        self.linear += other.linear;
        self.constant += other.constant;
        self.weight += other.weight;
    }

    /// Sum of the weights of the planes.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// Squared distances of `p` to the planes, weighted and summed.
    pub(super) fn sum_at(&self, p: &Vector3<f64>) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.square;
        let square = xx * p.x * p.x + yy * p.y * p.y + zz * p.z * p.z;
        let mixed = xy * p.x * p.y + xz * p.x * p.z + yz * p.y * p.z;
        (square + 2.0 * (mixed + self.linear.dot(p)) + self.constant).max(0.0)
    }

    /// The point nearest to all planes, unless it is ill-conditioned.
    pub(super) fn minimum(&self) -> Option<Vector3<f64>> {
        let [xx, xy, xz, yy, yz, zz] = self.square;
        let trace = xx + yy + zz;
        let cofactors = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy];
        let determinant = xx * cofactors[0] + xy * cofactors[1] + xz * cofactors[2];
        if determinant.abs() <= FLATTEST * trace * trace * trace {
            return None;
        }
        let (c11, c12, c22) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
        let adjugate = Matrix3::new(
            cofactors[0],
            cofactors[1],
            cofactors[2], //
            cofactors[1],
            c11,
            c12, //
            cofactors[2],
            c12,
            c22,
        );
        Some(adjugate * -self.linear / determinant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_their_corner() {
        let corner = Vector3::new(3.0, -2.0, 5.0);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let mut sum = Quadric::default();
        for k in 0..3 {
            let (u, v) = (axes[k], axes[(k + 1) % 3]);
            sum.add(&Quadric::of_triangle([corner, corner + u, corner + v]));
        }
        assert!((sum.minimum().unwrap() - corner).norm() < 1e-12);
        assert!(sum.sum_at(&corner) < 1e-12);
        let away = corner + Vector3::new(0.0, 0.0, 2.0);
        assert!((sum.sum_at(&away) - 0.5 * 4.0).abs() < 1e-12, "one plane of three is 2 away");
    }

    #[test]
    fn a_flat_patch_has_no_corner() {
        let flat = Quadric::of_triangle([Vector3::zeros(), Vector3::x(), Vector3::y()]);
        assert!(flat.minimum().is_none());
    }
}
