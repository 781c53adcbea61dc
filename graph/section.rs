//! Cross-sections of passages: width, height and outline.
//!
//! ```
//! use plume_graph::{Section, Shape};
//!
//! let drift = Section { width_m: 4.0, height_m: 3.0, shape: Shape::Drift };
//! let room = Section { width_m: 8.0, height_m: 5.0, ..drift };
//! assert_eq!(drift.towards(room, 0.5).width_m, 6.0);
//! ```

use serde::{Deserialize, Serialize};

/// The cross-section of a passage, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Full width.
    pub width_m: f64,
    /// From floor to ceiling, in the middle.
    pub height_m: f64,
    /// Its outline.
    #[serde(skip_serializing_if = "Shape::is_drift")]
    pub shape: Shape,
}

/// The outline of a passage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Nearly a rectangle, as mined.
    #[default]
    Drift,
    /// An ellipse over a floor, as in nature.
    Cave,
}

impl Section {
    /// Depth of the floor of a drift below the axis, relative to half its full height: the full height is clear, and the
    /// outline is cut off below it.
    pub const DRIFT_DROP: f64 = 0.8;

    /// The same of a cave, unless a recipe tells otherwise.
    pub const CAVE_DROP: f64 = 0.5;

    /// Height of the axis, which is where stations lie, above the floor in metres.
    pub fn axis_height_m(self) -> f64 {
        let share = match self.shape {
            Shape::Drift => Self::DRIFT_DROP / (1.0 + Self::DRIFT_DROP),
            Shape::Cave => Self::CAVE_DROP / (1.0 + Self::CAVE_DROP),
        };
        share * self.height_m
    }

    /// The same shape with another width and height.
    pub fn map(self, length_m: impl Fn(f64) -> f64) -> Self {
        Self { width_m: length_m(self.width_m), height_m: length_m(self.height_m), ..self }
    }

    /// The section interpolated to another by this fraction, with the shape of the nearer one.
    pub fn towards(self, other: Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + (b - a) * share;
        Self {
            width_m: between(self.width_m, other.width_m),
            height_m: between(self.height_m, other.height_m),
            shape: if share < 0.5 { self.shape } else { other.shape },
        }
    }
}

/// The clearance radius of a passage around its axis, which is a third of the height above the floor.
pub fn clearance_radius_m(width_m: f64, height_m: f64) -> f64 {
    (0.5 * width_m).max(height_m / (1.0 + Section::CAVE_DROP))
}

impl Shape {
    fn is_drift(&self) -> bool {
        *self == Self::Drift
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_half_way_on_the_shape_is_that_of_the_other_section() {
        let drift = Section { width_m: 4.0, height_m: 3.0, shape: Shape::Drift };
        let cave = Section { width_m: 8.0, height_m: 1.0, shape: Shape::Cave };
        assert_eq!(drift.towards(cave, 0.25), Section { width_m: 5.0, height_m: 2.5, shape: Shape::Drift });
        assert_eq!(drift.towards(cave, 0.5), Section { width_m: 6.0, height_m: 2.0, shape: Shape::Cave });
    }
}
