//! Where objects for search tasks and models of the user are: spread evenly along the passages, at the foot of a wall, or in
//! halls beside the way.
//!
//! The place of each follows from the lengths of all edges, so that every chunk knows all of them; where a wall leaves no room
//! there, it is tried a little further on. Not promised: an object where there is no room within [`FURTHEST_TRIED_M`], or where
//! another one already is.

use std::f64::consts::{FRAC_PI_2, TAU};

use plume_graph::seed::salt;

use super::along::{ASIDE_M, Built, FOOT_M, Way};
use super::kind::{KindRow, Place};
use super::lots::Lots;
use super::place::{Candidate, Site, without_overlaps};

/// How far from its place an object is tried to either side, in metres, in as many steps as there are.
const TRIED_M: [f64; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5];
/// The furthest of these.
pub(super) const FURTHEST_TRIED_M: f64 = TRIED_M[5];

impl<'a> Site<'a> {
    /// The objects near the bounds of these walls.
    pub fn left(&self, ways: &[Way]) -> Vec<Built<'a>> {
        let artefacts: Vec<KindRow> = self.rows().filter(|row| matches!(row.place, Place::Lost)).collect();
        let mut found = self.spread("artefacts", &artefacts, self.settings.artefacts, ways);
        for row in self.rows() {
            if let Place::Left(count) = row.place {
                found.extend(self.spread(row.name, &[row], count, ways));
            }
        }
        let candidates: Vec<Candidate> = found.iter().map(|built| built.candidate.clone()).collect();
        let kept = without_overlaps(&candidates);
        found.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(built, _)| built).collect()
    }

    /// As many objects of these kinds in turn along all passages, those that are on these ways.
    fn spread(&self, name: &str, rows: &[KindRow<'a>], count: u32, ways: &[Way]) -> Vec<Built<'a>> {
        if rows.is_empty() || count == 0 {
            return Vec::new();
        }
        let edges = &self.setting.graph.edges;
        let length_m = |edge: &[plume_graph::StationId; 2]| {
            let [a, b] = edge.map(|station| self.setting.graph[station].position);
            (b - a).norm()
        };
        let part_m = edges.iter().map(length_m).sum::<f64>() / f64::from(count);
        let salt = u64::from(salt(self.setting.seed, name));
        let first = Lots::new(salt, [0, -1]).unit() * rows.len() as f64;
        let (mut found, mut start_m, mut next) = (Vec::new(), 0.0, 0_u32);
        for edge in edges {
            let end_m = start_m + length_m(edge);
            let way = ways.iter().find(|way| way.is_along(edge));
            while next < count {
                let mut lots = Lots::new(salt, [next as i32, 0]);
                let at_m = (f64::from(next) + lots.unit()) * part_m;
                if at_m >= end_m {
                    break;
                }
                let row = rows[(first as usize + next as usize) % rows.len()];
                if let Some(way) = way {
                    found.extend(self.left_at(row, way, at_m - start_m, lots));
                }
                next += 1;
            }
            start_m = end_m;
        }
        found
    }

    /// An object at the foot of a wall, as near to its place as there is room.
    fn left_at(&self, row: KindRow<'a>, way: &Way, along_m: f64, mut lots: Lots) -> Option<Built<'a>> {
        let side = if lots.unit() < 0.5 { -1.0 } else { 1.0 };
        let prototype = lots.one_of(self.setting.library.of(&row))?;
        let turn = lots.unit();
        let [x_m, y_m] = [prototype.size_m.x, prototype.size_m.y];
        let (yaw_rad, half_m) = match row.place {
            // With its longer side along the wall, either way round.
            Place::Left(_) => {
                let quarters = if turn < 0.5 { 0.0 } else { 2.0 } + if x_m < y_m { 1.0 } else { 0.0 };
                (way.yaw_rad() + FRAC_PI_2 * quarters, [0.5 * x_m.max(y_m), 0.5 * x_m.min(y_m)])
            }
            _ => (TAU * turn, [prototype.reach_m; 2]),
        };
        let id = lots.id(0.0);
        let places = TRIED_M.into_iter().flat_map(|shift| [side, -side].map(|side| (along_m + shift, side)));
        places.filter(|(along_m, _)| way.holds(*along_m)).find_map(|(along_m, side)| {
            // In a hall it is as far from the way as walls are looked for.
            let wall_m = self.aside(way, along_m, side, &FOOT_M).unwrap_or(ASIDE_M);
            let (pose, embedding_m) = self.at_foot(way, along_m, side * wall_m, half_m)?;
            let pose = pose * super::rest::about_z(yaw_rad);
            let at = pose.translation.vector.into();
            let candidate = Candidate {
                id,
                row,
                prototype,
                scale: 1.0,
                yaw_rad,
                at,
                embedding_m,
                stands: true,
                rank: f64::INFINITY,
            };
            let built = Built { candidate, pose };
            self.leaves_the_way(&built, way.at(along_m)).then_some(built)
        })
    }
}
