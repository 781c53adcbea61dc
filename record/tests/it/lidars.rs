//! Points of a lidar are on the surfaces, wherever it was at their time.

use nalgebra::{Point3, Vector3};
use plume_record::rig::Rig;
use plume_record::trajectory::Trajectory;

use crate::room::{ALBEDO, CUBE, FAR, Room, bend, rest};

/// A point of a PCD.
struct Read {
    place: Point3<f64>,
    intensity: f64,
    ring: u16,
    time_s: f64,
}

fn points(file: &[u8]) -> Vec<Read> {
    let head = file.windows(12).position(|window| window == b"DATA binary\n").unwrap() + 12;
    let float = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().unwrap()));
    let point = |row: &[u8]| Read {
        place: Point3::new(float(&row[..4]), float(&row[4..8]), float(&row[8..12])),
        intensity: float(&row[12..16]),
        ring: u16::from_le_bytes([row[16], row[17]]),
        time_s: float(&row[18..22]),
    };
    file[head..].chunks_exact(22).map(point).collect()
}

fn rig(scan: &str) -> String {
    format!(
        "[[lidars]]\nname = \"lidar0\"\nrate_hz = 2.0\nposition_m = [0.1, 0.0, 0.2]\nrpy_deg = [0.0, 5.0, 0.0]\nnoise_m = 0.0\nscan = {scan}\n"
    )
}

/// How far a point is from the nearest surface of the room.
fn off_m(point: &Point3<f64>) -> f64 {
    let [x, y, z] = FAR;
    let of_room =
        [x - point.x.abs(), y - point.y.abs(), z - point.z, point.z].map(f64::abs).into_iter().fold(f64::MAX, f64::min);
    let of_cube =
        (0..3).map(|axis| (CUBE[0][axis] - point[axis]).max(point[axis] - CUBE[1][axis])).fold(f64::MIN, f64::max);
    of_room.min(of_cube.abs())
}

fn check(scan: &str, path: &Trajectory, least: usize) {
    let text = rig(scan);
    let (recording, memory) = Room::new().record(&text, path, &["tum"]).unwrap();
    let mount = Rig::parse(&text, "rig".as_ref()).unwrap().lidars[0].body_from_lidar();
    assert_eq!(recording.counts["lidar0"], 2);
    let file = &memory.bytes["lidar0/5.500000.pcd"];
    let found = points(file);
    assert!(found.len() >= least, "{}", found.len());
    for point in &found {
        let time_ns = 5_500_000_000 + (point.time_s * 1e9) as i64;
        let there = path.at_ns(time_ns).pose * mount * point.place;
        assert!(off_m(&there) < 1e-4, "{there} is {} m off", off_m(&there));
    }
    let still = path.at_ns(5_500_000_000).pose * mount;
    assert!(found.iter().any(|point| off_m(&(still * point.place)) > 0.05), "the body moves during a sweep");
}

#[test]
fn a_spinning_lidar_tells_where_surfaces_are() {
    check(
        "{ pattern = \"spinning\", beams = 16, lowest_deg = -15.0, highest_deg = 15.0, columns = 200 }",
        &bend(),
        3200,
    );
}

#[test]
fn a_rosette_tells_where_surfaces_are() {
    check("{ pattern = \"rosette\", cone_deg = 70.0, points = 5000 }", &bend(), 5000);
}

#[test]
fn intensity_is_albedo_times_cosine() {
    let scan = "{ pattern = \"spinning\", beams = 2, lowest_deg = 0.0, highest_deg = 60.0, columns = 4 }";
    let text = rig(scan).replace("[0.0, 5.0, 0.0]", "[0.0, 0.0, 0.0]");
    let (_, memory) = Room::new().record(&text, &rest([0.0; 3], 0.0), &["tum"]).unwrap();
    let found = points(&memory.bytes["lidar0/0.000000.pcd"]);
    assert_eq!(found.len(), 8);
    for point in found {
        let facing = match point.ring {
            0 => 1.0,
            // To the ceiling, or to a wall.
            _ => {
                let ray: Vector3<f64> = point.place.coords.normalize();
                let is_ceiling = (point.place.z + 0.2 - FAR[2]).abs() < 1e-3;
                if is_ceiling { ray.z } else { libm::hypot(ray.x, ray.y) }
            }
        };
        assert!((point.intensity - ALBEDO * facing).abs() < 0.01, "{} {facing}", point.intensity);
    }
}
