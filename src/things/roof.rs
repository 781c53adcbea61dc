//! What holds the roof of a passage: timber sets, the boards that lie on them, bolts, and the mesh that bolts hold.

use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use super::along::{Fitted, POST_M, Stop, Way, facing, level};
use super::equipment::{BOARD_M, CAP_M, MESH_M, TIMBER_M};
use super::kind::{Along, Fit};
use super::place::Site;
use super::plane::Plane;
use super::rest::turn;

/// Distance between bolts across the passage, in metres.
const BOLT_M: f64 = 1.2;
/// Room for lagging between beams and the roof, in metres.
const LAGGING_M: f64 = 0.05;
/// Distance between boards of lagging across the passage, in metres: a choice, common practice is gaps of a few centimetres.
const BOARD_PITCH_M: f64 = BOARD_M[1] + 0.05;

/// Most unevenness of a roof with mesh, and how far bumps may reach through that, in metres: mesh is flat here. Tuned.
const UNEVEN_M: f64 = 0.14;
const BUMP_M: f64 = 0.02;
/// Furthest below the roof that a bolt holds mesh, in metres: its tail is 2 cm longer.
const TAIL_M: f64 = 0.12;

/// A set of timber: scale, pose and how deep its foot is in the floor.
pub(super) struct Set {
    pub posts: [Fitted; 2],
    pub beam: Fitted,
    /// How far its posts are to the right of the way, in metres.
    offsets: [f64; 2],
    /// Height of the upper side of its beam.
    top: f64,
}

impl Site<'_> {
    /// A timber set: posts at both walls under a beam, with room for lagging between it and the roof.
    pub fn set(&self, way: &Way, along_m: f64) -> Option<Set> {
        let at = way.at(along_m);
        let aside = |side: f64| self.aside(way, along_m, side, &[0.3, 1.0, 1.7, 2.4, 3.1]);
        let offsets = [-aside(-1.0)?, aside(1.0)?].map(|offset| offset - offset.signum() * (POST_M[0] + POST_M[1]));
        if offsets.iter().any(|offset| offset.abs() < 0.5 * self.settings.corridor_m + POST_M[0] + 0.03) {
            return None;
        }
        let heights = |share: f64| self.height(at + way.right * (offsets[0] + (offsets[1] - offsets[0]) * share));
        let columns: Option<Vec<[f64; 2]>> = (0..=8).map(|n| heights(f64::from(n) / 8.0)).collect();
        let roof = columns?.into_iter().map(|[_, roof]| roof).reduce(f64::min)?;
        let span_m = offsets[1] - offsets[0] + 2.0 * POST_M[0];
        let scale = stepped_up(span_m / TIMBER_M);
        let top = roof - LAGGING_M;
        let under = top - CAP_M * scale;
        let facing = turn(Vector3::x(), level(way.ahead));
        let middle = at + way.right * (0.5 * (offsets[0] + offsets[1]));
        let pose = |at: Point3<f64>, z: f64| Isometry3::from_parts(Translation3::new(at.x, at.y, z), facing);
        let post = |offset: f64| {
            let foot = at + way.right * offset;
            let [floor, _] = self.height(foot)?;
            let scale = stepped_up((under - floor) / TIMBER_M);
            let length_m = TIMBER_M * scale;
            (under > floor + 1.4).then(|| (scale, pose(foot, under - length_m), length_m - (under - floor)))
        };
        let beam = (scale, pose(middle, top - 0.5 * CAP_M * scale), 0.0);
        Some(Set { posts: [post(offsets[0])?, post(offsets[1])?], beam, offsets, top })
    }

    /// Boards side by side from the beam of a stop to that of the next, where they are in the air.
    pub fn lagging(&self, timber: &Along, stop: &Stop) -> Vec<Fitted> {
        let way = stop.way;
        let ends = [stop.middle(), stop.middle() + stop.reach[1] - stop.reach[0]];
        if !way.holds(ends[1]) || !self.has(timber, way.at(ends[1])) {
            return Vec::new();
        }
        let [Some(here), Some(there)] = ends.map(|along_m| self.set(way, along_m)) else { return Vec::new() };
        let left = here.offsets[0].max(there.offsets[0]);
        let count = ((here.offsets[1].min(there.offsets[1]) - left) / BOARD_PITCH_M).floor();
        // Those of the next bay lie beside them on the beam.
        let first = left + BOARD_PITCH_M * if stop.number.is_multiple_of(2) { 0.25 } else { 0.75 };
        let board = |n: u32| {
            let aside = way.right * (first + BOARD_PITCH_M * f64::from(n));
            let on = |along_m: f64, top: f64| {
                let at = way.at(along_m) + aside;
                Point3::new(at.x, at.y, top)
            };
            let [a, b] = [on(ends[0], here.top), on(ends[1], there.top)];
            let shares = [0.1, 0.3, 0.5, 0.7, 0.9].map(|share| (a + (b - a) * share).map(|c| c as f32).into());
            let is_free = self.setting.field.scattered(&shares).iter().all(|depth| *depth < 0.0);
            let pose = Isometry3::from_parts(Translation3::from(nalgebra::center(&a, &b)), facing(b - a));
            is_free.then(|| (stepped_down((b - a).norm() / BOARD_M[0]), pose, 0.0))
        };
        (0..count as u32).filter_map(board).collect()
    }

    /// Bolts in a row across the passage; those that hold mesh are as low as it is.
    pub fn bolts(&self, stop: &Stop) -> Vec<Fitted> {
        let is_meshed =
            self.along_fitted(Fit::AgainstRoof).is_some_and(|mesh| self.has(&mesh, stop.way.at(stop.middle())));
        let bolt = |place: Point3<f64>| {
            let mesh = if is_meshed { self.under_bumps(stop.way, place) } else { None };
            mesh.or_else(|| self.on_roof(place))
        };
        bolted(stop).filter_map(bolt).map(|pose| (1.0, pose, 0.0)).collect()
    }

    /// Squares of mesh with a bolt in the middle of each.
    pub fn roof_mesh(&self, stop: &Stop) -> Vec<Fitted> {
        bolted(stop).filter_map(|place| self.under_bumps(stop.way, place)).map(|pose| (1.0, pose, 0.0)).collect()
    }

    /// The pose of something flat on the roof at a point of the map.
    fn on_roof(&self, place: Point3<f64>) -> Option<Isometry3<f64>> {
        /// Steepest roof that is bolted from below.
        const LEVEL: f64 = -0.6;
        self.height(place)?;
        let hits = self.walls.hits(place.x, place.y);
        let roof = hits.iter().find(|hit| hit.z > place.z && hit.normal.z < LEVEL)?;
        let turned = turn(Vector3::z(), -roof.normal);
        Some(Isometry3::from_parts(Translation3::new(place.x, place.y, roof.z), turned))
    }

    /// The pose of a square of mesh in the plane fitted to the roof and then let down until bumps reach through it by no more
    /// than [`BUMP_M`]; `None` where the roof is too uneven for a flat one.
    fn under_bumps(&self, way: &Way, place: Point3<f64>) -> Option<Isometry3<f64>> {
        let bolted_z = self.on_roof(place)?.translation.z;
        let ahead = level(way.ahead);
        let steps = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|n| n * 0.25 * MESH_M);
        let roof = Plane::through(&steps, |[u, v]| Some(self.height(place + ahead * u + way.right * v)?[1]))?;
        let [low_m, high_m] = roof.off_m;
        if low_m.max(high_m) > UNEVEN_M {
            return None;
        }
        let up = Vector3::z() - ahead * roof.slopes[0] - way.right * roof.slopes[1];
        let turned = turn(Vector3::z(), up.normalize()) * turn(Vector3::x(), ahead);
        let z = bolted_z.min(roof.height - (low_m - BUMP_M).max(0.0));
        let pose = Isometry3::from_parts(Translation3::new(place.x, place.y, z), turned);
        (bolted_z - z < TAIL_M).then_some(pose)
    }
}

/// Places of bolts across a passage, at the height of its axis: every other row is shifted by half.
fn bolted(stop: &Stop) -> impl Iterator<Item = Point3<f64>> {
    let (at, right) = (stop.way.at(stop.middle()), stop.way.right);
    let shift = if stop.number.is_multiple_of(2) { 0.0 } else { 0.5 };
    (-2..=2).map(move |n| at + right * (BOLT_M * (f64::from(n) + shift)))
}

/// A size rounded up in steps of a twenty-fourth of an octave, so that few meshes serve a mine.
fn stepped_up(size: f64) -> f64 {
    libm::exp2((24.0 * libm::log2(size)).ceil() / 24.0)
}

/// A size rounded down in such steps.
fn stepped_down(size: f64) -> f64 {
    libm::exp2((24.0 * libm::log2(size)).floor() / 24.0)
}
