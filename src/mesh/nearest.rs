//! The triangle of a surface that is nearest to a point.

use nalgebra::Vector3;

use plume_graph::Aabb;

pub(crate) type Point = Vector3<f64>;
pub(crate) type Triangle = [Point; 3];

/// Triangles of a leaf. Tuned.
const LEAF: usize = 4;

/// A bounding volume hierarchy of a surface, split at the median.
#[derive(Debug)]
pub(crate) struct Nearest {
    /// Triangles with their indices in the surface.
    triangles: Vec<(Triangle, u32)>,
    /// Boxes; each is followed by its first half.
    boxes: Vec<TreeNode>,
}

/// The nearest triangle to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) triangle: Triangle,
    /// Index of the triangle in the surface.
    pub(crate) index: u32,
    /// Squared distance.
    pub(crate) squared: f64,
}

/// The box round some triangles.
#[derive(Clone, Copy, Debug)]
struct TreeNode {
    bounds: Aabb<f64>,
    /// Index of the second half; 0 for a leaf.
    second: usize,
}

impl Nearest {
    /// The tree of a surface of at least one triangle.
    pub(crate) fn new(surface: &[Triangle]) -> Self {
        let triangles = surface.iter().copied().zip(0..).collect();
        let mut tree = Self { triangles, boxes: Vec::new() };
        tree.build(0, surface.len());
        tree
    }

    fn build(&mut self, start: usize, end: usize) {
        let part = &mut self.triangles[start..end];
        let corners = part.iter().flat_map(|(triangle, _)| triangle).copied();
        let bounds = Aabb::from_points(corners).expect("a part has triangles");
        let at = self.boxes.len();
        self.boxes.push(TreeNode { bounds, second: 0 });
        if end - start <= LEAF {
            return;
        }
        let axis = bounds.longest_axis();
        let along = |(t, _): &(Triangle, u32)| t[0][axis] + t[1][axis] + t[2][axis];
        let half = (end - start) / 2;
        part.sort_by(|a, b| along(a).total_cmp(&along(b)));
        self.build(start, start + half);
        self.boxes[at].second = self.boxes.len();
        self.build(start + half, end);
    }

    /// The triangle nearest to a point.
    pub(crate) fn nearest(&self, point: Point) -> Found {
        self.nearer(point, f64::INFINITY).expect("there is a triangle")
    }

    /// The triangle nearest to a point, if its squared distance is less than this one.
    pub(crate) fn nearer(&self, point: Point, squared: f64) -> Option<Found> {
        let mut best = (None, squared);
        self.search(point, 0, 0..self.triangles.len(), &mut best);
        let (triangle, index) = self.triangles[best.0?];
        Some(Found { triangle, index, squared: best.1 })
    }

    /// Searches below a box; the nearer half first.
    fn search(&self, point: Point, at: usize, range: std::ops::Range<usize>, best: &mut (Option<usize>, f64)) {
        let second = self.boxes[at].second;
        if second == 0 {
            for place in range {
                let squared = squared_distance(point, self.triangles[place].0);
                if squared < best.1 {
                    *best = (Some(place), squared);
                }
            }
            return;
        }
        let middle = range.start + range.len() / 2;
        let distance = |at: usize| self.boxes[at].bounds.squared_distance(point.into());
        let mut halves =
            [(distance(at + 1), at + 1, range.start..middle), (distance(second), second, middle..range.end)];
        if halves[1].0 < halves[0].0 {
            halves.reverse();
        }
        for (squared, at, range) in halves {
            if squared < best.1 {
                self.search(point, at, range, best);
            }
        }
    }
}

/// A bounding sphere of a triangle around the mean of its corners.
pub(super) struct Ball {
    pub(super) centre: Point,
    pub(super) radius: f64,
}

impl Ball {
    pub(super) fn around(&[a, b, c]: &Triangle) -> Self {
        let centre = (a + b + c) / 3.0;
        let radius = [a, b, c].map(|corner| (corner - centre).norm_squared()).into_iter().fold(0.0, f64::max).sqrt();
        Self { centre, radius }
    }

    /// Whether all of it is further than this from a point.
    pub(super) fn is_beyond(&self, point: Point, distance: f64) -> bool {
        let far = distance + self.radius;
        (point - self.centre).norm_squared() > far * far
    }
}

/// A triangle bisected across the longest side.
pub(super) fn halves([a, b, c]: Triangle) -> [Triangle; 2] {
    let sides = [(b - a).norm_squared(), (c - b).norm_squared(), (a - c).norm_squared()];
    let [a, b, c] = match sides {
        [ab, bc, ca] if ab >= bc && ab >= ca => [a, b, c],
        [_, bc, ca] if bc >= ca => [b, c, a],
        _ => [c, a, b],
    };
    let middle = (a + b) * 0.5;
    [[a, middle, c], [middle, b, c]]
}

/// Squared distance of a point to a triangle.
pub(super) fn squared_distance(point: Point, triangle: Triangle) -> f64 {
    (point - closest(point, triangle).0).norm_squared()
}

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// The corner with this index.
    Corner(usize),
    /// The edge from the corner with this index to the next.
    Edge(usize),
    /// The interior.
    Inside,
}

/// The point of a triangle that is closest to `p`, and the part of the triangle that contains it (Ericson, *Real-Time Collision
/// Detection*, 2005, 5.1.5).
pub(crate) fn closest(p: Point, [a, b, c]: Triangle) -> (Point, Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6)), Feature::Edge(1));
    }
    let scale = 1.0 / (va + vb + vc);
    (a + ab * (vb * scale) + ac * (vc * scale), Feature::Inside)
}
