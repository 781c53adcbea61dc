//! The convex hull of a few points in whole quanta: exact, so always convex and closed.
//!
//! Points are added one by one (incremental construction; de Berg et al., *Computational Geometry*, 2008, ch. 11). A face
//! whose plane holds the new point goes with those that see it, so every vertex left is a corner. Coordinates may differ
//! by less than 2¹⁹ quanta (128 m); products of three then fit into 64 bits.

use nalgebra::Vector3;

type Point = Vector3<i64>;

/// A closed convex surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Hull {
    /// Which of the points are its corners.
    pub(crate) corners: Vec<u32>,
    /// Its triangles, counter-clockwise from outside, as indices into `corners`.
    pub(crate) faces: Vec<[u32; 3]>,
}

/// The hull of points that are not coplanar.
pub(crate) fn hull(points: &[[i32; 3]]) -> Option<Hull> {
    let first = *points.first()?;
    let points: Vec<Point> =
        points.iter().map(|p| Vector3::from_fn(|i, _| i64::from(p[i]) - i64::from(first[i]))).collect();
    let start = tetrahedron(&points)?;
    let mut faces: Vec<Face> = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]
        .map(|corners| Face::new(&points, corners.map(|corner| start[corner])))
        .into();
    let mut seen_edges = Vec::new();
    for (index, point) in points.iter().enumerate() {
        if !faces.iter().any(|face| face.height(point) > 0) {
            continue;
        }
        seen_edges.clear();
        faces.retain(|face| {
            let seen = face.height(point) >= 0;
            if seen {
                seen_edges.extend(face.edges());
            }
            !seen
        });
        for &[a, b] in &seen_edges {
            if !seen_edges.contains(&[b, a]) {
                faces.push(Face::new(&points, [a, b, index as u32]));
            }
        }
    }
    Some(named(&faces))
}

/// A triangle of the hull under construction.
struct Face {
    corners: [u32; 3],
    normal: Point,
    offset: i64,
}

impl Face {
    fn new(points: &[Point], corners: [u32; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let normal = (b - a).cross(&(c - a));
        Self { corners, normal, offset: normal.dot(&a) }
    }

    /// Positive outside.
    fn height(&self, point: &Point) -> i64 {
        self.normal.dot(point) - self.offset
    }

    fn edges(&self) -> [[u32; 2]; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]]
    }
}

/// Four points that are not coplanar, the last behind the triangle of the others.
fn tetrahedron(points: &[Point]) -> Option<[u32; 4]> {
    let farthest = |measure: &dyn Fn(&Point) -> i64| {
        let best = (0..points.len()).max_by_key(|&i| (measure(&points[i]), std::cmp::Reverse(i)))?;
        (measure(&points[best]) > 0).then_some(best)
    };
    let a = points[0];
    let second = farthest(&|p| (p - a).abs().sum())?;
    let along = points[second] - a;
    let third = farthest(&|p| along.cross(&(p - a)).abs().sum())?;
    let normal = along.cross(&(points[third] - a));
    let fourth = farthest(&|p| normal.dot(&(p - a)).abs())?;
    let [b, c, d] = [second, third, fourth].map(|i| i as u32);
    Some(if normal.dot(&(points[fourth] - a)) < 0 { [0, b, c, d] } else { [0, c, b, d] })
}

fn named(faces: &[Face]) -> Hull {
    let mut corners: Vec<u32> = faces.iter().flat_map(|face| face.corners).collect();
    corners.sort_unstable();
    corners.dedup();
    let place = |corner: u32| corners.binary_search(&corner).expect("a face has it") as u32;
    let faces = faces.iter().map(|face| face.corners.map(place)).collect();
    Hull { corners, faces }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn heights<'a>(points: &'a [[i32; 3]], hull: &'a Hull) -> impl Iterator<Item = i64> + 'a {
        let point = |p: &[i32; 3]| Point::from(p.map(i64::from));
        let all: Vec<Point> = points.iter().map(point).collect();
        let corners: Vec<Point> = hull.corners.iter().map(|&c| all[c as usize]).collect();
        let faces: Vec<Face> = hull.faces.iter().map(|&face| Face::new(&corners, face)).collect();
        faces.into_iter().flat_map(move |face| all.clone().into_iter().map(move |point| face.height(&point)))
    }

    fn is_closed(hull: &Hull) -> bool {
        let mut edges: Vec<[u32; 2]> = hull.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        let twins = edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok());
        edges.windows(2).all(|pair| pair[0] != pair[1]) && twins
    }

    #[test]
    fn coplanar_points_have_no_hull() {
        let flat: Vec<[i32; 3]> = (0..9).map(|i| [i % 3, i / 3, 2 * (i % 3) - i / 3]).collect();
        assert_eq!(hull(&flat), None);
        assert_eq!(hull(&[[1, 2, 3]; 5]), None);
        assert_eq!(hull(&[]), None);
    }

    #[test]
    fn a_lattice_has_the_corners_of_its_box() {
        let lattice: Vec<[i32; 3]> = (0..64).map(|i| [i % 4, i / 4 % 4, i / 16]).collect();
        let hull = hull(&lattice).unwrap();
        assert_eq!((hull.corners.len(), hull.faces.len()), (8, 12));
        assert!(is_closed(&hull));
    }

    proptest! {
        #[test]
        fn it_is_closed_and_holds_every_point(points in prop::collection::vec(prop::array::uniform3(-6..6i32), 1..40)) {
            if let Some(hull) = hull(&points) {
                prop_assert!(is_closed(&hull));
                prop_assert_eq!(hull.faces.len(), 2 * hull.corners.len() - 4);
                prop_assert!(heights(&points, &hull).all(|height| height <= 0));
            }
        }

        #[test]
        fn far_points_do_not_overflow(points in prop::collection::vec(prop::array::uniform3(0..(1 << 19)), 4..12)) {
            if let Some(hull) = hull(&points) {
                prop_assert!(is_closed(&hull));
                prop_assert!(heights(&points, &hull).all(|height| height <= 0));
            }
        }
    }
}
