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

/// A piece of a run.
struct Piece<'a> {
    stop: Stop<'a>,
    pose: Isometry3<f64>,
    /// The ends next to which there is no other piece.
    open: Vec<End>,
}

impl Site<'_> {
    /// The pieces of a run along a way, by stop.
    pub(super) fn run<'w>(&self, along: &Along, ways: &[Way], way: &'w Way) -> Vec<(Stop<'w>, Vec<Fitted>)> {
        let pieces = self.pieces(along, ways, way).into_iter();
        pieces.map(|piece| (piece.stop, vec![(1.0, piece.pose, 0.0)])).collect()
    }

    /// The elbows with which a run along a way turns into the wall, by stop.
    pub(super) fn ends_of_run<'w>(&self, along: &Along, ways: &[Way], way: &'w Way) -> Vec<(Stop<'w>, Vec<Fitted>)> {
        let elbows = |piece: &Piece| piece.open.iter().filter_map(|end| self.elbow(along, &piece.pose, *end)).collect();
        self.pieces(along, ways, way).into_iter().map(|piece| (piece.stop, elbows(&piece))).collect()
    }

    /// The pieces of a run along a way, without those that would be alone.
    fn pieces<'w>(&self, along: &Along, ways: &[Way], way: &'w Way) -> Vec<Piece<'w>> {
        let stops: Vec<Stop> = way.stops(along).collect();
        let poses: Vec<Option<Isometry3<f64>>> = stops.iter().map(|stop| self.piece(along, stop)).collect();
        let goes_on = |number: usize, end: End| match end {
            End::First if number > 0 => poses[number - 1].is_some(),
            End::Last if number + 1 < poses.len() => poses[number + 1].is_some(),
            _ => self.goes_on_after(along, ways, way, end),
        };
        let numbered = stops.into_iter().zip(&poses).enumerate();
        let pieces = numbered.filter_map(|(number, (stop, pose))| {
            let open = pose.as_ref().map(|_| ENDS.into_iter().filter(|end| !goes_on(number, *end)).collect())?;
            Some(Piece { stop, pose: (*pose)?, open })
        });
        pieces.filter(|piece| piece.open.len() < ENDS.len()).collect()
    }

    /// The piece between both ends of a stop.
    fn piece(&self, along: &Along, stop: &Stop) -> Option<Isometry3<f64>> {
        let is_here = self.has(along, stop.way.at(stop.middle()));
        is_here.then(|| self.between(stop, |along_m| self.place_of_run(along, stop.way, along_m))).flatten()
    }

    fn place_of_run(&self, along: &Along, way: &Way, along_m: f64) -> Option<Point3<f64>> {
        match wall_of(along.fit) {
            Some([side, height_m]) => self.on_wall(way, along_m, side, height_m),
            None => self.under_roof(way, along_m),
        }
    }

    /// Whether there is a piece straight on in the next passage.
    fn goes_on_after(&self, along: &Along, ways: &[Way], way: &Way, end: End) -> bool {
        let beyond = ways.iter().filter(|other| other.ahead.dot(&way.ahead) > ONWARDS && other.follows(way, end));
        let mut nearest = beyond.map(|other| match end {
            End::First => other.stop(along, other.parts(along.spacing_m) - 1),
            End::Last => other.stop(along, 0),
        });
        nearest.any(|stop| self.piece(along, &stop).is_some())
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
        let [side, _] = wall_of(along.fit)?;
        let [ahead_m, aside_m] = ELBOW_M;
        let tip = pose * Point3::new(ahead_m, -side * aside_m, 0.0);
        let is_in_rock = self.setting.field.scattered(&[tip.map(|c| c as f32).into()])[0] > IN_ROCK_M;
        is_in_rock.then_some((1.0, pose, 0.0))
    }

    /// A piece between the places at both ends of a stop, if it is in the air.
    pub(super) fn between(&self, stop: &Stop, place: impl Fn(f64) -> Option<Point3<f64>>) -> Option<Isometry3<f64>> {
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
        is_free.then(|| Isometry3::from_parts(Translation3::from(middle), facing(b - a)))
    }
}

/// The wall that something runs along, 1 for the right one and -1 for the left one, and how high over the floor, in metres.
fn wall_of(fit: Fit) -> Option<[f64; 2]> {
    match fit {
        Fit::RightWall | Fit::IntoRightWall => Some([1.0, 1.6]),
        Fit::LeftWall | Fit::IntoLeftWall => Some([-1.0, 1.7]),
        _ => None,
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
