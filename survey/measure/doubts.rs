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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use plume_graph::NoOutside;

    use crate::{Parts, Source, compass, svx, therion, walls};

    /// What is told of doubtful readings, as the readers of surveys tell it.
    fn warnings(name: &str, text: &str) -> String {
        let reader = match name.rsplit_once('.').expect("it has an extension").1 {
            "svx" => svx::import,
            "th" => therion::import,
            "srv" => walls::import,
            _ => compass::import,
        };
        let source = Source { path: Path::new(name), bytes: text.as_bytes(), outside: &NoOutside };
        let import = reader(&source, Parts::Refuse).unwrap();
        assert_eq!(import.tally.doubtful, import.warnings.len());
        import.warnings.iter().map(|warning| format!("{warning}\n")).collect()
    }

    /// Cavern 1.4.4 warns of the same readings.
    const DOUBTFUL: &str = "\
1 2 10 0 95
2 3 10 400 -90
3 4 -10 360 90
*units compass clino grads
4 5 10 400 100
5 6 10 401 -101
*units compass clino degrees
*calibrate tape 11
6 7 10 0 0
*calibrate tape 0
*data normal from to tape compass backcompass clino backclino
7 8 10 1 181 5 -5
8 9 10 20 190 5 -10
*data diving station newline tape compass depthchange
9
5 -1 6
10
*data normal from to tape compass clino
*flags splay
10 .. -2 0 up
";

    #[test]
    fn implausible_readings_are_told_by_line() {
        let told = "\
cave.svx:1: the clino reading 95 is not within -90 to 90
cave.svx:2: the compass reading 400 is not within 0 to 360
cave.svx:3: the tape reading -10 is negative
cave.svx:6: the compass reading 401 is not within 0 to 400
cave.svx:6: the clino reading -101 is not within -100 to 100
cave.svx:9: the length is negative once it is corrected
cave.svx:13: the clino readings of both ends differ by 5.0°
cave.svx:13: the compass readings of both ends differ by 10.0°
cave.svx:16: the compass reading -1 is not within 0 to 360
cave.svx:16: the tape is shorter than the change in depth
cave.svx:20: the tape reading -2 is negative
";
        assert_eq!(warnings("cave.svx", DOUBTFUL), told);
    }

    #[test]
    fn no_more_than_a_hundred_doubts_are_told() {
        let legs: String = (0..200).map(|leg| format!("{leg} {} 5 0 91\n", leg + 1)).collect();
        let source = Source { path: Path::new("cave.svx"), bytes: legs.as_bytes(), outside: &NoOutside };
        let import = svx::import(&source, Parts::Refuse).unwrap();
        assert_eq!((import.warnings.len(), import.tally.doubtful), (100, 200));
    }

    #[test]
    fn implausible_readings_are_told_in_other_formats() {
        let therion = "centreline\nunits compass grads\n1 2 9 401 0\nendcentreline\n";
        assert_eq!(warnings("a.th", therion), "a.th:3: the compass reading 401 is not within 0 to 400\n");
        let compass = "FROM TO\n\nA1 A2 10 370 -91 1 1 1 1\n";
        let told = "a.dat:3: the compass reading 370 is not within 0 to 360\n\
                    a.dat:3: the clino reading -91 is not within -90 to 90\n";
        assert_eq!(warnings("a.dat", compass), told);
    }
}
