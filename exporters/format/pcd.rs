//! PCD point clouds, binary, version 0.7: the [rows](super::points) of points after eleven lines of text.
//!
//! Follows <https://pointclouds.org/documentation/tutorials/pcd_file_format.html>; names are those of the point types of PCL.
//!
//! ```
//! use plume_exporters::format::pcd;
//!
//! let mut file = Vec::new();
//! pcd::write_head(&mut file, "metres, Z up", 2)?;
//! assert!(file.ends_with(b"POINTS 2\nDATA binary\n"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

/// Writes everything before the rows; the comment is one line.
///
/// # Errors
/// Those of `file`.
pub fn write_head(file: &mut dyn Write, comment: &str, points: u64) -> io::Result<()> {
    write!(
        file,
        "# .PCD v0.7 - Point Cloud Data file format\n# {comment}\nVERSION 0.7\n\
         FIELDS x y z normal_x normal_y normal_z label chunk thing\nSIZE 4 4 4 4 4 4 4 4 4\nTYPE F F F F F F U U U\n\
         COUNT 1 1 1 1 1 1 1 1 1\nWIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary\n"
    )
}
