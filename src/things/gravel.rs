//! Gravel: stones too small to hinder anything that drives, which are only drawn.
//!
//! Promised: each stone lies on the triangle of the wall under it, and follows from the walls of its chunk alone. Not promised:
//! that stones do not overlap, or are in nothing larger.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::Thing;
use super::catalogue::KINDS;
use super::kind::{Place, Scatter};
use super::place::{Candidate, Setting, Site, owns};
use super::rest::about_z;
use crate::mesh::Mesh;
use plume_graph::Aabb;

/// How far around a chunk the triangles are that its gravel may lie on, in metres.
const MARGIN_M: f64 = 0.1;
/// Share of the height of a stone that is in the ground. Tuned: it neither floats nor drowns.
const SUNK: f64 = 0.2;

/// The gravel in a chunk, given its wall and those of its neighbours; from large to small.
pub fn strew<'a>(setting: &Setting, chunk: Aabb<f64>, walls: impl Iterator<Item = &'a Mesh>) -> Vec<Thing> {
    let Some(site) = Site::new(setting, chunk.padded(MARGIN_M), walls, 0.0) else { return Vec::new() };
    let kinds = site.rows().filter_map(|row| match row.place {
        Place::Strewn(scatter) => Some((row, scatter)),
        _ => None,
    });
    let amount = site.settings.gravel;
    let scattered = kinds.flat_map(|(row, scatter)| {
        let scatter = Scatter { share: scatter.share * amount, ..scatter };
        site.scattered(row, scatter, chunk.padded(MARGIN_M))
    });
    let mut candidates: Vec<Candidate> = scattered.collect();
    candidates.sort_by(|a, b| b.rank.total_cmp(&a.rank).then(a.id.cmp(&b.id)));
    let gravel = candidates.iter().filter_map(|candidate| site.lain(candidate));
    gravel.filter(|stone| owns(&chunk, stone.pose.translation.vector)).collect()
}

impl Thing {
    /// Whether it is gravel, which is only drawn.
    pub fn is_gravel(&self) -> bool {
        KINDS.find(&self.kind).is_some_and(|row| matches!(row.place, Place::Strewn(_)))
    }
}

impl Site<'_> {
    /// A stone on the triangle under it.
    fn lain(&self, candidate: &Candidate) -> Option<Thing> {
        let Candidate { prototype, scale, yaw_rad, at, .. } = *candidate;
        let hit = self.walls.hits(at.x, at.y).into_iter().find(|hit| hit.z >= at.z)?;
        let side = prototype.lies.get(candidate.id as usize % prototype.lies.len().max(1))?;
        let onto = UnitQuaternion::rotation_between(&Vector3::z(), &hit.normal)?;
        let rotation = onto * about_z(yaw_rad) * side;
        let along = |corner: &Point3<f64>| (rotation * corner.coords).dot(&hit.normal) * scale;
        let heights = prototype.hull.corners.iter().map(along);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let embedding_m = SUNK * (high - low);
        let position = at.coords - hit.normal * (low + embedding_m);
        let pose = Isometry3::from_parts(Translation3::from(position), rotation);
        Some(Thing { embedding_m, ..candidate.thing(pose) })
    }
}
