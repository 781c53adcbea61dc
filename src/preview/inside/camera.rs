//! A pinhole camera with a headlamp.

use crate::preview::Size;

/// Tangent of half the horizontal field of view, which is 80°.
const HALF_WIDTH: f32 = 0.839_1;

/// A camera pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position, metres.
    pub eye: [f32; 3],
    /// Yaw, radians anticlockwise from +x.
    pub yaw_rad: f32,
    /// Pitch, radians upwards.
    pub pitch_rad: f32,
}

impl Pose {
    /// Unit vector ahead.
    pub fn ahead(&self) -> [f32; 3] {
        let level = libm::cosf(self.pitch_rad);
        [level * libm::cosf(self.yaw_rad), level * libm::sinf(self.yaw_rad), libm::sinf(self.pitch_rad)]
    }
}

/// A ray: all points `start + t · along`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub from: [f32; 3],
    /// Unit direction.
    pub along: [f32; 3],
    /// Known distance of air, metres.
    pub start: f32,
}

impl Ray {
    /// The point at `t` metres.
    pub fn at(&self, t: f32) -> [f32; 3] {
        std::array::from_fn(|i| self.from[i] + t * self.along[i])
    }
}

/// Rays through pixels.
pub struct Camera {
    eye: [f32; 3],
    ahead: [f32; 3],
    right: [f32; 3],
    up: [f32; 3],
    size: Size,
    /// Width of a pixel at one metre.
    pub pixel: f32,
}

impl Camera {
    /// A camera for images of this size.
    pub fn new(pose: Pose, size: Size) -> Self {
        let ahead = pose.ahead();
        let right = [libm::sinf(pose.yaw_rad), -libm::cosf(pose.yaw_rad), 0.0];
        let up = cross(right, ahead);
        Self { eye: pose.eye, ahead, right, up, size, pixel: 2.0 * HALF_WIDTH / size.width as f32 }
    }

    /// The ray through a point of the image; pixels from its upper left corner.
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let across = (x - self.size.width as f32 / 2.0) * self.pixel;
        let down = (y - self.size.height as f32 / 2.0) * self.pixel;
        let along = std::array::from_fn(|i| self.ahead[i] + across * self.right[i] - down * self.up[i]);
        Ray { from: self.eye, along: unit(along), start: 0.0 }
    }

    /// Position of the headlamp: slightly above and to the left of the camera, so that relief is shaded.
    pub fn lamp(&self) -> [f32; 3] {
        std::array::from_fn(|i| self.eye[i] + 0.18 * self.up[i] - 0.22 * self.right[i])
    }
}

/// The scalar product.
pub fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The normalised vector; a zero vector is unchanged.
pub fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = dot(v, v).sqrt();
    if length > 1e-9 { v.map(|c| c / length) } else { v }
}

/// From one point to another.
pub fn between(from: [f32; 3], to: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| to[i] - from[i])
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
