//! Signed distance to the wall, and whether a triangle stays in the rock within a tolerance.
//!
//! The sign follows from the normal of the nearest part of the wall: of a triangle, of an edge (sum of both sides), or of a
//! vertex (weighted by angle), which is correct wherever the wall is closed (Bærentzen and Aanæs, *Signed distance computation
//! using the angle weighted pseudonormal*, 2005).

use nalgebra::Vector3;
use rustc_hash::FxHashMap;

use super::super::measure::weld;
use super::super::nearest::{Ball, Feature, Found, Point, Triangle, closest, halves, squared_distance};
use super::super::{Mesh, QUANTA_PER_M};
use super::cells::Cells;
use super::{PieceSettings, Zone};
use plume_graph::Aabb;

/// Parts of a triangle shorter than this, in quanta, are not subdivided: that close to the tolerance they are rejected.
const FINEST: f64 = 2.0;

/// The rock around a chunk, in quanta from an origin.
pub(super) struct RockMass {
    origin: [i32; 3],
    /// The walls of the chunk and of its neighbours, within the reach of pieces.
    triangles: Vec<[u32; 3]>,
    zones: Vec<Zone>,
    nearest: Cells,
    corner_normals: Vec<Point>,
    edge_normals: FxHashMap<[u32; 2], Point>,
    /// Thickness of pieces.
    pub(super) thickness: f64,
    /// Lower bound of the distance of omitted walls to points of pieces.
    horizon: f64,
    /// The minimum of the tolerances around each vertex.
    corner_tolerances: Vec<f64>,
    /// Tolerances by zone.
    tolerances: [f64; 3],
    least_tolerance: f64,
}

impl RockMass {
    /// The rock around the wall of a chunk, whose triangles come first.
    pub(super) fn new(wall: &Mesh, around: &[Mesh], settings: &PieceSettings) -> Self {
        let quanta = f64::from(QUANTA_PER_M);
        let origin = wall.positions[0];
        let thickness = f64::from(settings.thickness_m) * quanta;
        let near = near(around, &bounds(wall).padded((thickness + HORIZON * thickness).ceil() as i64));
        let Mesh { positions, triangles, .. } = weld(std::iter::once(wall).chain(&near));
        let positions: Vec<Point> = positions.into_iter().map(|position| at(origin, position)).collect();
        let surface: Vec<Triangle> = triangles.iter().map(|t| t.map(|corner| positions[corner as usize])).collect();
        let zones: Vec<Zone> = surface.iter().map(|triangle| Zone::of(&normal(triangle))).collect();
        let tolerances = Zone::ALL.map(|zone| f64::from(settings.tolerance_m(zone)) * quanta);
        let (corner_normals, edge_normals) = pseudonormals(positions.len(), &triangles, &surface);
        let mut corner_tolerances = vec![f64::INFINITY; positions.len()];
        for (names, zone) in triangles.iter().zip(&zones) {
            for &name in names {
                let least = &mut corner_tolerances[name as usize];
                *least = least.min(tolerances[*zone as usize]);
            }
        }
        Self {
            origin,
            corner_tolerances,
            nearest: Cells::new(surface, tolerances.into_iter().fold(REACH_M * quanta, f64::max)),
            triangles,
            zones,
            corner_normals,
            edge_normals,
            thickness,
            horizon: HORIZON * thickness,
            tolerances,
            least_tolerance: tolerances.into_iter().fold(f64::INFINITY, f64::min),
        }
    }

    /// A position in quanta from the origin.
    pub(super) fn at(&self, position: [i32; 3]) -> Point {
        at(self.origin, position)
    }

    /// The zone of a triangle of the wall.
    pub(super) fn zone(&self, triangle: usize) -> Zone {
        self.zones[triangle]
    }

    /// The minimum tolerance of the triangles around the corners of one, in quanta.
    pub(super) fn corner_tolerances(&self, triangle: usize) -> [f64; 3] {
        self.triangles[triangle].map(|corner| self.corner_tolerances[corner as usize])
    }

    /// Signed distance to the wall in quanta, positive in air, and the zone of the wall there.
    pub(super) fn distance(&self, point: Point) -> (f64, Zone) {
        let found = self.nearest.nearest(point);
        (self.signed(point, &found), self.zones[found.index as usize])
    }

    fn signed(&self, point: Point, found: &Found) -> f64 {
        let (foot, part) = closest(point, found.triangle);
        let corners = self.triangles[found.index as usize];
        let normal = match part {
            Feature::Inside => normal(&found.triangle),
            Feature::Corner(place) => self.corner_normals[corners[place] as usize],
            Feature::Edge(place) => {
                let [a, b] = [corners[place], corners[(place + 1) % 3]];
                self.edge_normals[&[a.min(b), a.max(b)]]
            }
        };
        let distance = found.squared.sqrt();
        if normal.dot(&(point - foot)) > 0.0 { distance } else { -distance }
    }

    /// Whether a point is within the tolerance of a zone steeper than a floor.
    pub(super) fn is_by_steeper(&self, point: Point) -> bool {
        let is_steep_and_near = |index: u32| {
            let zone = self.zones[index as usize];
            let tolerance = self.tolerances[zone as usize];
            zone != Zone::Floor && self.nearest.squared_distance(point, index) <= tolerance * tolerance
        };
        self.nearest.near(point).any(is_steep_and_near)
    }

    /// How far a point is in the air, relative to the tolerance there, negative in rock; `None` beyond the tolerance.
    pub(super) fn share(&self, point: Point) -> Option<f64> {
        let (distance, zone) = self.distance(point);
        let share = distance / self.tolerances[zone as usize];
        (share <= 1.0).then_some(share)
    }

    /// Whether every point of a triangle is in the rock, or within the tolerance of the zone of some triangle of the wall.
    pub(super) fn holds(&self, corners: Triangle) -> bool {
        let mut parts = vec![corners];
        while let Some(part) = parts.pop() {
            match self.judge(part) {
                Verdict::Held => {}
                Verdict::Out => return false,
                Verdict::Open => parts.extend(halves(part)),
            }
        }
        true
    }

    fn judge(&self, corners: Triangle) -> Verdict {
        let Ball { centre, radius } = Ball::around(&corners);
        let found = self.nearest.nearest(centre);
        let tolerance = self.tolerances[self.zones[found.index as usize] as usize];
        let distance = self.signed(centre, &found);
        if distance > tolerance {
            return Verdict::Out;
        }
        // What is in the rock enters the air through some zone.
        let slack =
            if distance > 0.0 { tolerance - distance } else { self.least_tolerance + self.horizon.min(-distance) };
        if radius <= slack {
            return Verdict::Held;
        }
        // The distance to a triangle is convex, so its maximum is at a corner.
        let limit = tolerance * tolerance;
        if corners.iter().all(|&corner| squared_distance(corner, found.triangle) <= limit) {
            return Verdict::Held;
        }
        if radius < FINEST { Verdict::Out } else { Verdict::Open }
    }
}

/// The verdict on a part of a triangle.
enum Verdict {
    /// It stays within the tolerance.
    Held,
    /// It exceeds the tolerance.
    Out,
    /// It must be subdivided.
    Open,
}

/// Most queried points are within this distance of the wall, in metres, unless a tolerance is larger. Tuned.
const REACH_M: f64 = 0.1;
/// Walls are considered up to this many thicknesses from the box of the pieces of a chunk. Tuned.
const HORIZON: f64 = 1.5;

/// The triangles of some walls that overlap a box.
fn near(walls: &[Mesh], bounds: &Aabb<i64>) -> Vec<Mesh> {
    let reaches_in = |wall: &Mesh, triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|corner| wall.positions[corner as usize].map(i64::from));
        Aabb::from(a).including(b).including(c).intersects(bounds)
    };
    let part = |wall: &Mesh| {
        let triangles = wall.triangles.iter().copied().filter(|&triangle| reaches_in(wall, triangle)).collect();
        Mesh { triangles, ..wall.clone() }
    };
    walls.iter().map(part).collect()
}

/// The box of a wall, in numbers that have room for more than any file can say.
fn bounds(wall: &Mesh) -> Aabb<i64> {
    Aabb::from_points(wall.positions.iter().map(|position| position.map(i64::from))).expect("a wall has vertices")
}

fn at(origin: [i32; 3], position: [i32; 3]) -> Point {
    Vector3::from_fn(|i, _| f64::from(position[i]) - f64::from(origin[i]))
}

fn normal([a, b, c]: &Triangle) -> Point {
    (b - a).cross(&(c - a))
}

type EdgeNormals = FxHashMap<[u32; 2], Point>;

fn pseudonormals(vertices: usize, triangles: &[[u32; 3]], surface: &[Triangle]) -> (Vec<Point>, EdgeNormals) {
    let mut of_corners = vec![Vector3::zeros(); vertices];
    let mut of_edges = EdgeNormals::default();
    for (names, triangle) in triangles.iter().zip(surface) {
        let Some(normal) = normal(triangle).try_normalize(0.0) else { continue };
        for place in 0..3 {
            let [at, next, last] = [0, 1, 2].map(|step| triangle[(place + step) % 3]);
            let (to_next, to_last) = (next - at, last - at);
            let angle = libm::atan2(to_next.cross(&to_last).norm(), to_next.dot(&to_last));
            of_corners[names[place] as usize] += normal * angle;
            let [a, b] = [names[place], names[(place + 1) % 3]];
            *of_edges.entry([a.min(b), a.max(b)]).or_insert_with(Vector3::zeros) += normal;
        }
    }
    (of_corners, of_edges)
}
