//! The laws of a mesh, run on real caves: every generator in every rock.

use crate::common;
use crate::common::world;
use crate::common::{assert_lawful, chunks, triangle_set, visuals};
use nalgebra::Point3;
use plume::field::{CaveField, PassageSettings};
use plume::generators::GENERATORS;
use plume::graph::{Graph, Node, StationId};
use plume::material::{Look, MATERIALS, MaterialRow};
use plume::mesh::MeshSettings;
use serde_json::json;
use world::small;

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
fn every_generator_in_every_rock_keeps_the_laws() {
    // By turns, so that every generator has each of them in some rock.
    let sizes = [(1, 0.2, 16.0), (2, 0.25, 8.0), (3, 0.3, 32.0)];
    let pairs = GENERATORS.iter().flat_map(|g| MATERIALS.iter().map(move |m| (g, m)));
    for ((generator, material), (seed, voxel_m, chunk_m)) in pairs.zip(sizes.into_iter().cycle()) {
        let field = field(&small(generator, 10, seed), material, seed);
        let settings = MeshSettings { voxel_m, chunk_m: [chunk_m; 3], ..MeshSettings::default() };
        let made = chunks(&field, field.bounds(), &settings);
        let report = assert_lawful(&visuals(&made));
        assert_eq!(report.components, 1, "{} in {}, seed {seed}", generator.name, material.name);
        assert_lawful(&common::collisions(&made));
    }
}

#[test]
fn chunk_size_changes_no_triangle() {
    for material in MATERIALS.iter() {
        let field = field(&small(GENERATORS.default_row(), 8, 5), material, 5);
        let [small, middle, large] =
            [8.0, 16.0, 32.0].map(|chunk_m| chunks(&field, field.bounds(), &whole(0.25, chunk_m)));
        let triangles = triangle_set(&visuals(&small));
        assert!(!triangles.is_empty());
        assert!(triangles == triangle_set(&visuals(&middle)), "8 and 16 m differ in {}", material.name);
        assert!(triangles == triangle_set(&visuals(&large)), "8 and 32 m differ in {}", material.name);
    }
}

/// Two parallel passages `8 m` apart, `rungs` cross-passages between them.
fn ladder(rungs: usize) -> Graph {
    let node = |id: usize| Node {
        id: id as u64,
        parent: id.checked_sub(if id.is_multiple_of(2) { 2 } else { 1 }).map(StationId::new),
        position: Point3::new((id / 2) as f64 * 9.0, (id % 2) as f64 * 8.0, 0.0),
        radius: 5.0,
        active: false,
        level: 0,
        section: None,
        name: None,
    };
    let rungs_between = (0..rungs).map(|i| [2 * i, 2 * i + 1]);
    let rails = (0..rungs - 1).flat_map(|i| [[2 * i, 2 * i + 2], [2 * i + 1, 2 * i + 3]]);
    Graph::new((0..2 * rungs).map(node).collect(), StationId::pairs(rungs_between.chain(rails)))
}

#[test]
fn ladders_have_as_many_handles_as_their_graph_has_loops() {
    for (material, rungs) in MATERIALS.iter().flat_map(|m| [2, 5, 10].map(|rungs| (m, rungs))) {
        let graph = ladder(rungs);
        assert_eq!(graph.loops(), rungs - 1);
        let mild = (material.read)(json!({"relief": 0.3})).unwrap();
        let field = CaveField::new(&graph, &PassageSettings::default(), mild, Look::default(), 3);
        for voxel_m in [0.2, 0.3] {
            let report = assert_lawful(&visuals(&chunks(&field, field.bounds(), &whole(voxel_m, 16.0))));
            assert_eq!(report.genus, graph.loops() as i64, "{} with {rungs} rungs", material.name);
        }
    }
}
