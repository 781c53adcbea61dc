//! Where objects for search tasks are: spread evenly along the passages, at the foot of a wall, or in halls beside
//! the way.
//!
//! The place of each follows from the lengths of all edges, so that every chunk knows all of them; where a wall leaves no room
//! there, it is tried a little further on. Not promised: an object where there is no room within [`TRIED_M`].

use plume_graph::seed::salt;

use super::along::{ASIDE_M, Built, FOOT_M, Way};
use super::kind::{KindRow, Place};
use super::lots::Lots;
use super::place::{Candidate, Site};

/// How far from its place an object is tried to either side, in metres, in as many steps as there are.
const TRIED_M: [f64; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5];

impl<'a> Site<'a> {
    /// The objects near the bounds of these walls.
    pub fn lost(&self, ways: &[Way]) -> Vec<Built<'a>> {
        let rows: Vec<&'static KindRow> = self.rows().filter(|row| matches!(row.place, Place::Lost)).collect();
        let count = self.settings.artefacts;
        if rows.is_empty() || count == 0 {
            return Vec::new();
        }
        let edges = &self.setting.graph.edges;
        let length_m = |edge: &[plume_graph::StationId; 2]| {
            let [a, b] = edge.map(|station| self.setting.graph[station].position);
            (b - a).norm()
        };
        let part_m = edges.iter().map(length_m).sum::<f64>() / f64::from(count);
        let salt = u64::from(salt(self.setting.seed, "artefacts"));
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
    fn left_at(&self, row: &'static KindRow, way: &Way, along_m: f64, mut lots: Lots) -> Option<Built<'a>> {
        let side = if lots.unit() < 0.5 { -1.0 } else { 1.0 };
        let prototype = lots.one_of(self.setting.library.of(row))?;
        let yaw_rad = std::f64::consts::TAU * lots.unit();
        let id = lots.id(0.0);
        let places = TRIED_M.into_iter().flat_map(|shift| [side, -side].map(|side| (along_m + shift, side)));
        places.filter(|(along_m, _)| way.holds(*along_m)).find_map(|(along_m, side)| {
            // In a hall it is as far from the way as walls are looked for.
            let wall_m = self.aside(way, along_m, side, &FOOT_M).unwrap_or(ASIDE_M);
            let (pose, embedding_m) = self.at_foot(way, along_m, side * wall_m, prototype.reach_m)?;
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
