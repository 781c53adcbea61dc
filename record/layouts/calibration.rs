//! Calibration files for SLAM programs: the settings of ORB-SLAM3, and the camera of RTAB-Map, which is that of ROS.
//!
//! Both are YAML as OpenCV 2 and later reads it (`%YAML:1.0`). ORB-SLAM3: its `Calibration_Tutorial.pdf` and the files in its
//! `Examples`; the numbers of features and thresholds are those of its `TUM1.yaml`. Not promised: that they are the best ones.

use std::fmt::Write as _;

use nalgebra::{Isometry3, Matrix4};

use crate::lens::Lens;
use crate::rig::{self, Camera, Output, Rig};

/// Settings of ORB-SLAM3 for the first camera, with the second if both are a stereo pair, and the IMU; depth images have so many
/// units per metre. `None` without a camera.
pub fn orb_slam3(rig: &Rig, units_per_m: f32) -> Option<String> {
    let camera = rig.cameras.first()?;
    let lens = Lens::of(camera);
    let [width, height] = lens.size;
    let baseline_m = rig.cameras.get(1).and_then(|other| baseline_m(camera, other)).filter(|_| is_plain(camera));
    // A stereo pair could also be "Rectified", but then ORB-SLAM3 1.0 crashes when it prints what it has read.
    let model = if lens.is_fisheye() { "KannalaBrandt8" } else { "PinHole" };
    let cameras: &[&str] = if baseline_m.is_some() { &["Camera1", "Camera2"] } else { &["Camera1"] };
    let mut text = format!("%YAML:1.0\n\nFile.version: \"1.0\"\nCamera.type: \"{model}\"\n");
    let mut line = |key: &str, value: String| writeln!(text, "{key}: {value}").expect("a string grows");
    for name in cameras {
        let focal_and_centre = ["fx", "fy", "cx", "cy"].into_iter().zip(intrinsics(&lens));
        for (key, value) in focal_and_centre.chain(coefficients(&lens)) {
            line(&format!("{name}.{key}"), decimal(value));
        }
    }
    line("Camera.width", width.to_string());
    line("Camera.height", height.to_string());
    line("Camera.fps", format!("{}", camera.rate_hz.round().max(1.0) as u32));
    line("Camera.RGB", "1".into());
    if let Some(baseline_m) = baseline_m {
        line("Stereo.T_c1_c2", matrix(&Isometry3::translation(baseline_m, 0.0, 0.0)));
        line("Stereo.b", decimal(baseline_m));
        line("Stereo.ThDepth", "40.0".into());
    } else if camera.outputs.contains(&Output::Depth) || camera.outputs.contains(&Output::ExactDepth) {
        line("Stereo.b", "0.0745".into());
        line("Stereo.ThDepth", "40.0".into());
        line("RGBD.DepthMapFactor", decimal(f64::from(units_per_m)));
    }
    if let Some(imu) = &rig.imu {
        line("IMU.T_b_c1", matrix(&(imu.body_from_imu().inverse() * camera.body_from_optical())));
        for (key, value) in [
            ("NoiseGyro", imu.gyro_noise),
            ("NoiseAcc", imu.accel_noise),
            ("GyroWalk", imu.gyro_walk),
            ("AccWalk", imu.accel_walk),
            ("Frequency", imu.rate_hz),
        ] {
            line(&format!("IMU.{key}"), decimal(value));
        }
    }
    text += FEATURES;
    Some(text)
}

/// The numbers of ORB-SLAM3's examples.
const FEATURES: &str = "ORBextractor.nFeatures: 1000\nORBextractor.scaleFactor: 1.2\nORBextractor.nLevels: 8\n\
    ORBextractor.iniThFAST: 20\nORBextractor.minThFAST: 7\nViewer.KeyFrameSize: 0.05\nViewer.KeyFrameLineWidth: 1.0\n\
    Viewer.GraphLineWidth: 0.9\nViewer.PointSize: 2.0\nViewer.CameraSize: 0.08\nViewer.CameraLineWidth: 3.0\n\
    Viewer.ViewpointX: 0.0\nViewer.ViewpointY: -0.7\nViewer.ViewpointZ: -1.8\nViewer.ViewpointF: 500.0\n";

/// A camera as `camera_calibration_parsers` of ROS and RTAB-Map read it.
pub fn camera_info(camera: &Camera) -> String {
    let lens = Lens::of(camera);
    let ([fx, fy, cx, cy], [width, height]) = (intrinsics(&lens), lens.size);
    let distortion: Vec<String> = coefficients(&lens).into_iter().map(|(_, value)| decimal(value)).collect();
    let model = if lens.is_fisheye() { "equidistant" } else { "plumb_bob" };
    let rows = |name: &str, rows: usize, columns: usize, data: &str| {
        format!("{name}:\n   rows: {rows}\n   cols: {columns}\n   data: [ {data} ]\n")
    };
    let [fx, fy, cx, cy] = [fx, fy, cx, cy].map(decimal);
    [
        format!("%YAML:1.0\n---\ncamera_name: {}\nimage_width: {width}\nimage_height: {height}\n", camera.name),
        rows("camera_matrix", 3, 3, &format!("{fx}, 0.0, {cx}, 0.0, {fy}, {cy}, 0.0, 0.0, 1.0")),
        format!("distortion_model: {model}\n"),
        rows("distortion_coefficients", 1, distortion.len(), &distortion.join(", ")),
        rows("rectification_matrix", 3, 3, "1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0"),
        rows("projection_matrix", 3, 4, &format!("{fx}, 0.0, {cx}, 0.0, 0.0, {fy}, {cy}, 0.0, 0.0, 0.0, 1.0, 0.0")),
    ]
    .concat()
}

/// Focal lengths and principal point.
pub fn intrinsics(lens: &Lens) -> [f64; 4] {
    [lens.focal, lens.focal, lens.centre[0], lens.centre[1]]
}

/// Coefficients of distortion in the order of OpenCV.
pub fn coefficients(lens: &Lens) -> Vec<(&'static str, f64)> {
    match &lens.model {
        rig::Lens::Pinhole { distortion } => ["k1", "k2", "p1", "p2", "k3"].into_iter().zip(*distortion).collect(),
        rig::Lens::Fisheye { distortion } => ["k1", "k2", "k3", "k4"].into_iter().zip(*distortion).collect(),
    }
}

/// Whether a camera is a pinhole without distortion.
pub fn is_plain(camera: &Camera) -> bool {
    camera.lens == rig::Lens::default()
}

/// How far a camera is to the right of another, if they are alike otherwise.
pub fn baseline_m(left: &Camera, right: &Camera) -> Option<f64> {
    let is_alike = (left.size_px, left.fov_deg, &left.lens, left.rpy_deg, left.rate_hz)
        == (right.size_px, right.fov_deg, &right.lens, right.rpy_deg, right.rate_hz);
    let between = (left.body_from_optical().inverse() * right.body_from_optical()).translation.vector;
    (is_alike && between.x > 0.0 && between.y.abs() + between.z.abs() < 1e-9).then_some(between.x)
}

/// A pose as a matrix of OpenCV.
fn matrix(pose: &Isometry3<f64>) -> String {
    format!("!!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n   data: [{}]", row_major(pose))
}

/// The sixteen numbers of a pose, row by row.
pub fn row_major(pose: &Isometry3<f64>) -> String {
    let matrix: Matrix4<f64> = pose.to_homogeneous();
    matrix.transpose().iter().map(|value| decimal(*value)).collect::<Vec<_>>().join(", ")
}

/// With a point, so that OpenCV reads a real number.
pub fn decimal(value: f64) -> String {
    let text = format!("{value:.10}");
    let text = text.trim_end_matches('0');
    let text = if text.ends_with('.') { format!("{text}0") } else { text.to_owned() };
    if text == "-0.0" { "0.0".to_owned() } else { text }
}
