//! Readings that can be taken as they are, but are probably mistakes.
//!
//! They are those that cavern 1.4 warns of: a bearing beyond a full circle, a gradient beyond the vertical, a negative length, a
//! tape shorter than the change in depth, and a foresight and a backsight that differ by more than three standard
//! deviations.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{Instruments, Quantity, Reading, Row, Style, Unit};

/// Relative tolerance of limits: units such as grads convert inexactly.
const ROUNDING: f64 = 1e-9;
/// Standard deviations by which a foresight and a backsight may differ, as in cavern.
const SPREADS: f64 = 3.0;

impl Instruments {
    /// What is doubtful about the readings of a leg, one sentence each.
    pub(in super::super) fn doubts(&self, style: Style, row: &Row) -> Vec<String> {
        let mut doubts = Vec::new();
        if !matches!(style, Style::Normal | Style::Diving | Style::Cylpolar) {
            return doubts;
        }
        doubts.extend(self.negative_length(row));
        for (quantity, name) in [(Quantity::Bearing, "compass"), (Quantity::BackBearing, "back compass")] {
            doubts.extend(self.beyond(row, quantity, name, [0.0, TAU]));
        }
        if style == Style::Normal {
            for (quantity, name) in [(Quantity::Gradient, "clino"), (Quantity::BackGradient, "back clino")] {
                doubts.extend(self.beyond(row, quantity, name, [-FRAC_PI_2, FRAC_PI_2]));
            }
            doubts.extend(self.disagreement(row, [Quantity::Gradient, Quantity::BackGradient], "clino", |a, b| a + b));
        }
        if style == Style::Diving {
            doubts.extend(self.short_tape(row));
        }
        doubts.extend(self.disagreement(row, [Quantity::Bearing, Quantity::BackBearing], "compass", off_opposite));
        doubts
    }

    fn negative_length(&self, row: &Row) -> Option<String> {
        let tapes = [(Quantity::Length, "tape"), (Quantity::BackLength, "back tape")];
        let negative = tapes.into_iter().find_map(|(quantity, name)| {
            let reading = row.number(Reading::Of(quantity))?;
            (reading < 0.0).then(|| format!("the {name} reading {reading} is negative"))
        });
        let corrected = || {
            let (length_m, _) = self.length(row).ok()?;
            (length_m < 0.0).then(|| "the length is negative once it is corrected".to_owned())
        };
        negative.or_else(corrected)
    }

    /// A reading of an angle outside a range in radians, before it is corrected.
    fn beyond(&self, row: &Row, quantity: Quantity, name: &str, range_rad: [f64; 2]) -> Option<String> {
        let reading = row.number(Reading::Of(quantity))?;
        let factor = match self.gauges[quantity as usize].unit {
            Unit::Angle(factor) => factor,
            Unit::Quadrants => 1_f64.to_radians(),
            Unit::Length(_) | Unit::Percent => return None,
        };
        let [least, most] = range_rad.map(|limit_rad| (limit_rad / factor * 1e6).round() / 1e6);
        let slack = ROUNDING * (most - least).abs();
        let is_within = reading >= least.min(most) - slack && reading <= least.max(most) + slack;
        (!is_within).then(|| format!("the {name} reading {reading} is not within {least} to {most}"))
    }

    fn short_tape(&self, row: &Row) -> Option<String> {
        let (length_m, rise_m) = (self.length(row).ok()?.0, self.rise(row).ok()?.0);
        (length_m < rise_m.abs()).then(|| "the tape is shorter than the change in depth".to_owned())
    }

    /// A foresight and a backsight, corrected, that differ too much; `off` is by how much, in radians.
    fn disagreement(
        &self,
        row: &Row,
        sights: [Quantity; 2],
        name: &str,
        off: impl Fn(f64, f64) -> f64,
    ) -> Option<String> {
        let [fore, back] = sights.map(|quantity| {
            let reading = row.number(Reading::Of(quantity))?;
            Some(self.value(quantity, reading))
        });
        let off_rad = off(fore?, back?).abs();
        let [a, b] = sights.map(|quantity| self.spread(quantity));
        let is_too_much = off_rad > SPREADS * (a * a + b * b).sqrt() + ROUNDING;
        is_too_much.then(|| format!("the {name} readings of both ends differ by {:.1}°", off_rad.to_degrees()))
    }
}

/// How far two bearings are from opposite ones, in radians, −π to π.
fn off_opposite(fore: f64, back: f64) -> f64 {
    let off = fore - back - PI;
    off - TAU * (off / TAU).round()
}
