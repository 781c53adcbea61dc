//! Points in vector lanes, and smooth combinations of numbers.

use super::lane::Real;
use fearless_simd::Simd;

/// A point or direction in lanes, metres.
#[derive(Clone, Copy, Debug)]
pub struct Vec3<T> {
    /// East.
    pub x: T,
    /// North.
    pub y: T,
    /// Up.
    pub z: T,
}

/// A vector of its components.
#[inline(always)]
pub fn vec3<T>(x: T, y: T, z: T) -> Vec3<T> {
    Vec3 { x, y, z }
}

impl<T> Vec3<T> {
    /// All components times a factor.
    #[inline(always)]
    pub fn scaled<S: Simd>(self, factor: f32) -> Self
    where
        T: Real<S>,
    {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }

    /// Each component times its own factor.
    #[inline(always)]
    pub fn stretched<S: Simd>(self, x: f32, y: f32, z: f32) -> Self
    where
        T: Real<S>,
    {
        vec3(self.x * x, self.y * y, self.z * z)
    }

    /// Moved by a constant.
    #[inline(always)]
    pub fn shifted<S: Simd>(self, x: f32, y: f32, z: f32) -> Self
    where
        T: Real<S>,
    {
        vec3(self.x + x, self.y + y, self.z + z)
    }

    /// Projection on a constant direction.
    #[inline(always)]
    pub fn along<S: Simd>(self, direction: [f32; 3]) -> T
    where
        T: Real<S>,
    {
        self.x * direction[0] + self.y * direction[1] + self.z * direction[2]
    }

    /// Rotated by a fixed rotation, so that lattices of successive octaves are not aligned.
    #[inline(always)]
    pub fn turned<S: Simd>(self) -> Self
    where
        T: Real<S>,
    {
        vec3(self.along([0.0, 0.80, 0.60]), self.along([-0.80, 0.36, -0.48]), self.along([-0.60, -0.48, 0.64]))
    }
}

/// Polynomial smooth minimum: exactly the smaller where they differ by `width` or more, at most `width / 4` below it.
#[inline(always)]
pub fn soft_min<S: Simd, T: Real<S>>(a: T, b: T, width: f32) -> T {
    let difference = a - b;
    let gap = difference.max(-difference);
    let near = (-gap + width).at_least(0.0) * (1.0 / width);
    a.min(b) - near * near * (width * 0.25)
}

/// Polynomial smooth maximum: exactly the larger where they differ by `width` or more, at most `width / 4` above it.
#[inline(always)]
pub fn soft_max<S: Simd, T: Real<S>>(a: T, b: T, width: f32) -> T {
    -soft_min(-a, -b, width)
}

/// Interpolates from `a` at 0 to `b` at 1.
#[inline(always)]
pub fn mix<S: Simd, T: Real<S>>(a: T, b: T, t: T) -> T {
    a + (b - a) * t
}
