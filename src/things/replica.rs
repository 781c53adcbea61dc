//! A model of the user as a thing: welded to a closed surface, found fit to be one, and painted by its own colours.
//!
//! Promised: a surface that is closed and manifold and faces outwards, on the origin, or an error. Its texels have the colour,
//! the roughness and the normal of the model where it is nearest.

use nalgebra::{Point3, Vector3};
use plume_graph::Aabb;
use plume_graph::echo::plain;
use rustc_hash::FxHashMap;

use crate::field::Texel;
use crate::mesh::measure::Report;
use crate::mesh::{Found, Mesh, Nearest, QUANTA_PER_M, closest};
use crate::model::{Corner, Material, Model, ModelError, Triangle};

/// Longest side of a model in metres: as long as what is built in.
const LONGEST_M: f64 = 2.0;
/// Least length of its shortest side in metres. Tuned: twenty quanta, so that its hull is a body.
const THINNEST_M: f64 = 0.005;
const CLOSE: &str = "a thing is a closed surface: fill its holes and merge its vertices, for example with Make Manifold of \
                     Blender's 3D Print Toolbox, and leave out what is inside";
const NORMALS: &str = "let its faces point outwards, for example with Recalculate Outside in Blender";
const SCALE: &str = "lengths are metres, of which at most 2 m and at least 5 mm are possible: set `scale`";

/// A model fit to be a thing.
#[derive(Debug)]
pub struct Replica {
    /// Around the middle of its underside.
    mesh: Mesh,
    /// The triangles of the mesh as they are in the model.
    triangles: Vec<Triangle>,
    materials: Vec<Material>,
    nearest: Nearest,
}

impl Replica {
    /// A model in this scale.
    ///
    /// # Errors
    /// If it is no closed surface, or is too large or too thin.
    pub fn new(model: Model, scale: f64) -> Result<Self, ModelError> {
        let Model { triangles, materials } = standing(model, scale)?;
        let (mesh, kept) = welded(&triangles);
        refuse_unfit(&Report::of(&mesh))?;
        let surface: Vec<_> =
            mesh.triangles.iter().map(|triangle| triangle.map(|vertex| position_m(&mesh, vertex))).collect();
        let triangles = kept.into_iter().map(|n| triangles[n]).collect();
        Ok(Self { nearest: Nearest::new(&surface), mesh, triangles, materials })
    }

    /// Its surface in its own frame.
    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The surface nearest to points in its own frame.
    pub(super) fn paint(&self, points: &[[f32; 3]], texel_m: f32, out: &mut [Texel]) {
        for (out, point) in out.iter_mut().zip(points) {
            *out = self.texel(Vector3::from(point.map(f64::from)), texel_m);
        }
    }

    fn texel(&self, point: Vector3<f64>, texel_m: f32) -> Texel {
        let Found { triangle, index, .. } = self.nearest.nearest(point);
        let own = &self.triangles[index as usize];
        let shares = shares(triangle, closest(point, triangle).0);
        let mixed = |of: &dyn Fn(&Corner) -> f32| {
            own.corners.iter().zip(shares).map(|(corner, share)| of(corner) * share as f32).sum::<f32>()
        };
        let Material { color, roughness, texture } = &self.materials[own.material];
        let image = texture.as_ref().map_or([1.0; 3], |texture| {
            let uv = [0, 1].map(|axis| mixed(&|corner| corner.uv[axis]));
            texture.image.color(uv, texture.wrap, texel_m * uv_per_m(own, triangle))
        });
        let channel = |n: usize| (color[n] * image[n] * mixed(&|corner| corner.color[n])).clamp(0.0, 1.0);
        Texel {
            color: [0, 1, 2].map(channel),
            normal: normal(own, triangle, shares).map(|c| c as f32).into(),
            roughness: roughness.clamp(0.0, 1.0),
            occlusion: 1.0,
            height_m: 0.0,
        }
    }
}

/// The model in this scale, with the middle of its underside at the origin.
fn standing(mut model: Model, scale: f64) -> Result<Model, ModelError> {
    let corners = || model.triangles.iter().flat_map(|triangle| triangle.corners);
    let places = corners().map(|corner| <[f64; 3]>::from(corner.at * scale));
    if places.clone().flatten().any(|c| !c.is_finite()) {
        return Err(ModelError::new("has corners that are nowhere", "export it again"));
    }
    let bounds = Aabb::from_points(places).ok_or_else(|| ModelError::new("has no triangles", CLOSE))?;
    let size = bounds.size();
    let [longest_m, thinnest_m] = [size.into_iter().fold(0.0, f64::max), size.into_iter().fold(f64::MAX, f64::min)];
    if longest_m > LONGEST_M {
        let longest = plain(&format!("{longest_m:.3}"));
        return Err(ModelError::new(format!("is {longest} m long, and more than {LONGEST_M} m is too large"), SCALE));
    }
    if thinnest_m < THINNEST_M {
        return Err(ModelError::new(format!("is only {:.3} mm thick", 1000.0 * thinnest_m), SCALE));
    }
    let [x, y, _] = bounds.center();
    let foot = Vector3::new(x, y, bounds.min[2]);
    for corner in model.triangles.iter_mut().flat_map(|triangle| &mut triangle.corners) {
        corner.at = corner.at * scale - foot;
    }
    Ok(model)
}

/// The mesh of triangles, with those that it keeps: corners in one place are one, and a triangle with two of them vanishes.
fn welded(triangles: &[Triangle]) -> (Mesh, Vec<usize>) {
    let (mut mesh, mut kept) = (Mesh::default(), Vec::new());
    let mut known: FxHashMap<[i32; 3], u32> = FxHashMap::default();
    for (n, triangle) in triangles.iter().enumerate() {
        let places = triangle.corners.map(|corner| quanta(corner.at));
        let [a, b, c] = places;
        if a == b || b == c || c == a {
            continue;
        }
        mesh.triangles.push(places.map(|place| {
            *known.entry(place).or_insert_with(|| {
                mesh.positions.push(place);
                mesh.positions.len() as u32 - 1
            })
        }));
        kept.push(n);
    }
    mesh.border = vec![false; mesh.positions.len()];
    mesh.normals = normals(&mesh);
    (mesh, kept)
}

fn quanta(at: Point3<f64>) -> [i32; 3] {
    at.coords.map(|c| (c * f64::from(QUANTA_PER_M)).round() as i32).into()
}

/// Means of the normals of the triangles around each vertex, weighted by their angles there: edges of a box lean evenly to all
/// of its sides, however those are cut into triangles.
fn normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![Vector3::zeros(); mesh.positions.len()];
    for triangle in &mesh.triangles {
        let corners = triangle.map(|vertex| position_m(mesh, vertex));
        let facing = facing(corners);
        for (n, vertex) in triangle.iter().enumerate() {
            let [at, next, last] = [0, 1, 2].map(|step| corners[(n + step) % 3]);
            let cosine = (next - at).normalize().dot(&(last - at).normalize());
            sums[*vertex as usize] += facing * libm::acos(cosine.clamp(-1.0, 1.0));
        }
    }
    sums.into_iter().map(|sum| sum.try_normalize(1e-9).unwrap_or(Vector3::z()).map(|c| c as f32).into()).collect()
}

fn refuse_unfit(report: &Report) -> Result<(), ModelError> {
    let Report { open_edges, nonmanifold_edges, nonmanifold_vertices, inconsistent_winding, .. } = *report;
    let faults = [
        (open_edges, "is not closed: edges of one triangle only", CLOSE),
        (nonmanifold_edges, "is not a surface: edges of more than two triangles", CLOSE),
        (nonmanifold_vertices, "has parts that only touch: corners in which they do", CLOSE),
        (inconsistent_winding, "has faces that face opposite sides: edges between them", NORMALS),
        (report.degenerate_triangles, "has triangles without area", CLOSE),
    ];
    if let Some((count, what, hint)) = faults.into_iter().find(|(count, ..)| *count > 0) {
        return Err(ModelError::new(format!("{what} ({count})"), hint));
    }
    // A report takes the outside of a surface for its air.
    if report.volume_m3 >= 0.0 {
        return Err(ModelError::new("is inside out", NORMALS));
    }
    Ok(())
}

fn position_m(mesh: &Mesh, vertex: u32) -> Vector3<f64> {
    Vector3::from(mesh.positions[vertex as usize].map(|q| f64::from(q) / f64::from(QUANTA_PER_M)))
}

/// The unit normal of a triangle; nothing if it has no area.
fn facing([a, b, c]: [Vector3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
}

/// The shares of the corners of a triangle in a point of it.
fn shares([a, b, c]: [Vector3<f64>; 3], point: Vector3<f64>) -> [f64; 3] {
    let whole = (b - a).cross(&(c - a));
    let share = |p: Vector3<f64>, q: Vector3<f64>| (p - point).cross(&(q - point)).dot(&whole) / whole.norm_squared();
    let [of_a, of_b] = [share(b, c), share(c, a)];
    [of_a, of_b, 1.0 - of_a - of_b]
}

/// The normal of the model in a point of a triangle.
fn normal(own: &Triangle, triangle: [Vector3<f64>; 3], shares: [f64; 3]) -> Vector3<f64> {
    let facing = facing(triangle);
    let corners = own.corners.iter().zip(shares);
    let sum: Vector3<f64> = corners.map(|(corner, share)| corner.normal.unwrap_or(facing) * share).sum();
    // One that faces away is of no use to a map.
    sum.try_normalize(1e-9).filter(|normal| normal.dot(&facing) > 0.0).unwrap_or(facing)
}

/// How far texture coordinates go per metre of a triangle.
fn uv_per_m(own: &Triangle, [a, b, c]: [Vector3<f64>; 3]) -> f32 {
    let [p, q, r] = own.corners.map(|corner| corner.uv);
    let doubled = ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).abs();
    let area = (b - a).cross(&(c - a)).norm() as f32;
    (doubled / area).sqrt()
}
