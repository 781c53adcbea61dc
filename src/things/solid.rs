//! Closed surfaces of things that a voxel is too coarse for: bars, tubes, sheets and bodies of revolution.
//!
//! Every part is a loft: rings with as many corners each, joined by strips, and a cap at either end. Edges are bevelled by a
//! few millimetres, since the vertices of a mesh are shared and have one normal each. Promised: every part is closed,
//! manifold and faces outwards. Parts of one solid may overlap.

use nalgebra::{Isometry3, Point2, Point3, Translation3, UnitQuaternion, Vector3};
use plume_graph::Aabb;

use super::rest::turn;
use super::substance::Substance;

/// Width of the bevel of an edge in metres, and at most relative to the shortest side: beyond a quarter, bevels
/// would cross.
const BEVEL_M: f64 = 0.004;
const BEVEL: f64 = 0.2;

/// A thing made of parts.
pub struct Solid {
    pub(super) parts: Vec<Part>,
}

/// A closed surface of one substance.
pub(super) struct Part {
    pub vertices: Vec<Vertex>,
    pub faces: Vec<[u32; 3]>,
    pub substance: &'static Substance,
    /// From its own frame, whose z axis is its length, to that of the solid.
    pub frame: Isometry3<f64>,
    /// Its box in its own frame.
    pub bounds: Aabb<f64>,
}

/// A corner of a surface, with its normal.
#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub at: Point3<f64>,
    pub normal: Vector3<f64>,
}

/// Corners around a part, counter-clockwise seen from its end; a corner and its opposite across the y axis are at `n` and at
/// `len - 1 - n`.
type Ring = Vec<Vertex>;

impl Solid {
    /// A bar along z, centred, whose outline is symmetric about the y axis: the corners of its right half from below.
    pub fn bar(half: &[[f64; 2]], length_m: f64, substance: &'static Substance) -> Self {
        let outline = mirrored(half);
        let bevel_m = BEVEL_M.min(BEVEL * shortest_side_m(&outline).min(length_m));
        let outline = bevelled(&outline, bevel_m);
        let end = 0.5 * length_m;
        let ring = |z: f64, inset: f64, is_cap: bool| -> Ring {
            let corner = |(at, normal, inwards): &([f64; 2], [f64; 2], [f64; 2])| Vertex {
                at: Point3::new(at[0] + inset * inwards[0], at[1] + inset * inwards[1], z),
                normal: if is_cap { Vector3::z() * z.signum() } else { Vector3::new(normal[0], normal[1], 0.0) },
            };
            outline.iter().map(corner).collect()
        };
        let rings = [
            ring(-end, bevel_m, true),
            ring(-end + bevel_m, 0.0, false),
            ring(end - bevel_m, 0.0, false),
            ring(end, bevel_m, true),
        ];
        Self::of(loft(&rings), substance)
    }

    /// A box with these sides, centred, whose length is its z axis.
    pub fn cuboid(size_m: [f64; 3], substance: &'static Substance) -> Self {
        let [x, y] = [0.5 * size_m[0], 0.5 * size_m[1]];
        Self::bar(&[[x, -y], [x, y]], size_m[2], substance)
    }

    /// A body of revolution about z with this many sides: height and radius from below, neither radius 0.
    pub fn lathe(profile: &[[f64; 2]], sides: usize, substance: &'static Substance) -> Self {
        let ring = |n: usize| -> Ring {
            let [z, radius] = profile[n];
            let (below, above) = (profile[n.saturating_sub(1)], profile[(n + 1).min(profile.len() - 1)]);
            let slope = Vector3::new(above[0] - below[0], 0.0, below[1] - above[1]);
            round(sides)
                .map(|[x, y]| Vertex {
                    at: Point3::new(radius * x, radius * y, z),
                    normal: Vector3::new(slope.x * x, slope.x * y, slope.z).normalize(),
                })
                .collect()
        };
        let cap = |n: usize, up: f64| -> Ring {
            let [z, radius] = profile[n];
            let inner = radius - BEVEL_M.min(0.3 * radius);
            let z = z + up * BEVEL_M;
            round(sides)
                .map(|[x, y]| Vertex { at: Point3::new(inner * x, inner * y, z), normal: Vector3::z() * up })
                .collect()
        };
        let mut rings = vec![cap(0, -1.0)];
        rings.extend((0..profile.len()).map(ring));
        rings.push(cap(profile.len() - 1, 1.0));
        Self::of(loft(&rings), substance)
    }

    /// A cylinder about z, centred.
    pub fn cylinder(radius_m: f64, length_m: f64, sides: usize, substance: &'static Substance) -> Self {
        let end = 0.5 * length_m - BEVEL_M;
        Self::lathe(&[[-end, radius_m], [end, radius_m]], sides, substance)
    }

    /// A tube of this radius along a path that does not turn back, nor point straight down.
    pub fn tube(path: &[Point3<f64>], radius_m: f64, sides: usize, substance: &'static Substance) -> Self {
        let last = path.len() - 1;
        let along = |n: usize| (path[(n + 1).min(last)] - path[n.saturating_sub(1)]).normalize();
        let ring = |n: usize| -> Ring {
            let facing = turn(Vector3::z(), along(n));
            let spoke = |[x, y]: [f64; 2]| facing * Vector3::new(x, y, 0.0);
            round(sides).map(spoke).map(|spoke| Vertex { at: path[n] + spoke * radius_m, normal: spoke }).collect()
        };
        let cap = |n: usize, way: f64| -> Ring {
            let out = along(n) * way;
            let inner = 0.7 * radius_m;
            let facing = turn(Vector3::z(), along(n));
            let spoke = |[x, y]: [f64; 2]| facing * Vector3::new(x, y, 0.0);
            round(sides)
                .map(|at| Vertex { at: path[n] + spoke(at) * inner + out * 0.3 * radius_m, normal: out })
                .collect()
        };
        let mut rings = vec![cap(0, -1.0)];
        rings.extend((0..path.len()).map(ring));
        rings.push(cap(last, 1.0));
        // Its grain runs along its chord.
        let chord = turn(Vector3::z(), (path[last] - path[0]).normalize());
        Self::framed(loft(&rings), substance, Isometry3::from_parts(Translation3::identity(), chord))
    }

    /// A body along z through outlines at heights from below, with normals that are smooth even over its edges. Outlines have
    /// as many corners each, counter-clockwise: first those on the right from below, then as many on the left from above.
    pub fn through(outlines: &[(f64, Vec<[f64; 2]>)], substance: &'static Substance) -> Self {
        let ring = |(z, outline): &(f64, Vec<[f64; 2]>)| -> Ring {
            let corner = |[x, y]: &[f64; 2]| Vertex { at: Point3::new(*x, *y, *z), normal: Vector3::zeros() };
            outline.iter().map(corner).collect()
        };
        let (mut vertices, faces) = loft(&outlines.iter().map(ring).collect::<Vec<_>>());
        smooth(&mut vertices, &faces);
        Self::of((vertices, faces), substance)
    }

    fn of(surface: (Vec<Vertex>, Vec<[u32; 3]>), substance: &'static Substance) -> Self {
        Self::framed(surface, substance, Isometry3::identity())
    }

    fn framed(
        (vertices, faces): (Vec<Vertex>, Vec<[u32; 3]>),
        substance: &'static Substance,
        frame: Isometry3<f64>,
    ) -> Self {
        let own = vertices.iter().map(|vertex| <[f64; 3]>::from(frame.inverse_transform_point(&vertex.at)));
        let bounds = Aabb::from_points(own).expect("a part has corners");
        Self { parts: vec![Part { vertices, faces, substance, frame, bounds }] }
    }

    /// Moved.
    pub fn at(mut self, x: f64, y: f64, z: f64) -> Self {
        self.parts.iter_mut().for_each(|part| part.move_by(&Isometry3::translation(x, y, z)));
        self
    }

    /// Turned so that what was up points this way, the shortest way.
    pub fn towards(mut self, direction: Vector3<f64>) -> Self {
        let turned = Isometry3::from_parts(Translation3::identity(), turn(Vector3::z(), direction));
        self.parts.iter_mut().for_each(|part| part.move_by(&turned));
        self
    }

    /// Turned so that its length is along x and the y axis of its outline is up.
    pub fn lying(mut self) -> Self {
        let half = nalgebra::Quaternion::new(0.5, 0.5, 0.5, 0.5);
        let turned = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::new_normalize(half));
        self.parts.iter_mut().for_each(|part| part.move_by(&turned));
        self
    }

    /// The part that has this point on its surface: of several whose boxes hold it, the last.
    pub(super) fn part_at(&self, at: Point3<f64>) -> &Part {
        /// Rounding of the mesh, in metres.
        const ROUNDING_M: f64 = 0.002;
        let holds = self.parts.iter().rev().find(|part| part.outside_m(at) < ROUNDING_M);
        let nearest = || self.parts.iter().min_by(|a, b| a.outside_m(at).total_cmp(&b.outside_m(at)));
        holds.or_else(nearest).expect("a solid has parts")
    }

    /// Together with another one.
    pub fn and(mut self, other: Self) -> Self {
        self.parts.extend(other.parts);
        self
    }
}

impl Part {
    fn move_by(&mut self, pose: &Isometry3<f64>) {
        for vertex in &mut self.vertices {
            *vertex = Vertex { at: pose * vertex.at, normal: pose * vertex.normal };
        }
        self.frame = pose * self.frame;
    }

    /// How far a point is outside of its box, in metres.
    pub fn outside_m(&self, at: Point3<f64>) -> f64 {
        let own = self.frame.inverse_transform_point(&at);
        let beyond = |axis: usize| (self.bounds.min[axis] - own[axis]).max(own[axis] - self.bounds.max[axis]);
        beyond(0).max(beyond(1)).max(beyond(2)).max(0.0)
    }
}

/// The whole outline, counter-clockwise, given its right half from below.
fn mirrored(half: &[[f64; 2]]) -> Vec<[f64; 2]> {
    half.iter().copied().chain(half.iter().rev().map(|[x, y]| [-x, *y])).collect()
}

/// Length of the shortest side of an outline.
fn shortest_side_m(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let sides = outline.iter().zip(next).map(|(a, b)| (Point2::from(*b) - Point2::from(*a)).norm());
    sides.fold(f64::INFINITY, f64::min)
}

/// Every corner cut off: where, the normal of the side that it is on, and a vector inwards that insets both sides by one.
fn bevelled(outline: &[[f64; 2]], bevel_m: f64) -> Vec<([f64; 2], [f64; 2], [f64; 2])> {
    let count = outline.len();
    let side = |n: usize| {
        let ([ax, ay], [bx, by]) = (outline[n % count], outline[(n + 1) % count]);
        let length = ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
        [(bx - ax) / length, (by - ay) / length]
    };
    let mut bevelled = Vec::new();
    for (n, [x, y]) in outline.iter().copied().enumerate() {
        let (before, after) = (side(n + count - 1), side(n));
        let (left, right) = ([before[1], -before[0]], [after[1], -after[0]]);
        let turn = 1.0 + left[0] * right[0] + left[1] * right[1];
        let inwards = [-(left[0] + right[0]) / turn, -(left[1] + right[1]) / turn];
        bevelled.push(([x - before[0] * bevel_m, y - before[1] * bevel_m], left, inwards));
        bevelled.push(([x + after[0] * bevel_m, y + after[1] * bevel_m], right, inwards));
    }
    bevelled
}

/// Corners of a circle of radius 1, an even number of them.
fn round(sides: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..sides).map(move |n| {
        let angle = std::f64::consts::TAU * ((n as f64 + 0.5) / sides as f64 - 0.25);
        [libm::cos(angle), libm::sin(angle)]
    })
}

/// Rings joined by strips, and closed at both ends.
fn loft(rings: &[Ring]) -> (Vec<Vertex>, Vec<[u32; 3]>) {
    let count = rings[0].len() as u32;
    let mut faces = Vec::new();
    for first in (0..rings.len() as u32 - 1).map(|ring| ring * count) {
        for n in 0..count {
            let (a, b) = (first + n, first + (n + 1) % count);
            faces.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
    }
    let last = (rings.len() as u32 - 1) * count;
    for n in 0..count / 2 - 1 {
        // Between a corner, the next one, and those opposite.
        let quad = [n, n + 1, count - 2 - n, count - 1 - n];
        let up = quad.map(|corner| last + corner);
        faces.extend([[up[0], up[1], up[2]], [up[0], up[2], up[3]]]);
        faces.extend([[quad[0], quad[2], quad[1]], [quad[0], quad[3], quad[2]]]);
    }
    (rings.concat(), faces)
}

/// Gives each corner the mean of the normals of its faces, weighted by their angles there: by area, narrow rims face away.
fn smooth(vertices: &mut [Vertex], faces: &[[u32; 3]]) {
    for face in faces {
        let at = face.map(|corner| vertices[corner as usize].at);
        let normal = (at[1] - at[0]).cross(&(at[2] - at[0])).normalize();
        for n in 0..3 {
            let [next, last] = [1, 2].map(|step| at[(n + step) % 3] - at[n]);
            let angle_rad = libm::atan2(next.cross(&last).norm(), next.dot(&last));
            vertices[face[n] as usize].normal += normal * angle_rad;
        }
    }
    vertices.iter_mut().for_each(|vertex| vertex.normal = vertex.normal.normalize());
}
