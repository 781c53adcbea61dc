//! Cave surveys as Survex data (`.svx`), as `cavern` reads them: <https://survex.com/docs/manual/datafile.htm>.
//!
//! Tapes are in metres to a tenth of a millimetre, angles in degrees to a ten-thousandth, finer than any instrument, so that what
//! has no errors is placed as exactly as a millimetre.

/// A survey.
pub struct Survey<'a> {
    /// Its name.
    pub name: &'a str,
    /// What made it.
    pub generator: &'a str,
    /// Standard deviations of the readings, if they have errors.
    pub errors: Option<Errors>,
    /// Stations whose places are known, in metres.
    pub fixed: Vec<(&'a str, [f64; 3])>,
    /// What was measured.
    pub legs: Vec<Leg<'a>>,
    /// Cross-sections at both ends of passages; those that could not be measured are left out.
    pub passages: Vec<[Section<'a>; 2]>,
}

/// Standard deviations of readings.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of the tape, in metres.
    pub tape_m: f64,
    /// Of compass and clinometer, in degrees.
    pub angle_deg: f64,
}

/// A leg from one station to another.
pub struct Leg<'a> {
    /// The stations.
    pub ends: [&'a str; 2],
    /// Distance in metres.
    pub tape_m: f64,
    /// Where it leads.
    pub aim: Aim,
}

/// Where a leg leads.
pub enum Aim {
    /// Along a bearing.
    Bearing {
        /// From north, which is +y, over east, in degrees from 0 to 360.
        compass_deg: f64,
        /// Upwards, in degrees.
        clino_deg: f64,
    },
    /// Straight up.
    Up,
    /// Straight down.
    Down,
}

/// What is around a station for one who looks along a passage.
pub struct Section<'a> {
    /// The station.
    pub station: &'a str,
    /// To the left, to the right, up and down, in metres.
    pub room_m: [f64; 4],
}

impl Survey<'_> {
    /// The file.
    pub fn text(&self) -> String {
        let mut lines = vec![
            format!("; made by {}: metres and degrees, x is east, y is north", self.generator),
            format!("*begin {}", self.name),
            "*case preserve".to_owned(),
        ];
        if let Some(Errors { tape_m, angle_deg }) = self.errors {
            lines.extend((tape_m > 0.0).then(|| format!("*sd tape {tape_m} metres")));
            lines.extend((angle_deg > 0.0).then(|| format!("*sd compass clino {angle_deg} degrees")));
        }
        lines.extend(self.fixed.iter().map(|(name, [x, y, z])| format!("*fix {name} {x:.4} {y:.4} {z:.4}")));
        lines.push("*data normal from to tape compass clino".to_owned());
        lines.extend(self.legs.iter().map(|Leg { ends: [from, to], tape_m, aim }| match aim {
            Aim::Bearing { compass_deg, clino_deg } => {
                format!("{from} {to} {tape_m:.4} {compass_deg:.4} {clino_deg:.4}")
            }
            Aim::Up => format!("{from} {to} {tape_m:.4} - UP"),
            Aim::Down => format!("{from} {to} {tape_m:.4} - DOWN"),
        }));
        for ends in &self.passages {
            lines.push("*data passage station left right up down".to_owned());
            lines.extend(ends.iter().map(|Section { station, room_m: [left, right, up, down] }| {
                format!("{station} {left:.2} {right:.2} {up:.2} {down:.2}")
            }));
        }
        lines.push(format!("*end {}\n", self.name));
        lines.join("\n")
    }
}
