//! Thins open cells to lines one cell wide.
//!
//! Cells are removed in the order of their distance to rock, as long as no neighbours are disconnected and no line loses its
//! end (distance-ordered homotopic thinning: Pudney, "Distance-ordered homotopic thinning", Computer Vision and Image
//! Understanding 72, 1998). The result is on the medial axis to within a cell, with one loop around each pillar and one
//! component for each region. Bumps of the wall leave spurs.

use super::Mask;
use plume_graph::Rows;

/// The remaining cells.
pub(super) fn thinned(mask: &Mask, squares: &[u32]) -> Mask {
    let mut thin = mask.clone();
    let round = mask.round();
    let mut order = by_distance(mask, squares);
    loop {
        let before = order.len();
        order.retain(|&cell| {
            let goes = may_go(&thin, cell as usize, &round);
            if goes {
                thin.open[cell as usize] = false;
            }
            !goes
        });
        if order.len() == before {
            return thin;
        }
    }
}

/// Open cells, those next to rock first, and by place where the distance is the same.
fn by_distance(mask: &Mask, squares: &[u32]) -> Vec<u32> {
    let farthest = squares.iter().copied().max().unwrap_or(0) as usize;
    let open = (0..mask.open.len()).filter(|&cell| mask.open[cell]);
    Rows::from_pairs(farthest + 1, open.map(|cell| (squares[cell] as usize, cell as u32))).into_items()
}

/// Whether a cell may be removed: it is not the end of a line, and its neighbours stay connected without it.
fn may_go(mask: &Mask, cell: usize, round: &[usize; 8]) -> bool {
    let open = round.map(|way| mask.open[cell.wrapping_add(way)]);
    let count = open.iter().filter(|&&open| open).count();
    count >= 2 && crossings(open) == 1
}

/// Yokoi's connectivity number for 8-connected cells: the number of components of the neighbours, 1 for a border cell, 0
/// for one without rock at its sides.
fn crossings(open: [bool; 8]) -> usize {
    let shut = open.map(|open| !open);
    let begins = |side: usize| shut[side] && !(shut[(side + 1) % 8] && shut[(side + 2) % 8]);
    [0, 2, 4, 6].into_iter().filter(|&side| begins(side)).count()
}

#[cfg(test)]
mod tests {
    use super::super::distance;
    use super::*;

    fn picture(rows: &[&str]) -> Vec<String> {
        let mask = Mask::drawn(rows);
        thinned(&mask, &distance::squares(&mask)).picture()
    }

    #[test]
    fn a_passage_keeps_its_middle_and_its_ends() {
        let thin = picture(&["###########", "#.........#", "#.........#", "#.........#", "###########"]);
        assert_eq!(thin[2].matches('.').count(), 7, "{thin:?}");
        assert!(thin[2].contains("......."));
    }

    #[test]
    fn a_pillar_keeps_its_loop() {
        let thin = picture(&["#######", "#.....#", "#.....#", "#..#..#", "#.....#", "#.....#", "#######"]);
        let open: usize = thin.iter().map(|row| row.matches('.').count()).sum();
        assert!((4..=12).contains(&open), "{thin:?}");
        assert_eq!(thin[3].as_bytes()[3], b'#');
    }
}
