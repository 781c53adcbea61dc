//! Which triangle lies across an edge.

/// No triangle: the edge is open, or more than two triangles meet there.
pub(super) const NONE: u32 = u32::MAX;

/// The neighbour of every triangle across its edges; edge `k` runs from corner `k` to corner `k + 1`.
pub(super) fn neighbours(vertex_count: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let (starts, halves) = half_edges_by_lower_vertex(vertex_count, triangles);
    let mut across = vec![[NONE; 3]; triangles.len()];
    for window in starts.windows(2) {
        let fan = &halves[window[0] as usize..window[1] as usize];
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

fn half_edges_by_lower_vertex(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<HalfEdge>) {
    let edges = || {
        triangles.iter().enumerate().flat_map(|(t, corners)| {
            (0..3).map(move |k| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                (a.min(b), HalfEdge { upper: a.max(b), edge: (3 * t + k) as u32 })
            })
        })
    };
    let mut starts = vec![0_u32; vertex_count + 1];
    for (lower, _) in edges() {
        starts[lower as usize + 1] += 1;
    }
    for v in 0..vertex_count {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut halves = vec![HalfEdge::default(); triangles.len() * 3];
    for (lower, half) in edges() {
        halves[next[lower as usize] as usize] = half;
        next[lower as usize] += 1;
    }
    (starts, halves)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_see_each_other_and_a_third_on_the_edge_hides_all() {
        let quad = [[0, 1, 2], [2, 1, 3]];
        assert_eq!(neighbours(4, &quad), [[NONE, 1, NONE], [0, NONE, NONE]]);
        let book = [[0, 1, 2], [2, 1, 3], [1, 2, 4]];
        assert_eq!(neighbours(5, &book), [[NONE; 3]; 3]);
    }
}
