//! Disconnected parts of a graph.
//!
//! Points in the same place, to 1 mm, are one; a point without passages is not a part and is dropped. Joins are the shortest
//! that connect all parts: a minimum spanning tree between them. They are the same on every machine, and the time grows
//! little faster than the number of points, even for a malicious file (see [`joins`]).

mod joins;
mod tree;

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use nalgebra::Point3;

use super::{Parts, ReadError};
use plume_graph::millimetres;
use plume_graph::sets::Sets;

/// Members listed if a graph is disconnected.
const NAMED: usize = 10;
/// Hint for a disconnected graph.
pub(super) const HINT: &str = "add the missing passages, or `--set graph.parts=join` (or `keep`, or `longest`); \
     at an import `--parts join`";

/// The graph has several parts, which are refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Disconnected {
    /// The number of parts.
    pub(super) parts: usize,
    /// The first point of each, at most ten.
    pub(super) members: Vec<usize>,
}

impl Disconnected {
    /// The number of parts, and one member of each by the name that it has in the file.
    pub(super) fn message(&self, name: impl Fn(usize) -> String) -> String {
        let mut text = format!("the graph is in {} parts, with {}", self.parts, self.names(name));
        if self.parts > self.members.len() {
            write!(text, ", …").expect("memory takes any text");
        }
        text
    }

    /// The same as an error of the whole file.
    pub(super) fn into_error(self, path: &Path, name: impl Fn(usize) -> String) -> ReadError {
        ReadError::whole(path, self.message(name), HINT)
    }

    fn names(&self, name: impl Fn(usize) -> String) -> String {
        self.members.iter().map(|&member| name(member)).collect::<Vec<_>>().join(", ")
    }
}

/// The changes to points and lines that make their parts as asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fate {
    /// Lines to add.
    pub(super) joins: Vec<[usize; 2]>,
    /// Whether each point is kept.
    pub(super) stays: Vec<bool>,
    /// Number of points of dropped parts.
    pub(super) left_out: usize,
    /// Number of parts afterwards.
    pub(super) parts: usize,
}

impl Fate {
    /// # Errors
    /// If there are several parts and they are refused.
    pub(super) fn of(places: &[Point3<f64>], lines: &[[usize; 2]], parts: Parts) -> Result<Self, Disconnected> {
        let pieces = Pieces::of(places, lines);
        match parts {
            Parts::Refuse if pieces.lengths_m.len() > 1 => Err(pieces.into_refusal()),
            Parts::Refuse | Parts::Keep => Ok(pieces.kept(Vec::new())),
            Parts::Join => {
                let joins = joins::shortest(places, &pieces.of_point, pieces.lengths_m.len());
                Ok(pieces.kept(joins))
            }
            Parts::Longest => Ok(pieces.longest()),
        }
    }
}

/// No part.
const NONE: usize = usize::MAX;

/// The part of each point.
struct Pieces {
    /// Numbered by their first point, ascending; [`NONE`] for a point without passages.
    of_point: Vec<usize>,
    /// Total length of the passages of each part.
    lengths_m: Vec<f64>,
}

impl Pieces {
    fn of(places: &[Point3<f64>], lines: &[[usize; 2]]) -> Self {
        let welds = first_at_place(places);
        let mut sets = Sets::new(places.len());
        for [a, b] in welds.iter().copied().enumerate().map(Into::into).chain(lines.iter().copied()) {
            sets.unite(a, b);
        }
        let passages = || lines.iter().filter(|&&[a, b]| welds[a] != welds[b]);
        let mut on_passage = vec![false; places.len()];
        passages().for_each(|&[a, _]| on_passage[sets.find(a)] = true);
        let mut pieces = Self { of_point: vec![NONE; places.len()], lengths_m: Vec::new() };
        let mut of_set = vec![NONE; places.len()];
        for point in 0..places.len() {
            let set = sets.find(point);
            if !on_passage[set] {
                continue;
            }
            if of_set[set] == NONE {
                of_set[set] = pieces.lengths_m.len();
                pieces.lengths_m.push(0.0);
            }
            pieces.of_point[point] = of_set[set];
        }
        for &[a, b] in passages() {
            pieces.lengths_m[pieces.of_point[a]] += (places[a] - places[b]).norm();
        }
        pieces
    }

    fn into_refusal(self) -> Disconnected {
        let parts = self.lengths_m.len();
        let first = |part: usize| self.of_point.iter().position(|&other| other == part);
        Disconnected { parts, members: (0..parts.min(NAMED)).filter_map(first).collect() }
    }

    fn kept(self, joins: Vec<[usize; 2]>) -> Fate {
        let stays = self.of_point.iter().map(|&part| part != NONE).collect();
        Fate { parts: self.lengths_m.len() - joins.len(), joins, stays, left_out: 0 }
    }

    /// Keeps only the part with the greatest length of passages; of equals the first.
    fn longest(self) -> Fate {
        let parts = 0..self.lengths_m.len();
        let longest = parts.rev().max_by(|&a, &b| self.lengths_m[a].total_cmp(&self.lengths_m[b]));
        let stays = self.of_point.iter().map(|&part| part != NONE && Some(part) == longest);
        let gone = self.of_point.iter().filter(|&&part| part != NONE && Some(part) != longest);
        Fate { joins: Vec::new(), stays: stays.collect(), left_out: gone.count(), parts: self.lengths_m.len().min(1) }
    }
}

/// The first point in the place of each, to 1 mm. Randomly hashed, so that no file can provoke collisions.
pub(super) fn first_at_place(places: &[Point3<f64>]) -> Vec<usize> {
    let mut of_place: HashMap<[u64; 3], usize> = HashMap::new();
    let key = |place: &Point3<f64>| place.map(millimetres).coords.map(f64::to_bits).into();
    places.iter().enumerate().map(|(point, place)| *of_place.entry(key(place)).or_insert(point)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};

    /// A centreline whose parts are as asked.
    #[derive(Clone, Debug, PartialEq)]
    struct Settled {
        centreline: CentrelineBuilder,
        /// Lines that were added to join parts.
        joined: usize,
        /// Vertices of dropped parts; isolated ones do not count.
        left_out: usize,
    }

    /// Drops isolated vertices and treats the parts as asked.
    fn settled(centreline: CentrelineBuilder, parts: Parts) -> Result<Settled, Disconnected> {
        let places: Vec<Point3<f64>> = centreline.vertices.iter().map(|vertex| vertex.position).collect();
        let lines: Vec<[usize; 2]> = centreline.lines.iter().map(|line| line.map(VertexId::index)).collect();
        let fate = Fate::of(&places, &lines, parts)?;
        let mut settled =
            Settled { centreline: CentrelineBuilder::default(), joined: fate.joins.len(), left_out: fate.left_out };
        let mut new = vec![VertexId::default(); centreline.vertices.len()];
        for (index, vertex) in centreline.vertices.into_iter().enumerate().filter(|&(index, _)| fate.stays[index]) {
            new[index] = settled.centreline.add(vertex);
        }
        let lines = lines.into_iter().filter(|line| line.iter().all(|&end| fate.stays[end]));
        settled.centreline.lines = lines.chain(fate.joins).map(|line| line.map(|end| new[end])).collect();
        Ok(settled)
    }

    fn centreline(places: &[[f64; 3]], lines: &[[usize; 2]]) -> CentrelineBuilder {
        let vertex = |&place: &[f64; 3]| Vertex { position: place.into(), section: None, level: 0 };
        CentrelineBuilder {
            vertices: places.iter().map(vertex).collect(),
            lines: VertexId::pairs(lines.iter().copied()),
        }
    }

    /// Three parts along x, an isolated vertex and a zero-length line.
    fn three() -> CentrelineBuilder {
        let places = [[0.0; 3], [2.0, 0.0, 0.0], [90.0, 0.0, 0.0], [4.0, 1.0, 0.0], [4.0, 9.0, 0.0], [7.0, 3.0, 0.0]];
        let more = [[7.0, 4.0, 0.0], [50.0, 0.0, 0.0], [50.0002, 0.0, 0.0]];
        centreline(&[&places[..], &more].concat(), &[[0, 1], [3, 4], [5, 6], [7, 8]])
    }

    #[test]
    fn parts_are_refused_by_name() {
        let error = settled(three(), Parts::Refuse).expect_err("there are three");
        assert_eq!(error, Disconnected { parts: 3, members: vec![0, 3, 5] });
        assert_eq!(error.message(|vertex| format!("#{vertex}")), "the graph is in 3 parts, with #0, #3, #5");
        let many: Vec<[f64; 3]> = (0..40).map(|x| [f64::from(x), 0.0, 0.0]).collect();
        let pairs: Vec<[usize; 2]> = (0..20).map(|pair| [2 * pair, 2 * pair + 1]).collect();
        let error = settled(centreline(&many, &pairs), Parts::Refuse).expect_err("there are twenty");
        assert!(
            error
                .message(|vertex| vertex.to_string())
                .ends_with(" 20 parts, with 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, …")
        );
    }

    #[test]
    fn parts_are_joined_where_they_are_nearest() {
        let Settled { centreline, joined, left_out } = settled(three(), Parts::Join).expect("joined");
        assert_eq!((centreline.vertices.len(), joined, left_out), (6, 2, 0));
        assert_eq!(centreline.lines, VertexId::pairs([[0, 1], [2, 3], [4, 5], [1, 2], [2, 4]]));
    }

    #[test]
    fn parts_are_kept_or_only_the_longest_stays() {
        let kept = settled(three(), Parts::Keep).expect("kept");
        assert_eq!((kept.centreline.vertices.len(), kept.joined, kept.left_out), (6, 0, 0));
        assert_eq!(kept.centreline.into_graph().components().len(), 3);
        let longest = settled(three(), Parts::Longest).expect("one stays");
        assert_eq!((longest.centreline.vertices.len(), longest.joined, longest.left_out), (2, 0, 4));
        assert_eq!(longest.centreline.vertices[1].position.y, 9.0);
    }

    #[test]
    fn points_in_one_place_are_in_one_part() {
        let touching = centreline(&[[0.0; 3], [5.0, 0.0, 0.0], [5.0001, 0.0, 0.0], [9.0, 0.0, 0.0]], &[[0, 1], [2, 3]]);
        assert_eq!(settled(touching.clone(), Parts::Refuse).map(|settled| settled.centreline), Ok(touching));
        let nothing = settled(CentrelineBuilder::default(), Parts::Join).expect("no parts");
        assert_eq!(nothing.centreline, CentrelineBuilder::default());
    }
}
