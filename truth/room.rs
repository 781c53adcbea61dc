//! The room around a station, as it is measured in a survey.

use super::floor::{Floor, Lookup};

/// Furthest that it is measured to a side, in metres: as far as a tape or a laser reaches in a passage.
const FURTHEST_M: f64 = 30.0;

/// How far it is from a station to the rock: up and down at its place, and level to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// To the left, in metres; at most 30.
    pub left_m: f64,
    /// To the right, in metres; at most 30.
    pub right_m: f64,
    /// Up, in metres.
    pub up_m: f64,
    /// Down, in metres.
    pub down_m: f64,
}

impl Room {
    /// The room around a station in metres for one who faces this way, from +x towards +y in radians; `None` where it is not in the
    /// air. Sides are known to a cell, up and down as exactly as the floor in that cell.
    pub fn around(floor: &Floor, station_m: [f64; 3], heading_rad: f64) -> Option<Self> {
        let [x, y, z] = station_m;
        let mut lookup = Lookup::new(floor);
        let [floor_m, ceiling_m] = lookup.holding([x, y], z as f32)?;
        let left = [-libm::sin(heading_rad), libm::cos(heading_rad)];
        let mut beside_m = |side: f64| {
            let step_m = floor.cell_m() / 2.0;
            let is_air = |step: &i32| {
                let off_m = side * f64::from(*step) * step_m;
                lookup.holding([x + off_m * left[0], y + off_m * left[1]], z as f32).is_some()
            };
            let most = (FURTHEST_M / step_m) as i32;
            f64::from((1..=most).take_while(is_air).last().unwrap_or(0)) * step_m
        };
        let [left_m, right_m] = [1.0, -1.0].map(&mut beside_m);
        Some(Self { left_m, right_m, up_m: f64::from(ceiling_m) - z, down_m: z - f64::from(floor_m) })
    }
}
