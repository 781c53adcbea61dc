//! Ramps of a given slope: straight ones, and arcs of a helix where a straight one would be too steep.
//!
//! A helix through two points has a constant slope, and the largest radius possible. Promised: every step of a ramp is
//! within the range of slopes, after rounding to 1 mm, otherwise there is no ramp; nor is there one of more than 200 steps.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use nalgebra::{Point3, Vector2};

use plume_graph::millimetres;

/// Change of a slope by rounding to 1 mm, in radians.
const ROUNDING: f64 = 2e-4;
/// The longest arc without a whole turn, so that its ends do not meet.
const LONGEST_ARC: f64 = 0.95 * TAU;
/// Maximum turn from one station to the next.
const SHARPEST: f64 = FRAC_PI_4;
/// Bisection steps for a radius or an angle: down to the last bits.
const HALVINGS: usize = 60;
/// Most steps of a ramp: at 4 m each, enough to climb 50 m at 4 degrees.
const MOST_STEPS: f64 = 200.0;
/// Iterations in which an arc is lengthened because its chords are shorter.
const CHORD_ROUNDS: usize = 4;

/// From the least to the greatest slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes {
    pub(super) least_rad: f64,
    pub(super) greatest_rad: f64,
}

impl Slopes {
    pub(super) fn of_degrees(least_deg: f64, greatest_deg: f64) -> Self {
        Self { least_rad: least_deg.to_radians(), greatest_rad: greatest_deg.to_radians() }
    }

    /// Whether the slope of a passage is within the range.
    pub(super) fn hold(&self, a: &Point3<f64>, b: &Point3<f64>) -> bool {
        let slope_rad = slope_rad(a, b);
        slope_rad >= self.least_rad - ROUNDING && slope_rad <= self.greatest_rad + ROUNDING
    }
}

/// The slope of a passage, in radians.
pub(super) fn slope_rad(a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    libm::atan2((a.z - b.z).abs(), (a.xy() - b.xy()).norm())
}

/// The horizontal course of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Course {
    /// Along a straight line.
    Straight,
    /// Along a circle.
    Round(Helix),
}

/// A helix around a vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Helix {
    /// Of every step.
    pub(super) slope_rad: f64,
    /// Whole turns, in addition to a partial one.
    pub(super) turns: u32,
    /// Left (1) or right (-1).
    pub(super) side: f64,
    /// Initial direction if the points are above each other, in radians from east.
    pub(super) bearing_rad: f64,
}

/// The stations of a ramp from `top` down to `foot`, inclusive, at most `step_m` apart. `None` if the course does not lead
/// there within the range of slopes.
pub(super) fn way_down(
    [top, foot]: [Point3<f64>; 2],
    course: Course,
    slopes: &Slopes,
    step_m: f64,
) -> Option<Vec<Point3<f64>>> {
    let way = match course {
        Course::Straight => straight(&top, &foot, step_m)?,
        Course::Round(helix) => Arc::between([top, foot], helix, step_m)?.stations([top, foot]),
    };
    way.windows(2).all(|step| slopes.hold(&step[0], &step[1])).then_some(way)
}

fn straight(top: &Point3<f64>, foot: &Point3<f64>, step_m: f64) -> Option<Vec<Point3<f64>>> {
    let steps = ((foot - top).norm() / step_m).ceil().max(1.0);
    let at = |step: usize| (top + (foot - top) * (step as f64 / steps)).map(millimetres);
    (steps <= MOST_STEPS).then(|| (0..=steps as usize).map(at).collect())
}

/// The horizontal projection of a helix between two points.
struct Arc {
    center: Vector2<f64>,
    radius: f64,
    /// Start angle on the circle.
    start_rad: f64,
    /// Signed total turn.
    turn_rad: f64,
    steps: usize,
}

impl Arc {
    fn between([top, foot]: [Point3<f64>; 2], helix: Helix, step_m: f64) -> Option<Self> {
        let Helix { slope_rad, turns, side, bearing_rad } = helix;
        let chord = (foot.xy() - top.xy()).norm();
        let length = (top.z - foot.z) / libm::tan(slope_rad);
        let mut arc_length = length;
        let mut found = None;
        for _ in 0..CHORD_ROUNDS {
            let (radius, turn_rad) = if turns == 0 { bow(chord, arc_length)? } else { coil(chord, arc_length, turns)? };
            let steps = (arc_length / libm::cos(slope_rad) / step_m).ceil().max((turn_rad / SHARPEST).ceil()).max(2.0);
            if steps > MOST_STEPS {
                return None;
            }
            let half_step = 0.5 * turn_rad / steps;
            arc_length = length * half_step / libm::sin(half_step);
            found = Some((radius, turn_rad, steps as usize));
        }
        let (radius, turn_rad, steps) = found?;
        let along = if chord > 0.001 {
            (foot.xy() - top.xy()) / chord
        } else {
            Vector2::new(libm::cos(bearing_rad), libm::sin(bearing_rad))
        };
        let left = Vector2::new(-along.y, along.x) * side;
        // Half the chord ahead, and aside by the apothem: on the other side beyond half a turn.
        let bend = 0.5 * turn_rad.rem_euclid(TAU);
        let center = top.coords.xy() + along * (0.5 * chord) + left * (radius * libm::cos(bend));
        let out = top.coords.xy() - center;
        Some(Self { center, radius, start_rad: libm::atan2(out.y, out.x), turn_rad: side * turn_rad, steps })
    }

    fn stations(&self, [top, foot]: [Point3<f64>; 2]) -> Vec<Point3<f64>> {
        let inner = (1..self.steps).map(|step| {
            let share = step as f64 / self.steps as f64;
            let angle = self.start_rad + self.turn_rad * share;
            let x = self.center.x + self.radius * libm::cos(angle);
            let y = self.center.y + self.radius * libm::sin(angle);
            Point3::new(x, y, top.z + (foot.z - top.z) * share).map(millimetres)
        });
        std::iter::once(top).chain(inner).chain([foot]).collect()
    }
}

/// Radius and turn of an arc of this length over a chord, less than a full turn.
fn bow(chord: f64, length: f64) -> Option<(f64, f64)> {
    let ratio = |turn_rad: f64| libm::sin(0.5 * turn_rad) / (0.5 * turn_rad);
    if length <= chord || chord / length < ratio(LONGEST_ARC) {
        return None;
    }
    let turn_rad = halved([1e-3, LONGEST_ARC], |turn_rad| ratio(turn_rad) * length > chord);
    Some((length / turn_rad, turn_rad))
}

/// Radius and turn of an arc of this length over a chord with this many full turns and the shorter partial one.
fn coil(chord: f64, length: f64, turns: u32) -> Option<(f64, f64)> {
    let round = TAU * f64::from(turns);
    let turn_rad = |radius: f64| round + 2.0 * libm::asin((0.5 * chord / radius).min(1.0));
    let least = (0.5 * chord).max(1e-3);
    if least * turn_rad(least) > length {
        return None;
    }
    let radius = halved([least, length / PI], |radius| radius * turn_rad(radius) < length);
    Some((radius, turn_rad(radius)))
}

/// Bisection: where between two values a condition ends that holds at the first.
fn halved([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(degrees: f64, turns: u32, side: f64) -> Course {
        Course::Round(Helix { slope_rad: degrees.to_radians(), turns, side, bearing_rad: 1.0 })
    }

    #[test]
    fn every_step_has_the_requested_slope() {
        let slopes = Slopes::of_degrees(14.95, 15.05);
        for (chord, turns) in [(30.0, 0), (10.0, 0), (6.0, 1), (0.0, 1), (3.0, 2), (0.0, 3)] {
            for side in [-1.0, 1.0] {
                let ends = [Point3::new(1.0, 2.0, 0.0), Point3::new(1.0 + 0.6 * chord, 2.0 + 0.8 * chord, -10.0)];
                let way = way_down(ends, arc(15.0, turns, side), &slopes, 4.0).expect("37 m are enough");
                assert_eq!([way[0], way[way.len() - 1]], ends);
                let steps = way.windows(2).map(|step| (step[1] - step[0]).norm());
                assert!(steps.clone().all(|step| step <= 4.1), "{chord} {turns}");
                let even = steps.clone().fold(0.0, f64::max) - steps.fold(f64::INFINITY, f64::min);
                assert!(even < 0.01, "{chord} {turns}: {even}");
            }
        }
    }

    #[test]
    fn shafts_are_vertical_and_impossible_ramps_are_refused() {
        let slopes = Slopes::of_degrees(90.0, 90.0);
        let ends = [Point3::new(3.0, 4.0, 5.0), Point3::new(3.0, 4.0, -5.0)];
        let shaft = way_down(ends, Course::Straight, &slopes, 3.0).expect("it is plumb");
        assert_eq!(shaft.len(), 5);
        let gentle = Slopes::of_degrees(10.0, 20.0);
        assert_eq!(way_down(ends, Course::Straight, &gentle, 3.0), None);
        assert_eq!(way_down(ends, arc(15.0, 0, 1.0), &gentle, 3.0), None);
        let far = [Point3::origin(), Point3::new(100.0, 0.0, -10.0)];
        assert_eq!(way_down(far, arc(15.0, 0, 1.0), &gentle, 3.0), None);
    }
}
