//! How a vehicle stands on the floor.
//!
//! Its wheels rest on a plane, and its body is level with that. What is under, over and beside the body is compared with the
//! plane, cell by cell of the footprint. Not promised: suspensions, tracks or gaits, which get over more.

use std::f64::consts::FRAC_PI_2;

use super::floor::{Floor, rounded_down};
use super::vehicle::{Cause, Class, Fault, Vehicle};
use super::window::{Place, Size, Window};

/// How much steeper than its limits a floor may be before there is no hope for a vehicle: 6°. Drives of a rover on four wheels
/// just above its limit were a matter of chance.
const MARGINAL_RAD: f64 = 0.105;
/// The same for steps, as a share of the limit.
const MARGINAL_STEP: f64 = 1.25;
/// How much of its step a vehicle loses on a floor as steep as it can climb: tuned, as wheels on a slope of 27° were stuck at a bump of
/// half the step.
const CLIMBING: f64 = 0.6;
/// How the shares of grip that a slope ahead and one to a side take add up, as a power: tuned, as a rover slipped on floors of 32° to 33°
/// that leaned 20° to a side, and drove straight up and down them.
const GRIP: f64 = 1.5;
/// How far a vehicle slips to either side of its path where it is steep, as a share of its length: a rover that followed a path on a floor of
/// 28° was 0.2 m beside it, where the floor was steeper, and tipped over.
const DRIFT: f64 = 0.23;
/// Where it is steep, as a share of the steepest slope. Tuned.
const STEEP: f64 = 0.7;
/// Room under and over a body that simply gets through, in metres: floors are known at the centres of cells only.
const SPARE_M: f64 = 0.03;
/// Furthest that the floor under a wheel is from that under the middle, in metres: more is another floor.
const SAME_FLOOR_M: f64 = 0.6;
/// Deepest drop beside a vehicle that stays upright if it strays there, in metres.
const DROP_M: f64 = 0.25;
/// How far ahead of the front wheels steps are looked for, in metres.
const STEPS_M: [f64; 2] = [0.1, 0.2];

/// How a vehicle stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Height in metres of the plane of its wheels at its middle.
    pub ground_m: f64,
    /// Rise of that plane ahead, in radians.
    pub climb_rad: f64,
    /// Rise of that plane to the left, in radians.
    pub lean_rad: f64,
    /// Whether it gets through.
    pub class: Class,
    /// The worst of what keeps it from simply getting through.
    pub fault: Option<Fault>,
}

/// The footprint of a vehicle that faces one way, by places in a window around the cell that holds its middle.
pub struct Footprint<'a> {
    vehicle: &'a Vehicle,
    size: Size,
    /// The cells that each wheel rests on.
    wheels: [[Place; 9]; 4],
    /// The same as far to the left and to the right as it may slip.
    aside: [[[Place; 9]; 4]; 2],
    /// From the sides inwards: that is where rock is met first.
    spots: Vec<Spot>,
    /// Under the front wheels, and at [`STEPS_M`] ahead of that.
    treads: Vec<[Place; 1 + STEPS_M.len()]>,
}

/// A cell of a footprint.
struct Spot {
    place: Place,
    along_m: f64,
    across_m: f64,
    part: Part,
}

/// What a vehicle has over a cell.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Belly,
    Wheels,
    /// Only air, as long as it does not stray from its path.
    Nothing,
}

/// The plane of the wheels, from the middle of the footprint.
struct Ground {
    middle_m: f64,
    ahead: f64,
    left: f64,
}

impl Ground {
    fn under(&self, spot: &Spot) -> f64 {
        self.middle_m + self.ahead * spot.along_m + self.left * spot.across_m
    }

    fn slope_rad(&self) -> f64 {
        libm::atan(libm::hypot(self.ahead, self.left))
    }
}

impl<'a> Footprint<'a> {
    /// The footprint on a floor, of which the middle is in the middle of a cell.
    pub fn new(vehicle: &'a Vehicle, heading_rad: f64, floor: &Floor) -> Self {
        Self::at(vehicle, heading_rad, floor.cell_m(), floor.centre_m([0; 2]))
    }

    /// The footprint in cells with this side in metres, of which the middle is that far from the lower corner of its cell.
    fn at(vehicle: &'a Vehicle, heading_rad: f64, cell_m: f64, middle_m: [f64; 2]) -> Self {
        let (sin, cos) = (libm::sin(heading_rad), libm::cos(heading_rad));
        let size = Size::of(vehicle, cell_m);
        let cell = |along_m: f64, across_m: f64| {
            let offset_m = [along_m * cos - across_m * sin, along_m * sin + across_m * cos];
            [0, 1].map(|axis| rounded_down((middle_m[axis] + offset_m[axis]) / cell_m))
        };
        let place = |along_m: f64, across_m: f64| size.place(cell(along_m, across_m));
        let [fore_m, side_m] = [vehicle.wheel_base_m / 2.0, vehicle.track_m / 2.0];
        let wheels = |aside_m: f64| {
            [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]: [f64; 2]| {
                let [i, j] = cell(x * fore_m, y * side_m + aside_m);
                std::array::from_fn(|n| size.place([i + n as i32 / 3 - 1, j + n as i32 % 3 - 1]))
            })
        };
        let inner_m = (vehicle.track_m - vehicle.width_m / 2.0).max(0.0);
        let along = spread(vehicle.length_m / 2.0, cell_m);
        let spot = |along_m: f64, across_m: f64| Spot {
            place: place(along_m, across_m),
            along_m,
            across_m,
            part: match across_m.abs() {
                away_m if away_m < inner_m => Part::Belly,
                away_m if away_m <= vehicle.width_m / 2.0 => Part::Wheels,
                _ => Part::Nothing,
            },
        };
        let mut across = spread(vehicle.width_m / 2.0 + vehicle.margin_m, cell_m);
        across.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
        let spots = across.iter().flat_map(|across_m| along.iter().map(|along_m| spot(*along_m, *across_m))).collect();
        let tyre = spread(vehicle.width_m / 2.0 - side_m, cell_m);
        let tread = |across_m: f64| {
            let [near_m, far_m] = STEPS_M;
            [0.0, near_m, far_m].map(|run_m| place(fore_m + run_m, across_m))
        };
        let under = |side: f64| tyre.iter().map(move |across_m| tread(side * side_m + across_m));
        Self {
            vehicle,
            size,
            wheels: wheels(0.0),
            aside: [DRIFT, -DRIFT].map(|share| wheels(share * vehicle.length_m)),
            spots,
            treads: [1.0, -1.0].into_iter().flat_map(under).collect(),
        }
    }

    /// The floor around a cell of the map, as far as this footprint needs it; it suits footprints of the vehicle in all directions.
    pub fn window<'f>(&self, floor: &'f Floor, middle: [i32; 2]) -> Window<'f> {
        Window::around(floor, self.size, middle)
    }

    /// How a vehicle stands at any point of the map in metres.
    pub fn stand_at(
        vehicle: &'a Vehicle,
        heading_rad: f64,
        floor: &Floor,
        at_m: [f64; 2],
        near_m: f64,
    ) -> Option<Stance> {
        let (cell, cell_m) = (floor.cell_at(at_m), floor.cell_m());
        let middle_m = [0, 1].map(|axis| at_m[axis] - f64::from(cell[axis]) * cell_m);
        let footprint = Self::at(vehicle, heading_rad, cell_m, middle_m);
        footprint.stand(&footprint.window(floor, cell), near_m)
    }

    /// How the vehicle stands here; `None` if there is no floor under one of its wheels. Once it is clear that it does not get
    /// through, nothing more is compared.
    pub fn stand(&self, window: &Window, near_m: f64) -> Option<Stance> {
        let ground = self.ground(window, &self.wheels, near_m)?;
        let (climb_rad, lean_rad) = (libm::atan(ground.ahead), libm::atan(ground.left));
        let mut worst = Worst::default();
        worst.compare(Cause::Climb, climb_rad, self.vehicle.climb_rad, MARGINAL_RAD);
        worst.compare(Cause::Descent, -climb_rad, self.vehicle.descent_rad, MARGINAL_RAD);
        worst.compare(Cause::SideSlope, lean_rad.abs(), self.vehicle.side_slope_rad, MARGINAL_RAD);
        let steepest_rad = self.steepest_rad(&ground);
        worst.compare(Cause::Slope, ground.slope_rad(), steepest_rad, MARGINAL_RAD);
        if ground.slope_rad() > STEEP * steepest_rad {
            self.judge_aside(window, near_m, &mut worst);
        }
        self.judge_steps(window, &ground, &mut worst);
        let mut spots = self.spots.iter();
        while let Some(spot) = spots.next().filter(|_| worst.class < Class::NoGo) {
            self.judge_spot(window, &ground, spot, &mut worst);
        }
        let Worst { class, fault, .. } = worst;
        Some(Stance { ground_m: ground.middle_m, climb_rad, lean_rad, class, fault })
    }

    /// The steepest slope in the direction of that of a plane. Wheels have one grip for climbing and for not slipping sideways.
    fn steepest_rad(&self, ground: &Ground) -> f64 {
        let Vehicle { climb_rad, descent_rad, side_slope_rad, .. } = *self.vehicle;
        let ahead_rad = if ground.ahead > 0.0 { climb_rad } else { descent_rad };
        let share = |rise: f64, most_rad: f64| libm::pow(rise.abs() / libm::tan(most_rad), GRIP);
        let used = share(ground.ahead, ahead_rad) + share(ground.left, side_slope_rad);
        if used == 0.0 {
            return ahead_rad;
        }
        libm::atan(libm::hypot(ground.ahead, ground.left) / libm::pow(used, 1.0 / GRIP))
    }

    /// Compares how steep the floor is to either side: marginal at worst, as the vehicle may not slip there. Where there is no floor, it
    /// cannot.
    fn judge_aside(&self, window: &Window, near_m: f64, worst: &mut Worst) {
        for ground in self.aside.iter().filter_map(|wheels| self.ground(window, wheels, near_m)) {
            worst.compare(Cause::Slope, ground.slope_rad(), self.steepest_rad(&ground), FRAC_PI_2);
        }
    }

    /// The plane with the least squares of distances to the floor under four wheels.
    fn ground(&self, window: &Window, wheels: &[[Place; 9]; 4], near_m: f64) -> Option<Ground> {
        let mut heights_m = [0.0; 4];
        for (height_m, wheel) in heights_m.iter_mut().zip(wheels) {
            *height_m = under_wheel_m(window, wheel, near_m)?;
        }
        let [front_left, front_right, rear_left, rear_right] = heights_m;
        let rise = |one: [f64; 2], other: [f64; 2], away_m: f64| (one[0] + one[1] - other[0] - other[1]) / 2.0 / away_m;
        let ahead = rise([front_left, front_right], [rear_left, rear_right], self.vehicle.wheel_base_m);
        let left = rise([front_left, rear_left], [front_right, rear_right], self.vehicle.track_m);
        Some(Ground { middle_m: heights_m.iter().sum::<f64>() / 4.0, ahead, left })
    }

    /// Compares how the floor rises and falls just ahead of the front wheels.
    fn judge_steps(&self, window: &Window, ground: &Ground, worst: &mut Worst) {
        let Vehicle { step_m, climb_rad, descent_rad, wheel_base_m, .. } = *self.vehicle;
        let near_m = ground.middle_m + ground.ahead * wheel_base_m / 2.0;
        let strain = (ground.slope_rad() / climb_rad).min(1.0);
        let most_m = step_m * (1.0 - CLIMBING * strain);
        let marginal_m = (MARGINAL_STEP - 1.0) * step_m;
        let deepest = libm::tan(descent_rad + MARGINAL_RAD);
        for [from, ahead @ ..] in &self.treads {
            let Some(from_m) = height_m(window, *from, near_m) else { continue };
            for (there, run_m) in ahead.iter().zip(STEPS_M) {
                let Some(to_m) = height_m(window, *there, near_m) else { continue };
                let rise_m = to_m - from_m;
                // Slopes are judged by the plane of all wheels.
                let up_m = rise_m - run_m * ground.ahead.max(0.0);
                worst.compare(Cause::Step, up_m, most_m, marginal_m);
                worst.compare(Cause::Step, -rise_m, step_m.max(run_m * deepest), marginal_m);
            }
        }
    }

    /// Compares what is under and over a cell of the footprint with the plane of the wheels.
    fn judge_spot(&self, window: &Window, ground: &Ground, spot: &Spot, worst: &mut Worst) {
        let Vehicle { height_m, ground_clearance_m, wheel_base_m, step_m, .. } = *self.vehicle;
        let under_m = ground.under(spot);
        // Wheels meet what is beside and between them when the vehicle turns, and bumpers may be as low as the belly.
        let is_between_axles = spot.along_m.abs() <= wheel_base_m / 2.0;
        let most_m = if is_between_axles { ground_clearance_m.min(step_m) } else { ground_clearance_m };
        let Some([up_m, room_m]) = gap(window, spot.place, under_m).map(|gap| gap.map(|z| z - under_m)) else {
            return worst.narrow(2.0 * spot.across_m.abs(), self.vehicle);
        };
        if spot.part == Part::Belly {
            worst.compare(Cause::Belly, up_m, ground_clearance_m - SPARE_M, SPARE_M);
        } else if up_m > most_m || up_m < -DROP_M || spot.part == Part::Nothing && room_m < height_m {
            return worst.narrow(2.0 * spot.across_m.abs(), self.vehicle);
        }
        if spot.part != Part::Nothing {
            worst.compare(Cause::Headroom, -room_m, -height_m - SPARE_M, SPARE_M);
        }
    }
}

impl Size {
    /// A window that holds all that a vehicle is over, and what is ahead of its wheels and beside them.
    fn of(vehicle: &Vehicle, cell_m: f64) -> Self {
        let body_m = libm::hypot(vehicle.length_m, vehicle.width_m + 2.0 * vehicle.margin_m) / 2.0;
        let [fore_m, side_m] = [vehicle.wheel_base_m / 2.0, vehicle.track_m / 2.0];
        let tyre_m = (vehicle.width_m / 2.0 - side_m).abs();
        let ahead_m = libm::hypot(fore_m + STEPS_M[STEPS_M.len() - 1], side_m + tyre_m);
        let aside_m = libm::hypot(fore_m, side_m + DRIFT * vehicle.length_m);
        // The middle is anywhere in its cell, and a wheel rests on the cells around its own.
        Self::new((body_m.max(ahead_m).max(aside_m) / cell_m).ceil() as i32 + 2)
    }
}

/// Floor and ceiling at a place.
fn gap(window: &Window, place: Place, near_m: f64) -> Option<[f64; 2]> {
    Some(window.gap(place, near_m as f32)?.map(f64::from))
}

fn height_m(window: &Window, place: Place, near_m: f64) -> Option<f64> {
    Some(gap(window, place, near_m)?[0])
}

/// Height of the floor under a wheel: the mean of the cells that it rests on.
fn under_wheel_m(window: &Window, wheel: &[Place; 9], near_m: f64) -> Option<f64> {
    /// Least number of cells with floor, of nine.
    const LEAST: u32 = 5;
    let (mut sum_m, mut count) = (0.0, 0);
    for place in wheel {
        let height_m = height_m(window, *place, near_m);
        if let Some(height_m) = height_m.filter(|height_m| (height_m - near_m).abs() <= SAME_FLOOR_M) {
            sum_m += height_m;
            count += 1;
        }
    }
    (count >= LEAST).then(|| sum_m / f64::from(count))
}

/// The worst of what was compared so far.
#[derive(Default)]
struct Worst {
    class: Class,
    fault: Option<Fault>,
    /// How far beyond its limit, in shares of what is marginal.
    excess: f64,
}

impl Worst {
    /// Compares a value with its limit, beyond which `marginal` more is marginal.
    fn compare(&mut self, cause: Cause, value: f64, limit: f64, marginal: f64) {
        // Most are within their limits, and divisions are slow.
        if value <= limit {
            return;
        }
        let excess = (value - limit) / marginal;
        if excess <= self.excess {
            return;
        }
        self.excess = excess;
        self.class = if excess > 1.0 { Class::NoGo } else { Class::Marginal };
        let is_least = matches!(cause, Cause::Headroom | Cause::Width);
        let [value, limit] = if is_least { [-value, -limit] } else { [value, limit] };
        self.fault = Some(Fault { cause, value, limit });
    }

    /// Notes that no more than a width is free.
    fn narrow(&mut self, free_m: f64, vehicle: &Vehicle) {
        let wanted_m = vehicle.width_m + 2.0 * vehicle.margin_m;
        let marginal_m = 2.0 * vehicle.margin_m.max(SPARE_M);
        self.compare(Cause::Width, -free_m, -wanted_m, marginal_m);
    }
}

/// Places from `-most` to `most` metres, no further from each other than a cell.
fn spread(most_m: f64, cell_m: f64) -> Vec<f64> {
    let count = (2.0 * most_m / cell_m).ceil() as usize;
    (0..=count).map(|i| most_m * (2.0 * i as f64 / count as f64 - 1.0)).collect()
}
