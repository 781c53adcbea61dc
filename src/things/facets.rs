//! Triangles of walls or of stones, for rays.

use nalgebra::{Isometry3, Point3, Vector3};
use rustc_hash::FxHashMap;

use super::library::Body;
use crate::mesh::Mesh;
use plume_graph::Aabb;

/// Side of the columns by which triangles are found, in metres.
const COLUMN_M: f64 = 0.25;

/// Triangles, sorted by where they are on the map.
#[derive(Default)]
pub struct Facets {
    all: Vec<Facet>,
    /// The triangles over each column. Never iterated.
    columns: FxHashMap<[i32; 2], Vec<u32>>,
}

/// A triangle.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    /// Its corners in metres.
    pub corners: [Point3<f64>; 3],
    /// Unit normal, into the air.
    pub normal: Vector3<f64>,
}

/// Where a vertical ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Height in metres.
    pub z: f64,
    /// Unit normal there, into the air.
    pub normal: Vector3<f64>,
}

impl Facets {
    /// The triangles of these walls that are in `bounds`, or partly.
    pub fn of_walls<'a>(walls: impl Iterator<Item = &'a Mesh>, bounds: Aabb<f64>) -> Self {
        let mut all = Self::default();
        for wall in walls {
            for triangle in &wall.triangles {
                let corners = triangle.map(|vertex| Point3::from(wall.position_m(vertex).map(f64::from)));
                let around = Aabb::from_points(corners.map(<[f64; 3]>::from)).expect("there are three");
                if around.intersects(&bounds) {
                    all.push(corners, &around);
                }
            }
        }
        all
    }

    /// Adds a body of this size in this pose.
    pub fn add(&mut self, body: &Body, scale: f64, pose: &Isometry3<f64>) {
        for face in &body.faces {
            let corners = face.map(|corner| pose * (body.corners[corner as usize] * scale));
            let around = Aabb::from_points(corners.map(<[f64; 3]>::from)).expect("there are three");
            self.push(corners, &around);
        }
    }

    fn push(&mut self, corners: [Point3<f64>; 3], around: &Aabb<f64>) {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else { return };
        let number = self.all.len() as u32;
        self.all.push(Facet { corners, normal });
        let [low, high] = [column(around.min), column(around.max)];
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                self.columns.entry([x, y]).or_default().push(number);
            }
        }
    }

    /// All triangles straight above and below a point of the map, from below.
    pub fn hits(&self, x: f64, y: f64) -> Vec<Hit> {
        let near = self.columns.get(&column([x, y, 0.0])).map_or(&[][..], Vec::as_slice);
        let hit = |number: &u32| {
            let facet = &self.all[*number as usize];
            facet.height(x, y).map(|z| Hit { z, normal: facet.normal })
        };
        let mut hits: Vec<Hit> = near.iter().filter_map(hit).collect();
        hits.sort_by(|a, b| a.z.total_cmp(&b.z));
        // On an edge there are two.
        hits.dedup_by(|a, b| a.z - b.z < 1e-6 && a.normal.z * b.normal.z > 0.0);
        hits
    }

    /// Height of the highest floor below a point.
    pub fn floor_below(&self, at: Point3<f64>) -> Option<f64> {
        self.hits(at.x, at.y).into_iter().rev().find(|hit| hit.z < at.z && hit.normal.z > 0.0).map(|hit| hit.z)
    }

    /// Distance along a level direction to the first triangle, if it is within `reach_m`.
    pub fn ray(&self, from: Point3<f64>, way: Vector3<f64>, reach_m: f64) -> Option<f64> {
        let along = Aabb::from_points([from, from + way * reach_m].map(<[f64; 3]>::from)).expect("there are two");
        let near = self.in_columns(&along).into_iter().filter_map(|facet| facet.distance_m(from, way));
        near.filter(|distance| *distance < reach_m).reduce(f64::min)
    }

    /// The triangles in the columns of a box, each once.
    fn in_columns(&self, around: &Aabb<f64>) -> Vec<Facet> {
        let [low, high] = [column(around.min), column(around.max)];
        let mut near: Vec<u32> = (low[0]..=high[0])
            .flat_map(|x| (low[1]..=high[1]).map(move |y| [x, y]))
            .filter_map(|column| self.columns.get(&column))
            .flatten()
            .copied()
            .collect();
        near.sort_unstable();
        near.dedup();
        near.into_iter().map(|number| self.all[number as usize]).collect()
    }

    /// The triangles that face upwards and are within `reach_m` of a point along x and y, somewhat more below it, and
    /// `above_m` above it.
    pub fn floor_near(&self, at: Point3<f64>, reach_m: f64, above_m: f64) -> Vec<Facet> {
        let down = Vector3::new(reach_m, reach_m, beyond_m(reach_m));
        let up = Vector3::new(reach_m, reach_m, above_m);
        let around = Aabb { min: (at - down).into(), max: (at + up).into() };
        let touches = |facet: &Facet| {
            let own = Aabb::from_points(facet.corners.map(<[f64; 3]>::from)).expect("there are three");
            facet.normal.z > 0.0 && own.intersects(&around)
        };
        self.in_columns(&around).into_iter().filter(touches).collect()
    }
}

impl Facet {
    /// Distance along a direction at which it is met, not from behind (Möller and Trumbore 1997).
    fn distance_m(&self, from: Point3<f64>, way: Vector3<f64>) -> Option<f64> {
        let [a, b, c] = self.corners;
        let (ab, ac) = (b - a, c - a);
        let across = way.cross(&ac);
        let volume = ab.dot(&across);
        if volume <= 0.0 {
            return None;
        }
        let to = from - a;
        let u = to.dot(&across) / volume;
        let turned = to.cross(&ab);
        let v = way.dot(&turned) / volume;
        let distance = ac.dot(&turned) / volume;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0).then_some(distance)
    }

    /// Its height at a point of the map, if it is above or below it.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let [a, b, c] = self.corners;
        let beside = |axis: usize, at: f64| {
            let [a, b, c] = [a[axis], b[axis], c[axis]];
            at < a.min(b).min(c) || at > a.max(b).max(c)
        };
        if beside(0, x) || beside(1, y) {
            return None;
        }
        let side = |p: Point3<f64>, q: Point3<f64>| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
        let (ab, bc, ca) = (side(a, b), side(b, c), side(c, a));
        let is_inside = (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
        let area = ab + bc + ca;
        (is_inside && area != 0.0).then(|| (a.z * bc + b.z * ca + c.z * ab) / area)
    }
}

/// How far above and below a stone of this reach a floor can be on which it lies, in metres.
pub fn beyond_m(reach_m: f64) -> f64 {
    1.3 * reach_m + 0.05
}

fn column([x, y, _]: [f64; 3]) -> [i32; 2] {
    [x, y].map(|c| (c / COLUMN_M).floor() as i32)
}
