//! The table of files in `truth.json`.

use serde::Serialize;

/// The frame of all files that do not say otherwise.
pub const FRAME: &str = "right-handed, Z up, metres";

/// The files that have been written, in their order.
#[derive(Default, Serialize)]
#[serde(transparent)]
pub struct Table(Vec<Entry>);

/// A file of ground truth.
#[derive(Serialize)]
pub struct Entry {
    file: String,
    content: &'static str,
    unit: &'static str,
    frame: &'static str,
    /// Side of a cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    resolution_m: Option<f64>,
    /// Points per square metre.
    #[serde(skip_serializing_if = "Option::is_none")]
    per_m2: Option<f64>,
}

impl Entry {
    /// A file, what is in it, and in which unit.
    pub fn new(file: impl Into<String>, content: &'static str, unit: &'static str) -> Self {
        Self { file: file.into(), content, unit, frame: FRAME, resolution_m: None, per_m2: None }
    }

    /// A file that is in another frame.
    pub fn of_frame(file: impl Into<String>, content: &'static str, unit: &'static str, frame: &'static str) -> Self {
        Self { frame, ..Self::new(file, content, unit) }
    }

    /// A file with cells of this side.
    pub fn of_cells(file: impl Into<String>, content: &'static str, unit: &'static str, cell_m: f64) -> Self {
        Self { resolution_m: Some(cell_m), ..Self::new(file, content, unit) }
    }

    /// A file with so many points per square metre.
    pub fn of_points(file: impl Into<String>, content: &'static str, per_m2: f64) -> Self {
        Self { per_m2: Some(per_m2), ..Self::new(file, content, "m") }
    }
}

impl Table {
    /// Adds a file.
    pub fn add(&mut self, entry: Entry) {
        self.0.push(entry);
    }
}
