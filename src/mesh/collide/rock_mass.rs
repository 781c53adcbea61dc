//! Which side of the wall a point is on, how far from it, and whether a triangle stays in the rock but for a tolerance.
//!
//! The side is told by the normal of the nearest part of the wall: of a triangle, of an edge (sum of both sides), or of a
//! corner (weighted by angle), which is right wherever the wall is closed (Bærentzen and Aanæs, *Signed distance
//! computation using the angle weighted pseudonormal*, 2005).

use nalgebra::Vector3;
use rustc_hash::FxHashMap;

use super::super::measure::weld;
use super::super::nearest::{Ball, Feature, Found, Point, Triangle, closest, halves, squared_distance};
use super::super::{Mesh, QUANTA_PER_M};
use super::cells::Cells;
use super::{PieceSettings, Zone};
use plume_graph::Aabb;

/// Parts of a triangle are not cut any further below this length, in quanta: what is that close to the tolerance is out.
const FINEST: f64 = 2.0;

/// The rock around a chunk, in quanta from an origin.
pub(super) struct RockMass {
    origin: [i32; 3],
    /// Of the walls of the chunk and of those around it, as far as pieces may reach.
    triangles: Vec<[u32; 3]>,
    zones: Vec<Zone>,
    nearest: Cells,
    corner_normals: Vec<Point>,
    edge_normals: FxHashMap<[u32; 2], Point>,
    /// How far pieces reach into it.
    pub(super) thickness: f64,
    /// No wall that is left out lies nearer to a point of a piece.
    horizon: f64,
    /// The least of the triangles around each vertex.
    corner_tolerances: Vec<f64>,
    /// Into the open, by zone.
    tolerances: [f64; 3],
    least_tolerance: f64,
}

impl RockMass {
    /// Around the wall of a chunk, whose triangles come first.
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

    /// The least tolerance of the triangles around the corners of one, in quanta.
    pub(super) fn corner_tolerances(&self, triangle: usize) -> [f64; 3] {
        self.triangles[triangle].map(|corner| self.corner_tolerances[corner as usize])
    }

    /// Distance to the wall in quanta, above 0 in the open, and the zone of the wall there.
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

    /// Whether a point is no further from something steeper than a floor than the tolerance there.
    pub(super) fn is_by_steeper(&self, point: Point) -> bool {
        let is_steep_and_near = |&index: &u32| {
            let zone = self.zones[index as usize];
            let tolerance = self.tolerances[zone as usize];
            zone != Zone::Floor && self.nearest.squared_distance(point, index) <= tolerance * tolerance
        };
        self.nearest.near(point).iter().any(is_steep_and_near)
    }

    /// How far a point is in the open, as a share of the tolerance there, below 0 in the rock; nothing beyond the
    /// tolerance.
    pub(super) fn share(&self, point: Point) -> Option<f64> {
        let (distance, zone) = self.distance(point);
        let share = distance / self.tolerances[zone as usize];
        (share <= 1.0).then_some(share)
    }

    /// Whether every point of a triangle is in the rock, or no further from some triangle of the wall than the tolerance
    /// of its zone.
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
        // What is in the rock comes into the open where some zone begins.
        let slack =
            if distance > 0.0 { tolerance - distance } else { self.least_tolerance + self.horizon.min(-distance) };
        if radius <= slack {
            return Verdict::Held;
        }
        // The distance to one triangle is convex: greatest at a corner.
        let limit = tolerance * tolerance;
        if corners.iter().all(|&corner| squared_distance(corner, found.triangle) <= limit) {
            return Verdict::Held;
        }
        if radius < FINEST { Verdict::Out } else { Verdict::Open }
    }
}

/// Of a part of a triangle.
enum Verdict {
    /// It stays within the tolerance.
    Held,
    /// It does not.
    Out,
    /// Its halves will tell.
    Open,
}

/// Most points that are asked for lie no further from the wall, in metres, unless a tolerance is larger. Tuned.
const REACH_M: f64 = 0.1;
/// Walls are taken into account up to this many thicknesses from the box in which the pieces of a chunk lie. Tuned.
const HORIZON: f64 = 1.5;

/// The triangles of some walls that reach into a box.
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
