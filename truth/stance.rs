//! How a vehicle stands on the floor.
//!
//! Its wheels rest on a plane, and its body is level with that. What is under, over and beside the body is compared with the
//! plane, cell by cell of the footprint. Not promised: suspensions, tracks or gaits, which get over more.

use super::floor::{Floor, Lookup};
use super::vehicle::{Cause, Class, Fault, Vehicle};

/// How much steeper than its limits a floor may be before there is no hope for a vehicle: 6°. Drives of a rover on four wheels
/// just above its limit were a matter of chance.
const MARGINAL_RAD: f64 = 0.105;
/// The same for steps, as a share of the limit.
const MARGINAL_STEP: f64 = 1.25;
/// How much of its step a vehicle loses where it climbs as steeply as it can: tuned, as wheels on a slope of 27° were stuck at a
/// bump of half the step.
const CLIMBING: f64 = 0.6;
/// How the shares of grip that a slope ahead and one to a side take add up, as a power: tuned, as a rover slipped on floors of 32° to 33°
/// that leaned 20° to a side, and drove straight up and down them.
const GRIP: f64 = 1.5;
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

/// The footprint of a vehicle that faces one way.
pub struct Footprint<'a> {
    vehicle: &'a Vehicle,
    ahead: [f64; 2],
    /// From the middle, in metres on the map.
    wheels: [[f64; 2]; 4],
    /// From the sides inwards: that is where rock is met first.
    spots: Vec<Spot>,
    /// Under the front wheels.
    treads: Vec<[f64; 2]>,
}

/// A cell of a footprint, from its middle.
struct Spot {
    offset_m: [f64; 2],
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
}

impl<'a> Footprint<'a> {
    /// The footprint in cells with this side in metres.
    pub fn new(vehicle: &'a Vehicle, heading_rad: f64, cell_m: f64) -> Self {
        let (sin, cos) = (libm::sin(heading_rad), libm::cos(heading_rad));
        let onto_map = |along_m: f64, across_m: f64| [along_m * cos - across_m * sin, along_m * sin + across_m * cos];
        let [fore_m, side_m] = [vehicle.wheel_base_m / 2.0, vehicle.track_m / 2.0];
        let wheels =
            [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]| onto_map(x * fore_m, y * side_m));
        let inner_m = (vehicle.track_m - vehicle.width_m / 2.0).max(0.0);
        let along = spread(vehicle.length_m / 2.0, cell_m);
        let spot = |along_m: f64, across_m: f64| Spot {
            offset_m: onto_map(along_m, across_m),
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
        let under = |side: f64| tyre.iter().map(move |across_m| onto_map(fore_m, side * side_m + across_m));
        Self { vehicle, ahead: [cos, sin], wheels, spots, treads: [1.0, -1.0].into_iter().flat_map(under).collect() }
    }

    /// How the vehicle stands here; `None` if there is no floor under one of its wheels. Once it is clear that it does not get
    /// through, nothing more is compared.
    pub fn stand(&self, floor: &Floor, at_m: [f64; 2], near_m: f64) -> Option<Stance> {
        let mut site = Site { floor: Lookup::new(floor), at_m };
        let ground = self.ground(&mut site, near_m)?;
        let (climb_rad, lean_rad) = (libm::atan(ground.ahead), libm::atan(ground.left));
        let mut worst = Worst::default();
        worst.compare(Cause::Climb, climb_rad, self.vehicle.climb_rad, MARGINAL_RAD);
        worst.compare(Cause::Descent, -climb_rad, self.vehicle.descent_rad, MARGINAL_RAD);
        worst.compare(Cause::SideSlope, lean_rad.abs(), self.vehicle.side_slope_rad, MARGINAL_RAD);
        let slope_rad = libm::atan(libm::hypot(ground.ahead, ground.left));
        worst.compare(Cause::Slope, slope_rad, self.steepest_rad(&ground), MARGINAL_RAD);
        self.judge_steps(&mut site, &ground, &mut worst);
        let mut spots = self.spots.iter();
        while let Some(spot) = spots.next().filter(|_| worst.class < Class::NoGo) {
            self.judge_spot(&mut site, &ground, spot, &mut worst);
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

    /// The plane with the least squares of distances to the floor under the four wheels.
    fn ground(&self, site: &mut Site, near_m: f64) -> Option<Ground> {
        let mut heights_m = [0.0; 4];
        for (height_m, wheel) in heights_m.iter_mut().zip(self.wheels) {
            *height_m = site.tread_m(wheel, near_m)?;
        }
        let [front_left, front_right, rear_left, rear_right] = heights_m;
        let rise = |one: [f64; 2], other: [f64; 2], away_m: f64| (one[0] + one[1] - other[0] - other[1]) / 2.0 / away_m;
        Some(Ground {
            middle_m: heights_m.iter().sum::<f64>() / 4.0,
            ahead: rise([front_left, front_right], [rear_left, rear_right], self.vehicle.wheel_base_m),
            left: rise([front_left, rear_left], [front_right, rear_right], self.vehicle.track_m),
        })
    }

    /// Compares how the floor rises and falls just ahead of the front wheels.
    fn judge_steps(&self, site: &mut Site, ground: &Ground, worst: &mut Worst) {
        let Vehicle { step_m, climb_rad, descent_rad, wheel_base_m, .. } = *self.vehicle;
        let near_m = ground.middle_m + ground.ahead * wheel_base_m / 2.0;
        let strain = (libm::atan(ground.ahead) / climb_rad).clamp(0.0, 1.0);
        let most_m = step_m * (1.0 - CLIMBING * strain);
        let marginal_m = (MARGINAL_STEP - 1.0) * step_m;
        let deepest = libm::tan(descent_rad + MARGINAL_RAD);
        for [x, y] in self.treads.iter().copied() {
            let Some(from_m) = site.height_m([x, y], near_m) else { continue };
            for run_m in STEPS_M {
                let there = [x + run_m * self.ahead[0], y + run_m * self.ahead[1]];
                let Some(to_m) = site.height_m(there, near_m) else { continue };
                let rise_m = to_m - from_m;
                // Slopes are judged by the plane of all wheels.
                let up_m = rise_m - run_m * ground.ahead.max(0.0);
                worst.compare(Cause::Step, up_m, most_m, marginal_m);
                worst.compare(Cause::Step, -rise_m, step_m.max(run_m * deepest), marginal_m);
            }
        }
    }

    /// Compares what is under and over a cell of the footprint with the plane of the wheels.
    fn judge_spot(&self, site: &mut Site, ground: &Ground, spot: &Spot, worst: &mut Worst) {
        let Vehicle { height_m, ground_clearance_m, wheel_base_m, .. } = *self.vehicle;
        let under_m = ground.under(spot);
        let overhang_m = (spot.along_m.abs() - wheel_base_m / 2.0).max(0.0);
        // Bumpers are higher than bellies: about as the floor of a slope of 45° under them.
        let most_m = ground_clearance_m + overhang_m;
        let Some([up_m, room_m]) = site.gap(spot.offset_m, under_m).map(|gap| gap.map(|z| z - under_m)) else {
            return worst.narrow(2.0 * spot.across_m.abs(), self.vehicle);
        };
        if spot.part == Part::Belly {
            worst.compare(Cause::Belly, up_m - overhang_m, ground_clearance_m - SPARE_M, SPARE_M);
        } else if up_m > most_m || up_m < -DROP_M || spot.part == Part::Nothing && room_m < height_m {
            return worst.narrow(2.0 * spot.across_m.abs(), self.vehicle);
        }
        if spot.part != Part::Nothing {
            worst.compare(Cause::Headroom, -room_m, -height_m - SPARE_M, SPARE_M);
        }
    }
}

/// The floor around the middle of a footprint.
struct Site<'a> {
    floor: Lookup<'a>,
    at_m: [f64; 2],
}

impl Site<'_> {
    /// Floor and ceiling at an offset from the middle.
    fn gap(&mut self, [x, y]: [f64; 2], near_m: f64) -> Option<[f64; 2]> {
        let gap = self.floor.gap([self.at_m[0] + x, self.at_m[1] + y], near_m as f32)?;
        Some(gap.map(f64::from))
    }

    fn height_m(&mut self, offset_m: [f64; 2], near_m: f64) -> Option<f64> {
        Some(self.gap(offset_m, near_m)?[0])
    }

    /// Height of the floor under a wheel: the mean of the cells that it rests on.
    fn tread_m(&mut self, [x, y]: [f64; 2], near_m: f64) -> Option<f64> {
        /// Least number of cells with floor, of nine.
        const LEAST: u32 = 5;
        let side_m = self.floor.cell_m();
        let (mut sum_m, mut count) = (0.0, 0);
        let off_m = [-side_m, 0.0, side_m];
        for [i, j] in off_m.into_iter().flat_map(|i| off_m.map(|j| [i, j])) {
            let height_m = self.height_m([x + i, y + j], near_m);
            if let Some(height_m) = height_m.filter(|height_m| (height_m - near_m).abs() <= SAME_FLOOR_M) {
                sum_m += height_m;
                count += 1;
            }
        }
        (count >= LEAST).then(|| sum_m / f64::from(count))
    }
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
