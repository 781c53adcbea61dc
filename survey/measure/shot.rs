//! From readings to a vector and its covariance.
//!
//! Covariances follow from the readings by error propagation, with the assumptions of Survex for missing readings: a shot
//! without a gradient is level, with a standard deviation of √0.1 of its length.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix3, Vector3};

use super::{Cell, Dialect, Instruments, Quantity, Reading, Row, Style};
use crate::limits::MAX_LENGTH_M;
use crate::traverse::Accuracy;

/// Variance of the rise of a shot without a gradient, relative to the square of its length.
const UNKNOWN_SLOPE: f64 = 0.1;
/// Tolerance for a gradient to count as vertical, in radians: a rounding error.
const PLUMB: f64 = 1e-6;

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) enum Measured {
    Shot {
        vector: Vector3<f64>,
        covariance: Matrix3<f64>,
    },
    /// Both stations are the same.
    Nothing,
    /// There is a connection, nothing else is known.
    Way,
}

/// The slope of a shot.
#[derive(Clone, Copy, PartialEq)]
enum Slope {
    Plumb(f64),
    Level,
    Gradient(f64),
    Unknown,
}

impl Instruments {
    /// The result of these readings.
    ///
    /// # Errors
    /// If there are too few, or they are implausible.
    pub(in super::super) fn shot(&self, style: Style, row: &Row) -> Result<Measured, String> {
        let measured = match style {
            Style::Normal => self.normal(row)?,
            Style::Diving => self.diving(row)?,
            Style::Cylpolar => self.cylpolar(row)?,
            Style::Cartesian => self.cartesian(row)?,
            Style::NoSurvey | Style::Passage | Style::Ignore => Measured::Way,
        };
        match &measured {
            Measured::Shot { vector, .. } if !(0.0..=MAX_LENGTH_M).contains(&vector.norm()) => {
                Err(format!("the shot is longer than {} km", MAX_LENGTH_M / 1000.0))
            }
            _ => Ok(measured),
        }
    }

    /// Distances to the walls left, right, above and below in metres, where measured: at the start of the leg or, if given,
    /// at its end.
    pub(in super::super) fn walls(&self, row: &Row, at_end: bool) -> [Option<f64>; 4] {
        [Quantity::Left, Quantity::Right, Quantity::Up, Quantity::Down].map(|side| {
            let number = match row.cell(Reading::Of(side))? {
                Cell::Number(number) if !at_end => number,
                Cell::Pair(start, end) => {
                    if at_end {
                        end
                    } else {
                        start
                    }
                }
                _ => return None,
            };
            let distance = self.value(side, number);
            (0.0..=MAX_LENGTH_M).contains(&distance).then_some(distance)
        })
    }

    fn normal(&self, row: &Row) -> Result<Measured, String> {
        let (length, length_m) = self.length(row)?;
        if self.infer_equates && row.number(Reading::Of(Quantity::Length)) == Some(0.0) {
            return Ok(Measured::Nothing);
        }
        let bearing = self.bearing(row);
        let (slope, gradient_rad) = match self.slope(row) {
            // A shot without a bearing has been plumbed.
            (Slope::Gradient(gradient), spread) if bearing.is_none() && is_plumb(gradient) => {
                (Slope::Plumb(gradient.signum()), spread)
            }
            taken => taken,
        };
        let mut accuracy = Accuracy {
            length_m,
            gradient_rad,
            plumb_rad: self.spread(Quantity::Plumb),
            position_m: self.spread(Quantity::Position),
            ..Accuracy::default()
        };
        if let Slope::Plumb(up) = slope {
            let vector = Vector3::new(0.0, 0.0, up * length);
            return Ok(Measured::Shot { covariance: accuracy.covariance(&vector), vector });
        }
        let Some((bearing, bearing_rad)) = bearing else {
            return Err("the bearing is missing, and the shot is not plumbed".to_owned());
        };
        accuracy.bearing_rad = bearing_rad;
        let gradient = if let Slope::Gradient(gradient) = slope { gradient } else { 0.0 };
        if slope == Slope::Level {
            accuracy.gradient_rad = self.spread(Quantity::Level);
        }
        let plan = length * libm::cos(gradient);
        let vector = Vector3::new(plan * libm::sin(bearing), plan * libm::cos(bearing), length * libm::sin(gradient));
        let mut covariance = accuracy.covariance(&vector);
        if slope == Slope::Unknown {
            covariance[(2, 2)] = accuracy.station()[(2, 2)] + UNKNOWN_SLOPE * length * length;
        }
        Ok(Measured::Shot { vector, covariance })
    }

    /// Shots with the tape along the shot and the rise from a depth gauge.
    fn diving(&self, row: &Row) -> Result<Measured, String> {
        let (length, length_m) = self.length(row)?;
        let (rise, rise_m) = self.rise(row)?;
        let plan2 = length * length - rise * rise;
        let Some((bearing, bearing_rad)) = self.bearing(row).filter(|_| plan2 > 0.0) else {
            // Tape and gauge overlap, so each is weighted by its variance.
            let (of_length, of_rise) = (length_m * length_m, rise_m * rise_m);
            let both = (of_length + of_rise).max(f64::MIN_POSITIVE);
            let height = (length * of_rise + rise.abs() * of_length) / both;
            return Ok(self.plumbed(height.copysign(rise), length, of_length * of_rise / both));
        };
        let plan = plan2.sqrt();
        let ahead = ahead(bearing);
        let vector = ahead * plan + Vector3::z() * rise;
        let along = ahead * (length_m * length / plan);
        let up = (Vector3::z() - ahead * (rise / plan)) * rise_m;
        Ok(self.by_depth(vector, bearing_rad, along, up))
    }

    /// Shots with a horizontal tape and the rise from a depth gauge.
    fn cylpolar(&self, row: &Row) -> Result<Measured, String> {
        let (length, length_m) = self.length(row)?;
        let (rise, rise_m) = self.rise(row)?;
        let Some((bearing, bearing_rad)) = self.bearing(row) else {
            return Ok(self.plumbed(rise, rise, rise_m * rise_m));
        };
        let ahead = ahead(bearing);
        let vector = ahead * length + Vector3::z() * rise;
        Ok(self.by_depth(vector, bearing_rad, ahead * length_m, Vector3::z() * rise_m))
    }

    /// A vertical shot, with an uncertainty of `length` sideways.
    fn plumbed(&self, rise: f64, length: f64, variance: f64) -> Measured {
        let aside = length * self.spread(Quantity::Plumb);
        let variances = Vector3::new(aside * aside, aside * aside, variance);
        let covariance = self.station() + Matrix3::from_diagonal(&variances);
        Measured::Shot { vector: Vector3::z() * rise, covariance }
    }

    /// A shot with the standard deviations `along` the tape and `up` of the depth gauge.
    fn by_depth(&self, vector: Vector3<f64>, bearing_rad: f64, along: Vector3<f64>, up: Vector3<f64>) -> Measured {
        let across = Vector3::new(vector.y, -vector.x, 0.0) * bearing_rad;
        let instruments = along * along.transpose() + up * up.transpose() + across * across.transpose();
        Measured::Shot { vector, covariance: self.station() + instruments }
    }

    /// The variance of the stations themselves.
    fn station(&self) -> Matrix3<f64> {
        Accuracy { position_m: self.spread(Quantity::Position), ..Accuracy::default() }.station()
    }

    fn cartesian(&self, row: &Row) -> Result<Measured, String> {
        let axes = [Quantity::East, Quantity::North, Quantity::Altitude];
        let mut vector = Vector3::zeros();
        let mut variances = Vector3::zeros();
        for (axis, quantity) in axes.into_iter().enumerate() {
            let number = row.number(Reading::Of(quantity)).ok_or("a coordinate is missing")?;
            vector[axis] = self.value(quantity, number);
            variances[axis] = self.spread(quantity) * self.spread(quantity);
        }
        if self.dialect == Dialect::Therion {
            // Relative to magnetic north in Therion, to grid north in Survex.
            let (sine, cosine) = libm::sincos(self.declination_rad());
            vector = Vector3::new(vector.x * cosine + vector.y * sine, vector.y * cosine - vector.x * sine, vector.z);
        }
        let least = Accuracy { position_m: 0.0, ..Accuracy::default() }.station();
        Ok(Measured::Shot { vector, covariance: Matrix3::from_diagonal(&variances) + least })
    }

    /// The length in metres, and its standard deviation.
    pub(super) fn length(&self, row: &Row) -> Result<(f64, f64), String> {
        let taken = [Quantity::Length, Quantity::BackLength].map(|quantity| {
            let number = row.number(Reading::Of(quantity))?;
            Some((self.value(quantity, number), self.spread(quantity)))
        });
        let counted = || {
            let [from, to] = [Reading::FromCount, Reading::ToCount].map(|reading| row.number(reading));
            let length = self.value(Quantity::Count, to?) - self.value(Quantity::Count, from?);
            Some((length, self.spread(Quantity::Count)))
        };
        both(taken[0], taken[1]).or_else(counted).ok_or_else(|| "the length is missing".to_owned())
    }

    /// The rise in metres, and its standard deviation.
    pub(super) fn rise(&self, row: &Row) -> Result<(f64, f64), String> {
        let spread = self.spread(Quantity::Depth);
        if let Some(change) = row.number(Reading::DepthChange) {
            return Ok((self.value(Quantity::Depth, change), spread * 2.0_f64.sqrt()));
        }
        let [from, to] = [Reading::FromDepth, Reading::ToDepth].map(|reading| row.number(reading));
        let (Some(from), Some(to)) = (from, to) else { return Err("the depth is missing".to_owned()) };
        Ok((self.value(Quantity::Depth, to) - self.value(Quantity::Depth, from), spread * 2.0_f64.sqrt()))
    }

    /// The bearing from true north and its standard deviation, in radians.
    fn bearing(&self, row: &Row) -> Option<(f64, f64)> {
        let read = |quantity| {
            let number = row.number(Reading::Of(quantity))?;
            Some((self.value(quantity, number), self.spread(quantity)))
        };
        let fore = read(Quantity::Bearing);
        let back = read(Quantity::BackBearing).map(|(bearing, spread)| {
            let there = bearing + PI;
            // Reversed to match the foresight, so that both can be averaged.
            let near = fore.map_or(0.0, |(fore, _)| fore);
            (there - TAU * ((there - near) / TAU).round(), spread)
        });
        let (bearing, spread) = both(fore, back)?;
        Some((bearing - self.gauges[Quantity::Declination as usize].zero, spread))
    }

    /// The slope, and the standard deviation of a gradient in radians.
    fn slope(&self, row: &Row) -> (Slope, f64) {
        let read = |quantity| match row.cell(Reading::Of(quantity))? {
            Cell::Up => Some(Slope::Plumb(1.0)),
            Cell::Down => Some(Slope::Plumb(-1.0)),
            Cell::Level => Some(Slope::Level),
            Cell::Number(number) => Some(self.gradient(quantity, number)),
            Cell::Omitted | Cell::Pair(..) => None,
        };
        let spreads = [self.spread(Quantity::Gradient), self.spread(Quantity::BackGradient)];
        let back = read(Quantity::BackGradient).map(|slope| match slope {
            Slope::Plumb(up) => Slope::Plumb(-up),
            Slope::Gradient(gradient) => Slope::Gradient(-gradient),
            other => other,
        });
        match (read(Quantity::Gradient), back) {
            (Some(Slope::Gradient(fore)), Some(Slope::Gradient(back))) => {
                let (gradient, spread) = mean((fore, spreads[0]), (back, spreads[1]));
                (Slope::Gradient(gradient), spread)
            }
            (Some(slope), _) => (slope, spreads[0]),
            (None, Some(slope)) => (slope, spreads[1]),
            (None, None) => (Slope::Unknown, spreads[0]),
        }
    }

    fn gradient(&self, quantity: Quantity, number: f64) -> Slope {
        let raw = self.gauges[quantity as usize].unit.of(number);
        if self.infer_plumbs && is_plumb(raw) {
            return Slope::Plumb(raw.signum());
        }
        Slope::Gradient(self.value(quantity, number))
    }
}

/// The unit vector of a bearing in plan.
fn ahead(bearing_rad: f64) -> Vector3<f64> {
    Vector3::new(libm::sin(bearing_rad), libm::cos(bearing_rad), 0.0)
}

fn is_plumb(gradient_rad: f64) -> bool {
    (gradient_rad.abs() - FRAC_PI_2).abs() < PLUMB
}

/// The mean of two measurements, or the only one.
fn both(a: Option<(f64, f64)>, b: Option<(f64, f64)>) -> Option<(f64, f64)> {
    match (a, b) {
        (Some(a), Some(b)) => Some(mean(a, b)),
        (a, b) => a.or(b),
    }
}

/// The mean of two measurements weighted by their variances, and its standard deviation.
fn mean((a, of_a): (f64, f64), (b, of_b): (f64, f64)) -> (f64, f64) {
    let [va, vb] = [of_a, of_b].map(|spread| (spread * spread).max(1e-12));
    ((a * vb + b * va) / (va + vb), (va * vb / (va + vb)).sqrt())
}
