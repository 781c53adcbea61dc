//! A cave with its things as one field and one surface, for pictures without meshes of things.
//!
//! Promised: the surface of a thing is that of its prototype but for the finest roughness, which only its normals have; that of
//! a solid is its convex hull. Not promised: distances in the air beyond [`BEYOND_M`] from every thing, which are cut there.

use nalgebra::{UnitQuaternion, Vector3};
use rustc_hash::FxHashMap;

use super::shelf::Shelf;
use super::{Library, Prototype, Thing};
use crate::field::{Aabb, CaveField, Field, Region, Surface, Texel};

/// Distance from every thing up to which it is looked for, in metres.
const BEYOND_M: f32 = 1.0;
/// Side of the cubes by which things are found, in metres.
const CUBE_M: f32 = 0.5;

/// A cave with its things.
pub struct Dressed<'a> {
    cave: &'a CaveField,
    shelf: &'a Shelf,
    things: Vec<Placed>,
    /// The things within [`BEYOND_M`] of each cube. Never iterated.
    near: FxHashMap<[i32; 3], Vec<u32>>,
}

/// A thing as a map from the cave to the shelf.
struct Placed {
    at: Vector3<f32>,
    shelf_from_cave: UnitQuaternion<f32>,
    scale: f32,
    /// Its origin on the shelf.
    origin: Vector3<f32>,
    /// The ball around `at` that it is in.
    reach_m: f32,
    /// The planes of the hull of a solid, which has no field; empty for all else.
    planes: Vec<Plane>,
}

/// A plane on the shelf.
struct Plane {
    normal: Vector3<f32>,
    point: Vector3<f32>,
}

impl Placed {
    fn on_shelf(&self, point: [f32; 3]) -> [f32; 3] {
        (self.origin + self.shelf_from_cave * (Vector3::from(point) - self.at) / self.scale).into()
    }

    /// Its depth below the surface at a point, and the plane to which it is least; of a solid.
    fn least_depth(&self, on_shelf: [f32; 3]) -> Option<(f32, &Plane)> {
        let depth = |plane: &Plane| plane.normal.dot(&(plane.point - Vector3::from(on_shelf)));
        self.planes.iter().map(|plane| (depth(plane), plane)).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Upper bound of the depth of a point in it, negative outside.
    fn most_depth_m(&self, point: [f32; 3]) -> f32 {
        self.reach_m - (Vector3::from(point) - self.at).norm()
    }
}

impl<'a> Dressed<'a> {
    /// These things in a cave.
    pub fn new(cave: &'a CaveField, shelf: &'a Shelf, library: &Library, things: &[Thing]) -> Self {
        let placed = things.iter().filter_map(|thing| {
            let prototype = library.named(&thing.prototype)?;
            let reach_m = prototype.hull.corners.iter().map(|corner| corner.coords.norm()).fold(0.0, f64::max);
            Some(Placed {
                planes: if prototype.row.is_solid() { planes(prototype) } else { Vec::new() },
                at: thing.pose.translation.vector.cast(),
                shelf_from_cave: thing.pose.rotation.inverse().cast(),
                scale: thing.scale as f32,
                origin: prototype.origin.coords.cast(),
                reach_m: (reach_m * thing.scale) as f32,
            })
        });
        let mut dressed = Self { cave, shelf, things: placed.collect(), near: FxHashMap::default() };
        for (number, thing) in (0..).zip(&dressed.things) {
            let around = Aabb::from(<[f32; 3]>::from(thing.at)).padded(thing.reach_m + BEYOND_M);
            let [low, high] = [cube(around.min), cube(around.max)];
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        dressed.near.entry([x, y, z]).or_default().push(number);
                    }
                }
            }
        }
        dressed
    }

    /// The depth of a point in things, negative outside, and the thing that is nearest, if any is near.
    fn thing_at(&self, point: [f32; 3]) -> (f32, Option<&Placed>) {
        let mut best = (-BEYOND_M, None);
        for number in self.near.get(&cube(point)).into_iter().flatten() {
            let thing = &self.things[*number as usize];
            if thing.most_depth_m(point) <= best.0 {
                continue;
            }
            let on_shelf = thing.on_shelf(point);
            let of_solid = thing.least_depth(on_shelf).map(|(depth_m, _)| depth_m);
            let depth_m = match of_solid.or_else(|| self.shelf.shape_at(thing.origin.into(), on_shelf)) {
                Some(depth_m) => depth_m * thing.scale,
                None => thing.most_depth_m(point),
            };
            if depth_m > best.0 {
                best = (depth_m, Some(thing));
            }
        }
        best
    }

    /// The points of a group on the shelf. Those of distant stones may be short of its cube, beside which is the next shape.
    fn surface_of(&self, thing: &Placed, group: &[usize], points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let at = |&n: &usize| self.shelf.surface_at(thing.origin.into(), thing.on_shelf(points[n]));
        group.iter().map(at).collect()
    }

    fn normals_of(&self, thing: &Placed, on_shelf: &[[f32; 3]]) -> Vec<[f32; 3]> {
        if thing.planes.is_empty() {
            return self.shelf.normals_at(on_shelf);
        }
        let of_face = |&point: &[f32; 3]| thing.least_depth(point).map_or([0.0; 3], |(_, plane)| plane.normal.into());
        on_shelf.iter().map(of_face).collect()
    }

    /// The things that are nearer than the wall at points, each with its points.
    fn before_the_wall(&self, points: &[[f32; 3]]) -> Vec<(&Placed, Vec<usize>)> {
        let walls = self.cave.distances_at(points);
        let mut groups: Vec<(&Placed, Vec<usize>)> = Vec::new();
        for (n, wall_m) in walls.into_iter().enumerate() {
            let (depth_m, Some(thing)) = self.thing_at(points[n]) else { continue };
            if depth_m <= wall_m {
                continue;
            }
            match groups.iter_mut().find(|(other, _)| std::ptr::eq(*other, thing)) {
                Some((_, group)) => group.push(n),
                None => groups.push((thing, vec![n])),
            }
        }
        groups
    }
}

impl Field for Dressed<'_> {
    fn region(&self, bounds: Aabb<f32>) -> Region {
        match self.cave.region(bounds) {
            Region::Air if !self.things.is_empty() => Region::Mixed,
            region => region,
        }
    }

    fn distances(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [f32]) {
        self.cave.distances(bounds, points, out);
        if self.things.is_empty() {
            return;
        }
        for (out, &point) in out.iter_mut().zip(points) {
            // In rock, things do not matter.
            if *out < 0.0 {
                *out = out.max(self.thing_at(point).0);
            }
        }
    }

    fn normals(&self, bounds: Aabb<f32>, points: &[[f32; 3]], out: &mut [[f32; 3]]) {
        self.cave.normals(bounds, points, out);
        for (thing, group) in self.before_the_wall(points) {
            let on_shelf = self.surface_of(thing, &group, points);
            for (n, normal) in group.into_iter().zip(self.normals_of(thing, &on_shelf)) {
                out[n] = turned(thing, normal);
            }
        }
    }
}

impl Surface for Dressed<'_> {
    fn texels(&self, bounds: Aabb<f32>, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]) {
        self.cave.texels(bounds, texel_m, points, normals, out);
        for (thing, group) in self.before_the_wall(points) {
            let on_shelf = self.surface_of(thing, &group, points);
            let upright = |&n: &usize| (thing.shelf_from_cave * Vector3::from(normals[n])).into();
            let upright: Vec<[f32; 3]> = group.iter().map(upright).collect();
            let mut texels = vec![Texel::default(); group.len()];
            let around = Aabb::from_points(on_shelf.iter().copied()).expect("a group has points");
            self.shelf.texels(around, texel_m / thing.scale, &on_shelf, &upright, &mut texels);
            for (n, texel) in group.into_iter().zip(texels) {
                out[n] = Texel { normal: turned(thing, texel.normal), ..texel };
            }
        }
    }
}

fn planes(prototype: &Prototype) -> Vec<Plane> {
    let corner = |corner: u32| (prototype.hull.corners[corner as usize] + prototype.origin.coords).coords.cast();
    let plane = |face: &[u32; 3]| {
        let [a, b, c]: [Vector3<f32>; 3] = face.map(corner);
        Some(Plane { normal: (b - a).cross(&(c - a)).try_normalize(0.0)?, point: a })
    };
    prototype.hull.faces.iter().filter_map(plane).collect()
}

/// A direction on the shelf as one in the cave.
fn turned(thing: &Placed, direction: [f32; 3]) -> [f32; 3] {
    thing.shelf_from_cave.inverse_transform_vector(&Vector3::from(direction)).into()
}

fn cube(point: [f32; 3]) -> [i32; 3] {
    point.map(|c| (c / CUBE_M).floor() as i32)
}
