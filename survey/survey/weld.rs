//! Welds stations that are one place of a cave.

use nalgebra::Point3;

use crate::parts::first_at_place;

/// Stations connected by a shorter leg are one place, in metres: no passage is narrower than five times that, and
/// stations this close cannot be told apart in the rock. Tuned.
const SHORT_M: f64 = 0.3;

/// The representative of each station: the first in its place, to 1 mm, or one connected by a passage of less than
/// [`SHORT_M`]. None moves further than that, so a chain of short legs is thinned out and keeps its shape.
pub(super) fn welds(places: &[Point3<f64>], passages: &[[usize; 2]]) -> Vec<usize> {
    let mut welds = first_at_place(places);
    let mut stands_for_others = vec![false; places.len()];
    for ends in passages {
        let [a, b] = ends.map(|end| welds[welds[end]]);
        let short = (places[a] - places[b]).norm() < SHORT_M;
        let joining = [[a, b], [b, a]].into_iter().find(|&[_, joins]| !stands_for_others[joins]);
        if let (true, true, Some([stays, joins])) = (a != b, short, joining) {
            stands_for_others[stays] = true;
            welds[joins] = stays;
        }
    }
    (0..welds.len()).map(|station| welds[welds[station]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places_m: &[f64]) -> Vec<Point3<f64>> {
        places_m.iter().map(|&x| Point3::new(x, 0.0, 0.0)).collect()
    }

    #[test]
    fn a_chain_of_short_legs_is_thinned_and_keeps_its_length() {
        let places = line(&[0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        let forth: Vec<[usize; 2]> = (0..5).map(|leg| [leg, leg + 1]).collect();
        let back: Vec<[usize; 2]> = forth.iter().rev().map(|&[a, b]| [b, a]).collect();
        for passages in [forth, back] {
            let welds = welds(&places, &passages);
            for (station, &one) in welds.iter().enumerate() {
                assert!((places[station] - places[one]).norm() < SHORT_M);
                assert_eq!(welds[one], one);
            }
            let mut left = welds.clone();
            left.sort_unstable();
            left.dedup();
            assert_eq!(left.len(), 3, "{welds:?}");
        }
    }

    #[test]
    fn stations_in_one_place_are_one_without_a_leg() {
        assert_eq!(welds(&line(&[0.0, 7.0, 7.000_1, 9.0]), &[[0, 1], [2, 3]]), [0, 1, 1, 3]);
    }
}
