//! Robots: a table of known ones, and what describes others.
//!
//! Sizes of products are those of their makers' data sheets, without payload. What they get over is less than what is advertised
//! for them: slopes also have to leave 5° to what the friction of the floor allows.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::vehicle::{Drone, Profile, Vehicle};

/// How far below the slope at which wheels slip a robot surely gets along. Drives are held to 5° over half a metre, where a floor is up to
/// half a degree steeper than the plane of the wheels.
const RESERVE_DEG: f64 = 6.0;
/// Steepest floor on which wheels that skid sideways turn a robot on the spot, as a share of the slope at which they slip: a rover and a
/// Husky turn there by 42° or more in four seconds at any friction from 0.3 to 1, and by less the steeper it is.
const TURNING: f64 = 0.6;
/// The same for turns of about a right angle or more. Tuned: meanwhile they slide by 0.6 m and more; at 0.58 a rover slid onto steeper floor
/// and tipped over.
const STOPPING: f64 = 0.5;
/// How much steeper a slope it comes down than up.
const DESCENT_MORE_DEG: f64 = 5.0;

/// A known robot.
pub struct RobotRow {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is.
    pub summary: &'static str,
    /// What it measures.
    pub settings: RobotSettings,
}

/// What a robot measures.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RobotSettings {
    /// On wheels or legs.
    Vehicle(VehicleSettings),
    /// In the air.
    Drone(DroneSettings),
}

/// What a robot on wheels or legs measures, and what it gets over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VehicleSettings {
    /// From front to back, m.
    #[schemars(range(min = 0.1, max = 10.0))]
    pub length_m: f64,
    /// From side to side, m.
    #[schemars(range(min = 0.1, max = 10.0))]
    pub width_m: f64,
    /// From the floor to its highest point, m.
    #[schemars(range(min = 0.05, max = 10.0))]
    pub height_m: f64,
    /// Between its axles, or its fore and hind feet, m.
    #[schemars(range(min = 0.05, max = 10.0))]
    pub wheel_base_m: f64,
    /// Between the middles of its left and right wheels or feet, m.
    #[schemars(range(min = 0.05, max = 10.0))]
    pub track_m: f64,
    /// Between the floor and its belly, m.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub ground_clearance_m: f64,
    /// Highest step that it climbs, m.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub step_m: f64,
    /// Steepest slope that it climbs, degrees.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub slope_deg: f64,
    /// Steepest slope across its way, degrees.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub side_slope_deg: f64,
    /// Narrowest passage that it may take, m.
    #[schemars(range(min = 0.1, max = 20.0))]
    pub passage_m: f64,
}

/// What a robot in the air measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DroneSettings {
    /// Radius of the sphere around it, m.
    #[schemars(range(min = 0.02, max = 5.0))]
    pub radius_m: f64,
    /// Narrowest passage that it may take, m.
    #[schemars(range(min = 0.05, max = 20.0))]
    pub passage_m: f64,
}

/// Every known robot.
pub static ROBOTS: [RobotRow; 6] = [
    RobotRow {
        name: "rover",
        summary: "the rover of target mujoco",
        settings: vehicle([0.88, 0.68, 0.68], [0.5, 0.56], [0.17, 0.12], [34.0, 30.0], 0.9),
    },
    RobotRow {
        name: "leo",
        summary: "Leo Rover 1.9 by Fictionlab",
        settings: vehicle([0.424, 0.445, 0.303], [0.295, 0.354], [0.108, 0.07], [30.0, 25.0], 0.65),
    },
    RobotRow {
        name: "husky",
        summary: "Husky A200 by Clearpath",
        settings: vehicle([0.99, 0.67, 0.39], [0.512, 0.555], [0.13, 0.1], [30.0, 25.0], 0.9),
    },
    RobotRow {
        name: "spot",
        summary: "Spot by Boston Dynamics",
        settings: vehicle([1.1, 0.5, 0.84], [0.6, 0.34], [0.35, 0.3], [30.0, 25.0], 0.8),
    },
    RobotRow {
        name: "anymal",
        summary: "ANYmal D by ANYbotics",
        settings: vehicle([0.93, 0.53, 0.89], [0.6, 0.43], [0.35, 0.25], [30.0, 25.0], 0.8),
    },
    RobotRow {
        name: "drone",
        summary: "a quadcopter half a metre across",
        settings: RobotSettings::Drone(DroneSettings { radius_m: 0.25, passage_m: 0.7 }),
    },
];

const fn vehicle(
    [length_m, width_m, height_m]: [f64; 3],
    [wheel_base_m, track_m]: [f64; 2],
    [ground_clearance_m, step_m]: [f64; 2],
    [slope_deg, side_slope_deg]: [f64; 2],
    passage_m: f64,
) -> RobotSettings {
    RobotSettings::Vehicle(VehicleSettings {
        length_m,
        width_m,
        height_m,
        wheel_base_m,
        track_m,
        ground_clearance_m,
        step_m,
        slope_deg,
        side_slope_deg,
        passage_m,
    })
}

/// The robot called `name`.
pub fn robot(name: &str) -> Option<&'static RobotRow> {
    ROBOTS.iter().find(|row| row.name == name)
}

/// The name of a known robot in settings.
pub fn name_schema(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<&str> = ROBOTS.iter().map(|row| row.name).collect();
    json_schema!({ "type": "string", "enum": names })
}

/// A list of such names.
pub fn names_schema(generator: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "array", "items": name_schema(generator) })
}

/// A known robot, in settings by its name.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Known(
    /// Its row.
    pub &'static RobotRow,
);

impl TryFrom<String> for Known {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        robot(&name).map(Self).ok_or_else(|| "there is no such robot".to_owned())
    }
}

impl From<Known> for String {
    fn from(Known(row): Known) -> Self {
        row.name.to_owned()
    }
}

impl PartialEq for Known {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl std::fmt::Debug for Known {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "{}", self.0.name)
    }
}

impl RobotSettings {
    /// What that means on a floor with this friction.
    pub fn profile(&self, friction: f64) -> Profile {
        let slip_deg = libm::atan(friction).to_degrees();
        match self {
            Self::Vehicle(settings) => Profile::Vehicle(settings.vehicle(slip_deg)),
            Self::Drone(DroneSettings { radius_m, passage_m }) => {
                Profile::Drone(Drone { radius_m: *radius_m, margin_m: (passage_m / 2.0 - radius_m).max(0.0) })
            }
        }
    }
}

impl VehicleSettings {
    fn vehicle(&self, slip_deg: f64) -> Vehicle {
        let slope_rad = |slope_deg: f64| slope_deg.min(slip_deg - RESERVE_DEG).max(0.0).to_radians();
        Vehicle {
            length_m: self.length_m,
            width_m: self.width_m,
            height_m: self.height_m,
            wheel_base_m: self.wheel_base_m,
            track_m: self.track_m,
            ground_clearance_m: self.ground_clearance_m,
            step_m: self.step_m,
            climb_rad: slope_rad(self.slope_deg),
            descent_rad: slope_rad(self.slope_deg + DESCENT_MORE_DEG),
            side_slope_rad: slope_rad(self.side_slope_deg),
            turn_rad: (TURNING * slip_deg).to_radians(),
            stop_rad: (STOPPING * slip_deg).to_radians(),
            margin_m: ((self.passage_m - self.width_m) / 2.0).max(0.0),
        }
    }
}
