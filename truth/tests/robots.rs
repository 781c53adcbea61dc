//! Certificates and paths, on worlds made of boxes.

mod world;

use plume_truth::{
    Cause, Certificate, Class, Drone, Floor, Network, Passage, Profile, Route, Through, Vehicle, Verdict,
};

use self::world::World;

const CELL_M: f64 = 0.05;
/// The ends of a corridor along x.
const ENDS: [[f64; 3]; 2] = [[1.5, 0.0, 0.5], [10.5, 0.0, 0.5]];

fn rover() -> Vehicle {
    Vehicle {
        length_m: 0.9,
        width_m: 0.7,
        height_m: 0.6,
        wheel_base_m: 0.5,
        track_m: 0.56,
        ground_clearance_m: 0.15,
        step_m: 0.1,
        climb_rad: 25_f64.to_radians(),
        descent_rad: 35_f64.to_radians(),
        side_slope_rad: 25_f64.to_radians(),
        turn_rad: 25_f64.to_radians(),
        stop_rad: 25_f64.to_radians(),
        margin_m: 0.1,
    }
}

/// A corridor along x, 12 m long, 3 m wide and 2 m high.
fn corridor() -> World {
    World::room([0.0, -1.5], [12.0, 1.5], 0.0, 2.0)
}

/// A box across the corridor from one place to another.
fn block(from: [f32; 2], to: [f32; 2], bottom: f32, top: f32) -> World {
    corridor().with([from, to], [bottom; 4], [top; 4], false)
}

fn certificate(floor: &Floor, robot: &Profile) -> Certificate {
    let network = Network { stations: ENDS.to_vec(), passages: vec![Passage { ends: [0, 1], reach_m: 1.5 }] };
    Certificate::of(floor, robot, &network, [1.5, 0.0, 0.0])
}

fn through(world: &World, robot: &Profile) -> Through {
    certificate(&world.floor(CELL_M), robot).passages.remove(0)
}

fn driven(world: &World) -> Through {
    through(world, &Profile::Vehicle(rover()))
}

fn cause(verdict: &Verdict) -> Option<(Class, Cause)> {
    verdict.fault.map(|(fault, _)| (verdict.class, fault.cause))
}

#[test]
fn an_empty_corridor_is_passable_both_ways() {
    let floor = corridor().floor(CELL_M);
    let found = certificate(&floor, &Profile::Vehicle(rover()));
    let through = &found.passages[0];
    assert_eq!((through.there.class, through.back.class), (Class::Go, Class::Go));
    assert!((through.widest_m - 3.0).abs() <= 0.1, "{}", through.widest_m);
    assert!(found.stations.iter().all(|reach| (reach.there, reach.back) == (Some(Class::Go), Some(Class::Go))));
    assert!((found.floor_m2 - 36.0).abs() < 0.1);
    // Its middle stays half its width and its margin from the sides; and it cannot turn in the corners.
    assert!(found.reached_m2 > 18.0 && found.reached_m2 < 26.5, "{}", found.reached_m2);
    assert_eq!(found.furthest.unwrap().0, 1);
}

#[test]
fn a_gap_is_as_wide_as_it_is() {
    // Two blocks that leave a gap of this width in the middle.
    let gap = |width: f32| {
        block([5.0, -2.0], [7.0, -width / 2.0], -1.0, 3.0).with(
            [[5.0, width / 2.0], [7.0, 2.0]],
            [-1.0; 4],
            [3.0; 4],
            false,
        )
    };
    for (width, class) in [(1.1, Class::Go), (0.8, Class::Marginal), (0.6, Class::NoGo)] {
        let through = driven(&gap(width));
        assert_eq!((through.there.class, through.back.class), (class, class), "{width} m");
        assert!((through.widest_m - f64::from(width)).abs() <= 0.1, "{width} m: {}", through.widest_m);
        if class > Class::Go {
            let (fault, [x, ..]) = through.there.fault.unwrap();
            assert_eq!(fault.cause, Cause::Width);
            assert!((4.4..7.6).contains(&x), "{x}");
        }
    }
}

#[test]
fn a_robot_that_cannot_stand_at_its_start_gets_nowhere() {
    let low = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 0.4).floor(CELL_M);
    let found = certificate(&low, &Profile::Vehicle(rover()));
    assert!(found.stations.iter().all(|reach| reach.there.is_none()) && found.furthest.is_none());
    assert_eq!((found.reached_m2, found.passages[0].there.class), (0.0, Class::NoGo));
}

#[test]
fn what_is_too_high_or_too_low_is_named() {
    let across = |bottom: f32, top: f32| driven(&block([5.0, -2.0], [7.0, 2.0], bottom, top)).there;
    let low = across(-1.0, 0.08);
    assert_eq!(low.class, Class::Go, "{:?}", low.fault);
    assert_eq!(cause(&across(-1.0, 0.14)), Some((Class::NoGo, Cause::Step)));
    assert_eq!(across(0.7, 3.0).class, Class::Go);
    assert_eq!(cause(&across(0.5, 3.0)), Some((Class::NoGo, Cause::Headroom)));
    // A kerb that fits between the wheels, but not under the belly.
    let kerb = |top: f32| {
        driven(
            &block([3.0, -0.1], [9.0, 0.1], -1.0, top)
                .with([[3.0, -2.0], [9.0, -0.5]], [-1.0; 4], [3.0; 4], false)
                .with([[3.0, 0.5], [9.0, 2.0]], [-1.0; 4], [3.0; 4], false),
        )
        .there
    };
    let low = kerb(0.1);
    assert_eq!(low.class, Class::Go, "{:?}", low.fault);
    assert_eq!(cause(&kerb(0.14)), Some((Class::Marginal, Cause::Belly)));
}

#[test]
fn a_ramp_may_be_passable_only_down() {
    // Up 30° towards +x: the robot climbs 25° and comes down 35°.
    let rise = 2.0 * 30_f32.to_radians().tan();
    let world = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 4.0)
        .with([[5.0, -2.0], [7.0, 2.0]], [-1.0; 4], [0.0, rise, rise, 0.0], false)
        .with([[7.0, -2.0], [13.0, 2.0]], [-1.0; 4], [rise; 4], false);
    let network = Network {
        stations: vec![[1.5, 0.0, 0.5], [10.5, 0.0, 0.5 + f64::from(rise)]],
        passages: vec![Passage { ends: [0, 1], reach_m: 1.5 }],
    };
    let found =
        Certificate::of(&world.floor(CELL_M), &Profile::Vehicle(rover()), &network, [10.5, 0.0, f64::from(rise)]);
    let through = &found.passages[0];
    assert_eq!(through.there.class, Class::Marginal, "{:?}", through.there.fault);
    assert_eq!(cause(&through.back), None);
    assert_eq!((found.stations[0].there, found.stations[0].back), (Some(Class::Go), Some(Class::Marginal)));
}

#[test]
fn a_bumper_meets_the_foot_of_a_ramp() {
    let rise = 2.0 * 20_f32.to_radians().tan();
    let ramp = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 4.0)
        .with([[5.0, -2.0], [7.0, 2.0]], [-1.0; 4], [0.0, rise, rise, 0.0], false)
        .with([[7.0, -2.0], [13.0, 2.0]], [-1.0; 4], [rise; 4], false);
    let class = |length_m| through(&ramp, &Profile::Vehicle(Vehicle { length_m, ..rover() })).there.class;
    assert_eq!(class(0.7), Class::Go);
    assert!(class(1.5) > Class::Go);
}

#[test]
fn what_is_beside_the_wheels_must_be_no_higher_than_a_step() {
    let lane = |top: f32| {
        let kerb = |inner: f32, outer: f32| [[3.0, inner], [9.0, outer]];
        corridor().with(kerb(-2.0, -0.4), [-1.0; 4], [top; 4], false).with(kerb(0.4, 2.0), [-1.0; 4], [top; 4], false)
    };
    let low = driven(&lane(0.08)).there;
    assert_eq!(low.class, Class::Go, "{:?}", low.fault);
    assert_eq!(cause(&driven(&lane(0.13)).there), Some((Class::Marginal, Cause::Width)));
}

#[test]
fn wheels_turn_on_gentle_slopes_only() {
    // Up 10°, around two blocks.
    let top = 12.0 * 10_f32.to_radians().tan();
    let world = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 5.0)
        .with([[0.0, -2.0], [12.0, 2.0]], [-1.0; 4], [0.0, top, top, 0.0], false)
        .with([[4.0, -2.0], [4.5, 0.2]], [-1.0; 4], [6.0; 4], false)
        .with([[7.0, -0.2], [7.5, 2.0]], [-1.0; 4], [6.0; 4], false);
    let network = Network {
        stations: [1.5, 10.5].map(|x| [x, 0.0, 0.5 + x * f64::from(top) / 12.0]).to_vec(),
        passages: vec![Passage { ends: [0, 1], reach_m: 1.5 }],
    };
    let there = |turn_deg: f64| {
        let robot = Profile::Vehicle(Vehicle { turn_rad: turn_deg.to_radians(), ..rover() });
        Certificate::of(&world.floor(CELL_M), &robot, &network, network.stations[0]).passages.remove(0).there
    };
    assert_eq!(there(12.0).class, Class::Go);
    assert_eq!(cause(&there(8.0)), Some((Class::Marginal, Cause::Slope)));
}

#[test]
fn wheels_stop_to_turn_back_on_gentler_slopes_only() {
    // Up 10° and down again.
    let top = 12.0 * 10_f32.to_radians().tan();
    let world = World::room([0.0, -1.5], [12.0, 1.5], 0.0, 5.0).with(
        [[0.0, -2.0], [12.0, 2.0]],
        [-1.0; 4],
        [0.0, top, top, 0.0],
        false,
    );
    let [low, high] = [1.5, 10.5].map(|x| [x, 0.0, 0.5 + x * f64::from(top) / 12.0]);
    let class = |stop_deg: f64, places: &[[f64; 3]]| {
        let robot = Profile::Vehicle(Vehicle { stop_rad: stop_deg.to_radians(), ..rover() });
        Route::via(&world.floor(CELL_M), &robot, low, places).unwrap().class
    };
    assert_eq!(class(12.0, &[high, low]), Class::Go);
    assert_eq!(class(8.0, &[high, low]), Class::Marginal);
    assert_eq!(class(8.0, &[high]), Class::Go);
}

#[test]
fn where_it_is_steep_the_floor_beside_counts_too() {
    // Up a ridge 0.8 m wide, 0.2 m above what is beside it.
    let class = |slope_deg: f32| {
        let top = 12.0 * slope_deg.to_radians().tan();
        let low = [-0.2, top - 0.2, top - 0.2, -0.2];
        let world = World::room([0.0, -0.75], [12.0, 0.75], -0.2, 7.0)
            .with([[0.0, -2.0], [12.0, 2.0]], [-1.0; 4], low, false)
            .with([[0.0, -0.4], [12.0, 0.4]], [-1.0; 4], [0.0, top, top, 0.0], false);
        let stations = [1.5, 10.5].map(|x| [x, 0.0, 0.5 + x * f64::from(top) / 12.0]).to_vec();
        let network = Network { stations, passages: vec![Passage { ends: [0, 1], reach_m: 1.5 }] };
        let start_m = network.stations[0];
        let robot = Profile::Vehicle(rover());
        Certificate::of(&world.floor(CELL_M), &robot, &network, start_m).passages.remove(0).there.class
    };
    assert_eq!(class(14.0), Class::Go);
    assert_ne!(class(20.0), Class::Go);
}

#[test]
fn a_drone_flies_over_what_stops_wheels() {
    let drone = |radius_m| Profile::Drone(Drone { radius_m, margin_m: 0.05 });
    // A wall with a window half a metre high over it.
    let world = block([5.0, -2.0], [7.0, 2.0], -1.0, 1.0).with([[5.0, -2.0], [7.0, 2.0]], [1.5; 4], [3.0; 4], false);
    assert_eq!(driven(&world).there.class, Class::NoGo);
    assert_eq!(through(&world, &drone(0.15)).there.class, Class::Go);
    assert_eq!(cause(&through(&world, &drone(0.3)).there), Some((Class::NoGo, Cause::Width)));
    let route = through(&world, &drone(0.15)).there.route;
    let over = route.waypoints.iter().filter(|waypoint| (5.5..6.5).contains(&waypoint.position_m[0]));
    assert!(over.clone().count() > 5, "{route:?}");
    assert!(over.clone().all(|waypoint| (1.2..1.3).contains(&waypoint.position_m[2])));
}

#[test]
fn a_drone_keeps_away_from_what_is_thinner_than_a_cell() {
    // Straws across the corridor that hang down to its floor between the centres of cells, except for a gap at one side.
    let straws = (-30..=5)
        .map(|n| n as f32 * 0.05)
        .fold(corridor(), |world, y| world.with([[5.998, y - 0.002], [6.002, y + 0.002]], [0.0; 4], [2.0; 4], false));
    let route = through(&straws, &Profile::Drone(Drone { radius_m: 0.25, margin_m: 0.1 })).there.route;
    assert_eq!(route.class, Class::Go);
    let away_m = |[x, y, _]: [f64; 3]| libm::hypot(x - 6.0, (y - 0.25).max(0.0));
    let nearest_m = route.waypoints.iter().map(|waypoint| away_m(waypoint.position_m)).fold(f64::INFINITY, f64::min);
    assert!((0.25..0.6).contains(&nearest_m), "{nearest_m} m");
}

#[test]
fn a_slope_takes_more_grip_where_it_also_leans() {
    // A corridor too narrow to turn in, on a plane that rises by these for each metre ahead and to the left.
    let on_plane = |ahead: f32, left: f32| {
        let top = |x: f32, y: f32| ahead * x + left * y;
        let heights = [top(0.0, -0.6), top(12.0, -0.6), top(12.0, 0.6), top(0.0, 0.6)];
        let world = World::room([0.0, -0.6], [12.0, 0.6], -2.0, 9.0).with(
            [[0.0, -0.6], [12.0, 0.6]],
            [-3.0; 4],
            heights,
            false,
        );
        let stations = [1.5, 10.5].map(|x| [f64::from(x), 0.0, f64::from(top(x, 0.0)) + 0.5]).to_vec();
        let network = Network { stations, passages: vec![Passage { ends: [0, 1], reach_m: 1.0 }] };
        let start_m = [1.5, 0.0, f64::from(top(1.5, 0.0))];
        let robot = Profile::Vehicle(rover());
        Certificate::of(&world.floor(CELL_M), &robot, &network, start_m).passages.remove(0).there
    };
    let diagonal = |slope_deg: f32| {
        let share = slope_deg.to_radians().tan() * std::f32::consts::FRAC_1_SQRT_2;
        on_plane(share, share).class
    };
    let straight = on_plane(24_f32.to_radians().tan(), 0.0);
    assert_eq!(straight.class, Class::Go, "{:?}", straight.fault);
    assert_eq!([20.0, 24.0].map(diagonal), [Class::Go, Class::Marginal]);
}

#[test]
fn a_path_goes_through_the_middle_and_around_corners() {
    // Around a wall that leaves a door at one side.
    let world = block([5.5, -1.4], [6.5, 0.3], -1.0, 3.0);
    let floor = world.floor(CELL_M);
    let robot = Profile::Vehicle(rover());
    let route = Route::via(&floor, &robot, [1.5, 0.0, 0.0], &[ENDS[1], ENDS[0]]).unwrap();
    assert_eq!(route.class, Class::Go);
    assert!(route.length_m() > 17.0 && route.length_m() < 22.0, "{}", route.length_m());
    for pair in route.waypoints.windows(2) {
        let [a, b] = [pair[0].position_m, pair[1].position_m];
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        assert!(x * x + y * y < 0.04 && (a[2] - b[2]).abs() < 1e-6);
        assert!(pair[0].clearance_m >= 0.4, "{:?}", pair[0]);
    }
    let locked = block([5.5, -2.0], [6.5, 2.0], -1.0, 3.0).floor(CELL_M);
    assert_eq!(Route::via(&locked, &robot, [1.5, 0.0, 0.0], &[ENDS[0], ENDS[1]]), Err(1));
}
