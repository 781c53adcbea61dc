//! Rest of a stone on a floor, without physics.
//!
//! A stone that comes down on a floor stops in the lowest position in which nothing of it is below the floor. Among the
//! planes above all contacts, that of the lowest height at the centre of mass is a linear programme in three variables; at
//! its optimum three supports surround the centre of mass. The stone then turns into that plane, and again, until it no
//! longer turns. Promised of a result: three supports around the centre of mass, with a margin, and nothing of the samples
//! below the floor. Not promised: edges that cross the edge of a triangle between samples.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector2, Vector3};

use super::ground::{Facet, Walls};
use super::library::Body;

/// Rounds until a stone must be at rest.
const MOST_ROUNDS: usize = 12;
/// Share of the way to the plane of the supports that a stone turns in a round.
const DAMPING: f64 = 0.8;
/// Turn below which a stone is at rest, as a slope.
const LEAST_TURN: f64 = 0.004;
/// Steepest rest, as a slope: 24°. Tuned: beyond, one stone in five tips over or slides in Bullet.
const STEEPEST: f64 = 0.44;
/// Least distance of the centre of mass from the edge of the triangle of supports, relative to the width of the stone.
const LEAST_MARGIN: f64 = 0.015;
/// Samples of the underside along either axis, in addition to corners.
const SAMPLES: usize = 5;

/// A stone over the floor on which it is to lie.
pub(super) struct Bed<'a> {
    corners: Vec<Vector3<f64>>,
    faces: &'a [[u32; 3]],
    floor: Vec<Facet>,
    at: Point3<f64>,
    reach_m: f64,
}

impl<'a> Bed<'a> {
    /// A stone of this size over a point of the floor.
    pub fn new(body: &'a Body, scale: f64, walls: &Walls, at: Point3<f64>) -> Self {
        let corners: Vec<Vector3<f64>> = body.corners.iter().map(|corner| corner.coords * scale).collect();
        let reach_m = corners.iter().map(Vector3::norm).fold(0.0, f64::max);
        let floor = walls.floor_near(at, 1.3 * reach_m + 0.05);
        Self { corners, faces: &body.faces, floor, at, reach_m }
    }

    /// The pose of the stone, around its centre of mass, that is turned by `yaw_rad` and let down; `None` if it would not stay.
    pub fn rest(&self, yaw_rad: f64) -> Option<Isometry3<f64>> {
        let mut turn = about_z(yaw_rad);
        for _ in 0..MOST_ROUNDS {
            let supports = supports(&self.gaps(turn))?;
            let plane = supports.plane()?;
            let slope = Vector2::new(plane.x, plane.y);
            if slope.norm() < LEAST_TURN {
                let up = turn * Vector3::z();
                let is_steep = up.xy().norm() > STEEPEST * up.z;
                let is_firm = supports.margin() > LEAST_MARGIN * 2.0 * self.reach_m;
                let position = Translation3::new(self.at.x, self.at.y, plane.z);
                return (!is_steep && is_firm).then(|| Isometry3::from_parts(position, turn));
            }
            turn = tilt(slope * DAMPING) * turn;
        }
        None
    }

    /// The gaps at the corners of the underside, at the corners of the floor under it, and on a grid.
    fn gaps(&self, turn: UnitQuaternion<f64>) -> Vec<Gap> {
        let corners: Vec<Vector3<f64>> = self.corners.iter().map(|corner| turn * corner).collect();
        let faces = self.faces.iter().map(|face| face.map(|corner| corners[corner as usize]));
        let (mut under, mut places) = (Vec::new(), Vec::new());
        for [a, b, c] in faces {
            let normal = (b - a).cross(&(c - a));
            if normal.z < 0.0 {
                under.push(Vector3::new(-normal.x, -normal.y, normal.dot(&a)) / normal.z);
                places.extend([a.xy(), b.xy(), c.xy()]);
            }
        }
        let bound = |axis: usize, of: fn(f64, f64) -> f64| corners.iter().map(|c| c[axis]).reduce(of).unwrap_or(0.0);
        let (min, max) = ([0, 1].map(|axis| bound(axis, f64::min)), [0, 1].map(|axis| bound(axis, f64::max)));
        let is_inside = |p: &Vector2<f64>| (0..2).all(|i| min[i] <= p[i] && p[i] <= max[i]);
        let of_floor = self.floor.iter().flat_map(|facet| facet.corners).map(|corner| (corner - self.at).xy());
        places.extend(of_floor.filter(is_inside));
        let along = |axis: usize, n: usize| min[axis] + (max[axis] - min[axis]) * (n as f64 + 0.5) / SAMPLES as f64;
        places.extend((0..SAMPLES * SAMPLES).map(|n| Vector2::new(along(0, n % SAMPLES), along(1, n / SAMPLES))));
        // The underside of a convex body is the highest of its planes, which beside the body are higher than any of it.
        let bottom = |at: Vector2<f64>| {
            under.iter().fold(f64::NEG_INFINITY, |most, plane| most.max(plane.z + plane.x * at.x + plane.y * at.y))
        };
        let top = |at: Vector2<f64>| {
            let heights = self.floor.iter().filter_map(|facet| facet.height(self.at.x + at.x, self.at.y + at.y));
            heights.reduce(f64::max)
        };
        places.into_iter().filter_map(|place| Some(Gap { place, height: top(place)? - bottom(place) })).collect()
    }
}

/// A turn about the vertical.
pub(super) fn about_z(angle_rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(libm::cos(angle_rad / 2.0), 0.0, 0.0, libm::sin(angle_rad / 2.0)))
}

/// The turn that brings the level plane into one of this slope.
fn tilt(slope: Vector2<f64>) -> UnitQuaternion<f64> {
    let normal = Vector3::new(-slope.x, -slope.y, 1.0).normalize();
    // The half-way vector gives the quaternion without an angle.
    let half = (normal + Vector3::z()).normalize();
    let axis = Vector3::z().cross(&half);
    UnitQuaternion::new_normalize(Quaternion::new(half.z, axis.x, axis.y, axis.z))
}

/// How high the centre of mass must be so that the stone does not go below the floor, by place relative to it.
struct Gap {
    place: Vector2<f64>,
    height: f64,
}

/// Three places around the centre of mass.
struct Supports([(Vector2<f64>, f64); 3]);

/// The supports in the lowest position: the facet above the centre of the upper hull of the gaps, by the dual simplex method.
fn supports(gaps: &[Gap]) -> Option<Supports> {
    /// Far supports below everything, so that the centre is surrounded from the start.
    const FAR_M: f64 = 1e3;
    let low = gaps.iter().map(|gap| gap.height).fold(f64::INFINITY, f64::min) - FAR_M;
    let corner = |x: f64, y: f64| (Vector2::new(x * FAR_M, y * FAR_M), low);
    let mut held = Supports([corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)]);
    for _ in 0..4 * gaps.len() {
        let plane = held.plane()?;
        let excess = |gap: &Gap| gap.height - (plane.z + plane.x * gap.place.x + plane.y * gap.place.y);
        let worst = gaps.iter().max_by(|a, b| excess(a).total_cmp(&excess(b)))?;
        if excess(worst) <= 1e-9 {
            let is_real = held.0.iter().all(|(place, _)| place.norm() < FAR_M / 2.0);
            return is_real.then_some(held);
        }
        held = held.with((worst.place, worst.height))?;
    }
    None
}

impl Supports {
    /// The plane through them: slopes along x and y, and the height at the centre.
    fn plane(&self) -> Option<Vector3<f64>> {
        let [(a, ha), (b, hb), (c, hc)] = self.0;
        let (u, v) = (b - a, c - a);
        let area = u.x * v.y - u.y * v.x;
        if area == 0.0 {
            return None;
        }
        let slope_x = ((hb - ha) * v.y - (hc - ha) * u.y) / area;
        let slope_y = ((hc - ha) * u.x - (hb - ha) * v.x) / area;
        Some(Vector3::new(slope_x, slope_y, ha - slope_x * a.x - slope_y * a.y))
    }

    /// The triangle with one corner replaced that still surrounds the centre, with the largest margin.
    fn with(&self, new: (Vector2<f64>, f64)) -> Option<Self> {
        let replaced = (0..3).map(|corner| {
            let mut three = self.0;
            three[corner] = new;
            Self(three)
        });
        replaced.filter(|three| three.margin() >= 0.0).max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// Distance of the centre from the nearest side, negative outside.
    fn margin(&self) -> f64 {
        let [a, b, c] = self.0.map(|(place, _)| place);
        let area = (b - a).perp(&(c - a));
        let side = |p: Vector2<f64>, q: Vector2<f64>| (q - p).perp(&-p) * area.signum() / (q - p).norm();
        side(a, b).min(side(b, c)).min(side(c, a))
    }
}
