//! The colliders of a chunk: one mesh, or a mesh per convex piece below a scope per zone.

use serde_json::{Value, json};

use super::{Array, push_triangles};
use crate::collision::Collision;
use crate::error::ExportError;
use crate::scene::{ByZone, Chunk, Mesh, Piece, Scene, Zone};
use crate::slope;
use crate::split_nonmanifold::split_nonmanifold_vertices;

/// The colliders of a chunk.
pub(super) enum Colliders {
    None,
    Triangles(Mesh),
    Pieces(Vec<Piece>),
}

impl Colliders {
    /// The colliders of the chunk `index`; a collision mesh is moved out of it.
    pub fn of(scene: &Scene, index: usize, chunk: &mut Chunk, wanted: Option<Collision>) -> Result<Self, ExportError> {
        Ok(match wanted {
            None => Self::None,
            Some(Collision::Triangles) => Self::Triangles(std::mem::take(&mut chunk.collision)),
            Some(Collision::Pieces) => Self::Pieces(scene.pieces(index)?),
        })
    }

    /// Number of triangles.
    pub fn triangles(&self) -> u64 {
        match self {
            Self::None => 0,
            Self::Triangles(mesh) => mesh.triangles(),
            Self::Pieces(pieces) => pieces.iter().map(|piece| piece.mesh.triangles()).sum(),
        }
    }

    /// The separate zones, each with its friction.
    pub fn zones(&self, friction: ByZone) -> Value {
        let Self::Pieces(pieces) = self else { return json!([]) };
        let there = Zone::ALL.into_iter().filter(|zone| pieces.iter().any(|piece| piece.zone == *zone));
        there.map(|zone| json!({ "name": zone.name(), "friction": friction.of(zone) })).collect()
    }

    /// The description of each mesh; its arrays go to `arrays`.
    pub fn describe(self, arrays: &mut Vec<(String, Array)>) -> Value {
        match self {
            Self::None => json!([]),
            Self::Triangles(mut mesh) => {
                split_nonmanifold_vertices(&mut mesh);
                json!([collider("Collision".to_owned(), "none", mesh, arrays)])
            }
            Self::Pieces(pieces) => pieces
                .into_iter()
                .enumerate()
                .map(|(number, Piece { mesh, zone })| {
                    collider(format!("Collision/{}/piece_{number}", zone.name()), "convexHull", mesh, arrays)
                })
                .collect(),
        }
    }
}

pub(super) fn collider(name: String, approximation: &str, mesh: Mesh, arrays: &mut Vec<(String, Array)>) -> Value {
    let extent = mesh.bounds();
    arrays.push((format!("{name}.normals"), Array::Float3(slope::face_normals(&mesh))));
    push_triangles(&name, mesh, arrays);
    json!({ "name": name, "arrays": name, "approximation": approximation, "extent": extent })
}
