//! MikkTSpace tangents (Mikkelsen 2008), the common standard of renderers for normal maps.

use std::collections::BTreeMap;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};

use super::unwrap::Unwrapped;
use crate::mesh::Mesh;
use rustc_hash::FxHashMap;

/// Tangents of all vertices: unit vectors along growing u, with the sign of the bitangent
/// `w * cross(normal, tangent)` as the fourth component. Vertices whose corners disagree are split in `cut`.
pub fn tangents(mesh: &Mesh, cut: &mut Unwrapped) -> Vec<[f32; 4]> {
    let mut corners = Corners { mesh, cut, tangents: vec![[[0.0; 4]; 3]; cut.triangles.len()] };
    generate_tangents(&mut corners).expect("the error type has no value");
    let mut per_corner = corners.tangents;
    agree_in_fans(&cut.triangles, &mut per_corner);
    split(cut, &per_corner)
}

/// Gives the corners of a vertex one tangent if their triangles share edges and have the same sign: MikkTSpace rarely
/// separates such triangles, and then a vertex would be stored twice without need.
fn agree_in_fans(triangles: &[[u32; 3]], per_corner: &mut [[[f32; 4]; 3]]) {
    let mut first: FxHashMap<u32, [f32; 4]> = FxHashMap::default();
    let mut mixed: BTreeMap<u32, Vec<[usize; 2]>> = BTreeMap::new();
    for (triangle, tangents) in triangles.iter().zip(&*per_corner) {
        for (vertex, tangent) in triangle.iter().zip(tangents) {
            if first.entry(*vertex).or_insert(*tangent) != tangent {
                mixed.insert(*vertex, vec![]);
            }
        }
    }
    for (number, triangle) in triangles.iter().enumerate() {
        for (corner, vertex) in triangle.iter().enumerate() {
            if let Some(corners) = mixed.get_mut(vertex) {
                corners.push([number, corner]);
            }
        }
    }
    for (vertex, mut rest) in mixed {
        while let Some([number, corner]) = rest.pop() {
            let tangent = per_corner[number][corner];
            let mut fan = vec![number];
            while let Some(at) = rest.iter().position(|[other, corner]| {
                let shares_edge = |known: &usize| share_edge(triangles[*known], triangles[*other], vertex);
                per_corner[*other][*corner][3] == tangent[3] && fan.iter().any(shares_edge)
            }) {
                let [other, corner] = rest.swap_remove(at);
                per_corner[other][corner] = tangent;
                fan.push(other);
            }
        }
    }
}

/// Whether two triangles at a vertex have another one in common.
fn share_edge(one: [u32; 3], other: [u32; 3], vertex: u32) -> bool {
    one.iter().any(|corner| *corner != vertex && other.contains(corner))
}

/// One tangent per vertex; a vertex with several is split.
fn split(cut: &mut Unwrapped, per_corner: &[[[f32; 4]; 3]]) -> Vec<[f32; 4]> {
    const NONE: u32 = u32::MAX;
    let mut tangents: Vec<Option<[f32; 4]>> = vec![None; cut.source.len()];
    // The next copy of each vertex, as a linked list.
    let mut next = vec![NONE; cut.source.len()];
    for (triangle, corner_tangents) in cut.triangles.iter_mut().zip(per_corner) {
        for (corner, &wanted) in triangle.iter_mut().zip(corner_tangents) {
            loop {
                let at = *corner as usize;
                if *tangents[at].get_or_insert(wanted) == wanted {
                    break;
                }
                if next[at] == NONE {
                    next[at] = tangents.len() as u32;
                    next.push(NONE);
                    tangents.push(None);
                    cut.source.push(cut.source[at]);
                    cut.uvs.push(cut.uvs[at]);
                }
                *corner = next[at];
            }
        }
    }
    tangents.into_iter().map(|tangent| tangent.expect("every vertex has a corner")).collect()
}

struct Corners<'a> {
    mesh: &'a Mesh,
    cut: &'a Unwrapped,
    tangents: Vec<[[f32; 4]; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.cut.triangles[face][corner] as usize
    }

    fn normal_at(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.cut.source[self.vertex(face, corner)] as usize]
    }
}

impl Geometry<Portable> for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.cut.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.position_m(self.cut.source[self.vertex(face, corner)])
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normal_at(face, corner)
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.cut.uvs[self.vertex(face, corner)]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let computed = space.map(|space| space.tangent_encoded()).filter(is_unit);
        self.tangents[face][corner] = computed.unwrap_or_else(|| any_tangent(self.normal_at(face, corner)));
    }
}

/// The same square roots and angles on every platform.
struct Portable;

impl Ops for Portable {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

fn is_unit(tangent: &[f32; 4]) -> bool {
    let [x, y, z, _] = *tangent;
    (x * x + y * y + z * z - 1.0).abs() < 1e-3
}

/// For a corner without a u direction (its triangle has no area in the atlas): any unit vector perpendicular to the
/// normal.
fn any_tangent(normal: [f32; 3]) -> [f32; 4] {
    let [x, y, z] = normal;
    let across = if x.abs() < 0.7 { [0.0, z, -y] } else { [-z, 0.0, x] };
    let length = (across[0] * across[0] + across[1] * across[1] + across[2] * across[2]).sqrt();
    if length > 0.0 { [across[0] / length, across[1] / length, across[2] / length, 1.0] } else { [1.0, 0.0, 0.0, 1.0] }
}
