//! The loops of crossed edges in a lattice cell.
//!
//! Dual marching cubes (Nielson 2004) puts one vertex into a cell per loop of crossed edges. An edge of the mesh then
//! crosses a cell face, and only one case gives it four triangles: all four edges of a face are crossed, and in both
//! adjacent cells all four are in one loop. Wenger (*Isosurfaces*, 2013) connects the crossings of such a face the other
//! way. Enumerated in the test: a cell has at most one face whose crossings are in one loop; connecting them the other way
//! splits the loop and leaves no such face. So the switch only depends on the two cells, in any order, and the mesh is
//! always manifold.
//!
//! Corner `x + 2y + 4z`; edge `4·axis + u + 2v`, with u and v the offsets along the other two axes, lower axis first;
//! face `2·axis + side`.

use std::sync::LazyLock;

/// Lower and upper corner of every edge.
pub(super) const EDGE_CORNERS: [[u8; 2]; 12] = edge_corners();

/// The loop of every crossed edge of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Loops {
    /// Loop by edge; [`Loops::NONE`] if the edge is not crossed.
    pub(super) of_edge: [u8; 12],
    /// Number of loops, 0 to 4.
    pub(super) count: u8,
}

impl Loops {
    pub(super) const NONE: u8 = u8::MAX;
}

/// A face of a cell, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Face(u8);

impl Face {
    pub(super) const NONE: Self = Self(6);

    pub(super) fn opposite(self) -> Self {
        Self(self.0 ^ 1)
    }

    /// Axis and direction (-1 or 1) of the neighbour beyond; `None` for no face.
    pub(super) fn direction(self) -> Option<(usize, i32)> {
        (self != Self::NONE).then(|| (usize::from(self.0 / 2), i32::from(self.0 % 2) * 2 - 1))
    }
}

/// The loops of every case.
pub(super) struct Table {
    /// By case, then by the face that is switched (the last: none).
    loops: [[Loops; 7]; 256],
    shared: [Face; 256],
}

/// The table.
pub(super) static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

impl Table {
    /// The loops of a cell whose corners given by the bits of `case` are in air, with the crossings of a face switched.
    pub(super) fn loops(&self, case: u8, switched: Face) -> &Loops {
        &self.loops[usize::from(case)][usize::from(switched.0)]
    }

    /// The face with four crossings in one loop.
    pub(super) fn shared_face(&self, case: u8) -> Face {
        self.shared[usize::from(case)]
    }

    fn new() -> Self {
        let cases: [u8; 256] = std::array::from_fn(|case| case as u8);
        let loops = cases.map(|case| std::array::from_fn(|face| trace(case, Face(face as u8))));
        let shared = cases.map(|case| {
            let plain = trace(case, Face::NONE);
            shared_faces(case, &plain).next().unwrap_or(Face::NONE)
        });
        Self { loops, shared }
    }
}

/// Walks around every loop: each face leads from the crossing where air begins to the one where that air ends or, if
/// switched, to the one where the previous air ended.
fn trace(case: u8, switched: Face) -> Loops {
    let mut next = [Loops::NONE; 12];
    for face in (0..6).map(Face) {
        let corners = face_corners(face);
        let air = |k: usize| case >> corners[k % 4] & 1 == 1;
        for begin in (0..4).filter(|&k| !air(k) && air(k + 1)) {
            let step = if face == switched { 3 } else { 1 };
            let ends = |k: &usize| air(*k) && !air(k + 1);
            let end = (1..4).map(|n| begin + n * step).find(ends).expect("air that begins ends");
            let edge = |k: usize| edge_between(corners[k % 4], corners[(k + 1) % 4]);
            next[edge(begin)] = edge(end) as u8;
        }
    }
    follow(&next)
}

fn follow(next: &[u8; 12]) -> Loops {
    let mut loops = Loops { of_edge: [Loops::NONE; 12], count: 0 };
    for first in 0..12 {
        if next[first] == Loops::NONE || loops.of_edge[first] != Loops::NONE {
            continue;
        }
        let mut edge = first;
        while loops.of_edge[edge] == Loops::NONE {
            loops.of_edge[edge] = loops.count;
            edge = usize::from(next[edge]);
        }
        loops.count += 1;
    }
    loops
}

fn shared_faces(case: u8, loops: &Loops) -> impl Iterator<Item = Face> {
    (0..6).map(Face).filter(move |&face| {
        let corners = face_corners(face);
        let loop_of = |k: usize| loops.of_edge[edge_between(corners[k], corners[(k + 1) % 4])];
        let air = |k: usize| case >> corners[k] & 1;
        let crossed = air(0) == air(2) && air(1) == air(3) && air(0) != air(1);
        crossed && (1..4).all(|k| loop_of(k) == loop_of(0))
    })
}

/// Corners of a face, counter-clockwise seen from outside the cell.
fn face_corners(face: Face) -> [u8; 4] {
    let (axis, side) = (face.0 / 2, face.0 % 2);
    let (a, b) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let corners = if side == 1 { [0, a, a | b, b] } else { [b, a | b, a, 0] };
    corners.map(|corner| corner | side << axis)
}

fn edge_between(a: u8, b: u8) -> usize {
    let lower = a & b;
    let axis = (a ^ b).trailing_zeros();
    let below = lower & ((1 << axis) - 1);
    let above = lower >> (axis + 1);
    usize::from(4 * axis as u8 + (below | above << axis))
}

const fn edge_corners() -> [[u8; 2]; 12] {
    let mut corners = [[0; 2]; 12];
    let mut edge = 0;
    while edge < 12 {
        let (axis, offsets) = (edge / 4, edge as u8 % 4);
        let below = offsets & ((1 << axis) - 1);
        let lower = below | (offsets >> axis) << (axis + 1);
        corners[edge] = [lower, lower | 1 << axis];
        edge += 1;
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_corners_agree() {
        for (edge, [lower, upper]) in EDGE_CORNERS.into_iter().enumerate() {
            assert_eq!(edge_between(lower, upper), edge);
            assert_eq!(edge_between(upper, lower), edge);
        }
        assert_eq!(EDGE_CORNERS[4 + 1 + 2], [5, 7], "edge along y at x = 1, z = 1");
    }

    #[test]
    fn every_crossed_edge_is_in_a_loop() {
        for case in 0..=255u8 {
            for face in (0..7).map(Face) {
                let loops = trace(case, face);
                for (edge, corners) in EDGE_CORNERS.into_iter().enumerate() {
                    let [a, b] = corners.map(|corner| case >> corner & 1);
                    assert_eq!(a != b, loops.of_edge[edge] != Loops::NONE);
                }
                for index in 0..loops.count {
                    let edges = loops.of_edge.iter().filter(|&&l| l == index).count();
                    assert!(edges >= 3, "case {case}: a loop has at least three edges");
                }
            }
        }
    }

    #[test]
    fn switching_the_one_shared_face_leaves_none() {
        let mut cases_with_shared_face = 0;
        for case in 0..=255u8 {
            let plain = trace(case, Face::NONE);
            let shared: Vec<Face> = shared_faces(case, &plain).collect();
            assert!(shared.len() <= 1, "case {case}");
            let Some(&face) = shared.first() else {
                continue;
            };
            cases_with_shared_face += 1;
            let switched = trace(case, face);
            assert_eq!(switched.count, plain.count + 1, "case {case}");
            assert_eq!(shared_faces(case, &switched).count(), 0, "case {case}");
        }
        assert_eq!(cases_with_shared_face, 36);
    }

    #[test]
    fn only_the_corners_in_air_matter() {
        assert_eq!(TABLE.loops(0, Face::NONE).count, 0);
        assert_eq!(TABLE.loops(255, Face::NONE).count, 0);
        assert_eq!(TABLE.loops(0b0000_0001, Face::NONE).count, 1);
        assert_eq!(TABLE.loops(0b0110_1001, Face::NONE).count, 4, "four corners cut off");
    }
}
