//! The sample rover: skid-steered, on four wheels. Templates of several simulators take its numbers from here.
//!
//! Its origin is on the ground between the wheels, +X forward, +Z up.

use serde::Serialize;

/// How far above the ground it starts, in metres: it drops, since the ground under its wheels is not flat. Tuned.
pub const START_HEIGHT_M: f64 = 0.05;

/// What the rover measures.
#[derive(Serialize)]
pub struct Rover {
    chassis: Chassis,
    deck: Block,
    mast: Block,
    head: Block,
    wheel: Wheel,
    /// Its camera.
    pub camera: Camera,
    imu_at_m: [f64; 3],
    /// Its lamps.
    pub lamp: Lamp,
}

/// A box, by halves of its sides as in MJCF.
#[derive(Serialize)]
struct Block {
    half_m: [f64; 3],
    at_m: [f64; 3],
}

/// The box that carries everything, with its moments about its own axes.
#[derive(Serialize)]
struct Chassis {
    half_m: [f64; 3],
    at_m: [f64; 3],
    mass_kg: f64,
    inertia_kg_m2: [f64; 3],
}

/// Four of these at either sign of x and y, ellipsoids with moments about their own axes.
#[derive(Serialize)]
struct Wheel {
    at_m: [f64; 3],
    radius_m: f64,
    half_width_m: f64,
    mass_kg: f64,
    inertia_kg_m2: [f64; 3],
    most_speed_rad_s: f64,
    most_torque_nm: f64,
}

/// Looks along +X.
#[derive(Serialize)]
pub struct Camera {
    at_m: [f64; 3],
    /// Vertical field of view.
    pub view_deg: f64,
}

/// Two of these at either sign of y, each turned outwards.
#[derive(Serialize)]
pub struct Lamp {
    at_m: [f64; 3],
    towards: [f64; 3],
    /// From the axis of the cone to its edge.
    pub half_angle_deg: f64,
    /// Luminous intensity on the axis.
    pub intensity_cd: f64,
    range_m: f64,
}

impl Rover {
    /// The one there is.
    pub fn new() -> Self {
        let (half_m, mass_kg) = ([0.44, 0.2, 0.1], 40.0);
        let chassis =
            Chassis { half_m, at_m: [0.0, 0.0, 0.27], mass_kg, inertia_kg_m2: moments(half_m, mass_kg / 3.0) };
        let (radius_m, half_width_m, mass_kg) = (0.18, 0.06, 2.5);
        let wheel = Wheel {
            at_m: [0.25, 0.28, radius_m],
            radius_m,
            half_width_m,
            mass_kg,
            inertia_kg_m2: moments([radius_m, half_width_m, radius_m], mass_kg / 5.0),
            most_speed_rad_s: 12.0,
            most_torque_nm: 80.0,
        };
        Self {
            chassis,
            deck: Block { half_m: [0.3, 0.24, 0.01], at_m: [0.0, 0.0, 0.38] },
            mast: Block { half_m: [0.02, 0.02, 0.12], at_m: [0.3, 0.0, 0.5] },
            head: Block { half_m: [0.03, 0.12, 0.03], at_m: [0.3, 0.0, 0.65] },
            wheel,
            camera: Camera { at_m: [0.36, 0.0, 0.65], view_deg: 60.0 },
            imu_at_m: [0.0, 0.0, 0.27],
            lamp: Lamp {
                at_m: [0.36, 0.1, 0.65],
                towards: [1.0, 0.1, -0.15],
                half_angle_deg: 70.0,
                intensity_cd: 200.0,
                range_m: 30.0,
            },
        }
    }
}

/// Moments of inertia of a box or an ellipsoid about its own axes: `share_kg` is a third of its mass or a fifth.
fn moments([x, y, z]: [f64; 3], share_kg: f64) -> [f64; 3] {
    [y * y + z * z, z * z + x * x, x * x + y * y].map(|square| share_kg * square)
}
