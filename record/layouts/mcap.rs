//! Layout `mcap`: one file of ROS 2 messages, as `ros2 bag` records and Foxglove shows them.
//!
//! | topic | message | |
//! |---|---|---|
//! | `/<camera>/image_raw`, `/<camera>/<output>` | `sensor_msgs/Image` | `rgb8`; depth `32FC1` in metres, NaN where there is none; labels `mono8`, things `16UC1`, normals `32FC3`, flow `32FC2` |
//! | `/<camera>/camera_info` | `sensor_msgs/CameraInfo` | `plumb_bob` or `equidistant` |
//! | `/<lidar>/points` | `sensor_msgs/PointCloud2` | x, y, z, intensity, ring, time; not corrected for motion |
//! | `/imu` | `sensor_msgs/Imu` | no orientation |
//! | `/odom` | `nav_msgs/Odometry` | by the wheels: `odom` to `base_link` |
//! | `/truth` | `nav_msgs/Odometry` | `world` to `base_link` |
//! | `/tf`, `/tf_static` | `tf2_msgs/TFMessage` | `odom` to `base_link` by the wheels, or `world` to `base_link` without; the sensors |
//!
//! Follows REP 103, 105 and 118. The file is `recording.mcap`.

use std::fs::File;
use std::io::BufWriter;

use nalgebra::{Isometry3, Vector3};
use plume_exporters::format::ros2::{Bag, Cdr, Kind, Message};
use tempfile::TempDir;

use super::calibration::{coefficients, intrinsics};
use crate::error::RecordError;
use crate::inertial::{Inertia, Wheeled};
use crate::layout::{Layout, LayoutRow, Out};
use crate::lens::Lens;
use crate::lidar::Sweep;
use crate::picture::{Frame, Picture, Pixels};
use crate::rig::{Output, Rig};
use crate::trajectory::Trajectory;

mod message;

/// The row of this layout.
pub const ROW: LayoutRow = LayoutRow {
    name: "mcap",
    summary: "MCAP: ROS 2 messages in one file",
    check: |_| Ok(()),
    begin: |rig, path| Box::new(Mcap { rig: rig.clone(), path: path.clone(), told: Vec::new(), open: None }),
};

const FILE: &str = "recording.mcap";
const BASE: &str = "base_link";
const WORLD: &str = "world";
const ODOM: &str = "odom";

struct Mcap {
    rig: Rig,
    path: Trajectory,
    /// Messages of what needs no file, until the next that does.
    told: Vec<Message>,
    open: Option<Open>,
}

/// The file while it grows.
struct Open {
    folder: TempDir,
    bag: Bag<BufWriter<File>>,
}

impl Layout for Mcap {
    fn frame(&mut self, frame: &Frame, out: &mut Out) -> Result<(), RecordError> {
        let camera = &self.rig.cameras[frame.camera];
        let name = camera.name.clone();
        self.tell(
            format!("/{name}/camera_info"),
            &message::CAMERA_INFO,
            frame.time_ns,
            camera_info(&Lens::of(camera), &name, frame.time_ns),
        );
        for picture in &frame.pictures {
            let topic = if picture.output == Output::Image { "image_raw" } else { picture.output.name() };
            self.tell(format!("/{name}/{topic}"), &message::IMAGE, frame.time_ns, image(picture, &name, frame.time_ns));
        }
        self.truth(frame.time_ns);
        self.write(out)
    }

    fn sweep(&mut self, sweep: &Sweep, out: &mut Out) -> Result<(), RecordError> {
        let name = self.rig.lidars[sweep.lidar].name.clone();
        self.tell(format!("/{name}/points"), &message::POINTS, sweep.time_ns, points(sweep, &name));
        self.truth(sweep.time_ns);
        self.write(out)
    }

    fn inertia(&mut self, told: &Inertia) {
        self.tell("/imu".into(), &message::IMU, told.time_ns, inertia(told));
    }

    fn wheeled(&mut self, told: &Wheeled) {
        let (pose, turn) = (told.isometry(), Vector3::new(0.0, 0.0, told.turn));
        let data = odometry(ODOM, told.time_ns, &pose, &Vector3::new(told.speed, 0.0, 0.0), &turn);
        self.tell("/odom".into(), &message::ODOMETRY, told.time_ns, data);
        self.tell("/tf".into(), &message::TF, told.time_ns, transforms(told.time_ns, &[(ODOM, BASE, pose)]));
        self.truth(told.time_ns);
    }

    fn finish(&mut self, out: &mut Out) -> Result<(), RecordError> {
        self.write(out)?;
        let Some(Open { folder, bag }) = self.open.take() else { return Ok(()) };
        bag.finish()?;
        let path = format!("{}{FILE}", out.folder);
        Ok(out.package.copy(&path, &folder.path().join(FILE))?)
    }
}

impl Mcap {
    fn tell(&mut self, topic: String, kind: &'static Kind, time_ns: i64, data: Vec<u8>) {
        self.told.push(Message { topic, kind, time_ns, data, is_latched: false });
    }

    fn truth(&mut self, time_ns: i64) {
        let motion = self.path.at_ns(time_ns);
        let velocity = motion.pose.rotation.inverse() * motion.velocity;
        let data = odometry(WORLD, time_ns, &motion.pose, &velocity, &motion.turn);
        self.tell("/truth".into(), &message::ODOMETRY, time_ns, data);
        if self.rig.odometry.is_none() {
            self.tell("/tf".into(), &message::TF, time_ns, transforms(time_ns, &[(WORLD, BASE, motion.pose)]));
        }
    }

    /// Writes what has been told.
    fn write(&mut self, out: &mut Out) -> Result<(), RecordError> {
        let open = match &mut self.open {
            Some(open) => open,
            none => {
                let mut open = Open::begin(out)?;
                let (topic, time_ns) = ("/tf_static".to_owned(), self.path.start_ns());
                let data = transforms(time_ns, &mounts(&self.rig));
                open.bag.write(Message { topic, kind: &message::TF, time_ns, data, is_latched: true })?;
                none.insert(open)
            }
        };
        for message in self.told.drain(..) {
            open.bag.write(message)?;
        }
        Ok(())
    }
}

impl Open {
    fn begin(out: &mut Out) -> Result<Self, RecordError> {
        let folder = out.package.scratch()?;
        let file = BufWriter::new(File::create_new(folder.path().join(FILE))?);
        Ok(Self { folder, bag: Bag::create(file)? })
    }
}

/// The sensors on the body.
fn mounts(rig: &Rig) -> Vec<(&str, &str, Isometry3<f64>)> {
    let cameras = rig.cameras.iter().map(|camera| (BASE, &*camera.name, camera.body_from_optical()));
    let lidars = rig.lidars.iter().map(|lidar| (BASE, &*lidar.name, lidar.body_from_lidar()));
    let imu = rig.imu.iter().map(|imu| (BASE, "imu", imu.body_from_imu()));
    cameras.chain(lidars).chain(imu).collect()
}

fn image(picture: &Picture, frame: &str, time_ns: i64) -> Vec<u8> {
    let [width, height] = picture.size;
    let floats = |values: &mut dyn Iterator<Item = f32>| values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let metres = |metres: &f32| if *metres > 0.0 { *metres } else { f32::NAN };
    let (encoding, bytes) = match &picture.pixels {
        Pixels::Color(pixels) => ("rgb8", pixels.as_flattened().to_vec()),
        Pixels::Labels(pixels) => ("mono8", pixels.clone()),
        Pixels::Things(pixels) => ("16UC1", pixels.iter().flat_map(|thing| thing.to_le_bytes()).collect()),
        Pixels::Metres(pixels) => ("32FC1", floats(&mut pixels.iter().map(metres))),
        Pixels::Normals(pixels) => ("32FC3", floats(&mut pixels.as_flattened().iter().copied())),
        Pixels::Flow(pixels) => ("32FC2", floats(&mut pixels.iter().flat_map(|moved| moved.unwrap_or([f32::NAN; 2])))),
    };
    let mut cdr = Cdr::stamped(time_ns, frame);
    cdr.u32(height);
    cdr.u32(width);
    cdr.text(encoding);
    cdr.u8(0);
    cdr.u32((bytes.len() / height as usize) as u32);
    cdr.bytes(&bytes);
    cdr.into_bytes()
}

fn camera_info(lens: &Lens, frame: &str, time_ns: i64) -> Vec<u8> {
    let [width, height] = lens.size;
    let [fx, fy, cx, cy] = intrinsics(lens);
    let distortion: Vec<f64> = coefficients(lens).into_iter().map(|(_, value)| value).collect();
    let mut cdr = Cdr::stamped(time_ns, frame);
    cdr.u32(height);
    cdr.u32(width);
    cdr.text(if lens.is_fisheye() { "equidistant" } else { "plumb_bob" });
    cdr.u32(distortion.len() as u32);
    cdr.f64s(&distortion);
    cdr.f64s(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]);
    cdr.f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    cdr.f64s(&[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
    // No binning, and the region of interest is all.
    [0; 6].into_iter().for_each(|nothing| cdr.u32(nothing));
    cdr.u8(0);
    cdr.into_bytes()
}

fn points(sweep: &Sweep, frame: &str) -> Vec<u8> {
    const STEP: usize = 22;
    let mut cdr = Cdr::stamped(sweep.time_ns, frame);
    cdr.u32(1);
    cdr.u32(sweep.points.len() as u32);
    // Numbers of the kinds: 7 is float32, 4 is uint16.
    let fields = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7), ("ring", 16, 4), ("time", 18, 7)];
    cdr.u32(fields.len() as u32);
    for (name, offset, kind) in fields {
        cdr.text(name);
        cdr.u32(offset);
        cdr.u8(kind);
        cdr.u32(1);
    }
    cdr.u8(0);
    cdr.u32(STEP as u32);
    cdr.u32((STEP * sweep.points.len()) as u32);
    let mut bytes = Vec::with_capacity(STEP * sweep.points.len());
    sweep.points.iter().for_each(|point| point.append_to(&mut bytes));
    cdr.bytes(&bytes);
    cdr.u8(1);
    cdr.into_bytes()
}

fn inertia(told: &Inertia) -> Vec<u8> {
    let mut cdr = Cdr::stamped(told.time_ns, "imu");
    cdr.f64s(&[0.0, 0.0, 0.0, 1.0]);
    // By convention: there is no orientation.
    cdr.f64s(&[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for vector in [told.gyro, told.accel] {
        cdr.f64s(vector.as_slice());
        cdr.f64s(&[0.0; 9]);
    }
    cdr.into_bytes()
}

fn odometry(frame: &str, time_ns: i64, pose: &Isometry3<f64>, velocity: &Vector3<f64>, turn: &Vector3<f64>) -> Vec<u8> {
    let mut cdr = Cdr::stamped(time_ns, frame);
    cdr.text(BASE);
    cdr.pose(pose);
    cdr.f64s(&[0.0; 36]);
    cdr.f64s(velocity.as_slice());
    cdr.f64s(turn.as_slice());
    cdr.f64s(&[0.0; 36]);
    cdr.into_bytes()
}

fn transforms(time_ns: i64, all: &[(&str, &str, Isometry3<f64>)]) -> Vec<u8> {
    let mut cdr = Cdr::default();
    cdr.u32(all.len() as u32);
    for (parent, child, pose) in all {
        cdr.header(time_ns, parent);
        cdr.text(child);
        cdr.pose(pose);
    }
    cdr.into_bytes()
}
