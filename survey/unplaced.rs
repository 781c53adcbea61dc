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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use plume_graph::NoOutside;

    use crate::{Import, Parts, ReadError, Source, Tally, svx};

    fn parsed(text: &str, parts: Parts) -> Result<Import, ReadError> {
        svx::import(&Source { path: Path::new("cave.svx"), bytes: text.as_bytes(), outside: &NoOutside }, parts)
    }

    /// Two legs of 32 m, then a leg without readings to one of 7 m.
    const BEHIND_A_GAP: &str =
        "1 2 10 0 0\n2 3 22 90 0\n*data nosurvey from to\n3 4\n*data default\n4 5 7 0 0\n4 .. 3 0 0\n";

    #[test]
    fn stations_that_only_legs_without_readings_reach_are_left_out_and_counted() {
        for fix in ["", "*fix 1 494000 5200000 1000\n"] {
            for parts in [Parts::Refuse, Parts::Join, Parts::Keep, Parts::Longest] {
                let import = parsed(&format!("{BEHIND_A_GAP}{fix}"), parts).unwrap();
                let Tally { unplaced, left_out, .. } = import.tally;
                assert_eq!((import.graph.length_m(), import.graph.nodes.len()), (32.0, 3), "{fix}");
                assert_eq!((unplaced, left_out), (2, 0), "{fix}");
            }
        }
    }

    #[test]
    fn the_longest_piece_stays_if_nothing_is_fixed_and_the_fixed_one_otherwise() {
        let text = "1 2 3 0 0\n3 4 7 0 0\n4 5 7 0 0\n*data nosurvey from to\n2 3\n";
        let import = parsed(text, Parts::Refuse).unwrap();
        assert_eq!((import.graph.length_m(), import.tally.unplaced), (14.0, 2));
        let import = parsed(&format!("{text}*fix 1 0 0 0\n"), Parts::Refuse).unwrap();
        assert_eq!((import.graph.length_m(), import.tally.unplaced), (3.0, 3));
        let fixed = "*data default\n9 .. 5 0 0\n*fix 9 0 0 0\n*data nosurvey from to\n9 1\n";
        let error = parsed(&format!("{text}{fixed}"), Parts::Refuse).unwrap_err();
        assert_eq!(error.to_string(), "cave.svx: has no passages with a known position");
    }

    #[test]
    fn pieces_without_a_position_are_laid_beside_each_other() {
        let text = "1 2 30 90 0\n8 9 20 270 5\n9 10 4 0 0\na b 3 0 0\n";
        let error = parsed(text, Parts::Refuse).unwrap_err();
        assert!(error.message.starts_with("has 3 disconnected pieces"), "{error}");
        for (fix, row) in [("", [30.0, 50.0, 89.924]), ("*fix 9 7 7 7\n", [27.0, 47.0, 97.0])] {
            let kept = parsed(&format!("{text}{fix}"), Parts::Keep).unwrap();
            let east = |name: &str| {
                let node = kept.graph.nodes.iter().find(|node| node.name.as_deref() == Some(name)).expect(name);
                node.position.x + kept.tally.origin_m.x
            };
            let found = if fix.is_empty() { ["2", "9", "a"] } else { ["8", "1", "a"] }.map(east);
            let found = found.map(|x| (x * 1000.0).round() / 1000.0);
            assert!(found.iter().zip(row).all(|(found, expected)| (found - expected).abs() < 0.1), "{found:?}");
            assert_eq!((kept.graph.components().len(), kept.graph.nodes.len(), kept.tally.afloat), (3, 7, 2));
            let joined = parsed(&format!("{text}{fix}"), Parts::Join).unwrap();
            assert_eq!((joined.graph.components().len(), joined.tally.joined, joined.tally.afloat), (1, 2, 2));
        }
        let longest = parsed(text, Parts::Longest).unwrap();
        assert_eq!((longest.graph.length_m(), longest.tally.afloat, longest.tally.left_out), (30.0, 0, 5));
    }

    #[test]
    fn a_leg_without_readings_between_placed_stations_is_a_passage() {
        let import = parsed("1 2 6 0 0\n2 3 8 90 0\n*data nosurvey from to\n1 3\n", Parts::Refuse).unwrap();
        assert_eq!((import.graph.length_m(), import.graph.loops(), import.tally.unplaced), (24.0, 1, 0));
    }
}
