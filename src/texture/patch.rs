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
    pub positions: [[f32; 3]; 3],
    pub normals: [[f32; 3]; 3],
    pub tangents: [[f32; 3]; 3],
    /// Sign of the bitangent.
    pub sign: f32,
}

/// Barycentric weights of a texel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// For its position, on the plane of the triangle.
    pub plane: [f32; 3],
    /// For its attributes: those of the nearest point of the triangle.
    pub nearest: [f32; 3],
}

impl Weights {
    /// Interpolates an attribute of the corners.
    pub fn mix(&self, a: f32, b: f32, c: f32) -> f32 {
        self.nearest[0] * a + self.nearest[1] * b + self.nearest[2] * c
    }
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

    /// The weights at the centre of a texel, which may lie outside.
    pub fn weights(&self, x: i32, y: i32) -> Weights {
        let plane = self.barycentric(x, y);
        let least = plane[0].min(plane[1]).min(plane[2]);
        let nearest = if least < 0.0 { clamped(plane) } else { plane };
        Weights { plane: if least < -REACH { nearest } else { plane }, nearest }
    }

    fn barycentric(&self, x: i32, y: i32) -> [f32; 3] {
        if self.inverse_area == 0.0 {
            return [1.0 / 3.0; 3];
        }
        let at = [raster::centre(x), raster::centre(y)];
        let [a, b, c] = self.corners.map(|p| [i64::from(p[0]) - at[0], i64::from(p[1]) - at[1]]);
        let second = (c[0] * a[1] - c[1] * a[0]) as f32 * self.inverse_area;
        let third = (a[0] * b[1] - a[1] * b[0]) as f32 * self.inverse_area;
        [1.0 - second - third, second, third]
    }
}

fn clamped(weights: [f32; 3]) -> [f32; 3] {
    let inside = weights.map(|w| w.max(0.0));
    let sum = inside[0] + inside[1] + inside[2];
    inside.map(|w| w / sum)
}
