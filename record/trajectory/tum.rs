//! Reads poses in the format of the TUM RGB-D benchmark: `timestamp tx ty tz qx qy qz qw` a line, seconds and metres, `#` before
//! comments. Writes them too.
//!
//! Follows <https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats>. Files are untrusted: size and number of poses are
//! bounded, and nothing of them is quoted but the number of a line.

use std::path::Path;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use super::Stamped;
use crate::error::RecordError;

/// Largest file.
const MOST_BYTES: u64 = 1 << 26;
/// Largest coordinate in metres: a cave is smaller.
const MOST_M: f64 = 1e5;
/// Latest time in seconds, so that 64 bits hold nanoseconds and their differences.
const MOST_S: f64 = 4e9;
/// Most lines.
const MOST_LINES: usize = 200_000;

/// The poses in a file.
///
/// # Errors
/// [`RecordError::Input`] if it cannot be read, [`RecordError::PathFile`] if a line is not a pose.
pub fn read(path: &Path) -> Result<Vec<Stamped>, RecordError> {
    let input = |source| RecordError::Input { path: path.to_owned(), source };
    let bytes = plume_disk::regular::read(path, MOST_BYTES).map_err(input)?;
    parse(&String::from_utf8_lossy(&bytes)).map_err(|error| error.in_file(path))
}

/// The poses in a text.
///
/// # Errors
/// [`RecordError::Path`] if a line is not a pose.
pub fn parse(text: &str) -> Result<Vec<Stamped>, RecordError> {
    if text.lines().count() > MOST_LINES {
        return Err(RecordError::path(format!("has more than {MOST_LINES} lines"), "record it in parts"));
    }
    let lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty() && !line.trim().starts_with('#'));
    let poses = lines.map(|(line, number)| {
        pose(line).ok_or_else(|| {
            RecordError::path(
                format!("line {number} is not a pose"),
                "a line is `timestamp tx ty tz qx qy qz qw`: seconds, metres, and a quaternion of length 1",
            )
        })
    });
    poses.collect()
}

fn pose(line: &str) -> Option<Stamped> {
    let numbers = line.split_ascii_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?;
    let [time_s, x, y, z, i, j, k, w] = numbers.try_into().ok()?;
    let turn = Quaternion::new(w, i, j, k);
    let is_unit = (turn.norm() - 1.0).abs() < 0.01;
    let is_place = [x, y, z].iter().all(|along| along.abs() < MOST_M) && time_s.abs() < MOST_S;
    let pose = Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::new_normalize(turn));
    (is_unit && is_place).then_some(Stamped { time_ns: (time_s * 1e9).round() as i64, pose })
}

/// A line of such a file, without its end.
pub fn line(time_ns: i64, pose: &Isometry3<f64>) -> String {
    let [x, y, z]: [f64; 3] = pose.translation.vector.into();
    let [i, j, k, w]: [f64; 4] = pose.rotation.coords.into();
    format!("{} {x:.7} {y:.7} {z:.7} {i:.8} {j:.8} {k:.8} {w:.8}", seconds(time_ns))
}

/// A time in seconds, to the microsecond.
pub fn seconds(time_ns: i64) -> String {
    let micros = (time_ns + 500).div_euclid(1000);
    format!("{}{}.{:06}", if micros < 0 { "-" } else { "" }, micros.abs() / 1_000_000, micros.abs() % 1_000_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_skipped_and_quaternions_normalised() {
        let poses = parse("# time x y z\n\n1.5 1 2 3 0 0 0 1.001\n1.600000 -1 2 3 0 0 1 0\r\n").unwrap();
        assert_eq!(poses.len(), 2);
        assert_eq!((poses[0].time_ns, poses[1].time_ns), (1_500_000_000, 1_600_000_000));
        assert_eq!(poses[0].pose.rotation, UnitQuaternion::identity());
        assert_eq!(
            line(poses[1].time_ns, &poses[1].pose),
            "1.600000 -1.0000000 2.0000000 3.0000000 0.00000000 0.00000000 1.00000000 0.00000000"
        );
    }

    #[test]
    fn what_is_no_pose_is_refused_with_its_line() {
        for text in [
            "1 2 3",
            "0 0 0 0 0 0 0 0",
            "0 0 0 0 0 0 0 1 5",
            "nan 0 0 0 0 0 0 1",
            "0 1e300 0 0 0 0 0 1",
            "a b c d e f g h",
        ] {
            let error = parse(&format!("#\n{text}\n")).unwrap_err();
            assert!(error.to_string().contains("line 2"), "{text}: {error}");
        }
    }

    #[test]
    fn times_before_the_epoch_keep_their_sign() {
        assert_eq!((seconds(-1_500_000_000), seconds(2_000_000_400)), ("-1.500000".into(), "2.000000".into()));
    }
}
