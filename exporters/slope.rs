//! Zones of triangles, by slope.

use std::f32::consts::FRAC_1_SQRT_2;

use nalgebra::Vector3;

use crate::scene::{Mesh, Zone};

/// Faces by zone: those that face up or down within 45° are floor and ceiling, the others wall.
pub(crate) fn zones(mesh: &Mesh) -> [(Zone, Vec<u32>); 3] {
    let mut zones = Zone::ALL.map(|zone| (zone, Vec::new()));
    for (face, normal) in face_normals(mesh).into_iter().enumerate() {
        zones[zone(normal) as usize].1.push(face as u32);
    }
    zones
}

/// The zone of a face with this unit normal.
pub(crate) fn zone(normal: [f32; 3]) -> Zone {
    match normal[2] {
        up if up > FRAC_1_SQRT_2 => Zone::Floor,
        up if up < -FRAC_1_SQRT_2 => Zone::Ceiling,
        _ => Zone::Wall,
    }
}

/// Unit normals of the triangles.
pub(crate) fn face_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let normal = |corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|k| Vector3::from(mesh.positions[corners[k] as usize].map(f64::from)));
        let across = (b - a).cross(&(c - a));
        <[f64; 3]>::from(across / across.norm()).map(|part| part as f32)
    };
    mesh.indices.chunks_exact(3).map(normal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_classified_by_slope() {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.9], [0.0, 1.0, 1.1]];
        let indices = vec![0, 1, 2, 0, 2, 1, 0, 1, 3, 0, 1, 4, 0, 4, 1];
        let faces = zones(&Mesh { positions, indices, ..Mesh::default() });
        assert_eq!(faces, [(Zone::Floor, vec![0, 2]), (Zone::Wall, vec![3, 4]), (Zone::Ceiling, vec![1])]);
    }
}
