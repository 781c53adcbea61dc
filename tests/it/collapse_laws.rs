//! The laws of roof falls and muck piles.

use crate::common::{assert_lawful, chunks, visuals, world};
use nalgebra::Point3;
use plume::field::{CaveField, Field, Heap, PassageSettings};
use plume::generators::GENERATORS;
use plume::graph::{Graph, Node, Section, Shape, StationId};
use plume::material::{Look, MATERIALS};
use plume::mesh::MeshSettings;
use serde_json::json;

/// A cave of the first rock with little relief, in which the roof fell as often as this.
fn cave(graph: &Graph, collapse: f32, seed: u64) -> CaveField {
    let rock = (MATERIALS.default_row().read)(json!({"relief": 0.3})).expect("a setting of the first rock");
    CaveField::new(graph, &PassageSettings { collapse, ..PassageSettings::default() }, rock, Look::default(), seed)
}

/// A straight, wide passage of 100 m.
fn gallery(section: Option<Section>) -> Graph {
    let node = |id: u64| Node {
        id,
        parent: id.checked_sub(1).map(|parent| StationId::new(parent as usize)),
        position: Point3::new(id as f64 * 5.0, 0.0, 0.0),
        radius: 5.0,
        active: false,
        level: 0,
        section,
        name: None,
    };
    Graph::new((0..21).map(node).collect(), StationId::pairs((0..20).map(|n| [n, n + 1])))
}

/// Height of the rock above a point in the open, or below it for a negative step.
fn rock_z(field: &CaveField, at: [f32; 3], step_m: f32) -> f32 {
    let heights = (0..200).map(|n| at[2] + n as f32 * step_m);
    heights.into_iter().find(|z| field.distances_at(&[[at[0], at[1], *z]])[0] > 0.0).expect("rock within 4 m")
}

#[test]
fn a_roof_fall_raises_floor_and_ceiling() {
    let graph = gallery(None);
    let (bare, fallen) = (cave(&graph, 0.0, 7), cave(&graph, 2.0, 7));
    assert!(bare.heaps().is_empty());
    assert!(fallen.heaps().len() > 4, "{:?}", fallen.heaps());
    for Heap { at: [x, y, floor_z], .. } in fallen.heaps() {
        let risen_m = rock_z(&fallen, [*x, *y, 0.2], -0.02) - floor_z;
        assert!(risen_m > 0.25, "the floor at {x}, {y} rises by {risen_m} m");
        let [before, after] = [&bare, &fallen].map(|field| rock_z(field, [*x, 0.2 * y, 0.2], 0.02));
        assert!(after > before + 0.2, "the ceiling at {x} rises from {before} to {after} m");
    }
}

#[test]
fn drifts_have_muck_at_their_faces_alone() {
    let drift = Section { width_m: 4.0, height_m: 3.5, shape: Shape::Drift };
    let field = cave(&gallery(Some(drift)), 1.0, 7);
    let places: Vec<f32> = field.heaps().iter().map(|heap| heap.at[0]).collect();
    assert!(matches!(places[..], [first, last] if first < 0.0 && last > 100.0), "{places:?}");
    let measured = Section { width_m: 4.0, height_m: 3.5, shape: Shape::Cave };
    assert!(cave(&gallery(Some(measured)), 2.0, 7).heaps().is_empty());
}

#[test]
fn stations_stay_in_the_open_and_passages_apart() {
    for (generator, rock) in world::kinds() {
        for seed in 1..4 {
            let graph = world::small(generator, 20, seed);
            let stations: Vec<[f32; 3]> =
                graph.nodes.iter().map(|node| node.position.coords.map(|c| c as f32).into()).collect();
            let settings = PassageSettings { collapse: 2.0, ..PassageSettings::default() };
            let material = (rock.read)(json!({})).expect("an empty object is valid");
            let field = CaveField::new(&graph, &settings, material, Look::default(), seed);
            let buried = field.scattered(&stations).into_iter().filter(|depth_m| *depth_m > 0.0).count();
            assert_eq!(buried, 0, "{} in {}, seed {seed}", generator.name, rock.name);
        }
    }
    for generator in GENERATORS.iter() {
        let graph = world::small(generator, 12, 2);
        let settings = MeshSettings { voxel_m: 0.25, ..MeshSettings::default() };
        let genus = |collapse: f32| {
            let field = cave(&graph, collapse, 2);
            assert_lawful(&visuals(&chunks(&field, field.bounds(), &settings))).genus
        };
        assert_eq!(genus(0.0), genus(2.0), "{}", generator.name);
    }
}
