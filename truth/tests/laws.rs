//! The laws of columns, floors, storeys and maps, on worlds made of boxes.

mod world;

use plume_truth::{Columns, Gap, Inside, OccupancyMap, Robot, State, Storeys};
use proptest::prelude::*;

use self::world::World;

const ROBOT: Robot = Robot { height_m: 0.5, step_m: 0.1, slope_rad: 0.5 };

fn gaps(world: &World, cell_m: f64) -> Vec<Gap> {
    let mut columns = Columns::new(cell_m);
    columns.add(&world.corners, &world.indices);
    columns.into_gaps()
}

#[test]
fn centres_on_edges_and_corners_are_hit_once() {
    // All corners, and the diagonals of all squares, are on centres of cells.
    let room = World::room([0.5, 0.5], [4.5, 4.5], -1.0, 1.0);
    let gaps = gaps(&room, 1.0);
    assert_eq!(gaps.len(), 4 * 4);
    assert!(gaps.iter().all(|gap| (gap.floor_m, gap.ceiling_m) == (-1.0, 1.0)));
}

#[test]
fn bodies_may_overlap_each_other_and_the_wall() {
    let world = World::room([0.0, 0.0], [2.0, 2.0], 0.0, 3.0)
        .with([[0.5, 0.5], [1.5, 1.5]], [-0.5; 4], [0.5; 4], false)
        .with([[0.5, 0.5], [1.5, 1.5]], [0.3; 4], [1.0; 4], false)
        .with([[0.5, 0.5], [1.5, 1.5]], [2.5; 4], [3.5; 4], false);
    let gaps = gaps(&world, 0.5);
    let middle: Vec<&Gap> = gaps.iter().filter(|gap| gap.cell == [1, 1]).collect();
    assert_eq!(middle.iter().map(|gap| [gap.floor_m, gap.ceiling_m]).collect::<Vec<_>>(), [[1.0, 2.5]]);
    assert_eq!(gaps.len(), 16);
}

#[test]
fn a_ramp_has_its_slope_and_steps() {
    // One in four.
    let world = World::default().with([[0.0, 0.0], [4.0, 2.0]], [0.0, 1.0, 1.0, 0.0], [3.0; 4], true);
    let floor = world.floor(0.1);
    for relief in floor.reliefs() {
        assert!((relief.slope_rad - 0.25_f32.atan()).abs() < 1e-4, "{relief:?}");
        assert!(relief.roughness_m < 1e-4 && (relief.step_m - 0.025).abs() < 1e-4, "{relief:?}");
    }
}

#[test]
fn a_robot_stays_off_what_is_too_high_too_low_or_too_steep() {
    let room = || World::room([0.0, 0.0], [6.0, 1.0], 0.0, 1.0);
    let wall = |bottom: f32, top: f32| room().with([[2.0, -1.0], [3.0, 2.0]], [bottom; 4], [top; 4], false);
    let ramp = |rise: f32| {
        let top = [0.0, rise, rise, 0.0];
        room().with([[2.0, -1.0], [3.0, 2.0]], [-1.0; 4], top, false).with(
            [[3.0, -1.0], [7.0, 2.0]],
            [-1.0; 4],
            [rise; 4],
            false,
        )
    };
    let crosses = |world: World| {
        let floor = world.floor(0.1);
        let storeys = Storeys::reached(&floor, &ROBOT, &[[0.5, 0.5, 0.0]]);
        let far = floor.over(floor.cell_at([5.5, 0.5])).next().unwrap();
        storeys.of[far].is_some()
    };
    assert!(crosses(room()));
    assert!(crosses(wall(-1.0, 0.09)) && !crosses(wall(-1.0, 0.11)), "steps");
    assert!(crosses(wall(0.51, 2.0)) && !crosses(wall(0.49, 2.0)), "headroom");
    assert!(crosses(ramp(0.49)) && !crosses(ramp(0.51)), "headroom on a ramp");
    // Two rooms, each high enough, of which one is a step higher.
    let stepped = |up: f32| {
        let [bottom, top] = [up, 0.55 + up].map(|z| [z; 4]);
        World::room([0.0, 0.0], [3.0, 1.0], 0.0, 0.55).with([[3.0, 0.0], [6.0, 1.0]], bottom, top, true)
    };
    assert!(crosses(stepped(0.04)) && !crosses(stepped(0.09)), "headroom over a step");
    // 22°, of which the steps from cell to cell are lower than what it climbs.
    let timid = Robot { slope_rad: 0.35, ..ROBOT };
    let floor = ramp(0.4).floor(0.1);
    let storeys = Storeys::reached(&floor, &timid, &[[0.5, 0.5, 0.0]]);
    assert_eq!(storeys.of[floor.over(floor.cell_at([5.5, 0.5])).next().unwrap()], None);
}

#[test]
fn a_storey_does_not_cover_itself() {
    // Up a ramp, along a bridge, and back over where it began.
    let world = World::room([0.0, 0.0], [8.0, 3.0], 0.0, 3.0)
        .with([[0.0, -1.0], [8.0, 1.0]], [1.4; 4], [1.5; 4], false)
        .with([[0.0, 1.0], [6.0, 2.0]], [-1.0; 4], [-0.5, 1.5, 1.5, -0.5], false)
        .with([[6.0, 1.0], [8.0, 2.0]], [1.4; 4], [1.5; 4], false);
    let floor = world.floor(0.1);
    let storeys = Storeys::reached(&floor, &ROBOT, &[[0.5, 2.5, 0.0]]);
    assert!(storeys.sizes.len() > 1);
    for storey in 0..storeys.sizes.len() as u16 {
        let own = || floor.cells().iter().zip(&storeys.of).filter(move |(_, of)| **of == Some(storey));
        let mut cells: Vec<[i32; 2]> = own().map(|(gap, _)| gap.cell).collect();
        cells.dedup();
        assert_eq!((cells.len(), own().count()), (storeys.sizes[storey as usize], storeys.sizes[storey as usize]));
    }
    let bridge = floor.over(floor.cell_at([1.0, 0.5])).last().unwrap();
    let below = floor.over(floor.cell_at([1.0, 0.5])).next().unwrap();
    assert!(storeys.of[bridge].is_some() && storeys.of[below].is_some() && storeys.of[bridge] != storeys.of[below]);
}

#[test]
fn a_map_shows_what_is_beside_the_floor() {
    let floor = World::room([1.0, -2.0], [3.0, 0.0], 0.0, 2.0).floor(0.1);
    let map = OccupancyMap::of(&floor, &Storeys::reached(&floor, &ROBOT, &[[2.0, -1.0, 0.0]]), 0);
    assert_eq!((map.size, map.count(State::Free)), ([28, 28], 400));
    assert!((map.origin_m[0] - 0.6).abs() < 1e-9 && (map.origin_m[1] + 2.4).abs() < 1e-9);
    let states = [[0, 0], [14, 1], [4, 4], [23, 23], [24, 23]].map(|cell| map.at(cell));
    assert_eq!(states, [State::Unknown, State::Occupied, State::Free, State::Free, State::Occupied]);
}

#[test]
fn a_start_without_floor_or_room_is_left_out() {
    let floor = World::room([0.0, 0.0], [1.0, 1.0], 0.0, 0.4).floor(0.1);
    for start in [[0.5, 0.5, 0.0], [5.0, 5.0, 0.0]] {
        assert!(Storeys::reached(&floor, &ROBOT, &[start]).sizes.is_empty());
    }
    assert!(World::default().floor(0.1).cells().is_empty());
}

proptest! {
    /// The order in which triangles come, and into how many parts they are divided, changes nothing.
    #[test]
    fn columns_are_a_function_of_the_world(
        boxes in prop::collection::vec((0.0_f32..5.0, 0.0_f32..5.0, -0.5_f32..1.5, 0.1_f32..1.0), 0..6),
        turn in 0_usize..50,
    ) {
        let room = World::room([0.0, 0.0], [6.0, 6.0], 0.0, 2.0);
        let world = boxes.into_iter().fold(room, |world, (x, y, z, side)| {
            world.with([[x, y], [x + side, y + side]], [z; 4], [z + side; 4], false)
        });
        let mut triangles: Vec<[u32; 3]> = world.indices.as_chunks::<3>().0.to_vec();
        let count = triangles.len();
        triangles.rotate_left(turn % count);
        let mut columns = Columns::new(0.25);
        for part in triangles.chunks(7) {
            columns.add(&world.corners, part.as_flattened());
        }
        let gaps = columns.into_gaps();
        prop_assert_eq!(&gaps, &self::gaps(&world, 0.25));
        prop_assert!(gaps.windows(2).all(|pair| (pair[0].cell, pair[0].ceiling_m) < (pair[1].cell, pair[1].floor_m)));
        prop_assert!(gaps.iter().all(|gap| gap.height_m() > 0.0));
    }

    /// A point is in the air where the columns say so.
    #[test]
    fn points_are_inside_as_columns_are(
        boxes in prop::collection::vec((0.0_f32..5.0, 0.0_f32..5.0, -0.5_f32..1.5, 0.1_f32..1.0), 0..6),
        heights in prop::collection::vec(-1.0_f32..3.0, 20),
    ) {
        let room = World::room([0.0, 0.0], [6.0, 6.0], 0.0, 2.0);
        let world = boxes.into_iter().fold(room, |world, (x, y, z, side)| {
            world.with([[x, y], [x + side, y + side]], [z; 4], [z + side; 4], false)
        });
        let gaps = gaps(&world, 0.25);
        let mut inside = Inside::default();
        inside.add(&world.corners, &world.indices);
        for (number, z) in heights.into_iter().enumerate() {
            let cell = [number as i32 + 2, 2 * number as i32 % 24];
            let point = [(cell[0] as f32 + 0.5) * 0.25, (cell[1] as f32 + 0.5) * 0.25, z];
            let is_in_gap = gaps.iter().any(|gap| gap.cell == cell && gap.floor_m < z && z < gap.ceiling_m);
            prop_assert_eq!(inside.is_air(point), is_in_gap, "{:?}", point);
        }
    }
}
