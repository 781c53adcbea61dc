//! The places on a floor between which robots move.

use super::floor::{Floor, beside};

/// Distance between two places along an axis, in metres; at least a cell.
const STRIDE_M: f64 = 0.1;

/// Every cell of a floor that is a whole number of strides from the first along both axes.
pub struct Lattice {
    cell_m: f64,
    /// Cells from one place to the next.
    stride: i32,
}

impl Lattice {
    /// The places on a floor.
    pub fn new(floor: &Floor) -> Self {
        let cell_m = floor.cell_m();
        Self { cell_m, stride: (STRIDE_M / cell_m).round().max(1.0) as i32 }
    }

    /// Whether a cell of the map is a place.
    pub fn holds(&self, cell: [i32; 2]) -> bool {
        cell.iter().all(|n| n.rem_euclid(self.stride) == 0)
    }

    /// The cell of the map a stride from one.
    pub fn beside(&self, cell: [i32; 2], towards: [i32; 2]) -> [i32; 2] {
        beside(cell, towards.map(|n| n * self.stride))
    }

    /// Length of such a stride in metres.
    pub fn stride_m(&self, towards: [i32; 2]) -> f64 {
        f64::from(self.stride) * self.cell_m * libm::hypot(towards[0].into(), towards[1].into())
    }
}
