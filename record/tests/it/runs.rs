//! Whole runs: what is written, that it does not depend on the number of threads, and that what cannot be is refused.

use std::sync::atomic::AtomicBool;

use nalgebra::{UnitQuaternion, Vector3};
use plume_exporters::package::Memory;
use plume_record::layout::{self, LAYOUTS};
use plume_record::rig::Rig;
use plume_record::{Order, record};

use crate::room::{Room, Unwatched, bend};

/// All sensors, small.
const RIG: &str = r#"
[[cameras]]
name = "left"
rate_hz = 5.0
size_px = [40, 30]
fov_deg = 70.0
position_m = [0.0, 0.05, 0.0]
outputs = ["image", "depth", "exact_depth", "normal", "label", "instance", "flow"]

[[cameras]]
name = "right"
rate_hz = 5.0
size_px = [40, 30]
fov_deg = 70.0
position_m = [0.0, -0.05, 0.0]
outputs = ["image"]

[[lidars]]
name = "lidar0"
rate_hz = 5.0
scan = { pattern = "spinning", beams = 4, lowest_deg = -15.0, highest_deg = 15.0, columns = 400 }

[imu]

[odometry]
rate_hz = 10.0

[light]
cave_lamps = true
dust_per_m = 0.02
"#;

fn in_threads(threads: usize) -> Memory {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let names = LAYOUTS.map(|row| row.name);
    pool.install(|| Room::new().record(RIG, &bend(), &names)).unwrap().1
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let [one, many] = [1, 3].map(in_threads);
    let differs = one.bytes.iter().find(|(path, bytes)| many.bytes.get(*path) != Some(*bytes));
    assert_eq!(differs.map(|(path, _)| path), None);
    assert_eq!(one.bytes.len(), many.bytes.len());
}

#[test]
fn another_seed_gives_other_noise_and_the_same_truth() {
    let (room, path) = (Room::new(), bend());
    let rig = Rig::parse(RIG, "rig".as_ref()).unwrap();
    let [one, other] = [1, 2].map(|seed| {
        let mut memory = Memory::default();
        let order = Order { rig: &rig, path: &path, seed, layouts: vec![layout::named("tum").unwrap()] };
        record(&room.scene(), &order, &mut memory, &Unwatched(AtomicBool::new(false))).unwrap();
        memory.bytes
    });
    for name in ["rgb/5.200000.png", "depth/5.200000.png", "lidar0/5.200000.pcd", "imu.csv", "odometry.csv"] {
        assert_ne!(one[name], other[name], "{name}");
    }
    for name in ["exact_depth/5.200000.png", "groundtruth.txt", "flow/5.200000.png", "label/5.200000.png"] {
        assert_eq!(one[name], other[name], "{name}");
    }
}

#[test]
fn every_layout_has_its_files() {
    let memory = in_threads(2);
    let files: Vec<String> = memory.bytes.iter().map(|(path, bytes)| format!("{path} {}", kind(bytes))).collect();
    insta::assert_snapshot!(files.join("\n"));
}

/// What is a text, and how long it is.
fn kind(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) if text.is_ascii() => format!("({} lines)", text.lines().count()),
        _ => String::new(),
    }
}

#[test]
fn texts_are_those_of_the_data_sets() {
    let memory = in_threads(2);
    let text = |path: &str| {
        let text = String::from_utf8(memory.bytes[path].clone()).unwrap();
        format!("== {path}\n{}", text.lines().take(14).collect::<Vec<_>>().join("\n"))
    };
    let paths = [
        "euroc/mav0/cam0/sensor.yaml",
        "euroc/mav0/imu0/sensor.yaml",
        "euroc/mav0/state_groundtruth_estimate0/data.csv",
        "kitti/sequences/00/calib.txt",
        "kitti/poses/00.txt",
        "tum/associations.txt",
        "tum/groundtruth.txt",
        "tum/left.yaml",
        "tum/orbslam3.yaml",
    ];
    insta::assert_snapshot!(paths.map(text).join("\n"));
}

/// Without noise, what the IMU feels leads along the path.
#[test]
fn inertia_integrates_to_the_path() {
    let rig = "[imu]\nrate_hz = 1000.0\ngyro_noise = 0.0\ngyro_walk = 0.0\naccel_noise = 0.0\naccel_walk = 0.0\n";
    let path = bend();
    let (_, memory) = Room::new().record(rig, &path, &["tum"]).unwrap();
    let text = String::from_utf8(memory.bytes["imu.csv"].clone()).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|n| n.parse().unwrap()).collect()).collect();
    let start = path.at_ns(path.start_ns());
    let (mut turn, mut place, mut velocity) = (start.pose.rotation, start.pose.translation.vector, start.velocity);
    for pair in rows.windows(2) {
        let step = pair[1][0] - pair[0][0];
        let [gyro, force] = [1, 4].map(|first| {
            let of = |row: &Vec<f64>| Vector3::new(row[first], row[first + 1], row[first + 2]);
            (of(&pair[0]) + of(&pair[1])) / 2.0
        });
        let middle = turn * UnitQuaternion::from_scaled_axis(gyro * step / 2.0);
        let acceleration = middle * force - Vector3::z() * 9.81;
        place += velocity * step + acceleration * (step * step / 2.0);
        velocity += acceleration * step;
        turn *= UnitQuaternion::from_scaled_axis(gyro * step);
    }
    let end = path.at_ns(path.end_ns());
    assert!((place - end.pose.translation.vector).norm() < 1e-4, "{}", place - end.pose.translation.vector);
    assert!(turn.angle_to(&end.pose.rotation) < 1e-5 && (velocity - end.velocity).norm() < 1e-3);
}

#[test]
fn a_layout_refuses_a_rig_that_it_cannot_hold() {
    let refused = [
        (RIG.replace("position_m = [0.0, -0.05, 0.0]", "position_m = [0.0, 0.15, 0.0]"), "kitti", "alike"),
        (RIG.replacen("rate_hz = 5.0\nscan", "rate_hz = 10.0\nscan", 1), "kitti", "another rate"),
        ("[odometry]\n".to_owned(), "euroc", "camera or an IMU"),
        ("[imu]\n".to_owned(), "kitti", "needs a camera"),
        (String::new(), "kittens", "unknown layout"),
    ];
    for (rig, name, part) in refused {
        let error = Room::new().record(&rig, &bend(), &[name]).err().unwrap();
        assert!(error.to_string().contains(part) && !error.hint().is_empty(), "{error}; {}", error.hint());
    }
}

#[test]
fn a_watch_can_stop_it() {
    let (room, path) = (Room::new(), bend());
    let rig = Rig::preset("rgbd").unwrap();
    let order = Order { rig: &rig, path: &path, seed: 1, layouts: vec![layout::named("tum").unwrap()] };
    let error = record(&room.scene(), &order, &mut Memory::default(), &Unwatched(AtomicBool::new(true))).unwrap_err();
    assert_eq!(error.to_string(), "interrupted");
}
