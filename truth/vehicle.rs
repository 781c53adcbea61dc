//! Robots: what they measure, and what they get over and through.

/// A robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// One on wheels or legs.
    Vehicle(Vehicle),
    /// One that flies.
    Drone(Drone),
}

/// A robot on wheels or legs.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// From front to back, in metres.
    pub length_m: f64,
    /// From side to side, in metres.
    pub width_m: f64,
    /// From the floor to its highest point, in metres.
    pub height_m: f64,
    /// Between the axles, or between fore and hind feet, in metres.
    pub wheel_base_m: f64,
    /// Between the middles of left and right wheels or feet, in metres.
    pub track_m: f64,
    /// Between the floor and its belly, in metres.
    pub ground_clearance_m: f64,
    /// Highest step that it climbs, in metres.
    pub step_m: f64,
    /// Steepest slope that it climbs, in radians.
    pub climb_rad: f64,
    /// Steepest slope that it comes down, in radians.
    pub descent_rad: f64,
    /// Steepest slope across its way, in radians.
    pub side_slope_rad: f64,
    /// Steepest floor on which it turns on the spot by an eighth, as in a bend, in radians.
    pub turn_rad: f64,
    /// Steepest floor on which it stops to turn by about a right angle or more, in radians.
    pub stop_rad: f64,
    /// Room on either side that keeps it free of rock when it strays from its path, in metres.
    pub margin_m: f64,
}

/// A robot that flies: a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drone {
    /// Radius of the sphere in metres.
    pub radius_m: f64,
    /// Room around it that keeps it free of rock when it strays from its path, in metres.
    pub margin_m: f64,
}

/// Whether a robot gets through, the best first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// It does.
    #[default]
    Go,
    /// It may: near the limits of a robot it is a matter of chance.
    Marginal,
    /// It does not.
    NoGo,
}

impl Class {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Go => "go",
            Self::Marginal => "marginal",
            Self::NoGo => "no-go",
        }
    }
}

/// What is in the way of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// How steeply the floor rises ahead, in radians.
    Climb,
    /// How steeply the floor falls ahead, in radians.
    Descent,
    /// How steeply the floor leans to a side, in radians.
    SideSlope,
    /// How steep the floor is in all, ahead and to a side, in radians.
    Slope,
    /// How high or deep a step is, in metres.
    Step,
    /// How high the floor between the wheels is, in metres.
    Belly,
    /// How high the ceiling is over the plane of the wheels, in metres.
    Headroom,
    /// How much width is free of rock and drops, in metres.
    Width,
    /// There is no floor, or no air, that leads there.
    NoFloor,
}

impl Cause {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Climb => "climb",
            Self::Descent => "descent",
            Self::SideSlope => "side-slope",
            Self::Slope => "slope",
            Self::Step => "step",
            Self::Belly => "belly",
            Self::Headroom => "headroom",
            Self::Width => "width",
            Self::NoFloor => "no-floor",
        }
    }

    /// Whether it is measured as an angle.
    pub fn is_angle(self) -> bool {
        matches!(self, Self::Climb | Self::Descent | Self::SideSlope | Self::Slope)
    }
}

/// Why a robot does not simply get through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What is in its way.
    pub cause: Cause,
    /// How much of that, in radians or metres.
    pub value: f64,
    /// With how much of that it would simply get through.
    pub limit: f64,
}

impl Fault {
    /// Its value and limit in degrees or metres.
    pub fn at_edge(&self) -> [f64; 2] {
        [self.value, self.limit].map(|value| if self.cause.is_angle() { value.to_degrees() } else { value })
    }
}
