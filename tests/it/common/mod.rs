//! The invariants of every chunked mesh, and fields to check them on.

pub mod damage;
pub mod distance;
pub mod dump;
pub mod fields;
pub mod files;
pub mod segment;
pub mod world;

use plume::field::{Aabb, Field};
use plume::mesh::measure::{Report, Seams, weld};
use plume::mesh::{ChunkMeshes, Grid, Mesh, MeshSettings, chunk};

/// Every chunk of a cave, one after the other.
pub fn chunks(field: &dyn Field, bounds: Aabb<f32>, settings: &MeshSettings) -> Vec<ChunkMeshes> {
    let grid = Grid::new(bounds, settings).expect("the bounds suit");
    grid.indices().filter_map(|index| chunk(field, &grid, index, settings)).collect()
}

/// The visual meshes of `chunks`.
pub fn visuals(chunks: &[ChunkMeshes]) -> Vec<&Mesh> {
    chunks.iter().map(|chunk| &chunk.visual).collect()
}

/// The collision meshes of `chunks`.
pub fn collisions(chunks: &[ChunkMeshes]) -> Vec<&Mesh> {
    chunks.iter().map(|chunk| &chunk.collision).collect()
}

/// Asserts the invariants of all chunks of a cave; returns the measures of the welded mesh.
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
    assert!(mesh.triangles.iter().flatten().all(|&corner| (corner as usize) < vertices));
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
