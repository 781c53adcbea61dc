//! Stations that no reading places.
//!
//! A leg of style `nosurvey` says that two stations are connected, but neither how far apart they are nor in which direction.
//! Between stations that shots place, it is a passage like any other. What is reached only by such legs has no position: of
//! the pieces that they connect, the fixed ones stay, or else the one with the greatest length of passages, and the stations
//! of the others are left out.
//!
//! Pieces that nothing connects may be without a position, too. They have a shape, though, so that they can be used: each is laid
//! beside those before it.

use nalgebra::Vector3;
use plume_graph::sets::Sets;

use super::survey::Leg;
use super::traverse::Placed;

/// The fixed piece; the others follow in the order of [`Placed::adrift`].
const FIXED: usize = 0;

/// Distance between pieces that are laid beside each other, in metres. Tuned: wider than most passages.
const GAP_M: f64 = 20.0;

/// The piece of a station.
fn piece(placed: &Placed, station: usize) -> usize {
    placed.piece_of[station].map_or(FIXED, |piece| FIXED + 1 + piece)
}

/// How far west and east each piece reaches, in metres.
fn ranges_m(placed: &Placed) -> Vec<[f64; 2]> {
    let mut ranges_m = vec![[f64::INFINITY, f64::NEG_INFINITY]; FIXED + 1 + placed.adrift.len()];
    for (station, position) in placed.positions.iter().enumerate() {
        let [least_m, most_m] = &mut ranges_m[piece(placed, station)];
        (*least_m, *most_m) = (least_m.min(position.x), most_m.max(position.x));
    }
    ranges_m
}

/// What stays of the pieces of a survey.
pub(super) struct Remaining {
    /// Whether each station stays.
    pub(super) stays: Vec<bool>,
    /// The first station of each remaining piece without a fix.
    pub(super) adrift: Vec<usize>,
}

impl Remaining {
    /// Keeps one piece of those that legs connect.
    pub(super) fn of(placed: &Placed, legs: &[([usize; 2], Leg)]) -> Self {
        let piece = |station: usize| piece(placed, station);
        let count = FIXED + 1 + placed.adrift.len();
        let mut sets = Sets::new(count);
        let mut lengths_m = vec![0.0; count];
        for &([a, b], leg) in legs {
            sets.unite(piece(a), piece(b));
            if leg == Leg::Passage && piece(a) == piece(b) {
                lengths_m[piece(a)] += (placed.positions[a] - placed.positions[b]).norm();
            }
        }
        lengths_m[FIXED] = f64::INFINITY;
        // The piece that stays of each set; of equals the first.
        let mut kept: Vec<Option<usize>> = vec![None; count];
        for piece in 0..count {
            let kept = &mut kept[sets.find(piece)];
            *kept = kept.filter(|&kept| lengths_m[kept] >= lengths_m[piece]).or(Some(piece));
        }
        let stays: Vec<bool> = (0..count).map(|piece| kept[sets.find(piece)] == Some(piece)).collect();
        Self {
            stays: (0..placed.positions.len()).map(|station| stays[piece(station)]).collect(),
            adrift: placed.adrift.iter().copied().filter(|&first| stays[piece(first)]).collect(),
        }
    }

    /// Lays the pieces without a position in a row, to the east of the fixed one or else of the first: their first stations at the
    /// height and the northing of its first station, and [`GAP_M`] between them. Returns how many have been laid.
    pub(super) fn lay_out(&self, placed: &mut Placed) -> usize {
        let fixed = (0..self.stays.len()).find(|&station| placed.piece_of[station].is_none());
        let (anchor, laid) = match (fixed, self.adrift.split_first()) {
            (Some(fixed), _) => (fixed, &self.adrift[..]),
            (None, Some((&first, others))) => (first, others),
            (None, None) => return 0,
        };
        let ranges_m = ranges_m(placed);
        let anchor_m = placed.positions[anchor];
        let mut edge_m = ranges_m[piece(placed, anchor)][1];
        let mut moves = vec![Vector3::zeros(); ranges_m.len()];
        for &first in laid {
            let [least_m, most_m] = ranges_m[piece(placed, first)];
            let aside = anchor_m - placed.positions[first];
            moves[piece(placed, first)] = Vector3::new(edge_m + GAP_M - least_m, aside.y, aside.z);
            edge_m += GAP_M + most_m - least_m;
        }
        for station in 0..placed.positions.len() {
            let by = moves[piece(placed, station)];
            placed.positions[station] += by;
        }
        laid.len()
    }

    /// Drops legs to stations that do not stay, and counts those stations as far as passages lead there.
    pub(super) fn retain(&self, legs: &mut Vec<([usize; 2], Leg)>) -> usize {
        let mut is_counted = vec![false; self.stays.len()];
        for &(ends, _) in legs.iter().filter(|(_, leg)| *leg == Leg::Passage) {
            ends.into_iter().filter(|&end| !self.stays[end]).for_each(|end| is_counted[end] = true);
        }
        legs.retain(|(ends, _)| ends.iter().all(|&end| self.stays[end]));
        is_counted.into_iter().filter(|is_counted| *is_counted).count()
    }
}
