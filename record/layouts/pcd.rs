//! Binary PCD 0.7 of the Point Cloud Library: x, y, z in metres, intensity, ring, and seconds since the beginning of the sweep.
//!
//! Follows <https://pointclouds.org/documentation/tutorials/pcd_file_format.html>.

use crate::lidar::Sweep;

/// A sweep as a file.
pub fn encode(sweep: &Sweep) -> Vec<u8> {
    let count = sweep.points.len();
    let head = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 4\n\
         TYPE F F F F U F\nCOUNT 1 1 1 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    );
    let mut file = head.into_bytes();
    sweep.points.iter().for_each(|point| point.append_to(&mut file));
    file
}
