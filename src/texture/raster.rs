//! Rasterises triangles in integer arithmetic.
//!
//! Corners are on a lattice of 1/[`SUBTEXELS`] texel, y up. A texel belongs to the triangle that contains its centre; a
//! centre on an edge belongs to the triangle on its right or above, so triangles that share an edge neither share nor omit a
//! texel.

use std::ops::Range;

/// Lattice steps per texel. Fine enough to be invisible, coarse enough that a coordinate within
/// [`super::settings::MAX_SIZE_PX`] texels is exact as a fraction in `f32`.
pub(super) const SUBTEXELS: i32 = 256;

/// A triangle in units of 1/[`SUBTEXELS`] texel, counter-clockwise; a clockwise one covers nothing.
pub(super) type Corners = [[i32; 2]; 3];

/// Calls `span(y, xs)` for every row in `rows` that has texel centres inside the triangle.
pub(super) fn spans(corners: &Corners, rows: Range<i32>, mut span: impl FnMut(i32, Range<i32>)) {
    let ys = corners.map(|c| c[1]);
    let [low, high] = extremes(ys);
    let first = rows.start.max(first_centre(low));
    let end = rows.end.min(first_centre(high) + 1);
    for y in first..end {
        let xs = row_span(corners, y);
        if xs.start < xs.end {
            span(y, xs);
        }
    }
}

fn row_span(corners: &Corners, y: i32) -> Range<i32> {
    let (mut start, mut end) = (i64::from(i32::MIN), i64::from(i32::MAX));
    for k in 0..3 {
        let edge = RowEdge::new(corners[k], corners[(k + 1) % 3], y);
        if edge.slope > 0 {
            end = end.min(edge.value.div_euclid(edge.slope) + 1);
        } else if edge.slope < 0 {
            start = start.max(-edge.value.div_euclid(-edge.slope));
        } else if edge.value < 0 {
            return 0..0;
        }
    }
    start as i32..end.max(start) as i32
}

/// Along a row, the centre of texel `x` is inside the edge when `value - slope * x >= 0`.
struct RowEdge {
    value: i64,
    slope: i64,
}

impl RowEdge {
    fn new(from: [i32; 2], to: [i32; 2], y: i32) -> Self {
        let [dx, dy] = [0, 1].map(|k| i64::from(to[k]) - i64::from(from[k]));
        let owns_its_points = dy < 0 || (dy == 0 && dx > 0);
        let rise = centre(y) - i64::from(from[1]);
        let value = dx * rise - dy * (centre(0) - i64::from(from[0]));
        Self { value: value - i64::from(!owns_its_points), slope: dy * i64::from(SUBTEXELS) }
    }
}

/// The centre of texel `index` in lattice units.
pub(super) fn centre(index: i32) -> i64 {
    i64::from(index) * i64::from(SUBTEXELS) + i64::from(SUBTEXELS / 2)
}

fn first_centre(at: i32) -> i32 {
    (at - SUBTEXELS / 2 + SUBTEXELS - 1).div_euclid(SUBTEXELS)
}

/// Twice the signed area in square lattice units.
pub(super) fn doubled_area(corners: &Corners) -> i64 {
    let [a, b, c] = corners.map(|p| p.map(i64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Calls `span(row, columns)` with every square cell (size in lattice units) that the triangle touches, and sometimes one
/// more at the ends of a row.
pub(super) fn touched(corners: &Corners, side: i32, mut span: impl FnMut(i32, Range<i32>)) {
    let [low, high] = extremes(corners.map(|c| c[1]));
    for row in low.div_euclid(side)..=high.div_euclid(side) {
        let [left, right] = extent_in_band(corners, row * side, (row + 1) * side);
        span(row, left.div_euclid(side)..right.div_euclid(side) + 1);
    }
}

/// Minimum and maximum x of the triangle between two heights, rounded outwards.
fn extent_in_band(corners: &Corners, bottom: i32, top: i32) -> [i32; 2] {
    let (mut left, mut right) = (i32::MAX, i32::MIN);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if (bottom..=top).contains(&a[1]) {
            (left, right) = (left.min(a[0]), right.max(a[0]));
        }
        for height in [bottom, top] {
            if (a[1] < height) == (b[1] < height) {
                continue;
            }
            let run = i64::from(b[0] - a[0]) * i64::from(height - a[1]);
            let x = a[0] + run.div_euclid(i64::from(b[1] - a[1])) as i32;
            (left, right) = (left.min(x), right.max(x + 1));
        }
    }
    [left, right]
}

fn extremes(values: [i32; 3]) -> [i32; 2] {
    let [a, b, c] = values;
    [a.min(b).min(c), a.max(b).max(c)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition, evaluated point by point.
    fn holds(corners: &Corners, x: i32, y: i32) -> bool {
        (0..3).all(|k| {
            let (a, b) = (corners[k].map(i64::from), corners[(k + 1) % 3].map(i64::from));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let side = dx * (centre(y) - a[1]) - dy * (centre(x) - a[0]);
            side > 0 || (side == 0 && (dy < 0 || (dy == 0 && dx > 0)))
        })
    }

    fn point() -> impl Strategy<Value = [i32; 2]> {
        // Multiples of a quarter texel, so that many centres are exactly on edges.
        [0..40_i32, 0..40_i32].prop_map(|p| p.map(|q| q * SUBTEXELS / 4))
    }

    proptest! {
        #[test]
        fn spans_match_the_definition(corners in [point(), point(), point()]) {
            let mut found = vec![];
            spans(&corners, 0..12, |y, xs| found.extend(xs.map(|x| (x, y))));
            let asked = (0..12).flat_map(|y| (-2..14).map(move |x| (x, y)));
            let expected: Vec<_> = asked.filter(|&(x, y)| holds(&corners, x, y)).collect();
            prop_assert_eq!(found, expected);
        }

        #[test]
        fn a_split_triangle_covers_each_texel_once(a in point(), b in point(), c in point(), d in point()) {
            let quad = if doubled_area(&[a, b, c]) > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, b, d]] };
            prop_assume!(quad.iter().all(|t| doubled_area(t) > 0));
            let mut owners = std::collections::BTreeMap::new();
            for triangle in &quad {
                spans(triangle, 0..12, |y, xs| xs.for_each(|x| *owners.entry((x, y)).or_insert(0) += 1));
            }
            prop_assert!(owners.values().all(|&n| n == 1));
        }

        #[test]
        fn touched_cells_include_every_covered_texel(corners in [point(), point(), point()]) {
            let mut cells = std::collections::BTreeSet::new();
            touched(&corners, 2 * SUBTEXELS, |row, xs| cells.extend(xs.map(|x| (x, row))));
            let mut all_inside = true;
            spans(&corners, 0..12, |y, xs| {
                all_inside &= xs.into_iter().all(|x| cells.contains(&(x.div_euclid(2), y.div_euclid(2))));
            });
            prop_assert!(all_inside);
            prop_assert!(corners.iter().all(|c| cells.contains(&(c[0].div_euclid(512), c[1].div_euclid(512)))));
        }
    }
}
