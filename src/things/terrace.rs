//! Rimstone: dams of calcite, each below the pool of the next, where water ran down a floor (Hill and Forti, *Cave Minerals of
//! the World*, 1997).
//!
//! Dams stand where the floor crosses levels of even height, so that each follows the contour, and is as far from the next as
//! their height over the slope. Every cell of a grid has at most one piece of a dam, at the point of the level that is nearest to
//! the middle of the cell: so a piece follows from the floor within a metre, and those of neighbours overlap. Not promised: a
//! pool that holds water, since dams leave the way free.

use nalgebra::{Point3, Vector3};

use super::dripstone::{DAM_LENGTH_M, DAM_M};
use super::kind::{KindRow, Place};
use super::place::{Candidate, Site};
use super::plane::Plane;
use plume_graph::Aabb;

/// Side of the cells in metres: pieces along a slanting contour are up to 1.42 times as far apart, and still overlap.
const CELL_M: f64 = DAM_LENGTH_M / 1.8;
/// Height from one dam to the next in metres: a little more than that of a dam, so that each pool ends at the next dam.
const LEVEL_M: f64 = DAM_M + 0.01;
/// Least and most slope of a floor with dams: pools of 2 m, and of a hand's width.
const SLOPE: [f64; 2] = [0.05, 0.6];
/// Most unevenness of the floor along a piece, in metres.
const UNEVEN_M: f64 = 0.05;
/// Length over which floors are wet or not, in metres, and the share of them that is. Tuned.
const STRETCH_M: f32 = 12.0;
const WET: f64 = 0.6;

/// Whether two pieces are of the same dam, next to each other.
fn is_next(one: &Candidate, other: &Candidate) -> bool {
    let between = one.at - other.at;
    between.z.abs() < 0.5 * LEVEL_M && between.norm() < DAM_LENGTH_M
}

impl<'a> Site<'a> {
    /// The pieces of dams in these bounds.
    pub fn terraces(&self, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let rows = self.rows().filter(|row| matches!(row.place, Place::Terrace));
        let found: Vec<Candidate> = rows.flat_map(|row| self.dams(row, around)).collect();
        let crest = |dam: &Candidate| vec![(dam.at + Vector3::z() * (DAM_M + 0.02)).map(|c| c as f32).into()];
        let depths = self.depths(found.iter().map(crest).collect());
        let open = found.into_iter().zip(depths).filter(|(_, crest)| crest[0] < 0.0);
        let open: Vec<Candidate> = open.map(|(dam, _)| dam).collect();
        // A piece by itself dams nothing.
        let goes_on = |dam: &Candidate| open.iter().any(|other| other.id != dam.id && is_next(dam, other));
        open.iter().filter(|dam| goes_on(dam)).cloned().collect()
    }

    fn dams(&self, row: KindRow<'a>, around: Aabb<f64>) -> Vec<Candidate<'a>> {
        let mut dams = Vec::new();
        for (mut lots, x, y) in self.cells(&row, CELL_M, around) {
            let Some(prototype) = lots.one_of(self.setting.library.of(&row)) else { continue };
            let [x, y] = [x, y].map(|c| ((c / CELL_M).floor() + 0.5) * CELL_M);
            let hits = self.walls.hits(x, y);
            let floors = hits.iter().filter(|hit| hit.normal.z > 0.0).map(|hit| Point3::new(x, y, hit.z));
            for middle in lots.one_per_storey(floors, |floor| floor.z) {
                let Some((at, uphill)) = self.on_level(middle) else { continue };
                let dam = Candidate {
                    id: lots.id(middle.z),
                    row,
                    prototype,
                    scale: 1.0,
                    // Its y axis points downhill.
                    yaw_rad: libm::atan2(uphill.x, -uphill.y),
                    at,
                    embedding_m: 0.0,
                    stands: true,
                    // Stones make room for it.
                    rank: f64::INFINITY,
                };
                let is_wet = self.share("wet floors", at, STRETCH_M) < WET * self.settings.dripstone;
                if is_wet && !self.corridor.is_within(at, dam.reach_m()) {
                    dams.push(dam);
                }
            }
        }
        dams
    }

    /// The point nearest to the middle of a cell where the floor crosses a level, and the slope there.
    fn on_level(&self, middle: Point3<f64>) -> Option<(Point3<f64>, Vector3<f64>)> {
        let half_m = 0.4 * DAM_LENGTH_M;
        let floor =
            Plane::through(&[-half_m, 0.0, half_m], |[x, y]| self.floor_near(middle + Vector3::new(x, y, 0.0)))?;
        let uphill = Vector3::new(floor.slopes[0], floor.slopes[1], 0.0);
        let slope = uphill.norm();
        let is_even = floor.off_m.iter().all(|off_m| *off_m < UNEVEN_M);
        if !is_even || !(SLOPE[0]..SLOPE[1]).contains(&slope) {
            return None;
        }
        let level = (floor.height / LEVEL_M).round() * LEVEL_M;
        let off = uphill * ((level - floor.height) / (slope * slope));
        (off.norm() <= 0.5 * CELL_M).then(|| (Point3::new(middle.x + off.x, middle.y + off.y, level), uphill))
    }

    /// Height of the floor above or below a point of one near by.
    fn floor_near(&self, at: Point3<f64>) -> Option<f64> {
        /// How far above or below it may be, in metres.
        const NEAR_M: f64 = 0.3;
        let floors = self.walls.hits(at.x, at.y).into_iter().filter(|hit| hit.normal.z > 0.0).map(|hit| hit.z);
        floors.filter(|z| (z - at.z).abs() < NEAR_M).min_by(|a, b| (a - at.z).abs().total_cmp(&(b - at.z).abs()))
    }
}
