//! The shortest joins between parts: Borůvka's minimum spanning tree (1926) over a k-d tree (Bentley & Friedman 1978:
//! "Fast algorithms for constructing minimal spanning trees in coordinate spaces").
//!
//! In each round every part but the largest takes the shortest join to another, which at least halves their number. The
//! nearest point found in one round stays the nearest until it is in the same part, and bounds later searches: for most
//! points there is only one search.

use nalgebra::Point3;

use super::NONE;
use super::tree::{Near, Tree};
use plume_graph::sets::Sets;

/// Joins that connect all `parts`, given the part of each point; lower index first.
pub(super) fn shortest(places: &[Point3<f64>], part_of: &[usize], parts: usize) -> Vec<[usize; 2]> {
    if parts < 2 {
        return Vec::new();
    }
    let points: Vec<usize> = (0..places.len()).filter(|&point| part_of[point] != NONE).collect();
    let mut rounds = Rounds {
        tree: Tree::new(places, points.clone()),
        points,
        part_of: part_of.to_vec(),
        nearest: vec![Near { point: NONE, squared: 0.0 }; places.len()],
    };
    let mut joined = Sets::new(parts);
    let mut joins = Vec::with_capacity(parts - 1);
    while joins.len() + 1 < parts {
        for [a, b] in rounds.ways_out(parts) {
            if joined.unite(part_of[a], part_of[b]) {
                joins.push([a.min(b), a.max(b)]);
            }
        }
        rounds.points.iter().for_each(|&point| rounds.part_of[point] = joined.find(part_of[point]));
    }
    joins
}

struct Rounds<'a> {
    tree: Tree<'a>,
    points: Vec<usize>,
    /// Part of each point, as joined so far.
    part_of: Vec<usize>,
    /// The last nearest point of each point; no point of another part is nearer.
    nearest: Vec<Near>,
}

impl Rounds<'_> {
    /// The shortest join out of every part but the largest, by part.
    fn ways_out(&mut self, parts: usize) -> Vec<[usize; 2]> {
        self.tree.set_parts(&self.part_of);
        let mut best: Vec<Option<(f64, [usize; 2])>> = vec![None; parts];
        let largest = self.largest(parts);
        let asking: Vec<usize> = self.points.iter().copied().filter(|&point| self.part_of[point] != largest).collect();
        let is_still_out =
            |near: Near, point: usize| near.point != NONE && self.part_of[near.point] != self.part_of[point];
        let (known, unknown): (Vec<usize>, Vec<usize>) =
            asking.into_iter().partition(|&point| is_still_out(self.nearest[point], point));
        for point in known {
            take(&mut best[self.part_of[point]], point, self.nearest[point]);
        }
        for point in unknown {
            let part = self.part_of[point];
            let within = best[part].map_or(f64::INFINITY, |(squared, _)| squared);
            if self.nearest[point].squared > within {
                continue;
            }
            match self.tree.nearest(point, &self.part_of, within) {
                Some(near) => {
                    self.nearest[point] = near;
                    take(&mut best[part], point, near);
                }
                None => self.nearest[point] = Near { point: NONE, squared: within },
            }
        }
        best.into_iter().flatten().map(|(_, ends)| ends).collect()
    }

    fn largest(&self, parts: usize) -> usize {
        let mut sizes = vec![0_usize; parts];
        self.points.iter().for_each(|&point| sizes[self.part_of[point]] += 1);
        (0..parts).rev().max_by_key(|&part| sizes[part]).unwrap_or_default()
    }
}

/// Keeps the shorter join; of equals, that of the lowest points.
fn take(best: &mut Option<(f64, [usize; 2])>, point: usize, near: Near) {
    let way = (near.squared, [point, near.point]);
    if best.is_none_or(|best| way < best) {
        *best = Some(way);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::rng::Rng;
    use plume_graph::seed;

    /// Kruskal's algorithm over all pairs: slow, and independent of the one above.
    fn slow_length(places: &[Point3<f64>], part_of: &[usize], parts: usize) -> f64 {
        let pairs = (0..places.len()).flat_map(|a| (0..a).map(move |b| [a, b]));
        let mut pairs: Vec<(f64, [usize; 2])> = pairs.map(|[a, b]| ((places[a] - places[b]).norm(), [a, b])).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut joined = Sets::new(parts);
        pairs.iter().filter(|(_, [a, b])| joined.unite(part_of[*a], part_of[*b])).map(|(length, _)| length).sum()
    }

    #[test]
    fn joins_are_as_short_as_those_of_a_slow_search() {
        let mut rng = Rng::new(seed::stream(7, "joins", 0));
        for (count, parts) in [(40, 2), (60, 30), (300, 7), (300, 150)] {
            let mut coordinate = || (rng.unit() * 40.0).round();
            let places: Vec<Point3<f64>> =
                (0..count).map(|_| Point3::new(coordinate(), coordinate(), coordinate() / 8.0)).collect();
            let part_of: Vec<usize> = (0..count).map(|point| point % parts).collect();
            let joins = shortest(&places, &part_of, parts);
            assert_eq!(joins.len(), parts - 1);
            let length: f64 = joins.iter().map(|&[a, b]| (places[a] - places[b]).norm()).sum();
            let slow = slow_length(&places, &part_of, parts);
            assert!((length - slow).abs() < 1e-9, "{count} points in {parts} parts: {length} m, not {slow} m");
        }
    }
}
