//! The laws of a mesh, run on real caves: every generator in every rock.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use common::{assert_lawful, chunks, triangle_set, visuals};
use plume::field::{CaveField, PassageSettings};
use plume::graph::{GENERATORS, GeneratorRow, Graph};
use plume::material::{Look, MATERIALS, MaterialRow};
use plume::mesh::MeshSettings;
use serde_json::json;

fn graph(row: &GeneratorRow, nodes: u32, seed: u64) -> Graph {
    let generator = (row.read)(json!({ "nodes": nodes })).unwrap();
    generator.generate(seed).unwrap()
}

fn field(graph: &Graph, row: &MaterialRow, seed: u64) -> CaveField {
    let material = (row.read)(json!({})).unwrap();
    CaveField::new(graph, &PassageSettings::default(), material, Look::default(), seed)
}

/// Every triangle of the wall: no simplification.
fn whole(voxel_m: f32, chunk_m: f32) -> MeshSettings {
    let settings = MeshSettings::default();
    MeshSettings { voxel_m, chunk_m: [chunk_m; 3], simplify_error_m: 0.0, collision_error_m: 0.0, ..settings }
}

#[test]
fn every_generator_in_every_rock_is_lawful() {
    for (generator, material) in GENERATORS.iter().flat_map(|g| MATERIALS.iter().map(move |m| (g, m))) {
        for (seed, voxel_m, chunk_m) in [(1, 0.2, 16.0), (2, 0.25, 8.0), (3, 0.3, 32.0)] {
            let field = field(&graph(generator, 10, seed), material, seed);
            let settings = MeshSettings { voxel_m, chunk_m: [chunk_m; 3], ..MeshSettings::default() };
            let made = chunks(&field, field.bounds(), &settings);
            let report = assert_lawful(&visuals(&made));
            assert_eq!(report.components, 1, "{} in {}, seed {seed}", generator.name, material.name);
            assert_lawful(&common::collisions(&made));
        }
    }
}

#[test]
fn chunk_size_changes_no_triangle() {
    for material in MATERIALS {
        let field = field(&graph(&GENERATORS[0], 8, 5), material, 5);
        let [small, middle, large] =
            [8.0, 16.0, 32.0].map(|chunk_m| chunks(&field, field.bounds(), &whole(0.25, chunk_m)));
        let triangles = triangle_set(&visuals(&small));
        assert!(!triangles.is_empty());
        assert!(triangles == triangle_set(&visuals(&middle)), "8 and 16 m differ in {}", material.name);
        assert!(triangles == triangle_set(&visuals(&large)), "8 and 32 m differ in {}", material.name);
    }
}
