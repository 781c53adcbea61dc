//! The triangle of a surface that is nearest to a point.

use nalgebra::Vector3;

pub(super) type Point = Vector3<f64>;
pub(super) type Triangle = [Point; 3];

/// Triangles of a leaf. Tuned.
const LEAF: usize = 4;

/// A surface as a tree of boxes, each split where half of its triangles lie on either side.
pub(super) struct Nearest {
    triangles: Vec<Triangle>,
    /// A box is followed by its first half.
    boxes: Vec<Box3>,
}

#[derive(Clone, Copy)]
struct Box3 {
    low: Point,
    high: Point,
    /// Index of the second half; 0 for a leaf.
    second: usize,
}

impl Nearest {
    /// The tree of a surface of at least one triangle.
    pub(super) fn new(surface: &[Triangle]) -> Self {
        let mut tree = Self { triangles: surface.to_vec(), boxes: Vec::new() };
        tree.build(0, surface.len());
        tree
    }

    fn build(&mut self, start: usize, end: usize) {
        let part = &mut self.triangles[start..end];
        let whole = Box3::around(part.iter().flatten());
        let at = self.boxes.len();
        self.boxes.push(whole);
        if end - start <= LEAF {
            return;
        }
        let axis = (whole.high - whole.low).imax();
        let along = |t: &Triangle| t[0][axis] + t[1][axis] + t[2][axis];
        let half = (end - start) / 2;
        part.sort_by(|a, b| along(a).total_cmp(&along(b)));
        self.build(start, start + half);
        self.boxes[at].second = self.boxes.len();
        self.build(start + half, end);
    }

    /// The nearest triangle and its squared distance.
    pub(super) fn nearest(&self, point: Point) -> (Triangle, f64) {
        let mut best = (self.triangles[0], f64::INFINITY);
        self.search(point, 0, 0..self.triangles.len(), &mut best);
        best
    }

    /// Searches below a box; the nearer half first.
    fn search(&self, point: Point, at: usize, range: std::ops::Range<usize>, best: &mut (Triangle, f64)) {
        let second = self.boxes[at].second;
        if second == 0 {
            for triangle in &self.triangles[range] {
                let squared = squared_distance(point, *triangle);
                if squared < best.1 {
                    *best = (*triangle, squared);
                }
            }
            return;
        }
        let middle = range.start + range.len() / 2;
        let mut halves = [(at + 1, range.start..middle), (second, middle..range.end)]
            .map(|(at, range)| (self.boxes[at].squared_distance(point), at, range));
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

impl Box3 {
    fn around<'a>(points: impl Iterator<Item = &'a Point>) -> Self {
        let start = Self { low: Point::repeat(f64::INFINITY), high: Point::repeat(f64::NEG_INFINITY), second: 0 };
        points.fold(start, |all, point| Self { low: all.low.inf(point), high: all.high.sup(point), second: 0 })
    }

    fn squared_distance(&self, point: Point) -> f64 {
        (point - point.sup(&self.low).inf(&self.high)).norm_squared()
    }
}

/// Squared distance of a point to a triangle (Ericson, *Real-Time Collision Detection*, 2005, 5.1.5).
pub(super) fn squared_distance(p: Point, [a, b, c]: Triangle) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.norm_squared();
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.norm_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).norm_squared();
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.norm_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).norm_squared();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (bp - (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6))).norm_squared();
    }
    let scale = 1.0 / (va + vb + vc);
    (ap - ab * (vb * scale) - ac * (vc * scale)).norm_squared()
}
