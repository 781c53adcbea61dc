//! Layout `euroc`: the EuRoC MAV data sets in the format of ASL (Burri et al. 2016).
//!
//! ```text
//! mav0/cam<n>/data/<ns>.png, data.csv, sensor.yaml         images
//! mav0/cam<n>/<output>/<ns>.png                            other outputs; 5000 units of depth per metre
//! mav0/imu0/data.csv, sensor.yaml
//! mav0/lidar<n>/data/<ns>.pcd, data.csv, sensor.yaml       sweeps, which EuRoC has not
//! mav0/odometry0/data.csv                                  wheels, which EuRoC has not
//! mav0/state_groundtruth_estimate0/data.csv, sensor.yaml   poses, velocities and biases at the times of the IMU, or of images
//! orbslam3.yaml
//! ```
//! Images are in colour. Follows the description with the data sets,
//! <https://projects.asl.ethz.ch/datasets/doku.php?id=kmavvisualinertialdatasets>.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Vector3};
use rayon::prelude::*;

use super::calibration::{coefficients, decimal, intrinsics, orb_slam3, row_major};
use super::pcd;
use crate::error::RecordError;
use crate::inertial::{Inertia, Wheeled};
use crate::layout::{Layout, LayoutRow, Out};
use crate::lens::Lens;
use crate::lidar::Sweep;
use crate::picture::Frame;
use crate::rig::{Camera, Imu, Output, Rig};
use crate::trajectory::Trajectory;

/// The row of this layout.
pub const ROW: LayoutRow = LayoutRow {
    name: "euroc",
    summary: "EuRoC MAV (ASL): images, IMU and states as CSV, a sensor.yaml each",
    check: |rig| match rig.cameras.is_empty() && rig.imu.is_none() {
        true => Err(("needs a camera or an IMU".to_owned(), "add one to the rig, or choose another layout")),
        false => Ok(()),
    },
    begin: |rig, path| {
        let times = [vec![Vec::new(); rig.cameras.len()], vec![Vec::new(); rig.lidars.len()]];
        let (rig, path) = (rig.clone(), path.clone());
        Box::new(Euroc { rig, path, times, inertia: Vec::new(), wheeled: Vec::new() })
    },
};

const UNITS_PER_M: f32 = 5000.0;

struct Euroc {
    rig: Rig,
    path: Trajectory,
    /// Times of cameras and of lidars.
    times: [Vec<Vec<i64>>; 2],
    inertia: Vec<Inertia>,
    wheeled: Vec<Wheeled>,
}

impl Layout for Euroc {
    fn frame(&mut self, frame: &Frame, out: &mut Out) -> Result<(), RecordError> {
        self.times[0][frame.camera].push(frame.time_ns);
        let files: Vec<_> = frame.pictures.par_iter().map(|picture| picture.png(UNITS_PER_M)).collect();
        for (picture, file) in frame.pictures.iter().zip(files) {
            let folder = if picture.output == Output::Image { "data" } else { picture.output.name() };
            out.bytes(&format!("mav0/cam{}/{folder}/{}.png", frame.camera, frame.time_ns), &file?)?;
        }
        Ok(())
    }

    fn sweep(&mut self, sweep: &Sweep, out: &mut Out) -> Result<(), RecordError> {
        self.times[1][sweep.lidar].push(sweep.time_ns);
        out.bytes(&format!("mav0/lidar{}/data/{}.pcd", sweep.lidar, sweep.time_ns), &pcd::encode(sweep))
    }

    fn inertia(&mut self, told: &Inertia) {
        self.inertia.push(*told);
    }

    fn wheeled(&mut self, told: &Wheeled) {
        self.wheeled.push(*told);
    }

    fn finish(&mut self, out: &mut Out) -> Result<(), RecordError> {
        for (number, camera) in self.rig.cameras.iter().enumerate() {
            out.bytes(&format!("mav0/cam{number}/data.csv"), list(&self.times[0][number], "png").as_bytes())?;
            out.bytes(&format!("mav0/cam{number}/sensor.yaml"), of_camera(camera).as_bytes())?;
        }
        for (number, lidar) in self.rig.lidars.iter().enumerate() {
            let about = sensor("lidar", &lidar.name, &lidar.body_from_lidar(), Some(lidar.rate_hz));
            out.bytes(&format!("mav0/lidar{number}/data.csv"), list(&self.times[1][number], "pcd").as_bytes())?;
            out.bytes(&format!("mav0/lidar{number}/sensor.yaml"), about.as_bytes())?;
        }
        if let Some(imu) = &self.rig.imu {
            out.bytes("mav0/imu0/data.csv", inertia(&self.inertia).as_bytes())?;
            out.bytes("mav0/imu0/sensor.yaml", of_imu(imu).as_bytes())?;
        }
        if !self.wheeled.is_empty() {
            out.bytes("mav0/odometry0/data.csv", wheeled(&self.wheeled).as_bytes())?;
        }
        let truth = "mav0/state_groundtruth_estimate0";
        let about = sensor("visual-inertial", "true states", &Isometry3::identity(), None);
        out.bytes(&format!("{truth}/data.csv"), self.states().as_bytes())?;
        out.bytes(&format!("{truth}/sensor.yaml"), about.as_bytes())?;
        match orb_slam3(&self.rig, UNITS_PER_M) {
            Some(text) => out.bytes("orbslam3.yaml", text.as_bytes()),
            None => Ok(()),
        }
    }
}

impl Euroc {
    fn states(&self) -> String {
        let biased = |told: &Inertia| (told.time_ns, told.gyro_bias, told.accel_bias);
        let moments: Vec<(i64, Vector3<f64>, Vector3<f64>)> = match (&self.inertia[..], self.times[0].first()) {
            ([], Some(times)) => times.iter().map(|time_ns| (*time_ns, Vector3::zeros(), Vector3::zeros())).collect(),
            (told, _) => told.iter().map(biased).collect(),
        };
        let mut text =
            "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], \
            v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], \
            b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n"
                .to_owned();
        for (time_ns, gyro_bias, accel_bias) in moments {
            let motion = self.path.at_ns(time_ns);
            let [i, j, k, w]: [f64; 4] = motion.pose.rotation.coords.into();
            let place: [f64; 3] = motion.pose.translation.vector.into();
            let rest = [motion.velocity, gyro_bias, accel_bias].map(<[f64; 3]>::from);
            row(&mut text, time_ns, place.into_iter().chain([w, i, j, k]).chain(rest.into_iter().flatten()));
        }
        text
    }
}

fn list(times: &[i64], ending: &str) -> String {
    let lines = times.iter().map(|time_ns| format!("{time_ns},{time_ns}.{ending}\n"));
    format!("#timestamp [ns],filename\n{}", lines.collect::<String>())
}

fn row(text: &mut String, time_ns: i64, numbers: impl Iterator<Item = f64>) {
    write!(text, "{time_ns}").expect("a string grows");
    numbers.for_each(|number| write!(text, ",{number:.9}").expect("a string grows"));
    text.push('\n');
}

fn inertia(told: &[Inertia]) -> String {
    let mut text = "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],\
        a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
        .to_owned();
    for told in told {
        row(&mut text, told.time_ns, told.gyro.iter().chain(told.accel.iter()).copied());
    }
    text
}

fn wheeled(told: &[Wheeled]) -> String {
    let mut text = "#timestamp [ns],x [m],y [m],heading [rad],speed [m s^-1],turn [rad s^-1]\n".to_owned();
    for told in told {
        row(&mut text, told.time_ns, told.pose.into_iter().chain([told.speed, told.turn]));
    }
    text
}

/// What all files about sensors begin with.
fn sensor(kind: &str, comment: &str, body_from_sensor: &Isometry3<f64>, rate_hz: Option<f64>) -> String {
    let matrix = row_major(body_from_sensor);
    let rate = rate_hz.map(|rate_hz| format!("rate_hz: {}\n", decimal(rate_hz))).unwrap_or_default();
    format!("sensor_type: {kind}\ncomment: {comment}\nT_BS:\n  cols: 4\n  rows: 4\n  data: [{matrix}]\n{rate}")
}

fn of_camera(camera: &Camera) -> String {
    let lens = Lens::of(camera);
    let numbers = |numbers: &[f64]| numbers.iter().map(|number| decimal(*number)).collect::<Vec<_>>().join(", ");
    let mut distortion: Vec<f64> = coefficients(&lens).into_iter().map(|(_, value)| value).collect();
    if distortion.len() == 5 && distortion[4] == 0.0 {
        distortion.pop();
    }
    let model = if lens.is_fisheye() { "equidistant" } else { "radial-tangential" };
    let [width, height] = lens.size;
    format!(
        "{}resolution: [{width}, {height}]\ncamera_model: pinhole\nintrinsics: [{}]\ndistortion_model: {model}\n\
         distortion_coefficients: [{}]\ndepth_units_per_m: {UNITS_PER_M:.1}\n",
        sensor("camera", &camera.name, &camera.body_from_optical(), Some(camera.rate_hz)),
        numbers(&intrinsics(&lens)),
        numbers(&distortion)
    )
}

fn of_imu(imu: &Imu) -> String {
    let head = sensor("imu", "imu", &imu.body_from_imu(), Some(imu.rate_hz));
    let [gyro_noise, gyro_walk, accel_noise, accel_walk] =
        [imu.gyro_noise, imu.gyro_walk, imu.accel_noise, imu.accel_walk].map(decimal);
    format!(
        "{head}gyroscope_noise_density: {gyro_noise}\ngyroscope_random_walk: {gyro_walk}\n\
         accelerometer_noise_density: {accel_noise}\naccelerometer_random_walk: {accel_walk}\n"
    )
}
