//! A k-d tree (Bentley 1975) that finds the nearest point of another part.
//!
//! Each branch knows the bounding box of its points and their common part, if there is one: a search skips a branch of its
//! own part in one step, however many points it has.
//!
//! `rstar`, which is used elsewhere, is unsuitable here: its trees know no parts, so a search visits all of its own part that
//! is nearer than the next one. For 100,000 stations in five parts the first round had not ended after a minute; here all
//! joins take a fifth of a second.

use nalgebra::Point3;

use plume_graph::Aabb;

/// Points in a leaf. Tuned.
const LEAF: usize = 8;
/// Most branches that one search visits. Real caves need some dozens; points on a sphere around the query point would need
/// all, and then the nearest found so far is taken. Tuned.
const MOST_VISITS: usize = 1024;
/// The points of a branch belong to several parts.
const MIXED: usize = usize::MAX;

/// A spatial index of the points of a graph.
pub(super) struct Tree<'a> {
    places: &'a [Point3<f64>],
    /// Points in the order of the leaves.
    points: Vec<usize>,
    /// Each before its children; a first child directly follows its parent.
    branches: Vec<Branch>,
}

struct Branch {
    bounds: Aabb<f64>,
    /// The range of its points in the tree.
    start: usize,
    end: usize,
    /// Its second child; `None` in a leaf.
    second: Option<usize>,
    part: usize,
}

/// The nearest point found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Near {
    pub(super) point: usize,
    pub(super) squared: f64,
}

impl<'a> Tree<'a> {
    /// The tree of a subset of the points, which is not empty.
    pub(super) fn new(places: &'a [Point3<f64>], points: Vec<usize>) -> Self {
        let mut tree = Self { places, branches: Vec::with_capacity(points.len() / 2), points };
        tree.grow(0, tree.points.len());
        tree
    }

    /// Splits into halves of equal count across the longest side of the box: the depth is logarithmic.
    fn grow(&mut self, start: usize, end: usize) {
        let places = self.places;
        let points = &mut self.points[start..end];
        let bounds = Aabb::from_points(points.iter().map(|&point| places[point])).expect("a branch has points");
        let at = self.branches.len();
        self.branches.push(Branch { bounds, start, end, second: None, part: MIXED });
        if points.len() <= LEAF {
            return;
        }
        let axis = bounds.longest_axis();
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |&a, &b| places[a][axis].total_cmp(&places[b][axis]).then(a.cmp(&b)));
        self.grow(start, start + middle);
        self.branches[at].second = Some(self.branches.len());
        self.grow(start + middle, end);
    }

    /// Updates the part of each point.
    pub(super) fn set_parts(&mut self, part_of: &[usize]) {
        for at in (0..self.branches.len()).rev() {
            let branch = &self.branches[at];
            self.branches[at].part = match branch.second {
                Some(second) if self.branches[at + 1].part == self.branches[second].part => self.branches[second].part,
                Some(_) => MIXED,
                None => {
                    let mut parts = self.points[branch.start..branch.end].iter().map(|&point| part_of[point]);
                    let first = parts.next().unwrap_or(MIXED);
                    if parts.all(|part| part == first) { first } else { MIXED }
                }
            };
        }
    }

    /// The point of another part nearest to this one, within a squared distance. Of equals, the lowest.
    pub(super) fn nearest(&self, from: usize, part_of: &[usize], within: f64) -> Option<Near> {
        let mut search = Search { from, part_of, within, best: None };
        let mut ahead = vec![(0, 0.0)];
        let mut visits = 0;
        while let Some((at, squared)) = ahead.pop() {
            // A branch at the same distance may hold a lower point; the first descent always reaches a leaf.
            if squared > search.within || (visits > MOST_VISITS && search.within.is_finite()) {
                continue;
            }
            visits += 1;
            let branch = &self.branches[at];
            let Some(second) = branch.second else {
                search.look(self.places, &self.points[branch.start..branch.end]);
                continue;
            };
            let mut children = [at + 1, second].map(|child| (child, self.squared(child, from)));
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            ahead.extend(children.into_iter().filter(|&(child, _)| self.branches[child].part != part_of[from]));
        }
        search.best
    }

    /// Squared distance from a point to the box of a branch.
    fn squared(&self, branch: usize, from: usize) -> f64 {
        self.branches[branch].bounds.squared_distance(self.places[from].into())
    }
}

/// A search in progress.
struct Search<'a> {
    from: usize,
    part_of: &'a [usize],
    within: f64,
    best: Option<Near>,
}

impl Search<'_> {
    fn look(&mut self, places: &[Point3<f64>], points: &[usize]) {
        for &point in points {
            let squared = (places[point] - places[self.from]).norm_squared();
            let is_nearer = match self.best {
                Some(best) => (squared, point) < (best.squared, best.point),
                None => squared <= self.within,
            };
            if is_nearer && self.part_of[point] != self.part_of[self.from] {
                self.within = squared;
                self.best = Some(Near { point, squared });
            }
        }
    }
}
