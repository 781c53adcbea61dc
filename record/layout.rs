//! Layouts of folders in which a recording is written: those of known data sets, so that their tools read it.
//!
//! ```
//! let names: Vec<&str> = plume_record::layout::LAYOUTS.iter().map(|row| row.name).collect();
//! assert_eq!(names[0], "tum");
//! ```

use plume_exporters::package::Package;
use plume_graph::echo;

use crate::error::RecordError;
use crate::inertial::{Inertia, Wheeled};
use crate::layouts::{euroc, kitti, mcap, tum};
use crate::lidar::Sweep;
use crate::picture::Frame;
use crate::rig::Rig;
use crate::trajectory::Trajectory;

/// All layouts.
pub const LAYOUTS: [LayoutRow; 4] = [tum::ROW, euroc::ROW, kitti::ROW, mcap::ROW];

/// A layout: one row of [`LAYOUTS`].
pub struct LayoutRow {
    /// Its name on the command line.
    pub name: &'static str,
    /// One line about it.
    pub summary: &'static str,
    /// Refuses a rig that it cannot hold: what is wrong, and what to do.
    pub check: fn(&Rig) -> Result<(), (String, &'static str)>,
    /// Begins one, of a run along a path.
    pub begin: fn(&Rig, &Trajectory) -> Box<dyn Layout>,
}

/// A layout that is being written. What is measured comes in the order of time.
pub trait Layout {
    /// Writes what a camera has recorded.
    ///
    /// # Errors
    /// If it cannot be written; so for all.
    fn frame(&mut self, frame: &Frame, out: &mut Out) -> Result<(), RecordError>;

    /// Writes a sweep of a lidar.
    ///
    /// # Errors
    /// As [`Layout::frame`].
    fn sweep(&mut self, sweep: &Sweep, out: &mut Out) -> Result<(), RecordError>;

    /// Takes a measurement of the IMU.
    fn inertia(&mut self, told: &Inertia);

    /// Takes a measurement of the wheels.
    fn wheeled(&mut self, told: &Wheeled);

    /// Writes what is left: lists, true poses, calibration.
    ///
    /// # Errors
    /// As [`Layout::frame`].
    fn finish(&mut self, out: &mut Out) -> Result<(), RecordError>;
}

/// The folder of a layout.
pub struct Out<'a> {
    /// Where all files go.
    pub package: &'a mut dyn Package,
    /// The folder within it: empty, or ends with a slash.
    pub folder: &'a str,
}

impl Out<'_> {
    /// Writes a file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn bytes(&mut self, path: &str, bytes: &[u8]) -> Result<(), RecordError> {
        let path = format!("{}{path}", self.folder);
        Ok(self.package.write(&path, |file| Ok(file.write_all(bytes)?))?)
    }
}

/// The layout called `name`.
///
/// # Errors
/// [`RecordError::UnknownLayout`], which lists the names.
pub fn named(name: &str) -> Result<&'static LayoutRow, RecordError> {
    let known = || LAYOUTS.map(|row| row.name).join(", ");
    let row = LAYOUTS.iter().find(|row| row.name == name);
    row.ok_or_else(|| RecordError::UnknownLayout { name: echo::shown(name), known: known() })
}
