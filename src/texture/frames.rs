//! Positions and tangent frames of many texels, by coordinate, so that vectors can process them.

use super::patch::{Patch, Weights};
use crate::noise::dispatched;
use fearless_simd::Simd;

/// Vectors of all texels, as their x, y and z coordinates.
pub(super) type Coordinates = [Vec<f32>; 3];

/// Position and frame of texels, cave frame. Normal and tangent are interpolated, not unit, as in a shader.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    pub positions: Coordinates,
    pub normals: Coordinates,
    pub tangents: Coordinates,
    /// Signs of the bitangents.
    pub signs: Vec<f32>,
    weights: Vec<Weights>,
}

impl Frames {
    pub fn clear(&mut self) {
        let Self { positions, normals, tangents, signs, .. } = self;
        [positions, normals, tangents].into_iter().flatten().for_each(Vec::clear);
        signs.clear();
    }

    /// Adds the texels of a row from column `x` on, as `patch` shows them.
    pub fn extend(&mut self, patch: &Patch, x: i32, y: i32, len: u32) {
        self.weights.clear();
        self.weights.extend((x..x + len as i32).map(|x| patch.weights(x, y)));
        for axis in 0..3 {
            let corner = |of: [[f32; 3]; 3]| of.map(|corner| corner[axis]);
            let [a, b, c] = corner(patch.positions);
            let [ab, ac] = [b - a, c - a];
            // Differences from the first corner preserve `f32` precision far from the origin.
            let position = |w: &Weights| a + (w.plane[1] * ab + w.plane[2] * ac);
            self.positions[axis].extend(self.weights.iter().map(position));
            let [a, b, c] = corner(patch.normals);
            self.normals[axis].extend(self.weights.iter().map(|w| w.mix(a, b, c)));
            let [a, b, c] = corner(patch.tangents);
            self.tangents[axis].extend(self.weights.iter().map(|w| w.mix(a, b, c)));
        }
        self.signs.resize(self.signs.len() + len as usize, patch.sign);
    }

    /// The interpolated normals at unit length.
    pub fn unit_normals(&self) -> Coordinates {
        dispatched!(simd => unit_normals(simd, &self.normals))
    }

    /// These unit normals (cave frame) in the tangent spaces of the frames: the unit vectors from which a shader reconstructs
    /// them by `normalize(x * t + y * b + z * n)` with `b = w * cross(n, t)`. Never below the surface.
    pub fn tangent_normals(&self, normals: &Coordinates) -> Coordinates {
        dispatched!(simd => tangent_normals(simd, self, normals))
    }
}

#[inline(always)]
fn unit_normals<S: Simd>(_simd: S, [x, y, z]: &Coordinates) -> Coordinates {
    let mut units = [x.clone(), y.clone(), z.clone()];
    let [ux, uy, uz] = &mut units;
    for ((x, y), z) in ux.iter_mut().zip(uy).zip(uz) {
        [*x, *y, *z] = unit_or_up([*x, *y, *z]);
    }
    units
}

#[inline(always)]
fn tangent_normals<S: Simd>(_simd: S, frames: &Frames, normals: &Coordinates) -> Coordinates {
    let mut local = normals.clone();
    let [lx, ly, lz] = &mut local;
    let len = lx.len();
    let ([nx, ny, nz], [tx, ty, tz]) = (&frames.normals, &frames.tangents);
    let (nx, ny, nz, tx, ty, tz) = (&nx[..len], &ny[..len], &nz[..len], &tx[..len], &ty[..len], &tz[..len]);
    let (lx, ly, lz, signs) = (&mut lx[..len], &mut ly[..len], &mut lz[..len], &frames.signs[..len]);
    for i in 0..len {
        let (n, t) = ([nx[i], ny[i], nz[i]], [tx[i], ty[i], tz[i]]);
        let b = cross(n, t);
        let b = [b[0] * signs[i], b[1] * signs[i], b[2] * signs[i]];
        let rows = [cross(b, n), cross(n, t), cross(t, b)];
        let sign = if dot(t, rows[0]) < 0.0 { -1.0 } else { 1.0 };
        let normal = [lx[i] * sign, ly[i] * sign, lz[i] * sign];
        let toward = [dot(normal, rows[0]), dot(normal, rows[1]), dot(normal, rows[2]).max(0.0)];
        [lx[i], ly[i], lz[i]] = unit_or_up(toward);
    }
    local
}

#[inline(always)]
fn unit_or_up([x, y, z]: [f32; 3]) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    if length > 0.0 { [x / length, y / length, z / length] } else { [0.0, 0.0, 1.0] }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
