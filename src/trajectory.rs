//! Paths of robots as files: poses over time.
//!
//! - TUM: `time x y z qx qy qz qw` a line, in seconds and metres (Sturm et al. 2012, the format that evo reads);
//! - CSV: the same with heading, clearance and distance covered;
//! - YAML: a `nav_msgs/msg/Path`, as `ros2 topic pub` takes it.

use std::fmt::Write;

use nalgebra::{UnitQuaternion, Vector3};
use plume_truth::{Route, Waypoint};

/// How fast a robot turns on the spot, in radians a second.
const TURN_RAD_S: f64 = 0.6;
/// Longest time between two poses of a turn on the spot, in seconds.
const TURN_STEP_S: f64 = 0.25;
/// Over how many waypoints a height over the floor is averaged, either way.
const LEVEL_OVER: usize = 4;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// For evo and recordings.
    Tum,
    /// For spreadsheets.
    Csv,
    /// For ROS 2.
    Yaml,
}

impl Format {
    /// Every format with the extension of its files.
    pub const ALL: [(&'static str, Self); 3] = [("tum", Self::Tum), ("csv", Self::Csv), ("yaml", Self::Yaml)];
}

/// Where a robot is relative to the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ride {
    /// On its wheels: pitched and leaning as the floor is.
    OnWheels,
    /// Level, at a height over the floor in metres.
    Level(f64),
}

/// Poses over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The poses.
    pub stamps: Vec<Stamp>,
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    /// Seconds since the start.
    pub time_s: f64,
    /// Metres along the path.
    pub along_m: f64,
    /// Position in metres.
    pub position_m: [f64; 3],
    /// Orientation: +X ahead, +Z up.
    pub rotation: UnitQuaternion<f64>,
    /// From the middle to what the robot cannot drive onto, in metres.
    pub clearance_m: f64,
}

impl Stamp {
    /// Time in seconds, position in metres, and the orientation as x, y, z, w: a row of a TUM file.
    pub fn row(&self) -> [f64; 8] {
        let ([x, y, z], [i, j, k, w]) = (self.position_m, <[f64; 4]>::from(self.rotation.coords));
        [self.time_s, x, y, z, i, j, k, w]
    }
}

impl Trajectory {
    /// A route driven at a constant speed in metres a second, with stops to turn on the spot.
    pub fn of(route: &Route, ride: Ride, speed_m_s: f64) -> Self {
        let waypoints = &route.waypoints;
        let mut trajectory = Self { stamps: Vec::with_capacity(waypoints.len()) };
        for (number, waypoint) in waypoints.iter().enumerate() {
            let (position_m, rotation) = placed(waypoints, number, ride);
            let clearance_m = waypoint.clearance_m;
            let stamp = Stamp { time_s: 0.0, along_m: 0.0, position_m, rotation, clearance_m };
            match trajectory.stamps.last() {
                None => trajectory.stamps.push(stamp),
                Some(&last) => trajectory.go_to(last, stamp, speed_m_s),
            }
        }
        trajectory
    }

    /// Adds the way from the last pose to the next, whose time and place along the path follow. Where turning takes longer than
    /// getting there it turns first: a curve through poses that are far apart in time would leave the path.
    fn go_to(&mut self, last: Stamp, next: Stamp, speed_m_s: f64) {
        let run_m = (Vector3::from(next.position_m) - Vector3::from(last.position_m)).norm();
        let turn = last.rotation.rotation_to(&next.rotation);
        let (run_s, turn_s) = (run_m / speed_m_s, turn.angle() / TURN_RAD_S);
        let along_m = last.along_m + run_m;
        if turn_s <= run_s {
            self.stamps.push(Stamp { time_s: last.time_s + run_s, along_m, ..next });
            return;
        }
        let steps = (turn_s / TURN_STEP_S).ceil();
        self.stamps.extend((1..=steps as usize).map(|step| {
            let share = step as f64 / steps;
            Stamp { time_s: last.time_s + share * turn_s, rotation: turn.powf(share) * last.rotation, ..last }
        }));
        if run_s > 0.0 {
            self.stamps.push(Stamp { time_s: last.time_s + turn_s + run_s, along_m, ..next });
        }
    }

    /// The text of a file.
    pub fn text(&self, format: Format) -> String {
        match format {
            Format::Tum => self.tum(),
            Format::Csv => self.csv(),
            Format::Yaml => self.yaml(),
        }
    }

    fn tum(&self) -> String {
        let line = |stamp: &Stamp| {
            let [time_s, x, y, z, i, j, k, w] = stamp.row();
            format!("{time_s:.6} {x:.6} {y:.6} {z:.6} {i:.9} {j:.9} {k:.9} {w:.9}\n")
        };
        self.stamps.iter().map(line).collect()
    }

    fn csv(&self) -> String {
        let line = |stamp: &Stamp| {
            let [time_s, x, y, z, i, j, k, w] = stamp.row();
            let Stamp { along_m, clearance_m, .. } = stamp;
            format!("{time_s:.6},{x:.6},{y:.6},{z:.6},{i:.9},{j:.9},{k:.9},{w:.9},{along_m:.4},{clearance_m:.3}\n")
        };
        let header = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,along_m,clearance_m\n".to_owned();
        header + &self.stamps.iter().map(line).collect::<String>()
    }

    fn yaml(&self) -> String {
        let mut text = "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: map\nposes:\n".to_owned();
        for stamp in &self.stamps {
            let [time_s, x, y, z, i, j, k, w] = stamp.row();
            let nanoseconds = (time_s * 1e9).round() as u64;
            let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
            let written = write!(
                text,
                "- header:\n    stamp: {{sec: {sec}, nanosec: {nanosec}}}\n    frame_id: map\n  pose:\n    \
                 position: {{x: {x:.6}, y: {y:.6}, z: {z:.6}}}\n    \
                 orientation: {{x: {i:.9}, y: {j:.9}, z: {k:.9}, w: {w:.9}}}\n"
            );
            written.expect("a text takes all");
        }
        text
    }
}

/// Where and how a robot is at a waypoint.
fn placed(waypoints: &[Waypoint], number: usize, ride: Ride) -> ([f64; 3], UnitQuaternion<f64>) {
    let Waypoint { position_m, heading_rad, climb_rad, lean_rad, .. } = waypoints[number];
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    match ride {
        Ride::OnWheels => {
            let pitch = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -climb_rad);
            (position_m, yaw * pitch * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), lean_rad))
        }
        Ride::Level(height_m) => {
            let around = &waypoints[number.saturating_sub(LEVEL_OVER)..(number + LEVEL_OVER + 1).min(waypoints.len())];
            let mean_m = around.iter().map(|waypoint| waypoint.position_m[2]).sum::<f64>() / around.len() as f64;
            ([position_m[0], position_m[1], mean_m + height_m], yaw)
        }
    }
}

#[cfg(test)]
mod tests {
    use plume_truth::Class;

    use super::*;

    #[test]
    fn a_robot_stays_where_it_turns() {
        let waypoint = |x, heading_rad| Waypoint {
            position_m: [x, 0.0, 0.0],
            heading_rad,
            climb_rad: 0.0,
            lean_rad: 0.0,
            clearance_m: 1.0,
        };
        let back = std::f64::consts::PI;
        let waypoints = vec![waypoint(0.0, 0.0), waypoint(1.0, 0.0), waypoint(1.0, back), waypoint(0.5, back)];
        let stamps = Trajectory::of(&Route { waypoints, class: Class::Go }, Ride::OnWheels, 0.5).stamps;
        assert!(stamps.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
        let turning = stamps.iter().filter(|stamp| stamp.position_m[0] == 1.0).count();
        assert!(turning as f64 > back / TURN_RAD_S / TURN_STEP_S, "{turning}");
        let last = stamps[stamps.len() - 1];
        assert!((last.time_s - (3.0 + back / TURN_RAD_S)).abs() < 1e-9 && (last.along_m - 1.5).abs() < 1e-9);
        assert!((last.rotation.angle() - back).abs() < 1e-9);
    }
}
