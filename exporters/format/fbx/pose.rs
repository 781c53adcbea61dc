//! Where a node is.

use nalgebra::{Isometry3, Point3};

use crate::frame::{self, Up};

/// Where a node is in the frame of the file, and its size.
pub struct Pose {
    /// In metres.
    pub position: [f64; 3],
    /// Angles about fixed x, y and z.
    pub degrees: [f64; 3],
    /// Size of what it shows, relative to its geometry.
    pub scale: f64,
}

impl Pose {
    /// At the origin, not turned.
    pub const ORIGIN: Self = Self { position: [0.0; 3], degrees: [0.0; 3], scale: 1.0 };

    /// A body of the scene, whose own axes stay what they are in the scene.
    pub fn of_body(pose: &Isometry3<f64>, up: Up) -> Self {
        Self::new(match up {
            Up::Z => frame::euler_pose(pose),
            Up::Y => frame::gltf_euler_pose_from_scene(pose),
        })
    }

    /// A copy of a geometry, whose vertices are in the frame of the file already.
    pub fn of_copy(pose: &Isometry3<f64>, scale: f64, up: Up) -> Self {
        let pose = match up {
            Up::Z => *pose,
            Up::Y => frame::gltf_isometry_from_scene(pose),
        };
        Self { scale, ..Self::new(frame::euler_pose(&pose)) }
    }

    /// A point, which has no axes.
    pub fn of_point(point: Point3<f64>, up: Up) -> Self {
        let position = match up {
            Up::Z => point.into(),
            Up::Y => frame::gltf_from_scene(point.into()),
        };
        Self { position, ..Self::ORIGIN }
    }

    fn new((position, angles): ([f64; 3], [f64; 3])) -> Self {
        Self { position, degrees: angles.map(f64::to_degrees), scale: 1.0 }
    }
}
