//! What every chunked mesh obeys, and fields to try it on.
#![allow(dead_code, reason = "each test binary uses a part")]

pub mod distance;
pub mod fields;

use plume::field::{Bounds, Field};
use plume::mesh::measure::{Report, Seams, weld};
use plume::mesh::{ChunkMeshes, Grid, Mesh, MeshSettings, chunk};

/// Every chunk of a cave, one after the other.
pub fn chunks(field: &dyn Field, bounds: Bounds, settings: &MeshSettings) -> Vec<ChunkMeshes> {
    let grid = Grid::new(bounds, settings).expect("the bounds suit");
    grid.indices()
        .filter_map(|index| chunk(field, &grid, index, settings))
        .collect()
}

/// The visual meshes of `chunks`.
pub fn visuals(chunks: &[ChunkMeshes]) -> Vec<&Mesh> {
    chunks.iter().map(|chunk| &chunk.visual).collect()
}

/// The collision meshes of `chunks`.
pub fn collisions(chunks: &[ChunkMeshes]) -> Vec<&Mesh> {
    chunks.iter().map(|chunk| &chunk.collision).collect()
}

/// Asserts what is promised of the chunks of one cave together; returns the measures of the welded mesh.
pub fn assert_lawful(meshes: &[&Mesh]) -> Report {
    for mesh in meshes {
        assert_whole(mesh);
    }
    let seams = Seams::of(meshes.iter().copied());
    assert!(seams.is_clean(), "{seams:#?}");
    let report = Report::of(&weld(meshes.iter().copied()));
    assert!(report.is_clean(), "{report:#?}");
    assert_eq!(report.angles_under_1deg, 0, "{report:#?}");
    assert!(report.volume_m3 > 0.0, "air is inside: {report:#?}");
    report
}

/// Asserts that arrays fit, indices hold and normals are unit vectors.
pub fn assert_whole(mesh: &Mesh) {
    let vertices = mesh.positions.len();
    assert_eq!(mesh.border.len(), vertices);
    assert!(mesh.normals.is_empty() || mesh.normals.len() == vertices);
    assert!(
        mesh.triangles
            .iter()
            .flatten()
            .all(|&corner| (corner as usize) < vertices)
    );
    for normal in &mesh.normals {
        let length = normal.map(|c| c * c).iter().sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{normal:?}");
    }
}

/// The corners of every triangle, each with the bits of its position and normal, in an order of their own: equal for
/// equal sets of triangles, however they are numbered and spread over chunks.
pub fn triangle_set(meshes: &[&Mesh]) -> Vec<[([i32; 3], [u32; 3]); 3]> {
    let mut set = Vec::new();
    for mesh in meshes {
        let corner = |vertex: u32| {
            let normal = mesh.normals[vertex as usize].map(f32::to_bits);
            (mesh.positions[vertex as usize], normal)
        };
        for triangle in &mesh.triangles {
            let mut corners = triangle.map(corner);
            let lowest = (0..3).min_by_key(|&k| corners[k]).expect("three");
            corners.rotate_left(lowest);
            set.push(corners);
        }
    }
    set.sort_unstable();
    set
}

/// The value of the field at a point.
pub fn value(field: &dyn Field, at: [f32; 3]) -> f32 {
    let mut out = [0.0];
    field.distances(Bounds { min: at, max: at }, &[at], &mut out);
    out[0]
}

/// How far the wall lies from the middle of each triangle and from each vertex, along the normal, at most `reach_m`:
/// the greatest such distance. It looks at the sign of the field alone, so the field need not be a distance.
pub fn greatest_distance_m(field: &dyn Field, mesh: &Mesh, reach_m: f32) -> f32 {
    let mut greatest = 0.0f32;
    for triangle in &mesh.triangles {
        let corners = triangle.map(|corner| mesh.position_m(corner));
        let normal = unit_normal(corners);
        let middle = std::array::from_fn(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        for point in [middle, corners[0]] {
            greatest = greatest.max(distance_along(field, point, normal, reach_m));
        }
    }
    greatest
}

fn unit_normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let n = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let length = n.map(|c| c * c).iter().sum::<f32>().sqrt();
    n.map(|c| c / length)
}

fn distance_along(field: &dyn Field, point: [f32; 3], normal: [f32; 3], reach_m: f32) -> f32 {
    const STEPS: i32 = 64;
    let here = value(field, point) < 0.0;
    let differs = |step: i32| {
        let along = step as f32 * reach_m / STEPS as f32;
        [along, -along].iter().any(|&along| {
            let there = std::array::from_fn(|i| point[i] + normal[i] * along);
            (value(field, there) < 0.0) != here
        })
    };
    (1..=STEPS).find(|&step| differs(step)).unwrap_or(STEPS) as f32 * reach_m / STEPS as f32
}
