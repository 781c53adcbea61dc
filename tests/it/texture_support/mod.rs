//! Meshes and surfaces with known answers.

pub mod baked;
pub mod bands;

use plume::field::{Aabb, Surface, Texel};
use plume::mesh::{Mesh, QUANTA_PER_M};

type Vector = [f64; 3];

/// A closed strip of quads: `along` × `around` points, the wall seen from inside.
pub fn tube(along: usize, around: usize, closed: bool, point: impl Fn(f64, f64) -> Vector) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..along {
        for j in 0..around {
            let s = i as f64 / (along - usize::from(!closed)) as f64;
            let p = point(s, j as f64 / around as f64);
            mesh.positions.push(p.map(|c| (c * f64::from(QUANTA_PER_M)).round() as i32));
        }
    }
    let at = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
    for i in 0..along - usize::from(!closed) {
        for j in 0..around {
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    mesh.border = vec![false; mesh.positions.len()];
    mesh.normals = averaged_normals(&mesh);
    mesh
}

/// A passage of roughly 3 m radius with bumps of many sizes.
pub fn rough_passage(along: usize, around: usize, length_m: f64, seed: u64) -> Mesh {
    let phase = |k: u64| (seed.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503) % 6283) as f64 / 1000.0;
    tube(along, around, false, |s, t| {
        let (x, angle) = (s * length_m, t * std::f64::consts::TAU);
        let bump = |wave: f64, lobes: f64, size: f64, k: u64| {
            size * libm::sin(x * wave + phase(k)) * libm::cos(lobes * angle + phase(k + 1))
        };
        let radius =
            3.0 + bump(0.7, 2.0, 0.6, 0) + bump(1.9, 5.0, 0.3, 2) + bump(4.3, 11.0, 0.12, 4) + bump(9.1, 23.0, 0.05, 6);
        let bend = 4.0 * libm::sin(x * 0.15 + phase(8));
        [x, bend + radius * libm::cos(angle), radius * libm::sin(angle)]
    })
}

/// A spiral ramp: what faces up or down overlaps itself when seen from above.
pub fn spiral(turns: f64, along: usize, around: usize) -> Mesh {
    tube(along, around, false, |s, t| {
        let (turn, angle) = (s * turns * std::f64::consts::TAU, t * std::f64::consts::TAU);
        let reach = 5.0 - 1.5 * libm::cos(angle);
        [reach * libm::cos(turn), reach * libm::sin(turn), 4.0 * s * turns + 1.5 * libm::sin(angle)]
    })
}

/// A bubble of rock-free space.
pub fn bubble(along: usize, around: usize, radius_m: f64) -> Mesh {
    tube(along, around, false, |s, t| {
        let (polar, angle) = (0.02 + s * 3.1, -t * std::f64::consts::TAU);
        let ring = radius_m * libm::sin(polar);
        [ring * libm::cos(angle), ring * libm::sin(angle), -radius_m * libm::cos(polar)]
    })
}

fn averaged_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0_f64; 3]; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].map(f64::from));
        let normal = cross(sub(b, a), sub(c, a));
        for &v in triangle {
            (0..3).for_each(|k| sums[v as usize][k] += normal[k]);
        }
    }
    sums.into_iter().map(|n| unit(n).map(|c| c as f32)).collect()
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn unit(a: Vector) -> Vector {
    a.map(|c| c / dot(a, a).sqrt())
}

/// Smooth colours from the position; the normal of the mesh, leaning by `tilt`.
pub struct Gradient {
    pub tilt: [f32; 3],
}

impl Gradient {
    pub fn color_at(p: [f32; 3]) -> [f32; 3] {
        p.map(|c| 0.5 + 0.4 * libm::sinf(0.8 * c))
    }

    pub fn height_at(p: [f32; 3]) -> f32 {
        0.2 * libm::sinf(0.8 * p[0])
    }

    pub fn leaning(&self, normal: [f32; 3]) -> [f32; 3] {
        unit([0, 1, 2].map(|k| f64::from(normal[k] + self.tilt[k]))).map(|c| c as f32)
    }
}

impl Surface for Gradient {
    fn texels(&self, bounds: Aabb<f32>, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        assert!(texel_m > 0.0);
        for ((point, &normal), texel) in points.iter().zip(normals).zip(out) {
            assert!(bounds.contains(*point));
            let color = Self::color_at(*point);
            let normal = self.leaning(normal);
            *texel =
                Texel { color, normal, roughness: color[0], occlusion: color[1], height_m: Self::height_at(*point) };
        }
    }
}
