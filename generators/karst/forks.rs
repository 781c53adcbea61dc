//! Opens forks: passages leave a vertex at distinct angles, and not too many of them.

use nalgebra::Vector3;

use plume_graph::centreline::{CentrelineBuilder, VertexId};
use plume_graph::tidy::MOST_PASSAGES;

/// Cosine of the minimum angle of forks: 30 degrees.
const LEAST_FORK_COSINE: f64 = 0.866;
const ROUNDS: usize = 64;

/// If two passages leave a vertex in nearly the same direction, or too many leave it, the longer one leaves from the end
/// of the shorter one instead. The moved passage gets shorter each time, so this terminates.
pub(super) fn open_forks(centreline: &mut CentrelineBuilder) {
    for _ in 0..ROUNDS {
        if !open_some(centreline) {
            break;
        }
    }
}

/// One pass over all vertices. Whether anything was moved.
fn open_some(centreline: &mut CentrelineBuilder) -> bool {
    centreline.lines.iter_mut().for_each(|line| line.sort_unstable());
    centreline.lines.sort_unstable();
    centreline.lines.dedup();
    let ends = |(line, ends): (usize, &[VertexId; 2])| ends.map(|vertex| (vertex, line as u32));
    let mut at_knots: Vec<(VertexId, u32)> = centreline.lines.iter().enumerate().flat_map(ends).collect();
    at_knots.sort_unstable();
    let mut touched = vec![false; centreline.lines.len()];
    let mut left = Vec::new();
    for at_knot in at_knots.chunk_by(|a, b| a.0 == b.0) {
        let vertex = at_knot[0].0;
        left.clear();
        left.extend(at_knot.iter().map(|&(_, line)| line as usize).filter(|&line| !touched[line]));
        while let Some((cosine, short, long)) = narrowest(centreline, vertex, &left) {
            if cosine <= LEAST_FORK_COSINE && left.len() <= MOST_PASSAGES {
                break;
            }
            centreline.lines[long] = [other_end(centreline, short, vertex), other_end(centreline, long, vertex)];
            touched[long] = true;
            touched[short] = true;
            left.retain(|&line| line != long);
        }
    }
    touched.contains(&true)
}

/// The two lines with the smallest angle between them: its cosine, the shorter line, the longer one.
fn narrowest(centreline: &CentrelineBuilder, vertex: VertexId, lines: &[usize]) -> Option<(f64, usize, usize)> {
    let way = |line: usize| -> Vector3<f64> {
        centreline[other_end(centreline, line, vertex)].position - centreline[vertex].position
    };
    let mut least: Option<(f64, usize, usize)> = None;
    for (place, &a) in lines.iter().enumerate() {
        for &b in &lines[place + 1..] {
            let (first, second) = (way(a), way(b));
            let cosine = first.dot(&second) / (first.norm() * second.norm());
            if least.is_none_or(|(other, ..)| cosine > other) {
                let [short, long] = if second.norm_squared() < first.norm_squared() { [b, a] } else { [a, b] };
                least = Some((cosine, short, long));
            }
        }
    }
    least
}

fn other_end(centreline: &CentrelineBuilder, line: usize, vertex: VertexId) -> VertexId {
    let [a, b] = centreline.lines[line];
    if a == vertex { b } else { a }
}
