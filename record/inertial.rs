//! What an inertial measurement unit and wheels tell of a motion.
//!
//! The IMU has white noise and biases that walk at random, drawn per measurement as in O. J. Woodman, "An Introduction to Inertial
//! Navigation" (2007) and Kalibr's wiki: a density σ gives σ/√dt, a walk σ_b moves the bias by σ_b·√dt. Biases begin at zero.

use nalgebra::{Isometry3, Vector3};
use plume_graph::rng::Rng;
use plume_graph::seed::stream;

use crate::rig::{Imu, Odometry};
use crate::trajectory::{Motion, exp};

/// A measurement of the IMU, in its own frame.
#[derive(Clone, Copy, Debug)]
pub struct Inertia {
    /// When.
    pub time_ns: i64,
    /// Rate of rotation in rad/s.
    pub gyro: Vector3<f64>,
    /// Specific force in m/s²: at rest it points up.
    pub accel: Vector3<f64>,
    /// Bias of the gyroscope, which is part of the measurement.
    pub gyro_bias: Vector3<f64>,
    /// Bias of the accelerometer, which is part of the measurement.
    pub accel_bias: Vector3<f64>,
}

/// An IMU during a run.
pub struct Unit {
    settings: Imu,
    body_from_imu: Isometry3<f64>,
    gravity: f64,
    rng: Rng,
    gyro_bias: Vector3<f64>,
    accel_bias: Vector3<f64>,
}

impl Unit {
    /// At the start of a run; `gravity` is in m/s².
    pub fn new(settings: &Imu, gravity: f64, seed: u64) -> Self {
        Self {
            settings: settings.clone(),
            body_from_imu: settings.body_from_imu(),
            gravity,
            rng: Rng::new(stream(seed, "imu", 0)),
            gyro_bias: Vector3::zeros(),
            accel_bias: Vector3::zeros(),
        }
    }

    /// The next measurement.
    pub fn measure(&mut self, time_ns: i64, motion: &Motion) -> Inertia {
        let (gyro, accel) = self.felt(motion);
        let Imu { rate_hz, gyro_noise, gyro_walk, accel_noise, accel_walk, .. } = self.settings;
        let (often, step) = (rate_hz.sqrt(), 1.0 / rate_hz.sqrt());
        let measured = Inertia {
            time_ns,
            gyro: gyro + self.gyro_bias + self.draw() * (gyro_noise * often),
            accel: accel + self.accel_bias + self.draw() * (accel_noise * often),
            gyro_bias: self.gyro_bias,
            accel_bias: self.accel_bias,
        };
        let steps = [gyro_walk, accel_walk].map(|walk| self.draw() * (walk * step));
        self.gyro_bias += steps[0];
        self.accel_bias += steps[1];
        measured
    }

    /// Without noise.
    fn felt(&self, motion: &Motion) -> (Vector3<f64>, Vector3<f64>) {
        let Motion { pose, acceleration, turn, turn_change, .. } = motion;
        let arm = self.body_from_imu.translation.vector;
        let of_arm = turn_change.cross(&arm) + turn.cross(&turn.cross(&arm));
        let force = pose.rotation.inverse() * (acceleration + Vector3::z() * self.gravity) + of_arm;
        let into = self.body_from_imu.rotation.inverse();
        (into * turn, into * force)
    }

    fn draw(&mut self) -> Vector3<f64> {
        Vector3::from([(); 3].map(|()| self.rng.normal()))
    }
}

/// What wheels tell: a pose that drifts, in the frame of the body at the start, and the speeds.
#[derive(Clone, Copy, Debug)]
pub struct Wheeled {
    /// When.
    pub time_ns: i64,
    /// Place and heading in the plane of the wheels: metres and radians.
    pub pose: [f64; 3],
    /// Ahead, in m/s.
    pub speed: f64,
    /// About the upward axis, in rad/s.
    pub turn: f64,
}

/// Wheels during a run.
pub struct Wheels {
    settings: Odometry,
    rng: Rng,
    scales: [f64; 2],
    pose: [f64; 3],
}

impl Wheels {
    /// At the start of a run.
    pub fn new(settings: &Odometry, seed: u64) -> Self {
        let mut rng = Rng::new(stream(seed, "odometry", 0));
        let scales = [(); 2].map(|()| 1.0 + settings.scale_error * rng.normal());
        Self { settings: settings.clone(), rng, scales, pose: [0.0; 3] }
    }

    /// The next measurement.
    pub fn measure(&mut self, time_ns: i64, motion: &Motion) -> Wheeled {
        let Odometry { rate_hz, speed_noise, turn_noise, .. } = self.settings;
        let ahead = (motion.pose.rotation.inverse() * motion.velocity).x;
        let speed = ahead * (self.scales[0] + speed_noise * self.rng.normal());
        let turn = motion.turn.z * (self.scales[1] + turn_noise * self.rng.normal());
        let told = Wheeled { time_ns, pose: self.pose, speed, turn };
        let [x, y, heading] = self.pose;
        let middle = heading + 0.5 * turn / rate_hz;
        let way = speed / rate_hz;
        self.pose = [x + way * libm::cos(middle), y + way * libm::sin(middle), heading + turn / rate_hz];
        told
    }
}

impl Wheeled {
    /// The pose in space.
    pub fn isometry(&self) -> Isometry3<f64> {
        let [x, y, heading] = self.pose;
        Isometry3::from_parts(Vector3::new(x, y, 0.0).into(), exp(&(Vector3::z() * heading)))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;

    fn still() -> Motion {
        Motion {
            pose: Isometry3::identity(),
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            turn: Vector3::zeros(),
            turn_change: Vector3::zeros(),
        }
    }

    fn quiet() -> Imu {
        Imu { gyro_noise: 0.0, gyro_walk: 0.0, accel_noise: 0.0, accel_walk: 0.0, ..Imu::default() }
    }

    #[test]
    fn at_rest_it_feels_gravity_upwards() {
        let mut unit = Unit::new(&Imu { rpy_deg: [0.0, 90.0, 0.0], ..quiet() }, 9.81, 1);
        let told = unit.measure(0, &still());
        assert!((told.accel - Vector3::new(-9.81, 0.0, 0.0)).norm() < 1e-12, "nodding down, its x axis points down");
        assert_eq!(told.gyro.norm(), 0.0);
    }

    #[test]
    fn an_arm_feels_the_turn() {
        let mut unit = Unit::new(&Imu { position_m: [0.5, 0.0, 0.0], ..quiet() }, 0.0, 1);
        let motion = Motion { turn: Vector3::z() * 2.0, turn_change: Vector3::z() * 3.0, ..still() };
        assert!((unit.measure(0, &motion).accel - Vector3::new(-2.0, 1.5, 0.0)).norm() < 1e-12);
    }

    /// Allan deviations of white noise and of its integral.
    #[test]
    fn noise_has_the_densities_of_the_rig() {
        let imu = Imu { gyro_noise: 0.01, gyro_walk: 0.0, accel_noise: 0.0, accel_walk: 0.02, ..Imu::default() };
        let mut unit = Unit::new(&imu, 0.0, 5);
        let told: Vec<Inertia> = (0..20_000).map(|n| unit.measure(n, &still())).collect();
        let gyro = told.iter().map(|told| told.gyro.x * told.gyro.x).sum::<f64>() / told.len() as f64;
        assert!((gyro.sqrt() / (0.01 * 200_f64.sqrt()) - 1.0).abs() < 0.03, "{gyro}");
        let steps = told.windows(2).map(|pair| pair[1].accel_bias.y - pair[0].accel_bias.y);
        let walk = steps.map(|step| step * step).sum::<f64>() / told.len() as f64;
        assert!((walk.sqrt() / (0.02 / 200_f64.sqrt()) - 1.0).abs() < 0.03, "{walk}");
    }

    #[test]
    fn quiet_wheels_follow_a_circle() {
        let settings = Odometry { rate_hz: 100.0, speed_noise: 0.0, turn_noise: 0.0, scale_error: 0.0 };
        let mut wheels = Wheels::new(&settings, 1);
        let mut last = None;
        for n in 0..=100 {
            let rotation = UnitQuaternion::identity();
            let pose = Isometry3::from_parts(Vector3::zeros().into(), rotation);
            let motion = Motion { pose, velocity: Vector3::x(), turn: Vector3::z(), ..still() };
            last = Some(wheels.measure(n, &motion));
        }
        let [x, y, heading] = last.unwrap().pose;
        assert!(
            (x - libm::sin(1.0)).abs() < 1e-4
                && (y - (1.0 - libm::cos(1.0))).abs() < 1e-4
                && (heading - 1.0).abs() < 1e-9
        );
    }
}
