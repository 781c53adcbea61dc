//! Hausdorff distance of two surfaces: a bound that holds at every point, not only at samples.
//!
//! The distance to a triangle is convex, so over a piece of a surface its maximum is at a corner; and distances are
//! 1-Lipschitz. Both bound the distance of a piece from the other surface. The piece with the largest bound is subdivided
//! until that bound is hardly more than a distance that was found (after Guthe, Borodin and Klein, *Fast and accurate
//! Hausdorff distance calculation between meshes*, 2005).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use super::nearest::{Ball, Found, Nearest, Triangle, halves, squared_distance};
use super::{Mesh, QUANTA_PER_M};

/// A bound is good enough if it is at most this share, and a quantum, above what was found. Tuned.
const SLACK: f64 = 0.05;

/// A surface to which others are compared.
pub(crate) struct HausdorffBound<'a> {
    positions: &'a [[i32; 3]],
    surface: Vec<Triangle>,
    tree: Nearest,
}

impl<'a> HausdorffBound<'a> {
    /// Indexes a surface of at least one triangle.
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let surface = placed(&mesh.positions, &mesh.triangles);
        Self { positions: &mesh.positions, tree: Nearest::new(&surface), surface }
    }

    /// An upper bound of the Hausdorff distance in metres, at most 5 % and a quantum above it. `triangles` is not empty and
    /// uses the same vertices.
    pub(crate) fn distance_bound_m(&self, triangles: &[[u32; 3]]) -> f32 {
        let other = placed(self.positions, triangles);
        let there = one_way(&self.surface, &Nearest::new(&other), 0.0);
        let both = one_way(&other, &self.tree, there);
        // The next float, to compensate for rounding.
        ((both / f64::from(QUANTA_PER_M)) as f32).next_up()
    }
}

/// Triangles in quanta from the first vertex.
fn placed(positions: &[[i32; 3]], triangles: &[[u32; 3]]) -> Vec<Triangle> {
    let first = positions[0];
    let at = |v: u32| Vector3::from_fn(|i, _| f64::from(positions[v as usize][i] - first[i]));
    triangles.iter().map(|triangle| triangle.map(at)).collect()
}

/// An upper bound of the distance of every point of `from` to the other surface, at least `least`.
fn one_way(from: &[Triangle], to: &Nearest, least: f64) -> f64 {
    let mut found = least;
    let mut pieces = BinaryHeap::new();
    let mut near = None;
    for triangle in from {
        let piece = Piece::new(*triangle, near, to, &mut found);
        near = Some(piece.near);
        pieces.push(piece);
    }
    while let Some(piece) = pieces.pop() {
        if piece.bound <= good_enough(found) {
            return piece.bound.max(least);
        }
        for half in halves(piece.corners) {
            pieces.push(Piece::new(half, Some(piece.near), to, &mut found));
        }
    }
    least
}

/// The largest bound that is good enough for a distance that was found.
fn good_enough(found: f64) -> f64 {
    found * (1.0 + SLACK) + 1.0
}

/// A part of a surface, ordered by its bound.
struct Piece {
    corners: Triangle,
    /// A triangle of the other surface that is near.
    near: Triangle,
    /// Upper bound of the distance of its points to the other surface.
    bound: f64,
}

impl Piece {
    /// The search for the nearest triangle is spared where one that is known to be near is good enough.
    fn new(corners: Triangle, known: Option<Triangle>, to: &Nearest, found: &mut f64) -> Self {
        let most =
            |triangle| corners.map(|corner| squared_distance(corner, triangle)).into_iter().fold(0.0, f64::max).sqrt();
        if let Some((near, bound)) =
            known.map(|near| (near, most(near))).filter(|(_, bound)| *bound <= good_enough(*found))
        {
            return Self { corners, near, bound };
        }
        let Ball { centre, radius } = Ball::around(&corners);
        let known = known.map(|near| (near, squared_distance(centre, near)));
        let nearer = to.nearer(centre, known.map_or(f64::INFINITY, |(_, squared)| squared));
        let nearest = nearer.map(|Found { triangle, squared, .. }| (triangle, squared)).or(known);
        let (near, squared) = nearest.expect("one of them is there");
        let distance = squared.sqrt();
        *found = found.max(distance);
        Self { corners, near, bound: most(near).min(distance + radius) }
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}
