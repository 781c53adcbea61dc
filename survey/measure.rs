//! What surveyors measure, with which instruments, and how a shot is computed from it.
//!
//! Survex and Therion share their terms, and Compass measures the same, so their readers share this: [`Instruments`] are the
//! settings for the lines that follow, an [`Order`] says which column holds what, [`Columns`] assembles the lines, and
//! [`Instruments::shot`] turns readings into a vector (Survex manual 1.4, chapter 4; Therion book 6.1, `centreline`).

mod columns;
mod doubts;
mod order;
mod shot;
mod words;

use std::f64::consts::PI;

pub(super) use columns::{Cell, Columns, Row};
pub(super) use order::{Order, Reading, Style};
pub(super) use shot::Measured;

/// A quantity that an instrument measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Length,
    BackLength,
    Bearing,
    BackBearing,
    Gradient,
    BackGradient,
    Count,
    Depth,
    Declination,
    East,
    North,
    Altitude,
    Left,
    Right,
    Up,
    Down,
    Level,
    Plumb,
    Position,
}

/// Quantities in the order of the enum.
const QUANTITIES: usize = Quantity::Position as usize + 1;

/// Names of the quantities.
const NAMES: &[(&str, Quantity)] = &[
    ("length", Quantity::Length),
    ("tape", Quantity::Length),
    ("backlength", Quantity::BackLength),
    ("backtape", Quantity::BackLength),
    ("bearing", Quantity::Bearing),
    ("compass", Quantity::Bearing),
    ("backbearing", Quantity::BackBearing),
    ("backcompass", Quantity::BackBearing),
    ("gradient", Quantity::Gradient),
    ("clino", Quantity::Gradient),
    ("backgradient", Quantity::BackGradient),
    ("backclino", Quantity::BackGradient),
    ("count", Quantity::Count),
    ("counter", Quantity::Count),
    ("depth", Quantity::Depth),
    ("declination", Quantity::Declination),
    ("easting", Quantity::East),
    ("dx", Quantity::East),
    ("northing", Quantity::North),
    ("dy", Quantity::North),
    ("altitude", Quantity::Altitude),
    ("dz", Quantity::Altitude),
    ("left", Quantity::Left),
    ("right", Quantity::Right),
    ("up", Quantity::Up),
    ("ceiling", Quantity::Up),
    ("down", Quantity::Down),
    ("floor", Quantity::Down),
    ("level", Quantity::Level),
    ("plumb", Quantity::Plumb),
    ("position", Quantity::Position),
];

impl Quantity {
    /// The quantity of this name, in any case.
    pub(super) fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|&(_, quantity)| quantity)
    }

    pub(super) fn is_angle(self) -> bool {
        matches!(
            self,
            Self::Bearing
                | Self::BackBearing
                | Self::Gradient
                | Self::BackGradient
                | Self::Declination
                | Self::Level
                | Self::Plumb
        )
    }

    /// The same quantity measured from the other end of the leg.
    fn back(self) -> Option<Self> {
        match self {
            Self::Length => Some(Self::BackLength),
            Self::Bearing => Some(Self::BackBearing),
            Self::Gradient => Some(Self::BackGradient),
            _ => None,
        }
    }

    fn is_gradient(self) -> bool {
        matches!(self, Self::Gradient | Self::BackGradient)
    }
}

/// Metres per international foot.
pub(super) const METRES_PER_FOOT: f64 = 0.3048;

/// The unit of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    /// A length: this many metres.
    Length(f64),
    /// An angle: this many radians.
    Angle(f64),
    /// A slope in per cent.
    Percent,
    /// A quadrant bearing: `S34E`.
    Quadrants,
}

const UNITS: &[(&str, Unit)] = &[
    ("metres", Unit::Length(1.0)),
    ("metre", Unit::Length(1.0)),
    ("meters", Unit::Length(1.0)),
    ("meter", Unit::Length(1.0)),
    ("metric", Unit::Length(1.0)),
    ("m", Unit::Length(1.0)),
    ("centimetres", Unit::Length(0.01)),
    ("centimetre", Unit::Length(0.01)),
    ("centimeters", Unit::Length(0.01)),
    ("centimeter", Unit::Length(0.01)),
    ("cm", Unit::Length(0.01)),
    ("inches", Unit::Length(0.0254)),
    ("inch", Unit::Length(0.0254)),
    ("in", Unit::Length(0.0254)),
    ("feet", Unit::Length(METRES_PER_FOOT)),
    ("foot", Unit::Length(METRES_PER_FOOT)),
    ("ft", Unit::Length(METRES_PER_FOOT)),
    ("yards", Unit::Length(0.9144)),
    ("yard", Unit::Length(0.9144)),
    ("yd", Unit::Length(0.9144)),
    ("degrees", Unit::Angle(PI / 180.0)),
    ("degree", Unit::Angle(PI / 180.0)),
    ("degs", Unit::Angle(PI / 180.0)),
    ("deg", Unit::Angle(PI / 180.0)),
    ("minutes", Unit::Angle(PI / 10_800.0)),
    ("minute", Unit::Angle(PI / 10_800.0)),
    ("min", Unit::Angle(PI / 10_800.0)),
    ("grads", Unit::Angle(PI / 200.0)),
    ("grad", Unit::Angle(PI / 200.0)),
    // The names of Survex, which Therion adopted.
    ("mils", Unit::Angle(PI / 200.0)),
    ("mil", Unit::Angle(PI / 200.0)),
    ("percentage", Unit::Percent),
    ("percent", Unit::Percent),
    ("quadrants", Unit::Quadrants),
    ("quads", Unit::Quadrants),
];

impl Unit {
    /// The unit of this name, in any case.
    fn named(name: &str) -> Option<Self> {
        UNITS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|&(_, unit)| unit)
    }

    fn times(self, factor: f64) -> Self {
        match self {
            Self::Length(metres) => Self::Length(metres * factor),
            Self::Angle(radians) => Self::Angle(radians * factor),
            Self::Percent | Self::Quadrants => self,
        }
    }

    fn measures(self, quantity: Quantity) -> bool {
        match self {
            Self::Length(_) => !quantity.is_angle(),
            Self::Angle(_) => quantity.is_angle(),
            Self::Percent => quantity.is_gradient(),
            Self::Quadrants => matches!(quantity, Quantity::Bearing | Quantity::BackBearing),
        }
    }

    /// A number in this unit, in metres or radians.
    fn of(self, number: f64) -> f64 {
        match self {
            Self::Length(factor) | Self::Angle(factor) => number * factor,
            Self::Percent => libm::atan(number / 100.0),
            Self::Quadrants => number.to_radians(),
        }
    }
}

/// How one quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gauge {
    unit: Unit,
    /// Zero error, in the unit of the reading.
    read_zero: f64,
    /// Zero error in metres or radians.
    zero: f64,
    scale: f64,
    /// Standard deviation, in metres or radians.
    spread: f64,
}

/// The program whose conventions the settings follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Dialect {
    /// A zero error is in the unit current when it is set.
    #[default]
    Survex,
    /// A zero error is in the unit current when a reading is taken, and settings of an instrument also apply to
    /// backsights.
    Therion,
}

/// The current settings of all instruments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Instruments {
    gauges: [Gauge; QUANTITIES],
    pub(super) dialect: Dialect,
    /// Whether gradients of 90° are plumbed.
    infer_plumbs: bool,
    /// Whether zero-length shots equate their stations.
    infer_equates: bool,
}

/// The defaults of Survex: metres, degrees, and standard deviations of BCRA grade 5.
impl Default for Instruments {
    fn default() -> Self {
        let length = Gauge { unit: Unit::Length(1.0), read_zero: 0.0, zero: 0.0, scale: 1.0, spread: 0.05 };
        let angle = Gauge {
            unit: Unit::Angle(PI / 180.0),
            read_zero: 0.0,
            zero: 0.0,
            scale: 1.0,
            spread: 0.5_f64.to_radians(),
        };
        let mut instruments =
            Self { gauges: [length; QUANTITIES], dialect: Dialect::Survex, infer_plumbs: false, infer_equates: false };
        for &(_, quantity) in NAMES.iter().filter(|(_, quantity)| quantity.is_angle()) {
            instruments.gauges[quantity as usize] = angle;
        }
        for plumb in [Quantity::Level, Quantity::Plumb] {
            instruments.gauges[plumb as usize].spread = 0.25_f64.to_radians();
        }
        instruments
    }
}

/// Limits of settings: values beyond are typing errors, and would make loops unsolvable.
const FACTORS: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

impl Instruments {
    /// The settings of Compass: lengths in feet, angles in degrees, plumbed shots and equates inferred.
    pub(super) fn of_compass() -> Self {
        let mut instruments = Self { infer_plumbs: true, infer_equates: true, ..Self::default() };
        for gauge in instruments.gauges.iter_mut().filter(|gauge| matches!(gauge.unit, Unit::Length(_))) {
            gauge.unit = Unit::Length(METRES_PER_FOOT);
        }
        instruments
    }

    /// The settings of Walls: metres and degrees, plumbed shots and equates inferred.
    pub(super) fn of_walls() -> Self {
        Self { infer_plumbs: true, infer_equates: true, ..Self::default() }
    }

    /// Sets what is added to readings from now on, in the current unit.
    pub(super) fn correct(&mut self, quantity: Quantity, by: f64) {
        let gauge = &mut self.gauges[quantity as usize];
        gauge.zero = -gauge.unit.of(by);
    }

    /// Sets the unit of these quantities from now on.
    fn set_unit(&mut self, of: &[Quantity], factor: f64, unit: Unit) -> Result<(), String> {
        if !FACTORS.contains(&factor.abs()) {
            return Err(format!("the factor of a unit cannot be {factor}"));
        }
        self.set(of, unit, |gauge| gauge.unit = unit.times(factor))
    }

    /// From now on these quantities are (reading − zero) · scale if the zero error is in the unit of the quantity, or
    /// reading · scale − zero if it has its own unit.
    fn calibrate(&mut self, of: &[Quantity], zero: f64, own: Option<Unit>, scale: f64) -> Result<(), String> {
        if !FACTORS.contains(&scale.abs()) {
            return Err(format!("a scale cannot be {scale}"));
        }
        for &quantity in of {
            let gauge = &mut self.gauges[quantity as usize];
            if own.is_some_and(|own| !own.measures(quantity)) {
                return Err("this unit does not fit the calibrated quantity".to_owned());
            }
            gauge.scale = scale;
            (gauge.read_zero, gauge.zero) = match (own, self.dialect) {
                (Some(own), _) => (0.0, own.of(zero) / scale),
                (None, Dialect::Survex) => (0.0, gauge.unit.of(zero)),
                (None, Dialect::Therion) => (zero, 0.0),
            };
        }
        Ok(())
    }

    /// Sets the standard deviation of these quantities.
    fn set_spread(&mut self, of: &[Quantity], spread: f64, unit: Unit) -> Result<(), String> {
        let spread = unit.of(spread);
        if !(0.0..=1e4).contains(&spread) {
            return Err("this is not a valid standard deviation".to_owned());
        }
        self.set(of, unit, |gauge| gauge.spread = spread)
    }

    /// Sets the declination, which is added to every bearing, in radians.
    pub(super) fn set_declination_rad(&mut self, declination_rad: f64) {
        self.gauges[Quantity::Declination as usize].zero = -declination_rad;
    }

    /// The declination, which is added to every bearing, in radians.
    pub(super) fn declination_rad(&self) -> f64 {
        -self.gauges[Quantity::Declination as usize].zero
    }

    /// Resets zero errors and scales.
    pub(super) fn reset_calibration(&mut self) {
        self.gauges.iter_mut().for_each(|gauge| (gauge.read_zero, gauge.zero, gauge.scale) = (0.0, 0.0, 1.0));
    }

    /// Resets units.
    pub(super) fn reset_units(&mut self) {
        let usual = Self::default();
        self.gauges.iter_mut().zip(usual.gauges).for_each(|(gauge, usual)| gauge.unit = usual.unit);
    }

    fn set(&mut self, of: &[Quantity], unit: Unit, change: impl Fn(&mut Gauge)) -> Result<(), String> {
        if of.iter().any(|&quantity| !unit.measures(quantity)) {
            return Err("this unit does not fit the measured quantity".to_owned());
        }
        of.iter().for_each(|&quantity| change(&mut self.gauges[quantity as usize]));
        Ok(())
    }

    /// The value of a reading, in metres or radians.
    fn value(&self, quantity: Quantity, number: f64) -> f64 {
        let gauge = &self.gauges[quantity as usize];
        (gauge.unit.of(number - gauge.read_zero) - gauge.zero) * gauge.scale
    }

    fn spread(&self, quantity: Quantity) -> f64 {
        self.gauges[quantity as usize].spread
    }
}
