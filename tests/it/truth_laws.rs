//! Ground truth in the cave of every generator, in every rock: its floor is where the field changes its sign.

use crate::common::world::{kinds, small};
use plume::field::{CaveField, PassageSettings};
use plume::graph::Graph;
use plume::material::Look;
use plume::mesh::{Grid, MeshSettings, visual_chunk};
use plume_truth::{Columns, Floor, Robot, Storeys};

const CELL_M: f64 = 0.1;
/// How far from floor and ceiling the field is asked, and how far the mesh may be from it, in metres.
const BEYOND_M: f32 = 0.15;
const MESH_M: f32 = 0.06;

fn floor_of(field: &CaveField) -> Floor {
    let mesh = MeshSettings { chunk_m: [16.0; 3], ..MeshSettings::default() };
    let grid = Grid::new(field.bounds(), &mesh).unwrap();
    let mut columns = Columns::new(CELL_M);
    for chunk in grid.indices().filter_map(|index| visual_chunk(field, &grid, index, &mesh)) {
        columns.add(&chunk.positions_m(), chunk.triangles.as_flattened());
    }
    Floor::new(columns)
}

#[test]
fn ground_truth_keeps_the_laws() {
    for ((generator, rock), seed) in kinds().into_iter().zip(1..) {
        let name = format!("{} in {}, seed {seed}", generator.name, rock.name);
        let graph = small(generator, 5, seed);
        let material = (rock.read)(serde_json::json!({})).unwrap();
        let field = CaveField::new(&graph, &PassageSettings::default(), material, Look::default(), 7);
        let floor = floor_of(&field);
        assert_it_is_where_the_field_changes(&name, &floor, &field);
        assert_stations_are_over_it(&name, &floor, &graph);
        if generator.name != "layers" {
            assert_what_is_connected_is_reached(&name, &floor, &graph);
        }
    }
}

fn assert_it_is_where_the_field_changes(name: &str, floor: &Floor, field: &CaveField) {
    let tall = floor.cells().iter().filter(|gap| gap.height_m() > 2.0 * BEYOND_M).step_by(5);
    let around = |z: f32, into_air: f32| [z + into_air * BEYOND_M, z - into_air * BEYOND_M];
    let points = tall.flat_map(|gap| {
        let [x, y] = floor.centre_m(gap.cell).map(|c| c as f32);
        let [air, rock] = around(gap.floor_m, 1.0);
        let [air_above, rock_above] = around(gap.ceiling_m, -1.0);
        [[x, y, air], [x, y, rock], [x, y, air_above], [x, y, rock_above]]
    });
    let points: Vec<[f32; 3]> = points.collect();
    let values = field.scattered(&points);
    let wrong =
        values.as_chunks::<4>().0.iter().filter(|[air, rock, air_above, rock_above]| {
            air.max(*air_above) > MESH_M || rock.min(*rock_above) < -MESH_M
        });
    let (wrong, all) = (wrong.count(), values.len() / 4);
    assert!(all > 100 && wrong * 100 <= all, "{name}: {wrong} of {all} cells are not between rock and air");
}

fn assert_stations_are_over_it(name: &str, floor: &Floor, graph: &Graph) {
    for node in &graph.nodes {
        let at = node.position;
        let gaps = floor.over(floor.cell_at([at.x, at.y])).map(|number| floor.cells()[number]);
        let holds = |gap: plume_truth::Gap| f64::from(gap.floor_m) < at.z && at.z < f64::from(gap.ceiling_m);
        assert!(gaps.into_iter().any(holds), "{name}: there is no floor below the station at {at}");
    }
}

/// A robot that gets over everything reaches all stations that passages connect with the start.
fn assert_what_is_connected_is_reached(name: &str, floor: &Floor, graph: &Graph) {
    const ANT: Robot = Robot { height_m: 0.2, step_m: 3.0, slope_rad: 1.5 };
    let stations: Vec<[f64; 3]> = graph.nodes.iter().map(|node| node.position.into()).collect();
    let under = |[x, y, z]: [f64; 3]| floor.nearest(floor.cell_at([x, y]), z as f32);
    let first = under(stations[0]).map(|number| f64::from(floor.cells()[number].floor_m)).unwrap();
    let storeys = Storeys::reached(floor, &ANT, &[[stations[0][0], stations[0][1], first]]);
    let reached = stations.iter().filter(|station| under(**station).is_some_and(|n| storeys.of[n].is_some())).count();
    assert_eq!(reached, stations.len(), "{name}");
}
