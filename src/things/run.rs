//! What runs along passages in pieces, such as pipes, and how it ends: it turns into the wall.
//!
//! A piece is there if there is room for it between the ends of its stop, and if the run goes on at one of them. Both follow from
//! the stops next to it, so a run depends on nothing further away.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::along::{Fitted, Stop, Way, facing};
use super::equipment::{ELBOW_M, PIECE_M, RAIL_M};
use super::kind::{Along, Fit};
use super::place::Site;

/// Least cosine of the turn from one passage to the next through which something runs on: 25°.
const ONWARDS: f64 = 0.906;
/// Least depth of the end of an elbow in the rock, in metres.
const IN_ROCK_M: f32 = 0.03;

/// An end of a stop.
#[derive(Clone, Copy, PartialEq)]
enum End {
    First,
    Last,
}

const ENDS: [End; 2] = [End::First, End::Last];

impl Site<'_> {
    /// The piece of a run at a stop, if it is not alone.
    pub(super) fn run(&self, along: &Along, ways: &[Way], stop: &Stop) -> Vec<Fitted> {
        let piece = self.piece(along, stop).filter(|_| ENDS.iter().any(|end| self.goes_on(along, ways, stop, *end)));
        piece.into_iter().collect()
    }

    /// Elbows into the wall at the ends of a run that are at this stop.
    pub(super) fn ends_of_run(&self, along: &Along, ways: &[Way], stop: &Stop) -> Vec<Fitted> {
        let pieces = self.run(along, ways, stop);
        let ends = pieces.iter().flat_map(|(_, piece, _)| ENDS.map(|end| (piece, end)));
        let free = ends.filter(|(_, end)| !self.goes_on(along, ways, stop, *end));
        free.filter_map(|(piece, end)| self.elbow(along, piece, end)).collect()
    }

    /// The piece between both ends of a stop.
    fn piece(&self, along: &Along, stop: &Stop) -> Option<Fitted> {
        let is_here = self.has(along, stop.way.at(stop.middle()));
        is_here.then(|| self.between(stop, |along_m| self.place_of_run(along, stop.way, along_m))).flatten()
    }

    fn place_of_run(&self, along: &Along, way: &Way, along_m: f64) -> Option<Point3<f64>> {
        match along.fit {
            Fit::RightWall | Fit::IntoRightWall => self.on_wall(way, along_m, 1.0, 1.6),
            Fit::LeftWall | Fit::IntoLeftWall => self.on_wall(way, along_m, -1.0, 1.7),
            Fit::UnderRoof => self.under_roof(way, along_m),
            _ => None,
        }
    }

    /// Whether there is a piece beyond an end of a stop, in this passage or straight on in the next.
    fn goes_on(&self, along: &Along, ways: &[Way], stop: &Stop, end: End) -> bool {
        let Stop { way, number, .. } = *stop;
        let last = way.parts(along.spacing_m) - 1;
        let next = match end {
            End::First => number.checked_sub(1),
            End::Last => Some(number + 1).filter(|next| *next <= last),
        };
        if let Some(next) = next {
            return self.piece(along, &way.stop(along, next)).is_some();
        }
        let beyond = ways.iter().filter(|other| other.ahead.dot(&way.ahead) > ONWARDS && other.follows(way, end));
        let mut first = beyond.map(|other| match end {
            End::First => other.stop(along, other.parts(along.spacing_m) - 1),
            End::Last => other.stop(along, 0),
        });
        first.any(|stop| self.piece(along, &stop).is_some())
    }

    /// The elbow at an end of a piece, if it ends in the rock.
    fn elbow(&self, along: &Along, piece: &Isometry3<f64>, end: End) -> Option<Fitted> {
        // Half a turn about the direction of the wall.
        let back = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 1.0, 0.0));
        let (along_m, turned) = match end {
            End::First => (-0.49 * PIECE_M, back),
            End::Last => (0.49 * PIECE_M, UnitQuaternion::identity()),
        };
        let pose = piece * Isometry3::from_parts(Translation3::new(along_m, 0.0, 0.0), turned);
        let side = if along.fit == Fit::IntoRightWall { -1.0 } else { 1.0 };
        let [ahead_m, aside_m] = ELBOW_M;
        let tip = pose * Point3::new(ahead_m, side * aside_m, 0.0);
        let is_in_rock = self.setting.field.scattered(&[tip.map(|c| c as f32).into()])[0] > IN_ROCK_M;
        is_in_rock.then_some((1.0, pose, 0.0))
    }

    /// A piece between the places at both ends of a stop, if it is in the air.
    pub(super) fn between(&self, stop: &Stop, place: impl Fn(f64) -> Option<Point3<f64>>) -> Option<Fitted> {
        let [a, b] = stop.reach.map(place);
        let (a, b) = (a?, b?);
        let middle = nalgebra::center(&a, &b);
        let over = |share: f64| {
            let at = a + (b - a) * share + Vector3::z() * RAIL_M;
            [at.x as f32, at.y as f32, at.z as f32]
        };
        let depths = self.setting.field.scattered(&[over(0.1), over(0.5), over(0.9)]);
        // On either side of a corner the wall is at another distance.
        let is_bent = (b - a).norm() > 1.04 * (stop.reach[1] - stop.reach[0]);
        let is_free = !is_bent && depths.iter().all(|depth| *depth <= 0.0);
        is_free.then(|| (1.0, Isometry3::from_parts(Translation3::from(middle), facing(b - a)), 0.0))
    }
}

impl Way {
    /// Whether this begins where another one ends, or the other way round.
    fn follows(&self, other: &Self, end: End) -> bool {
        /// Rounding of the end of a passage, in metres.
        const SAME_M: f64 = 1e-3;
        let [own, theirs] = match end {
            End::First => [self.end(), other.at(0.0)],
            End::Last => [self.at(0.0), other.end()],
        };
        (own - theirs).norm() < SAME_M
    }
}
