//! Connected regions of open cells and of rock: drops small ones, joins the others.

use std::cmp::Reverse;

use super::Mask;
use plume_graph::sets::Sets;

const NONE: u32 = u32::MAX;

/// Fills open regions smaller than this many cells, except the largest.
pub(crate) fn without_pockets(mut mask: Mask, least: usize) -> Mask {
    let regions = regions(&mask, true, &sides(&mask));
    let largest = regions.sizes.iter().enumerate().max_by_key(|&(at, &size)| (size, Reverse(at))).map(|(at, _)| at);
    for (cell, &region) in regions.of_cell.iter().enumerate() {
        if region != NONE && regions.sizes[region as usize] < least && Some(region as usize) != largest {
            mask.open[cell] = false;
        }
    }
    mask
}

/// Opens pillars smaller than this many cells. Rock that reaches the border is not a pillar.
pub(crate) fn without_pillars(mut mask: Mask, least: usize) -> Mask {
    let regions = regions(&mask, false, &mask.round());
    let border = regions.of_cell[0];
    for cell in mask.inner() {
        let region = regions.of_cell[cell];
        if region != NONE && region != border && regions.sizes[region as usize] < least {
            mask.open[cell] = true;
        }
    }
    mask
}

/// Joins all open regions by corridors of this half-width, along a minimum spanning tree of the gaps between them
/// (Kruskal). Regions grow into the rock at the same pace, and a gap is where two of them meet.
pub(crate) fn joined(mut mask: Mask, half_width: usize) -> Mask {
    let regions = regions(&mask, true, &sides(&mask));
    if regions.sizes.len() < 2 {
        return mask;
    }
    let mut sets = Sets::new(regions.sizes.len());
    for gap in gaps(&mask, regions) {
        let [a, b] = gap.regions.map(|region| region as usize);
        if sets.unite(a, b) {
            dig_between(&mut mask, gap.cells, half_width);
        }
    }
    mask
}

/// A gap between two regions: a cell of each and the distance between them, in cells.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Gap {
    steps: u32,
    cells: [usize; 2],
    regions: [u32; 2],
}

/// All places where two growing regions meet, the shortest gaps first.
fn gaps(mask: &Mask, regions: Regions) -> Vec<Gap> {
    let mut owner = regions.of_cell;
    let mut origin: Vec<u32> = vec![NONE; owner.len()];
    let mut front: Vec<usize> = (0..owner.len()).filter(|&cell| owner[cell] != NONE).collect();
    front.iter().for_each(|&cell| origin[cell] = cell as u32);
    let mut gaps = Vec::new();
    let ways = sides(mask);
    let mut steps = 0;
    while !front.is_empty() {
        let mut next_front = Vec::new();
        for cell in front {
            for way in ways {
                let next = cell.wrapping_add(way);
                if !mask.is_inner(next) {
                    continue;
                }
                if owner[next] == NONE {
                    (owner[next], origin[next]) = (owner[cell], origin[cell]);
                    next_front.push(next);
                } else if owner[next] < owner[cell] {
                    let cells = [cell, next].map(|cell| origin[cell] as usize);
                    gaps.push(Gap { steps, cells, regions: [owner[cell], owner[next]] });
                }
            }
        }
        front = next_front;
        steps += 1;
    }
    gaps.sort_unstable();
    gaps.dedup_by_key(|gap| (gap.cells, gap.regions));
    gaps
}

/// Opens a straight corridor.
fn dig_between(mask: &mut Mask, cells: [usize; 2], half_width: usize) {
    let [from, to] = cells.map(|cell| mask.place(cell).map(|at| at as i64));
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let steps = dx.abs().max(dy.abs()).max(1);
    for step in 0..=steps {
        let at = |from: i64, way: i64| (from + (2 * way * step + steps).div_euclid(2 * steps)) as usize;
        mask.dig([at(from[0], dx), at(from[1], dy)], half_width);
    }
}

/// Regions of cells, numbered from 0 in the order of their first cell.
struct Regions {
    /// The region of each cell; [`NONE`] for those of the other kind.
    of_cell: Vec<u32>,
    /// Number of cells of each region.
    sizes: Vec<usize>,
}

/// Connected regions of open or of rock cells; connectivity is along the first `ways` directions.
fn regions(mask: &Mask, open: bool, ways: &[usize]) -> Regions {
    let mut regions = Regions { of_cell: vec![NONE; mask.open.len()], sizes: Vec::new() };
    let mut found = Vec::new();
    for start in mask.inner() {
        if mask.open[start] != open || regions.of_cell[start] != NONE {
            continue;
        }
        let region = regions.sizes.len() as u32;
        regions.of_cell[start] = region;
        found.push(start);
        let mut size = 0;
        while let Some(cell) = found.pop() {
            size += 1;
            for way in ways {
                let next = cell.wrapping_add(*way);
                let inside = next < mask.open.len() && mask.open[next] == open;
                if inside && regions.of_cell[next] == NONE {
                    regions.of_cell[next] = region;
                    found.push(next);
                }
            }
        }
        regions.sizes.push(size);
    }
    regions
}

/// Index offsets across the sides of a cell.
fn sides(mask: &Mask) -> [usize; 4] {
    let round = mask.round();
    [round[0], round[2], round[4], round[6]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: [&str; 6] = ["##########", "#..####..#", "#..####..#", "#######..#", "#.####...#", "##########"];

    #[test]
    fn pockets_are_filled_and_the_largest_region_stays() {
        let picture = without_pockets(Mask::drawn(&THREE), 4).picture();
        assert_eq!(picture[4], "######...#");
        let alone = without_pockets(Mask::drawn(&THREE), 100);
        assert_eq!(alone.open.iter().filter(|&&open| open).count(), 9);
    }

    #[test]
    fn regions_are_joined_into_one() {
        let mask = joined(Mask::drawn(&THREE), 0);
        assert_eq!(regions(&mask, true, &sides(&mask)).sizes.len(), 1, "{:?}", mask.picture());
    }

    #[test]
    fn small_pillars_are_opened_and_the_border_is_not() {
        let mask = Mask::drawn(&["######", "#....#", "#.#..#", "#....#", "######"]);
        let open = without_pillars(mask.clone(), 2);
        assert_eq!(open.picture()[2], "#....#");
        assert_eq!(without_pillars(mask.clone(), 1), mask);
    }
}
