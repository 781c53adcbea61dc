//! Normals of a mesh, from the field, so that shading matches across borders.
//!
//! Where the field varies strongly within a voxel, its normal may face away from the triangles. There the mean normal of the
//! faces is used, see [`Facets::area_normals`].

use nalgebra::Vector3;

use crate::field::Field;

use super::facet::Facets;
use super::lattice::BRICK;
use super::{Mesh, QUANTA_PER_M};

/// Minimum cosine between a normal and the mean normal of the faces. Tuned: 75°.
const LEAST_COSINE: f64 = 0.25;

/// The normals at the vertices.
pub(super) fn normals(field: &dyn Field, voxel_m: f32, facets: &Facets) -> Vec<[f32; 3]> {
    let mut normals = steepest_descents(field, voxel_m, &facets.mesh);
    for (normal, &lean) in normals.iter_mut().zip(&facets.area_normals) {
        if opposes(*normal, lean) {
            *normal = unit(lean).unwrap_or(*normal);
        }
    }
    normals
}

/// Evaluates the field, a block of space at a time.
fn steepest_descents(field: &dyn Field, voxel_m: f32, mesh: &Mesh) -> Vec<[f32; 3]> {
    let block_quanta = (f64::from(BRICK) * f64::from(voxel_m) * f64::from(QUANTA_PER_M)) as i32;
    let block = |vertex: u32| mesh.positions[vertex as usize].map(|q| q.div_euclid(block_quanta));
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_by_cached_key(|&vertex| block(vertex));
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    for group in order.chunk_by(|&a, &b| block(a) == block(b)) {
        let points: Vec<[f32; 3]> = group.iter().map(|&vertex| mesh.position_m(vertex)).collect();
        for (&vertex, normal) in group.iter().zip(field.normals_at(&points)) {
            normals[vertex as usize] = normal;
        }
    }
    normals
}

/// Also true for a normal that is NaN.
fn opposes(normal: [f32; 3], lean: Vector3<f64>) -> bool {
    let cosine = Vector3::from(normal).map(f64::from).dot(&lean) / lean.norm();
    cosine.is_nan() || cosine < LEAST_COSINE
}

fn unit(lean: Vector3<f64>) -> Option<[f32; 3]> {
    let length = lean.norm();
    (length > 0.0).then(|| (lean / length).map(|c| c as f32).into())
}
