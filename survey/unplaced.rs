//! Stations that no reading places.
//!
//! A leg of style `nosurvey` says that two stations are connected, but neither how far apart they are nor in which direction.
//! Between stations that shots place, it is a passage like any other. What is reached only by such legs has no position: of
//! the pieces that they connect, the fixed ones stay, or else the one with the greatest length of passages, and the stations
//! of the others are left out.

use plume_graph::sets::Sets;

use super::survey::Leg;
use super::traverse::Placed;

/// The fixed piece; the others follow in the order of [`Placed::adrift`].
const FIXED: usize = 0;

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
        let piece = |station: usize| placed.piece_of[station].map_or(FIXED, |piece| FIXED + 1 + piece);
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
