//! The triangles of a scene, and what rays meet among them.
//!
//! A hierarchy of boxes (crate `obvhs`: built by PLOC, Meister and Bittner 2018, walked eight boxes at a time, Ylitie, Karras and
//! Laine 2017) finds candidates in single precision, with boxes a little larger than what they hold. Triangles are met in double
//! precision by the watertight test of Woop, Benthin and Wald (2013), so no ray slips through an edge. Of triangles at the same
//! distance the first counts. Rays of neighbouring pixels are followed together ([`World::hits`], [`World::shaded`]).

use glam::Vec3A;
use nalgebra::{Point3, Vector3};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use obvhs::{Boundable, BvhBuildParams};
use plume_exporters::ExportError;
use plume_exporters::labels::Labels;
use plume_exporters::scene::{Chunk, Content, Light, Material, Mesh, Scene};
use serde::Serialize;

use self::triangle::{Shear, Triangle};

mod bundle;
mod triangle;

/// The number of rock and gravel, which are no things.
pub const NO_THING: u32 = 0;

/// The surfaces around a path.
#[derive(Default)]
pub struct World {
    boxes: CwBvh,
    /// The corners of the faces in the order of the boxes, which read them one after the other.
    triangles: Vec<Triangle>,
    /// Corners of the faces, in metres; a face has three.
    faces: Vec<[u32; 3]>,
    corners: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    tangents: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    /// What each face is.
    kinds: Vec<Kind>,
    /// Materials by the numbers in the kinds.
    pub materials: Vec<Material>,
    /// The lamps of the scene.
    pub lamps: Vec<Light>,
    /// Downward acceleration in m/s².
    pub gravity: f64,
    /// Names of the labels.
    pub labels: Vec<Label>,
    /// The things, by their numbers from 1 on.
    pub things: Vec<Thing>,
}

/// What a face is.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Number of its material.
    pub material: u32,
    /// Number of its thing, or [`NO_THING`].
    pub thing: u32,
    /// Its label.
    pub label: u8,
}

/// A label and its name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Label {
    /// The value of a pixel.
    pub label: u8,
    /// The class.
    pub class: String,
}

/// A thing that can be seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thing {
    /// The value of a pixel.
    pub number: u32,
    /// Its identity in `instances.json` of packages.
    pub id: u64,
    /// What it is.
    pub class: String,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the ray, in lengths of its direction.
    pub distance: f64,
    /// The face.
    pub face: u32,
    /// Weights of its second and third corner.
    pub weights: [f64; 2],
}

impl Hit {
    /// Whether it comes before another one on its ray: of those at the same distance, the first face does.
    fn precedes(&self, other: Option<Self>) -> bool {
        other.is_none_or(|other| (self.distance, self.face) < (other.distance, other.face))
    }
}

/// What all points of a face have in common, and what differs at its corners.
pub struct Facet {
    /// Its number.
    pub face: u32,
    /// What it is.
    pub kind: Kind,
    /// Unit normal, against rays that see it from the front.
    pub flat_normal: Vector3<f64>,
    /// Change of the texture coordinates per metre of surface, at the most.
    pub uv_per_m: f32,
    normals: [Vector3<f32>; 3],
    tangents: [Vector3<f32>; 3],
    handedness: f32,
    uvs: [[f32; 2]; 3],
}

/// A surface where a ray has met it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Unit normal between those of its corners.
    pub normal: Vector3<f32>,
    /// Unit tangent along the first texture coordinate, and the handedness.
    pub tangent: (Vector3<f32>, f32),
    /// Texture coordinates from the lower left.
    pub uv: [f32; 2],
}

impl Facet {
    /// The surface at these weights of the second and third corner.
    #[inline(always)]
    pub fn at(&self, weights: [f64; 2]) -> Surface {
        let [b, c] = weights.map(|weight| weight as f32);
        let a = 1.0 - b - c;
        let between = |of: &[Vector3<f32>; 3]| of[0] * a + of[1] * b + of[2] * c;
        let along = |axis: usize| self.uvs[0][axis] * a + self.uvs[1][axis] * b + self.uvs[2][axis] * c;
        Surface {
            normal: unit(between(&self.normals)),
            tangent: (unit(between(&self.tangents)), self.handedness),
            uv: [along(0), along(1)],
        }
    }
}

impl World {
    /// The surfaces of a scene within `reach_m` of any of these points.
    ///
    /// # Errors
    /// If the scene cannot be read.
    pub fn load(scene: &Scene, around: &[Point3<f64>], reach_m: f64) -> Result<Self, ExportError> {
        let labels = Labels::of(scene)?;
        let names = labels.names().into_iter();
        let mut world = Self {
            lamps: scene.lights.clone(),
            gravity: scene.gravity,
            labels: names.map(|(label, class)| Label { label, class: class.to_owned() }).collect(),
            ..Self::default()
        };
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            if is_near(&chunk.visual, around, reach_m) {
                world.add(scene, index, &chunk, &labels)?;
            }
        }
        world.build();
        Ok(world)
    }

    fn add(&mut self, scene: &Scene, index: usize, chunk: &Chunk, labels: &Labels) -> Result<(), ExportError> {
        let (_, of_faces) = labels.of_chunk(scene, index, chunk)?;
        let material = self.material(&chunk.material);
        let first = self.corners.len() as u32;
        let mesh = &chunk.visual;
        self.corners.extend(&mesh.positions);
        self.normals.extend(&mesh.normals);
        self.tangents.extend(&mesh.tangents);
        self.uvs.extend(&mesh.uvs);
        self.faces.extend(mesh.indices.as_chunks::<3>().0.iter().map(|face| face.map(|corner| corner + first)));
        let mut numbers = vec![NO_THING; of_faces.len()];
        if matches!(chunk.content, Content::Things { .. }) {
            numbers.clear();
            let counts = labels.triangles_of_things(scene, index)?;
            for (thing, count) in scene.instances(index)?.into_iter().zip(counts) {
                let number = self.things.len() as u32 + 1;
                numbers.resize(numbers.len() + count, number);
                self.things.push(Thing { number, id: thing.id, class: thing.class });
            }
        }
        let kinds = of_faces.into_iter().zip(numbers).map(|(label, thing)| Kind { material, thing, label });
        self.kinds.extend(kinds);
        Ok(())
    }

    /// The number of a material.
    fn material(&mut self, material: &Material) -> u32 {
        let known = self.materials.iter().position(|known| known.name == material.name);
        known.unwrap_or_else(|| {
            self.materials.push(material.clone());
            self.materials.len() - 1
        }) as u32
    }

    fn build(&mut self) {
        let bounds: Vec<Bounds> = (0..self.faces.len() as u32).map(|face| Bounds::of(self.corners_of(face))).collect();
        if !bounds.is_empty() {
            self.boxes = build_cwbvh(&bounds, BvhBuildParams::slow_build(), &mut std::time::Duration::default());
            self.triangles = self.boxes.primitive_indices.iter().map(|face| self.corners_of(*face)).collect();
        }
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    /// What a face is.
    pub fn kind(&self, face: u32) -> Kind {
        self.kinds[face as usize]
    }

    /// The nearest surface on a ray, closer than `most` lengths of its direction.
    pub fn hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>, most: f64) -> Option<Hit> {
        let shear = Shear::along(direction);
        let mut best: Option<Hit> = None;
        let meet = |_: &Ray, place: usize| {
            let face = self.boxes.primitive_indices[place];
            let met = shear.meet(origin, &self.triangles[place]).filter(|(distance, _)| *distance <= most);
            let is_best = |distance: f64| best.is_none_or(|best| (distance, face) < (best.distance, best.face));
            let Some((distance, weights)) = met.filter(|(distance, _)| is_best(*distance)) else {
                return f32::INFINITY;
            };
            best = Some(Hit { distance, face, weights });
            slack(distance)
        };
        self.boxes.ray_traverse(ray(origin, direction, most), &mut RayHit::none(), meet);
        best
    }

    /// A face, from which the surface follows at each of its points.
    pub fn facet(&self, face: u32) -> Facet {
        let corners = self.faces[face as usize].map(|corner| corner as usize);
        let tangents = corners.map(|corner| self.tangents[corner]);
        let uvs = corners.map(|corner| self.uvs[corner]);
        let triangle = self.triangle(face);
        Facet {
            face,
            kind: self.kinds[face as usize],
            flat_normal: flat_normal(triangle),
            normals: corners.map(|corner| Vector3::from(self.normals[corner])),
            tangents: tangents.map(|[x, y, z, _]| Vector3::new(x, y, z)),
            handedness: tangents[0][3],
            uvs,
            uv_per_m: uv_per_m(triangle, uvs),
        }
    }

    fn corners_of(&self, face: u32) -> Triangle {
        let [a, b, c] = self.faces[face as usize];
        [self.corners[a as usize], self.corners[b as usize], self.corners[c as usize]]
    }

    fn triangle(&self, face: u32) -> [Vector3<f64>; 3] {
        self.corners_of(face).map(|corner| Vector3::from(corner.map(f64::from)))
    }
}

/// A vector of length 1, or 0 if it has no direction.
fn unit(vector: Vector3<f32>) -> Vector3<f32> {
    let length = vector.norm();
    if length > 0.0 { vector / length } else { vector }
}

fn flat_normal([a, b, c]: [Vector3<f64>; 3]) -> Vector3<f64> {
    let across = (b - a).cross(&(c - a));
    let length = across.norm();
    if length > 0.0 { across / length } else { Vector3::z() }
}

/// The root of the ratio of areas: charts are stretched little.
fn uv_per_m([a, b, c]: [Vector3<f64>; 3], uvs: [[f32; 2]; 3]) -> f32 {
    let area = (b - a).cross(&(c - a)).norm() as f32;
    let [p, q] = [1, 2].map(|k| [0, 1].map(|axis| uvs[k][axis] - uvs[0][axis]));
    let of_uv = (p[0] * q[1] - p[1] * q[0]).abs();
    if area > 0.0 { (of_uv / area).sqrt() } else { 0.0 }
}

fn is_near(mesh: &Mesh, around: &[Point3<f64>], reach_m: f64) -> bool {
    let [low, high] = mesh.bounds().map(|corner| corner.map(f64::from));
    around.iter().any(|point| {
        let gaps = [0, 1, 2].map(|axis| (low[axis] - point[axis]).max(point[axis] - high[axis]).max(0.0));
        Vector3::from(gaps).norm() <= reach_m
    })
}

/// The box around a triangle, a little larger, so that it holds whatever single precision makes of a ray.
struct Bounds(Aabb);

impl Bounds {
    fn of(corners: [[f32; 3]; 3]) -> Self {
        let exact = Aabb::from_points(&corners.map(Vec3A::from));
        let largest = exact.min.abs().max(exact.max.abs()).max_element();
        let margin = Vec3A::splat(1e-4 + 4e-6 * largest);
        Self(Aabb::new(exact.min - margin, exact.max + margin))
    }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

fn ray(origin: &Point3<f64>, direction: &Vector3<f64>, most: f64) -> Ray {
    Ray::new(single(&origin.coords), single(direction), 0.0, slack(most))
}

fn single(of: &Vector3<f64>) -> Vec3A {
    Vec3A::new(of.x as f32, of.y as f32, of.z as f32)
}

/// A distance in single precision that is surely not shorter.
fn slack(distance: f64) -> f32 {
    distance as f32 * 1.000_01 + 1e-5
}
