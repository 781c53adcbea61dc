//! The path of the body as a smooth function of time, so that what an inertial sensor feels follows from it analytically.
//!
//! Positions are a cubic B-spline, rotations a cumulative cubic B-spline of quaternions, both over the times of the given poses,
//! which need not be evenly spaced. Rates of rotation follow the recursion of Sommer, Usenko, Schubert, Demmel and Cremers,
//! "Efficient Derivative Computation for Cumulative B-Splines on Lie Groups" (CVPR 2020), here with knots of any spacing. Control
//! poses are corrected until the spline passes through every given pose (progressive iterative approximation; Lin, Bao and Wang
//! 2005).
//!
//! Promised: through every pose to a micrometre and a microradian; twice continuously differentiable; at rest in the second
//! derivative at both ends. Not promised: that the path stays clear of walls between two poses.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use self::basis::Basis;
use crate::error::RecordError;

mod basis;
pub mod tum;

/// Largest distance of the spline from a given pose, in metres and radians.
const WITHIN: f64 = 1e-6;
/// Corrections until then; evenly spaced poses need about thirty.
const MOST_CORRECTIONS: usize = 500;

/// A pose with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped {
    /// Nanoseconds since the epoch of the file.
    pub time_ns: i64,
    /// From the body, which looks along +X with +Z up, to the scene.
    pub pose: Isometry3<f64>,
}

/// A path of at least two poses.
#[derive(Clone, Debug)]
pub struct Trajectory {
    start_ns: i64,
    end_ns: i64,
    poses: usize,
    /// Times of the poses in seconds from the first, with two more before and after them.
    knots: Vec<f64>,
    /// One more control pose before the first pose and one after the last.
    positions: Vec<Vector3<f64>>,
    rotations: Vec<UnitQuaternion<f64>>,
}

/// How the body moves at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// From the body to the scene.
    pub pose: Isometry3<f64>,
    /// Of the body's origin in the scene, in m/s.
    pub velocity: Vector3<f64>,
    /// Of the body's origin in the scene, in m/s².
    pub acceleration: Vector3<f64>,
    /// In the body, in rad/s.
    pub turn: Vector3<f64>,
    /// In the body, in rad/s².
    pub turn_change: Vector3<f64>,
}

impl Trajectory {
    /// The path through these poses.
    ///
    /// # Errors
    /// [`RecordError::Path`] if there are fewer than two, their times do not rise, or are too uneven for a smooth path.
    pub fn through(poses: &[Stamped]) -> Result<Self, RecordError> {
        let [first, .., last] = poses else {
            return Err(RecordError::path("has fewer than two poses", "a path needs at least a start and an end"));
        };
        if let Some(pair) = poses.windows(2).find(|pair| pair[1].time_ns <= pair[0].time_ns) {
            let fault = format!("time {} s is not after the one before", pair[1].time_ns as f64 * 1e-9);
            return Err(RecordError::path(fault, "sort the poses by time and leave out repetitions"));
        }
        let times: Vec<f64> = poses.iter().map(|pose| (pose.time_ns - first.time_ns) as f64 * 1e-9).collect();
        let mut path = Self {
            start_ns: first.time_ns,
            end_ns: last.time_ns,
            poses: poses.len(),
            knots: extended(&times),
            positions: vec![Vector3::zeros(); poses.len() + 2],
            rotations: vec![UnitQuaternion::identity(); poses.len() + 2],
        };
        for (number, given) in poses.iter().enumerate() {
            path.positions[number + 1] = given.pose.translation.vector;
            path.rotations[number + 1] = given.pose.rotation;
        }
        path.fit(poses, &times)?;
        Ok(path)
    }

    /// When it begins, in nanoseconds since the epoch of the file.
    pub fn start_ns(&self) -> i64 {
        self.start_ns
    }

    /// When it ends.
    pub fn end_ns(&self) -> i64 {
        self.end_ns
    }

    /// Number of poses that it was made from.
    pub fn poses(&self) -> usize {
        self.poses
    }

    /// The motion at a time, which is moved into the path if it is outside.
    pub fn at_ns(&self, time_ns: i64) -> Motion {
        self.at((time_ns.clamp(self.start_ns, self.end_ns) - self.start_ns) as f64 * 1e-9)
    }

    fn at(&self, time_s: f64) -> Motion {
        let last = self.poses - 2;
        let times = &self.knots[2..self.poses + 2];
        let segment = times.partition_point(|knot| *knot <= time_s).saturating_sub(1).min(last);
        let window = self.knots[segment..segment + 6].try_into().expect("six knots are around a segment");
        let basis = Basis::at(window, time_s);
        let [position, velocity, acceleration] = basis.plain().map(|weights| {
            let controls = &self.positions[segment..segment + 4];
            controls.iter().zip(weights).map(|(control, weight)| control * weight).sum::<Vector3<f64>>()
        });
        let (rotation, turn, turn_change) = self.rotation(segment, &basis);
        let pose = Isometry3::from_parts(Translation3::from(position), rotation);
        Motion { pose, velocity, acceleration, turn, turn_change }
    }

    fn rotation(&self, segment: usize, basis: &Basis) -> (UnitQuaternion<f64>, Vector3<f64>, Vector3<f64>) {
        let [shares, rates, changes] = basis.cumulative();
        let mut rotation = self.rotations[segment];
        let (mut turn, mut turn_change) = (Vector3::zeros(), Vector3::zeros());
        for step in 0..3 {
            let [from, to] = [0, 1].map(|k| self.rotations[segment + step + k]);
            let axis = log(&(from.inverse() * to));
            let part = exp(&(axis * shares[step]));
            let back = part.inverse();
            turn = back * turn + axis * rates[step];
            turn_change = back * turn_change + turn.cross(&(axis * rates[step])) + axis * changes[step];
            rotation *= part;
        }
        (UnitQuaternion::new_normalize(rotation.into_inner()), turn, turn_change)
    }

    /// Moves the control poses until the path passes through the given ones.
    fn fit(&mut self, poses: &[Stamped], times: &[f64]) -> Result<(), RecordError> {
        for _ in 0..MOST_CORRECTIONS {
            self.extend();
            let found: Vec<Isometry3<f64>> = times.iter().map(|time_s| self.at(*time_s).pose).collect();
            let mut worst: f64 = 0.0;
            for (number, (given, found)) in poses.iter().zip(found).enumerate() {
                let shift = given.pose.translation.vector - found.translation.vector;
                let turn = log(&(found.rotation.inverse() * given.pose.rotation));
                self.positions[number + 1] += shift;
                self.rotations[number + 1] *= exp(&turn);
                worst = worst.max(shift.norm()).max(turn.norm());
            }
            if worst < WITHIN * 0.01 {
                self.extend();
                return Ok(());
            }
        }
        Err(RecordError::path("has times too uneven for a smooth path", "space the poses more evenly in time"))
    }

    /// Places the control poses beyond both ends in line with the two next to them.
    fn extend(&mut self) {
        let end = self.positions.len() - 1;
        for [beyond, near, far] in [[0, 1, 2], [end, end - 1, end - 2]] {
            self.positions[beyond] = 2.0 * self.positions[near] - self.positions[far];
            self.rotations[beyond] = self.rotations[near] * (self.rotations[far].inverse() * self.rotations[near]);
        }
    }
}

/// The times with two more at either end, as far apart as the two there.
fn extended(times: &[f64]) -> Vec<f64> {
    let end = times.len() - 1;
    let (first, last) = (times[1] - times[0], times[end] - times[end - 1]);
    let before = [2.0, 1.0].map(|steps| times[0] - steps * first);
    let after = [1.0, 2.0].map(|steps| times[end] + steps * last);
    before.into_iter().chain(times.iter().copied()).chain(after).collect()
}

/// The rotation about a vector by its length in radians; not nalgebra's, because libm gives the same bits everywhere.
pub(crate) fn exp(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = 0.5 * axis.norm();
    let share = if half < 1e-6 { 0.5 * (1.0 - half * half / 6.0) } else { 0.5 * libm::sin(half) / half };
    UnitQuaternion::new_normalize(Quaternion::from_parts(libm::cos(half), axis * share))
}

/// The inverse of [`exp`], up to half a turn.
fn log(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let (w, axis) = (rotation.w, rotation.imag());
    let (w, axis) = if w < 0.0 { (-w, -axis) } else { (w, axis) };
    let sine = axis.norm();
    if sine < 1e-9 { axis * 2.0 } else { axis * (2.0 * libm::atan2(sine, w) / sine) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A helix that also rolls and nods, with uneven times.
    fn helix() -> Vec<Stamped> {
        let pose = |n: i32| {
            let s = f64::from(n) * 0.1 + 0.02 * libm::sin(f64::from(n));
            let turn =
                exp(&Vector3::new(0.0, 0.0, s)) * exp(&Vector3::new(0.2 * libm::sin(s), 0.3 * libm::cos(s), 0.0));
            let place = Translation3::new(2.0 * libm::cos(s), 2.0 * libm::sin(s), 0.3 * s);
            Stamped { time_ns: 1_000_000_000_000 + (s * 1e9) as i64, pose: Isometry3::from_parts(place, turn) }
        };
        (0..40).map(pose).collect()
    }

    #[test]
    fn it_passes_through_every_pose() {
        let poses = helix();
        let path = Trajectory::through(&poses).unwrap();
        for given in &poses {
            let found = path.at_ns(given.time_ns).pose;
            assert!((found.translation.vector - given.pose.translation.vector).norm() < WITHIN);
            assert!(log(&(found.rotation.inverse() * given.pose.rotation)).norm() < WITHIN);
        }
    }

    #[test]
    fn rates_are_the_differences_of_poses() {
        let path = Trajectory::through(&helix()).unwrap();
        let step_ns = 20_000;
        let step_s = step_ns as f64 * 1e-9;
        for n in 1..300 {
            let time_ns = path.start_ns() + n * 13_000_000 % (path.end_ns() - path.start_ns());
            let [before, now, after] = [-1, 0, 1].map(|k| path.at_ns(time_ns + k * step_ns));
            let velocity = (after.pose.translation.vector - before.pose.translation.vector) / (2.0 * step_s);
            assert!((velocity - now.velocity).norm() < 1e-6, "{n}");
            let acceleration = (after.velocity - before.velocity) / (2.0 * step_s);
            assert!((acceleration - now.acceleration).norm() < 1e-3, "{n}");
            let turn = log(&(before.pose.rotation.inverse() * after.pose.rotation)) / (2.0 * step_s);
            assert!((turn - now.turn).norm() < 1e-6, "{n}");
            let change = (after.turn - before.turn) / (2.0 * step_s);
            assert!((change - now.turn_change).norm() < 1e-3, "{n}: {change} {}", now.turn_change);
        }
    }

    #[test]
    fn accelerations_have_no_jumps() {
        let poses = helix();
        let path = Trajectory::through(&poses).unwrap();
        for given in &poses[1..poses.len() - 1] {
            let [before, after] = [-1, 1].map(|ns| path.at_ns(given.time_ns + ns));
            assert!((before.acceleration - after.acceleration).norm() < 1e-5);
            assert!((before.turn_change - after.turn_change).norm() < 1e-5);
        }
    }

    #[test]
    fn unordered_and_single_poses_are_refused() {
        let mut poses = helix();
        assert!(Trajectory::through(&poses[..1]).is_err());
        poses.swap(3, 4);
        assert!(Trajectory::through(&poses).unwrap_err().to_string().contains("is not after"));
    }
}
