//! The laws of territories, lengths, episodes, views and rooms, on worlds made of boxes.

mod world;

use plume_truth::robot::robot;
use plume_truth::{Class, Episode, Eye, Floor, Profile, Room, Scout, Territory, views};
use proptest::prelude::*;

use self::world::World;

const CELL_M: f64 = 0.05;
/// What eight directions make of a straight line at most.
const OCTILE: f64 = 1.0824;
const EYE: Eye = Eye { height_m: 0.5, range_m: 4.0, sight_m: 0.1 };

fn rover() -> Profile {
    robot("rover").expect("it is in the table").settings.profile(0.8)
}

fn away(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum::<f64>().sqrt()
}

/// A block up to the ceiling in a room of 8 m by 8 m.
fn divided(low: [f32; 2], high: [f32; 2]) -> World {
    World::room([0.0, 0.0], [8.0, 8.0], 0.0, 2.0).with([low, high], [-1.0; 4], [3.0; 4], false)
}

#[test]
fn lengths_are_those_of_straight_lines_in_eight_directions() {
    let floor = World::room([0.0, 0.0], [8.0, 8.0], 0.0, 2.0).floor(CELL_M);
    let profile = rover();
    let territory = Territory::of(&mut Scout::new(&floor, &profile), [2.0, 2.0, 0.0]);
    // Its middle stays half its width and a margin from the walls.
    assert!((4500..5300).contains(&territory.cells().len()), "{}", territory.cells().len());
    let from_start = territory.from_start();
    let start = (0..territory.cells().len()).find(|place| from_start.length_m(*place) == 0.0).unwrap();
    let to_start = territory.to(start);
    for (place, at_m) in territory.at_m().iter().enumerate() {
        let straight_m = away(*at_m, territory.at_m()[start]);
        let length_m = to_start.length_m(place);
        assert!((straight_m - 1e-3..straight_m * OCTILE + 0.01).contains(&length_m), "{length_m} for {straight_m}");
    }
    let goal = territory.nearest([6.0, 5.0, 0.0]).unwrap();
    // The start is a few cells, and turns count next to nothing.
    assert!((territory.to(goal).length_m(start) - from_start.length_m(goal)).abs() < 0.3);
}

#[test]
fn ways_lead_around_walls_and_goals_are_far_from_each_other() {
    let floor = divided([3.9, -1.0], [4.1, 6.0]).floor(CELL_M);
    let profile = rover();
    let territory = Territory::of(&mut Scout::new(&floor, &profile), [1.0, 1.0, 0.0]);
    let from_start = territory.from_start();
    let behind = territory.nearest([7.0, 1.0, 0.0]).unwrap();
    assert!(from_start.length_m(behind) > 12.0, "{}", from_start.length_m(behind));
    let goals = territory.goals(&from_start, 3);
    assert_eq!(goals.len(), 3);
    assert!(from_start.length_m(goals[0].0) > 11.0);
    for (number, (place, _)) in goals.iter().enumerate() {
        assert!(goals[..number].iter().all(|(_, to_other)| to_other.length_m(*place) > 3.0));
    }
}

#[test]
fn a_place_from_which_there_is_no_way_back_is_no_territory() {
    // 30° up towards +x, which the rover comes down but does not surely climb; it starts at the top.
    let rise = 2.0 * 30_f32.to_radians().tan();
    let floor = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 4.0)
        .with([[5.0, -2.0], [7.0, 2.0]], [-1.0; 4], [0.0, rise, rise, 0.0], false)
        .with([[7.0, -2.0], [13.0, 2.0]], [-1.0; 4], [rise; 4], false)
        .floor(CELL_M);
    let Profile::Vehicle(vehicle) = rover() else { panic!("it is on wheels") };
    let timid = |climb_deg: f64| {
        Profile::Vehicle(plume_truth::Vehicle {
            climb_rad: climb_deg.to_radians(),
            descent_rad: 35_f64.to_radians(),
            ground_clearance_m: 0.5,
            ..vehicle.clone()
        })
    };
    let lowest = |profile: &Profile| {
        let territory = Territory::of(&mut Scout::new(&floor, profile), [10.5, 0.0, f64::from(rise)]);
        territory.at_m().iter().map(|at| at[0]).fold(f64::INFINITY, f64::min)
    };
    assert!(lowest(&timid(25.0)) > 6.0 && lowest(&timid(34.0)) < 2.0);
}

#[test]
fn without_a_start_there_is_nothing() {
    let floor = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 0.4).floor(CELL_M);
    let profile = rover();
    let mut scout = Scout::new(&floor, &profile);
    let territory = Territory::of(&mut scout, [1.5, 0.0, 0.0]);
    let from_start = territory.from_start();
    assert!(territory.cells().is_empty() && territory.nearest([0.0; 3]).is_none());
    let goals = territory.goals(&from_start, 3);
    assert!(goals.is_empty() && views(&floor, &territory, &from_start, EYE).is_empty());
    assert!(Episode::of(&mut scout, &territory, &goals, 5, &mut |_| 0).is_empty());
}

#[test]
fn episodes_lead_surely_from_their_starts_to_their_goals() {
    let floor = divided([3.9, -1.0], [4.1, 6.0]).floor(CELL_M);
    let profile = rover();
    let mut scout = Scout::new(&floor, &profile);
    let territory = Territory::of(&mut scout, [1.0, 1.0, 0.0]);
    let goals = territory.goals(&territory.from_start(), 3);
    let mut next = 0_usize;
    let mut draw = |end: usize| {
        next += 7919;
        next % end
    };
    let episodes = Episode::of(&mut scout, &territory, &goals, 20, &mut draw);
    assert_eq!(episodes.len(), 20);
    for Episode { goal, start, route } in &episodes {
        let (place, to_goal) = &goals[*goal];
        let ends = [route.waypoints.first().unwrap().position_m, route.waypoints.last().unwrap().position_m];
        assert!(away(ends[0], start.position_m) < 1e-6 && away(ends[1], territory.at_m()[*place]) < 0.02);
        assert_eq!(route.class, Class::Go);
        let (straight_m, length_m) = (away(ends[0], ends[1]), route.length_m());
        let found_m = to_goal.length_m(territory.nearest(start.position_m).unwrap());
        assert!(length_m >= straight_m - 1e-6 && straight_m >= 0.9, "{length_m} m for {straight_m} m");
        assert!(length_m <= found_m + 0.05 && length_m >= found_m / OCTILE - 0.05, "{length_m} m, {found_m} m");
    }
}

#[test]
fn the_room_around_a_station_is_measured() {
    let floor = World::room([0.0, 0.0], [6.0, 3.0], -1.0, 2.0).floor(CELL_M);
    let room = Room::around(&floor, [2.0, 1.0, 0.5], 0.0).unwrap();
    let expected = [2.0, 1.0, 1.5, 1.5];
    for (own, expected) in [room.left_m, room.right_m, room.up_m, room.down_m].into_iter().zip(expected) {
        assert!((own - expected).abs() <= CELL_M, "{room:?}");
    }
    let aside = Room::around(&floor, [2.0, 1.0, 0.5], std::f64::consts::FRAC_PI_2).unwrap();
    assert!((aside.left_m - 2.0).abs() <= CELL_M && (aside.right_m - 4.0).abs() <= CELL_M, "{aside:?}");
    assert_eq!(Room::around(&floor, [2.0, 1.0, 2.5], 0.0), None);
}

/// Whether a line is in the air at ten points per cell.
fn is_free(floor: &Floor, from: [f64; 3], to: [f64; 3]) -> bool {
    let steps = (away(from, to) / CELL_M * 10.0).ceil() as usize;
    (1..steps).all(|step| {
        let share = step as f64 / steps as f64;
        let [x, y, z] = [0, 1, 2].map(|axis| (from[axis] + share * (to[axis] - from[axis])) as f32);
        let mut over = floor.over(floor.cell_at([x.into(), y.into()]));
        over.any(|number| (floor.cells()[number].floor_m..=floor.cells()[number].ceiling_m).contains(&z))
    })
}

#[test]
fn short_branches_are_looked_at_first() {
    // From the middle of the lower side, a short way to the left and a long one to the right.
    let floor = World::room([0.0, 0.0], [20.0, 2.0], 0.0, 2.0).floor(CELL_M);
    let profile = rover();
    let territory = Territory::of(&mut Scout::new(&floor, &profile), [6.0, 1.0, 0.0]);
    let found = views(&floor, &territory, &territory.from_start(), EYE);
    let along: Vec<f64> = found.iter().map(|view| territory.at_m()[view.place][0]).collect();
    assert!(along.windows(2).filter(|pair| (pair[0] - 6.0) * (pair[1] - 6.0) < 0.0).count() <= 1, "{along:?}");
    assert!(along[0] < 6.0 && *along.last().unwrap() > 14.0, "{along:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// From the views together, every place is seen, and there are fewer of them than of circles side by side.
    #[test]
    fn everything_is_seen(
        boxes in prop::collection::vec((0.0_f32..5.0, 0.0_f32..5.0, 0.1_f32..1.2, 0.1_f32..3.0), 0..6),
    ) {
        let room = World::room([0.0, 0.0], [6.0, 6.0], 0.0, 2.0);
        let floor = boxes
            .into_iter()
            .fold(room, |world, (x, y, side, top)| {
                world.with([[x, y], [x + side, y + side]], [-1.0; 4], [top; 4], false)
            })
            .floor(CELL_M);
        let profile = rover();
        let territory = Territory::of(&mut Scout::new(&floor, &profile), [5.4, 5.4, 0.0]);
        let found = views(&floor, &territory, &territory.from_start(), EYE);
        let over = |place: usize, up: f64| {
            let [x, y, z] = territory.at_m()[place];
            [x, y, z + up]
        };
        let mut unseen = 0;
        for place in (0..territory.cells().len()).step_by(17) {
            let sight = over(place, EYE.sight_m);
            let sees = |view: &plume_truth::View| {
                let eye = over(view.place, EYE.height_m);
                away(eye, sight) <= EYE.range_m && is_free(&floor, eye, sight)
            };
            unseen += usize::from(!found.iter().any(sees));
        }
        // A line that grazes a corner may be in rock between two points of the coarser march.
        prop_assert!(unseen * 200 <= territory.cells().len() / 17 + 200, "{unseen} of {}", territory.cells().len() / 17);
        prop_assert!(found.len() <= 40, "{}", found.len());
    }
}
