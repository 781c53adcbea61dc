//! Mass properties of solid bodies.

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};

use crate::error::ExportError;
use crate::scene::{Instance, Mesh, Prototype};

/// Sweeps of Jacobi's method. Each squares what is left off the diagonal: three axes need about five.
const SWEEPS: usize = 8;

/// Mass properties of a body in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inertia {
    /// Mass in kilograms.
    pub mass_kg: f64,
    /// Centre of mass in metres.
    pub center: Point3<f64>,
    /// Moments and products of inertia about the centre of mass, in kg m².
    pub tensor: Matrix3<f64>,
}

impl Inertia {
    /// Those of a thing that fills its hull evenly: in the frame of its prototype, in its own size.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if the hull has no volume.
    pub fn of_thing(thing: &Instance, prototype: &Prototype) -> Result<Self, ExportError> {
        Self::of_solid(&prototype.hull, thing.scale, thing.mass_kg).ok_or_else(|| ExportError::BadScene {
            scene: thing.chunk.clone(),
            fault: format!("the hull of prototype `{}` has no volume", prototype.name),
        })
    }

    /// Those of a solid within a closed mesh, enlarged by `scale`; none if it has no volume.
    fn of_solid(mesh: &Mesh, scale: f64, mass_kg: f64) -> Option<Self> {
        let at = |corner: u32| Vector3::from(mesh.positions[corner as usize].map(f64::from)) * scale;
        // Sums over the tetrahedra between one vertex and each triangle.
        let apex = at(*mesh.indices.first()?);
        let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|corner| at(corners[corner]) - apex);
            let (six_volumes, sum) = (a.dot(&b.cross(&c)), a + b + c);
            let squares = [a, b, c, sum].iter().fold(Matrix3::zeros(), |all, v| all + v * v.transpose());
            volume += six_volumes / 6.0;
            first += sum * (six_volumes / 24.0);
            second += squares * (six_volumes / 120.0);
        }
        if volume <= 0.0 {
            return None;
        }
        let center = first / volume;
        let about_center = (second / volume - center * center.transpose()) * mass_kg;
        let tensor = Matrix3::identity() * about_center.trace() - about_center;
        Some(Self { mass_kg, center: (center + apex).into(), tensor })
    }

    /// The moments about the principal axes in kg m², and the turn from these axes to those of the body.
    pub fn principal(&self) -> ([f64; 3], UnitQuaternion<f64>) {
        let (mut tensor, mut axes) = (self.tensor, Matrix3::identity());
        for [p, q] in [[0, 1], [0, 2], [1, 2]].repeat(SWEEPS) {
            let turn = diagonalising(&tensor, p, q);
            tensor = turn.transpose() * tensor * turn;
            axes *= turn;
        }
        let rotation = Rotation3::from_matrix_unchecked(axes);
        (tensor.diagonal().into(), UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

/// The turn in the plane of the axes `p` and `q` that removes their product of inertia (Golub and Van Loan, Matrix
/// Computations, 8.5).
fn diagonalising(tensor: &Matrix3<f64>, p: usize, q: usize) -> Matrix3<f64> {
    let mut turn = Matrix3::identity();
    let product = tensor[(p, q)];
    if product == 0.0 {
        return turn;
    }
    let half = (tensor[(q, q)] - tensor[(p, p)]) / (2.0 * product);
    let tangent = 1.0_f64.copysign(half) / (half.abs() + (half * half + 1.0).sqrt());
    let cos = 1.0 / (tangent * tangent + 1.0).sqrt();
    (turn[(p, p)], turn[(q, q)]) = (cos, cos);
    (turn[(p, q)], turn[(q, p)]) = (tangent * cos, -tangent * cos);
    turn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with these edges around `center`, turned.
    fn cuboid(edges: [f32; 3], center: [f64; 3], turn: &Rotation3<f64>) -> Mesh {
        let corner = |number: usize| {
            let side = |axis: usize| if number >> axis & 1 == 1 { 0.5 } else { -0.5 };
            let local = Vector3::from([0, 1, 2].map(|axis| side(axis) * f64::from(edges[axis])));
            (turn * local + Vector3::from(center)).map(|part| part as f32).into()
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let indices = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
        Mesh { positions: (0..8).map(corner).collect(), indices, ..Mesh::default() }
    }

    /// m/12 (b² + c²) about each axis.
    fn moments(mass_kg: f64, [a, b, c]: [f64; 3]) -> Vector3<f64> {
        Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (mass_kg / 12.0)
    }

    #[test]
    fn a_box_has_the_moments_of_the_formula() {
        let turn: Rotation3<f64> = UnitQuaternion::from_euler_angles(0.4, -0.9, 2.0).to_rotation_matrix();
        let solid = cuboid([0.2, 0.4, 0.6], [3.0, -2.0, 5.0], &turn);
        let inertia = Inertia::of_solid(&solid, 1.5, 7.0).unwrap();
        assert!((inertia.center - Point3::new(4.5, -3.0, 7.5)).norm() < 1e-6);
        let expected = Matrix3::from_diagonal(&moments(7.0, [0.3, 0.6, 0.9]));
        let expected = turn.matrix() * expected * turn.matrix().transpose();
        assert!((inertia.tensor - expected).norm() < 1e-5, "{}", inertia.tensor);
    }

    #[test]
    fn principal_axes_give_the_tensor_back() {
        for angles in [[0.0; 3], [0.4, -0.9, 2.0], [1e-9, 0.0, 0.0], [0.0, 0.0, 1.5]] {
            let [roll, pitch, yaw] = angles;
            let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw).to_rotation_matrix();
            for edges in [[0.2, 0.4, 0.6], [0.3, 0.3, 0.1], [0.5; 3]] {
                let inertia = Inertia::of_solid(&cuboid(edges, [1.0; 3], &turn), 1.0, 7.0).unwrap();
                let (found, axes) = inertia.principal();
                let axes = axes.to_rotation_matrix();
                let again = axes.matrix() * Matrix3::from_diagonal(&found.into()) * axes.matrix().transpose();
                assert!((again - inertia.tensor).norm() < 1e-12, "{angles:?} {edges:?}");
                let sorted = |mut moments: [f64; 3]| {
                    moments.sort_by(f64::total_cmp);
                    Vector3::from(moments)
                };
                let expected = moments(7.0, edges.map(f64::from)).into();
                assert!((sorted(found) - sorted(expected)).norm() < 1e-5, "{found:?}");
            }
        }
    }

    #[test]
    fn a_flat_mesh_has_none() {
        let flat = cuboid([1.0, 1.0, 0.0], [0.0; 3], &Rotation3::identity());
        assert_eq!(Inertia::of_solid(&flat, 1.0, 1.0), None);
        assert_eq!(Inertia::of_solid(&Mesh::default(), 1.0, 1.0), None);
    }
}
