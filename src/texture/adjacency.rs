//! Adjacency of triangles across edges.

use plume_graph::Rows;

/// No triangle: a boundary edge, or more than two triangles.
pub(super) const NONE: u32 = u32::MAX;

/// The neighbour of every triangle across its edges; edge `k` runs from corner `k` to corner `k + 1`.
pub(super) fn neighbours(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut across = vec![[NONE; 3]; triangles.len()];
    for fan in half_edges_by_lower_vertex(vertex_count, triangles).iter() {
        for half in fan {
            let mut twins = fan.iter().filter(|twin| twin.upper == half.upper);
            let (Some(a), Some(b), None) = (twins.next(), twins.next(), twins.next()) else {
                continue;
            };
            let twin = if a.edge == half.edge { b } else { a };
            across[half.edge as usize / 3][half.edge as usize % 3] = twin.edge / 3;
        }
    }
    across
}

/// Edge `edge % 3` of triangle `edge / 3`, filed under the lower of its two vertices.
#[derive(Clone, Copy, Default)]
struct HalfEdge {
    upper: u32,
    edge: u32,
}

fn half_edges_by_lower_vertex(vertex_count: usize, triangles: &[[u32; 3]]) -> Rows<HalfEdge> {
    let of_triangle = |(edge, &[a, b, c]): (u32, &[u32; 3])| {
        let half = |step: u32, a: u32, b: u32| (a.min(b) as usize, HalfEdge { upper: a.max(b), edge: edge + step });
        [half(0, a, b), half(1, b, c), half(2, c, a)]
    };
    Rows::from_pairs(vertex_count, (0..).step_by(3).zip(triangles).flat_map(of_triangle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_are_adjacent_unless_a_third_shares_the_edge() {
        let quad = [[0, 1, 2], [2, 1, 3]];
        assert_eq!(neighbours(4, &quad), [[NONE, 1, NONE], [0, NONE, NONE]]);
        let book = [[0, 1, 2], [2, 1, 3], [1, 2, 4]];
        assert_eq!(neighbours(5, &book), [[NONE; 3]; 3]);
    }
}
