//! Layout `tum`: the TUM RGB-D benchmark (Sturm, Engelhard, Endres, Burgard and Cremers 2012).
//!
//! ```text
//! rgb/<time>.png, depth/<time>.png      of the first camera; 5000 units of depth per metre
//! <output>/<time>.png                   its other outputs
//! <camera>/<output>/<time>.png          outputs of other cameras
//! <lidar>/<time>.pcd                    sweeps
//! rgb.txt, depth.txt, associations.txt  times and files
//! groundtruth.txt                       poses of the first camera's optical frame, or of the body without a camera
//! accelerometer.txt, imu.csv            of the IMU
//! odometry.txt, odometry.csv            poses and speeds by the wheels
//! orbslam3.yaml, <camera>.yaml          calibration for ORB-SLAM3, and for ROS and RTAB-Map
//! ```
//! Follows <https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats>.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use rayon::prelude::*;

use super::{calibration, pcd};
use crate::error::RecordError;
use crate::inertial::{Inertia, Wheeled};
use crate::layout::{Layout, LayoutRow, Out};
use crate::lidar::Sweep;
use crate::picture::Frame;
use crate::rig::{Output, Rig};
use crate::trajectory::{Trajectory, tum};

/// The row of this layout.
pub const ROW: LayoutRow = LayoutRow {
    name: "tum",
    summary: "TUM RGB-D: PNG images and depth, text files; point clouds as PCD",
    check: |_| Ok(()),
    begin: |rig, path| {
        let (rig, path) = (rig.clone(), path.clone());
        Box::new(Tum { rig, path, times: Vec::new(), inertia: Vec::new(), wheeled: Vec::new() })
    },
};

/// The factor of the benchmark.
const UNITS_PER_M: f32 = 5000.0;
/// How often the true pose is told, besides at every image.
const TRUTH_NS: usize = 10_000_000;

struct Tum {
    rig: Rig,
    path: Trajectory,
    /// Times of the first camera.
    times: Vec<i64>,
    inertia: Vec<Inertia>,
    wheeled: Vec<Wheeled>,
}

impl Layout for Tum {
    fn frame(&mut self, frame: &Frame, out: &mut Out) -> Result<(), RecordError> {
        let time = tum::seconds(frame.time_ns);
        let files: Vec<_> = frame.pictures.par_iter().map(|picture| picture.png(UNITS_PER_M)).collect();
        for (picture, file) in frame.pictures.iter().zip(files) {
            out.bytes(&format!("{}/{time}.png", self.folder(frame.camera, picture.output)), &file?)?;
        }
        if frame.camera == 0 {
            self.times.push(frame.time_ns);
        }
        Ok(())
    }

    fn sweep(&mut self, sweep: &Sweep, out: &mut Out) -> Result<(), RecordError> {
        let name = &self.rig.lidars[sweep.lidar].name;
        out.bytes(&format!("{name}/{}.pcd", tum::seconds(sweep.time_ns)), &pcd::encode(sweep))
    }

    fn inertia(&mut self, told: &Inertia) {
        self.inertia.push(*told);
    }

    fn wheeled(&mut self, told: &Wheeled) {
        self.wheeled.push(*told);
    }

    fn finish(&mut self, out: &mut Out) -> Result<(), RecordError> {
        self.lists(out)?;
        out.bytes("groundtruth.txt", self.truth().as_bytes())?;
        if !self.inertia.is_empty() {
            let (accelerometer, imu) = inertia(&self.inertia);
            out.bytes("accelerometer.txt", accelerometer.as_bytes())?;
            out.bytes("imu.csv", imu.as_bytes())?;
        }
        if !self.wheeled.is_empty() {
            let (poses, speeds) = wheeled(&self.wheeled);
            out.bytes("odometry.txt", poses.as_bytes())?;
            out.bytes("odometry.csv", speeds.as_bytes())?;
        }
        if let Some(text) = calibration::orb_slam3(&self.rig, UNITS_PER_M) {
            out.bytes("orbslam3.yaml", text.as_bytes())?;
        }
        for camera in &self.rig.cameras {
            out.bytes(&format!("{}.yaml", camera.name), calibration::camera_info(camera).as_bytes())?;
        }
        Ok(())
    }
}

impl Tum {
    fn folder(&self, camera: usize, output: Output) -> String {
        let name = match output {
            Output::Image => "rgb",
            other => other.name(),
        };
        if camera == 0 { name.to_owned() } else { format!("{}/{name}", self.rig.cameras[camera].name) }
    }

    /// The lists of images of the first camera.
    fn lists(&self, out: &mut Out) -> Result<(), RecordError> {
        let Some(camera) = self.rig.cameras.first() else { return Ok(()) };
        let list = |folder: &str, title: &str| {
            let lines = self.times.iter().map(|time_ns| tum::seconds(*time_ns));
            let lines = lines.map(|time| format!("{time} {folder}/{time}.png\n")).collect::<String>();
            format!("# {title}\n# timestamp filename\n{lines}")
        };
        let [has_image, has_depth] = [Output::Image, Output::Depth].map(|output| camera.outputs.contains(&output));
        if has_image {
            out.bytes("rgb.txt", list("rgb", "colour images").as_bytes())?;
        }
        if has_depth {
            out.bytes("depth.txt", list("depth", "depth images, 5000 units per metre").as_bytes())?;
        }
        if has_image && has_depth {
            let lines = self.times.iter().map(|time_ns| tum::seconds(*time_ns));
            let lines: String = lines.map(|time| format!("{time} rgb/{time}.png {time} depth/{time}.png\n")).collect();
            out.bytes("associations.txt", lines.as_bytes())?;
        }
        Ok(())
    }

    fn truth(&self) -> String {
        let path = &self.path;
        let mut times: BTreeSet<i64> = self.times.iter().copied().collect();
        times.extend((path.start_ns()..=path.end_ns()).step_by(TRUTH_NS));
        let camera = self.rig.cameras.first().map(|camera| camera.body_from_optical());
        let what = if camera.is_some() { "the first camera's optical frame" } else { "the body" };
        let mut text = format!("# true poses of {what}\n# timestamp tx ty tz qx qy qz qw\n");
        for time_ns in times {
            let pose = path.at_ns(time_ns).pose;
            text += &tum::line(time_ns, &camera.map_or(pose, |camera| pose * camera));
            text.push('\n');
        }
        text
    }
}

/// `accelerometer.txt` and `imu.csv`.
fn inertia(told: &[Inertia]) -> (String, String) {
    let mut accelerometer = "# accelerometer data\n# timestamp ax ay az\n".to_owned();
    let mut imu = "timestamp,wx,wy,wz,ax,ay,az\n".to_owned();
    for Inertia { time_ns, gyro, accel, .. } in told {
        let time = tum::seconds(*time_ns);
        let ([wx, wy, wz], [ax, ay, az]): ([f64; 3], [f64; 3]) = ((*gyro).into(), (*accel).into());
        writeln!(accelerometer, "{time} {ax:.9} {ay:.9} {az:.9}").expect("a string grows");
        writeln!(imu, "{time},{wx:.9},{wy:.9},{wz:.9},{ax:.9},{ay:.9},{az:.9}").expect("a string grows");
    }
    (accelerometer, imu)
}

/// `odometry.txt` and `odometry.csv`.
fn wheeled(told: &[Wheeled]) -> (String, String) {
    let mut poses = "# poses by wheel odometry, from the start\n# timestamp tx ty tz qx qy qz qw\n".to_owned();
    let mut speeds = "timestamp,speed,turn\n".to_owned();
    for told in told {
        writeln!(poses, "{}", tum::line(told.time_ns, &told.isometry())).expect("a string grows");
        writeln!(speeds, "{},{:.9},{:.9}", tum::seconds(told.time_ns), told.speed, told.turn).expect("a string grows");
    }
    (poses, speeds)
}
