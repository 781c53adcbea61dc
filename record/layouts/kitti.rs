//! Layout `kitti`: the odometry benchmark of KITTI (Geiger, Lenz and Urtasun 2012).
//!
//! ```text
//! sequences/00/image_2/<number>.png, image_3/   the first camera, and the second of a stereo pair
//! sequences/00/image_2_<output>/<number>.png    other outputs of the first; 256 units of depth per metre
//! sequences/00/velodyne/<number>.bin            x, y, z, intensity of the first lidar, single precision; sweeps begin with images
//! sequences/00/calib.txt, times.txt
//! poses/00.txt                                  of the first camera, from its first pose
//! ```
//! Sweeps are as they were measured, while the body moved; they have no rings and times. The IMU and the wheels are left out, as KITTI
//! has none here. Follows the `readme.txt` of its development kit.

use nalgebra::Isometry3;
use rayon::prelude::*;

use super::calibration::{baseline_m, is_plain};
use crate::error::RecordError;
use crate::inertial::{Inertia, Wheeled};
use crate::layout::{Layout, LayoutRow, Out};
use crate::lens::Lens;
use crate::lidar::Sweep;
use crate::picture::Frame;
use crate::rig::{Output, Rig};

/// The row of this layout.
pub const ROW: LayoutRow = LayoutRow {
    name: "kitti",
    summary: "KITTI odometry: numbered images, Velodyne scans, poses of the first camera",
    check,
    begin: |rig, _| Box::new(Kitti { rig: rig.clone(), frames: Vec::new() }),
};

/// The factor of KITTI's depth images.
const UNITS_PER_M: f32 = 256.0;
const SEQUENCE: &str = "sequences/00";

struct Kitti {
    rig: Rig,
    /// Times and poses of the first camera.
    frames: Vec<(i64, Isometry3<f64>)>,
}

/// Images and scans have the same numbers, and cameras are rectified.
fn check(rig: &Rig) -> Result<(), (String, &'static str)> {
    let Some(left) = rig.cameras.first() else {
        return Err(("needs a camera".to_owned(), "add one to the rig, or choose another layout"));
    };
    if !is_plain(left) {
        let fault = format!("needs rectified images, but the lens of `{}` distorts", left.name);
        return Err((fault, "use a pinhole without distortion, or choose another layout"));
    }
    if rig.cameras.len() > 2 || rig.cameras.get(1).is_some_and(|right| baseline_m(left, right).is_none()) {
        let fault = "holds one camera, or two that are alike, the second to the right of the first".to_owned();
        return Err((fault, "leave out the other cameras, or choose another layout"));
    }
    match &rig.lidars[..] {
        [] => Ok(()),
        [lidar] if lidar.rate_hz == left.rate_hz => Ok(()),
        [lidar] => Err((
            format!("numbers sweeps like images, but `{}` has another rate than `{}`", lidar.name, left.name),
            "give both the same rate_hz, or choose another layout",
        )),
        _ => Err(("holds one lidar".to_owned(), "leave out the others, or choose another layout")),
    }
}

impl Layout for Kitti {
    fn frame(&mut self, frame: &Frame, out: &mut Out) -> Result<(), RecordError> {
        let folder = format!("{SEQUENCE}/image_{}", frame.camera + 2);
        let files: Vec<_> = frame.pictures.par_iter().map(|picture| picture.png(UNITS_PER_M)).collect();
        for (picture, file) in frame.pictures.iter().zip(files) {
            let ending = match picture.output {
                Output::Image => String::new(),
                other => format!("_{}", other.name()),
            };
            out.bytes(&format!("{folder}{ending}/{:06}.png", frame.number), &file?)?;
        }
        if frame.camera == 0 {
            self.frames.push((frame.time_ns, frame.scene_from_optical));
        }
        Ok(())
    }

    fn sweep(&mut self, sweep: &Sweep, out: &mut Out) -> Result<(), RecordError> {
        let numbers = sweep.points.iter().flat_map(|point| point.place.into_iter().chain([point.intensity]));
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        out.bytes(&format!("{SEQUENCE}/velodyne/{:06}.bin", sweep.number), &bytes)
    }

    fn inertia(&mut self, _: &Inertia) {}

    fn wheeled(&mut self, _: &Wheeled) {}

    fn finish(&mut self, out: &mut Out) -> Result<(), RecordError> {
        let Some((start_ns, start)) = self.frames.first().copied() else { return Ok(()) };
        let times = self.frames.iter().map(|(time_ns, _)| format!("{:e}\n", (time_ns - start_ns) as f64 * 1e-9));
        let poses = self.frames.iter().map(|(_, pose)| rows(&(start.inverse() * pose)) + "\n");
        out.bytes(&format!("{SEQUENCE}/times.txt"), times.collect::<String>().as_bytes())?;
        out.bytes("poses/00.txt", poses.collect::<String>().as_bytes())?;
        out.bytes(&format!("{SEQUENCE}/calib.txt"), self.calibration().as_bytes())
    }
}

impl Kitti {
    /// Projections of the grey and the colour cameras, which are the same ones here, and from the lidar to the first camera.
    fn calibration(&self) -> String {
        let left = &self.rig.cameras[0];
        let lens = Lens::of(left);
        let baseline_m = self.rig.cameras.get(1).and_then(|right| baseline_m(left, right)).unwrap_or_default();
        let ([cx, cy], f) = (lens.centre, lens.focal);
        let projection = |shift: f64| numbers(&[f, 0.0, cx, shift, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let projections = [0.0, -f * baseline_m, 0.0, -f * baseline_m].map(projection);
        let lines = projections.into_iter().zip(0..).map(|(line, number)| format!("P{number}: {line}\n"));
        let lidar =
            self.rig.lidars.first().map(|lidar| {
                format!("Tr: {}\n", rows(&(left.body_from_optical().inverse() * lidar.body_from_lidar())))
            });
        lines.chain(lidar).collect()
    }
}

/// The first three rows of a pose's matrix.
fn rows(pose: &Isometry3<f64>) -> String {
    let matrix = pose.to_homogeneous().transpose();
    numbers(&matrix.as_slice()[..12])
}

fn numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:.12e}")).collect::<Vec<_>>().join(" ")
}
