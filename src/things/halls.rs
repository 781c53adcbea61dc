//! The part of the shelf that is no field: solids and models, each in a cube of its own.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::replica::Replica;
use super::shelf::{SOLIDS, Shelf, middle_of};
use super::solid::Solid;
use super::substance::Sample;
use crate::field::Texel;
use crate::mesh::{Mesh, QUANTA_PER_M};

/// What is in a cube.
pub(super) enum Hall {
    /// A thing made of parts.
    Solid(Solid),
    /// A model of the user, as clean as it is.
    Replica(Arc<Replica>),
}

impl Shelf {
    /// What is in a slot.
    pub(super) fn hall(&self, slot: usize) -> Option<&Hall> {
        self.halls.get(slot.checked_sub(SOLIDS)?)
    }

    /// Adds the solids and the models, which are no part of the field, to its mesh.
    pub(super) fn add_halls(&self, mesh: &mut Mesh) {
        for (n, hall) in self.halls.iter().enumerate() {
            let middle_m = middle_of(SOLIDS + n).map(f64::from);
            match hall {
                Hall::Solid(solid) => add_solid(mesh, solid, middle_m),
                Hall::Replica(replica) => add_replica(mesh, replica, middle_m),
            }
        }
    }

    /// The surface of at most [`BLOCK`](crate::material::BLOCK) points of a hall, with their normals.
    pub(super) fn paint_hall(&self, slot: usize, texel_m: f32, [points, normals]: [&[[f32; 3]]; 2], out: &mut [Texel]) {
        let middle = middle_of(slot);
        let own: Vec<[f32; 3]> = points.iter().map(|p| std::array::from_fn(|axis| p[axis] - middle[axis])).collect();
        match self.hall(slot) {
            Some(Hall::Solid(solid)) => self.paint_solid(solid, &own, normals, out),
            Some(Hall::Replica(replica)) => replica.paint(&own, texel_m, out),
            None => {}
        }
    }

    /// The surface of a solid at its `own` points.
    fn paint_solid(&self, solid: &Solid, own: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        let part = |n: usize| solid.part_at(Point3::from(own[n].map(f64::from)));
        let mut start = 0;
        while start < own.len() {
            let here = part(start);
            let end = (start..own.len()).take_while(|&n| std::ptr::eq(part(n), here)).count() + start;
            let samples = here.substance.samples(&here.frame, self.source, [&own[start..end], &normals[start..end]]);
            for (lane, sample) in (start..end).zip(samples) {
                let Sample { color, normal, roughness } = sample;
                out[lane] = Texel { color, normal, roughness, occlusion: 1.0, height_m: 0.0 };
            }
            start = end;
        }
    }
}

fn add_solid(mesh: &mut Mesh, solid: &Solid, middle_m: [f64; 3]) {
    let middle = Vector3::from(middle_m);
    for part in &solid.parts {
        let first = mesh.positions.len() as u32;
        let quanta = |c: f64| (c * f64::from(QUANTA_PER_M)).round() as i32;
        mesh.positions.extend(part.vertices.iter().map(|v| <[i32; 3]>::from((v.at + middle).map(quanta))));
        mesh.normals.extend(part.vertices.iter().map(|v| <[f32; 3]>::from(v.normal.map(|c| c as f32))));
        mesh.border.resize(mesh.positions.len(), false);
        mesh.triangles.extend(part.faces.iter().map(|face| face.map(|corner| corner + first)));
    }
}

/// Moves all corners by whole quanta, so that none falls onto another.
fn add_replica(mesh: &mut Mesh, replica: &Replica, middle_m: [f64; 3]) {
    let middle = middle_m.map(|c| (c * f64::from(QUANTA_PER_M)).round() as i32);
    let first = mesh.positions.len() as u32;
    let Mesh { positions, normals, triangles, border } = replica.mesh();
    mesh.positions.extend(positions.iter().map(|at| [0, 1, 2].map(|axis| at[axis] + middle[axis])));
    mesh.normals.extend(normals);
    mesh.border.extend(border);
    mesh.triangles.extend(triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
}
