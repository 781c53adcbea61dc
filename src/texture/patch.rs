//! Interpolation of vertex attributes at texels, like a renderer.

use super::Textured;
use super::raster::{self, Corners, SUBTEXELS};

/// How far beyond a triangle, relative to its height, its plane is extrapolated for gutter texels; farther out the nearest
/// point is used. Tuned: slivers must not extrapolate far.
const REACH: f32 = 1.0;

/// A triangle of the atlas.
pub(super) struct Patch {
    corners: Corners,
    inverse_area: f32,
    positions: [[f32; 3]; 3],
    normals: [[f32; 3]; 3],
    tangents: [[f32; 3]; 3],
    sign: f32,
}

/// Position and frame at a texel, cave frame. Normal and tangent are interpolated, not unit, as in a shader.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub tangent: [f32; 3],
    /// Sign of the bitangent.
    pub sign: f32,
}

/// A triangle's corners on the lattice of the rasteriser; exact.
pub(super) fn corners(textured: &Textured, triangle: u32) -> Corners {
    let side = textured.size_px as f32 * SUBTEXELS as f32;
    textured.triangles[triangle as usize].map(|v| textured.uvs[v as usize].map(|c| (c * side + 0.5) as i32))
}

impl Patch {
    pub fn new(textured: &Textured, triangle: u32) -> Self {
        let corners = corners(textured, triangle);
        let area = raster::doubled_area(&corners);
        let vertices = textured.triangles[triangle as usize].map(|v| v as usize);
        let tangents = vertices.map(|v| textured.tangents[v]);
        Self {
            corners,
            inverse_area: if area > 0 { 1.0 / area as f32 } else { 0.0 },
            positions: vertices.map(|v| textured.positions[v]),
            normals: vertices.map(|v| textured.normals[v]),
            tangents: tangents.map(|[x, y, z, _]| [x, y, z]),
            sign: tangents[0][3],
        }
    }

    /// The frame at the centre of a texel, which may lie outside.
    pub fn frame(&self, x: i32, y: i32) -> Frame {
        let weights = self.weights(x, y);
        let least = weights[0].min(weights[1]).min(weights[2]);
        let nearest = if least < 0.0 { clamped(weights) } else { weights };
        Frame {
            position: self.position(if least < -REACH { nearest } else { weights }),
            normal: mix(nearest, self.normals),
            tangent: mix(nearest, self.tangents),
            sign: self.sign,
        }
    }

    /// Barycentric weights.
    fn weights(&self, x: i32, y: i32) -> [f32; 3] {
        if self.inverse_area == 0.0 {
            return [1.0 / 3.0; 3];
        }
        let at = [raster::centre(x), raster::centre(y)];
        let [a, b, c] = self.corners.map(|p| [i64::from(p[0]) - at[0], i64::from(p[1]) - at[1]]);
        let second = (c[0] * a[1] - c[1] * a[0]) as f32 * self.inverse_area;
        let third = (a[0] * b[1] - a[1] * b[0]) as f32 * self.inverse_area;
        [1.0 - second - third, second, third]
    }

    /// Interpolates differences from the first corner, which preserves `f32` precision far from the origin.
    fn position(&self, weights: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = self.positions;
        [0, 1, 2].map(|k| a[k] + (weights[1] * (b[k] - a[k]) + weights[2] * (c[k] - a[k])))
    }
}

fn clamped(weights: [f32; 3]) -> [f32; 3] {
    let inside = weights.map(|w| w.max(0.0));
    let sum = inside[0] + inside[1] + inside[2];
    inside.map(|w| w / sum)
}

fn mix(weights: [f32; 3], [a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k])
}

impl Frame {
    /// `normal` (unit, cave frame) in the tangent space of this frame: the unit vector from which a shader reconstructs it
    /// by `normalize(x * t + y * b + z * n)` with `b = w * cross(n, t)`. Never below the surface.
    pub fn tangent_normal(&self, normal: [f32; 3]) -> [f32; 3] {
        let (n, t) = (self.normal, self.tangent);
        let b = cross(n, t).map(|c| c * self.sign);
        let rows = [cross(b, n), cross(n, t), cross(t, b)];
        let sign = if dot(t, rows[0]) < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = rows.map(|row| sign * dot(normal, row));
        unit_or([x, y, z.max(0.0)], [0.0, 0.0, 1.0])
    }

    /// The interpolated normal at unit length.
    pub fn unit_normal(&self) -> [f32; 3] {
        unit_or(self.normal, [0.0, 0.0, 1.0])
    }
}

fn unit_or(vector: [f32; 3], fallback: [f32; 3]) -> [f32; 3] {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 { vector.map(|c| c / length) } else { fallback }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
