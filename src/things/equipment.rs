//! Shapes of what miners build in. Their x axis is the way along the passage, and z is up.
//!
//! Timber, rails and pipes have the proportions of common ones (a round post is about a fourteenth as thick as long; light
//! rails are 80 mm high); the rest is a choice.

use nalgebra::{Point3, Vector3};
use plume_graph::rng::Rng;

use super::solid::Solid;
use super::substance::{BLUE_PAINT, FABRIC, RUBBER, RUST, WOOD, ZINC};

/// Length of posts and caps, which are scaled to the passage, in metres.
pub(super) const TIMBER_M: f64 = 2.0;
/// Thickness of a cap of that length in metres.
pub(super) const CAP_M: f64 = 0.15;
/// Length and most width of a board of lagging in metres.
pub(super) const BOARD_M: [f64; 2] = [1.6, 0.15];
/// Distance between the wires of roof mesh, and their thickness, in metres: common sizes (75 mm, 5.6 mm).
const WIRE_M: [f64; 2] = [0.075, 0.0056];
/// Cells of a square of roof mesh along either side: it overlaps the next one by one.
const CELLS: u32 = 17;
/// Side of a square of roof mesh in metres.
pub(super) const MESH_M: f64 = WIRE_M[0] * CELLS as f64;
/// Length of what runs along a passage in pieces, in metres: a little longer than the distance between their ends.
pub(super) const PIECE_M: f64 = 2.0;
/// Height of a rail in metres.
pub(super) const RAIL_M: f64 = 0.08;
/// Radius of a water pipe in metres.
const PIPE_M: f64 = 0.055;
/// Radius of each of two cables, and how much nearer to the wall it hangs, in metres.
const CABLES_M: [[f64; 2]; 2] = [[0.022, 0.0], [0.014, 0.045]];
/// Length of a sleeper in metres.
pub(super) const SLEEPER_M: f64 = 0.9;
/// Thickness of a sleeper in metres.
pub(super) const SLEEPER_THICK_M: f64 = 0.12;
/// Radius of a ventilation duct in metres.
pub(super) const DUCT_M: f64 = 0.3;
/// Distance of a pipe or a cable from the wall, in metres.
pub(super) const OFF_WALL_M: f64 = 0.11;
/// Where a pipe or a cable that turns into the wall ends: ahead and aside, in metres. It may be off the wall by a post.
pub(super) const ELBOW_M: [f64; 2] = [0.16, 0.62];

/// A round post that stands on the origin, slightly tapered.
pub fn post(rng: &mut Rng) -> Solid {
    let foot = rng.between(0.068, 0.078);
    let at = |share: f64| [TIMBER_M * share, foot * (1.0 - 0.12 * share)];
    Solid::lathe(&[at(0.0), at(0.25), at(0.5), at(0.75), at(1.0)], 14, &WOOD)
}

/// A squared beam across the passage, around the origin.
pub fn cap(_: &mut Rng) -> Solid {
    Solid::cuboid([CAP_M, CAP_M, TIMBER_M], &WOOD).towards(Vector3::y())
}

/// A board of lagging along the passage, on the origin; no two are as wide or as thick.
pub fn board(rng: &mut Rng) -> Solid {
    let [length_m, most_m] = BOARD_M;
    let (width_m, thick_m) = (most_m * rng.between(0.8, 1.0), rng.between(0.035, 0.048));
    let aside_m = rng.between(-0.5, 0.5) * (most_m - width_m);
    Solid::cuboid([width_m, thick_m, length_m], &WOOD).lying().at(0.0, aside_m, 0.5 * thick_m)
}

/// The plate, the nut and the tail of a rock bolt; the rock is above the origin.
pub fn bolt(_: &mut Rng) -> Solid {
    let plate = Solid::cuboid([0.15, 0.15, 0.012], &ZINC).at(0.0, 0.0, -0.004);
    let dome = Solid::lathe(&[[-0.030, 0.026], [-0.018, 0.045], [0.004, 0.058]], 12, &ZINC);
    let nut = Solid::cylinder(0.021, 0.026, 6, &RUST).at(0.0, 0.0, -0.043);
    let tail = Solid::cylinder(0.011, 0.24, 8, &RUST).at(0.0, 0.0, 0.02);
    plate.and(dome).and(nut).and(tail)
}

/// A square of welded mesh: the rock is above the origin, and so are the wires.
pub fn roof_mesh(_: &mut Rng) -> Solid {
    let [pitch_m, thick_m] = WIRE_M;
    let (half_m, end_m) = (0.5 * thick_m, 0.5 * MESH_M + 0.02);
    let outline = || vec![[half_m, -half_m], [half_m, half_m], [-half_m, half_m], [-half_m, -half_m]];
    let wire = || Solid::through(&[(-end_m, outline()), (end_m, outline())], &ZINC);
    let pair = |n: u32| {
        let aside_m = pitch_m * f64::from(n) - 0.5 * MESH_M;
        let along = wire().towards(Vector3::x()).at(0.0, aside_m, half_m);
        along.and(wire().towards(Vector3::y()).at(aside_m, 0.0, half_m + thick_m))
    };
    (1..=CELLS).fold(pair(0), |all, n| all.and(pair(n)))
}

/// A piece of a rail on the origin.
pub fn rail(_: &mut Rng) -> Solid {
    let half = [[0.033, 0.0], [0.033, 0.010], [0.007, 0.018], [0.007, 0.056], [0.019, 0.062], [0.019, RAIL_M]];
    Solid::bar(&half, PIECE_M, &RUST).lying()
}

/// A sleeper, with its top at the origin.
pub fn sleeper(_: &mut Rng) -> Solid {
    let sleeper = Solid::cuboid([0.15, SLEEPER_THICK_M, SLEEPER_M], &WOOD).towards(Vector3::y());
    sleeper.at(0.0, 0.0, -0.5 * SLEEPER_THICK_M)
}

/// A water pipe with a coupling and a bracket; the wall is towards -y. The bracket is short, since all collides as one hull.
pub fn pipe(_: &mut Rng) -> Solid {
    let pipe = Solid::cylinder(PIPE_M, PIECE_M, 14, &BLUE_PAINT).lying();
    let coupling = Solid::cylinder(0.075, 0.11, 14, &RUST).lying().at(0.92, 0.0, 0.0);
    let bracket = Solid::cuboid([0.05, 0.012, 0.15], &RUST).towards(Vector3::y()).at(0.0, -0.02, -0.057);
    pipe.and(coupling).and(bracket)
}

/// A pipe that ends at the origin and turns into the wall, which is towards -y.
pub fn pipe_elbow(_: &mut Rng) -> Solid {
    let coupling = Solid::cylinder(0.075, 0.11, 14, &RUST).lying().at(-0.02, 0.0, 0.0);
    Solid::tube(&into_wall(-1.0, 0.0), PIPE_M, 14, &BLUE_PAINT).and(coupling)
}

/// Two cables that end at the origin and go into the wall, which is towards +y.
pub fn cable_end(_: &mut Rng) -> Solid {
    let [thick, thin] = CABLES_M;
    let inner = Solid::tube(&into_wall(1.0, 0.0), thick[0], 8, &RUBBER);
    inner.and(Solid::tube(&into_wall(1.0, thin[1]), thin[0], 8, &RUBBER))
}

/// The path of a pipe or cable that comes along the passage and bends into the wall on this side; `nearer_m` is how much closer
/// to the wall it runs than others.
fn into_wall(side: f64, nearer_m: f64) -> Vec<Point3<f64>> {
    /// Radius of the bend in metres.
    const BEND_M: f64 = 0.13;
    let [ahead_m, aside_m] = ELBOW_M;
    let ahead_m = ahead_m - nearer_m;
    let bend = (0..=5).map(|n| {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(n) / 5.0;
        let (along_m, aside_m) = (BEND_M * (libm::sin(angle) - 1.0), BEND_M * (1.0 - libm::cos(angle)));
        Point3::new(ahead_m + along_m, side * (nearer_m + aside_m), 0.0)
    });
    let ends = [Point3::new(-0.05, side * nearer_m, 0.0), Point3::new(ahead_m, side * aside_m, 0.0)];
    std::iter::once(ends[0]).chain(bend).chain([ends[1]]).collect()
}

/// Two cables that sag between hooks, little, since all collides as one hull; the wall is towards +y.
pub fn cable(_: &mut Rng) -> Solid {
    let sagging = |radius_m: f64, sag_m: f64, out_m: f64| {
        let place = |n: usize| {
            let share = n as f64 / 10.0 * 2.0 - 1.0;
            Point3::new(0.49 * PIECE_M * share, out_m, sag_m * (share * share - 1.0))
        };
        let path: Vec<Point3<f64>> = (0..=10).map(place).collect();
        Solid::tube(&path, radius_m, 8, &RUBBER)
    };
    let hook = Solid::cylinder(0.009, 0.18, 6, &RUST).towards(Vector3::y()).at(-0.95, 0.03, -0.032);
    let [thick, thin] = CABLES_M;
    sagging(thick[0], 0.030, thick[1]).and(sagging(thin[0], 0.045, thin[1])).and(hook)
}

/// A piece of ventilation duct, pleated between its hoops. Both ends are recessed, so that a free one looks open.
pub fn duct(_: &mut Rng) -> Solid {
    /// Thickness of the rim, and how deep the mouth is, in metres.
    const RIM_M: f64 = 0.025;
    const MOUTH_M: f64 = 0.3;
    let fold = |n: usize| {
        let z = PIECE_M * (n as f64 / 16.0 - 0.5);
        [z, if n.is_multiple_of(2) { DUCT_M } else { DUCT_M - 0.018 }]
    };
    let (end_m, bottom_m, inner_m) = (0.5 * PIECE_M, 0.5 * PIECE_M - MOUTH_M, DUCT_M - RIM_M);
    // From the middle of its bottom, outwards.
    let mouth = |way: f64| {
        let bottom = [[bottom_m, 0.05], [bottom_m, inner_m - 0.02], [bottom_m + 0.02, inner_m]];
        let rim = [[end_m - 0.01, inner_m], [end_m, DUCT_M - 0.5 * RIM_M]];
        bottom.into_iter().chain(rim).map(move |[z, radius]| [way * z, radius])
    };
    let folds = [[0.01 - end_m, DUCT_M]].into_iter().chain((1..16).map(fold)).chain([[end_m - 0.01, DUCT_M]]);
    let far: Vec<[f64; 2]> = mouth(1.0).collect();
    let profile: Vec<[f64; 2]> = mouth(-1.0).chain(folds).chain(far.into_iter().rev()).collect();
    Solid::lathe(&profile, 18, &FABRIC).lying()
}

/// A steel drum of 200 litres that stands on the origin.
pub fn drum(_: &mut Rng) -> Solid {
    let wall = |z: f64| [z, 0.286];
    let rib = |z: f64| [[z - 0.02, 0.286], [z, 0.298], [z + 0.02, 0.286]];
    let mut profile = vec![[0.005, 0.296], wall(0.03)];
    profile.extend(rib(0.30));
    profile.extend(rib(0.58));
    profile.extend([wall(0.85), [0.875, 0.296]]);
    // Hardly higher than the lid: their common hull stands that far above it.
    let bung = Solid::cylinder(0.035, 0.03, 10, &RUST).at(0.17, 0.0, 0.876);
    Solid::lathe(&profile, 20, &BLUE_PAINT).and(bung)
}
