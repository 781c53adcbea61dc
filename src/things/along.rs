//! What miners build in along the passages: where it stands, hangs and runs.
//!
//! Every edge of the graph is a way with stations at even distances. From each, rays find the floor, the roof and the walls,
//! and what does not fit there is left out: so a thing follows from the edge and the walls within [`ASIDE_M`] of it.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::equipment::{DUCT_M, OFF_WALL_M, SLEEPER_M};
use super::kind::{Along, Fit, KindRow};
use super::lots::Lots;
use super::place::{Candidate, Site};
use super::rest::turn;
use crate::material::roughness;
use crate::noise::Source;
use plume_graph::seed::salt;
use plume_graph::{Aabb, Graph, StationId};

/// How far from the axis of a passage a wall is looked for, in metres.
pub(super) const ASIDE_M: f64 = 3.4;
/// Least and most height of a passage in which anything is built, in metres.
const HEIGHT_M: [f64; 2] = [1.9, 5.0];
/// Steepest passage in which anything is built: rise over length.
const STEEPEST: f64 = 0.25;
/// Length over which passages have or do not have something, in metres.
const STRETCH_M: f32 = 30.0;
/// Half the gauge of the rails, in metres: 0.6 m is common underground.
const HALF_GAUGE_M: f64 = 0.3;
/// Radius of the thickest posts, and their distance from the wall, in metres.
pub(super) const POST_M: [f64; 2] = [0.17, 0.08];

/// Heights over the floor at which what stands at the foot of a wall would touch it, in metres.
pub(super) const FOOT_M: [f64; 3] = [0.2, 0.5, 0.9];
/// Radius of a drum in metres.
const DRUM_M: f64 = 0.3;

/// Scale, pose, and how deep it is in the rock in metres.
pub(super) type Fitted = (f64, Isometry3<f64>, f64);

/// Something built in, and its pose.
pub(super) struct Built<'a> {
    pub candidate: Candidate<'a>,
    pub pose: Isometry3<f64>,
}

/// A passage from one station of the graph to the next.
#[derive(Clone, Copy)]
pub(super) struct Way {
    /// The stations of its edge.
    key: [i32; 2],
    from: Point3<f64>,
    pub ahead: Vector3<f64>,
    pub right: Vector3<f64>,
    length_m: f64,
}

impl Way {
    /// The ways near these bounds.
    pub fn near(graph: &Graph, bounds: Aabb<f64>) -> Vec<Self> {
        let near = bounds.padded(ASIDE_M + 1.0);
        let way = |edge: &[StationId; 2]| {
            let [a, b] = edge.map(|station| graph[station].position);
            let flat = (b - a).xy();
            let is_near = Aabb::from_points([a, b].map(<[f64; 3]>::from)).is_some_and(|own| own.intersects(&near));
            let length_m = (b - a).norm();
            if !is_near || length_m < 1.0 || (b.z - a.z).abs() > STEEPEST * length_m {
                return None;
            }
            // So that what is on the right is so in the next passage too, whichever way its edge points.
            let [from, to] = if flat.x + 0.618 * flat.y > 0.0 { [a, b] } else { [b, a] };
            let ahead = (to - from) / length_m;
            let right = ahead.cross(&Vector3::z()).normalize();
            Some(Self { key: edge.map(|station| station.index() as i32), from, ahead, right, length_m })
        };
        graph.edges.iter().filter_map(way).collect()
    }

    /// Its direction on the map.
    pub fn yaw_rad(&self) -> f64 {
        libm::atan2(self.ahead.y, self.ahead.x)
    }

    pub fn at(&self, along_m: f64) -> Point3<f64> {
        self.from + self.ahead * along_m
    }

    /// Whether it goes from one station of an edge to the other.
    pub fn is_along(&self, edge: &[StationId; 2]) -> bool {
        self.key == edge.map(|station| station.index() as i32)
    }

    /// Whether this is between its ends.
    pub fn holds(&self, along_m: f64) -> bool {
        (0.0..=self.length_m).contains(&along_m)
    }

    /// Number of parts of at most this length.
    pub fn parts(&self, spacing_m: f64) -> u32 {
        (self.length_m / spacing_m).ceil().max(1.0) as u32
    }

    /// Where it ends.
    pub fn end(&self) -> Point3<f64> {
        self.at(self.length_m)
    }

    /// The places of a kind along it.
    pub fn stops(&self, along: &Along) -> impl Iterator<Item = Stop<'_>> {
        (0..self.parts(along.spacing_m)).map(|number| self.stop(along, number))
    }

    /// One of the places of a kind along it.
    pub fn stop(&self, along: &Along, number: u32) -> Stop<'_> {
        let part_m = self.length_m / f64::from(self.parts(along.spacing_m));
        let reach = [f64::from(number), f64::from(number + 1)].map(|n| n * part_m);
        Stop { way: self, number, reach }
    }
}

/// One of the places of a kind along a way.
#[derive(Clone, Copy)]
pub(super) struct Stop<'a> {
    pub way: &'a Way,
    pub number: u32,
    /// From and to where it reaches along the way, in metres.
    pub reach: [f64; 2],
}

impl Stop<'_> {
    pub fn middle(&self) -> f64 {
        0.5 * (self.reach[0] + self.reach[1])
    }
}

impl<'a> Site<'a> {
    /// What is built in along these passages.
    pub fn built(&self, ways: &[Way]) -> Vec<Built<'a>> {
        if self.settings.sets <= 0.0 {
            return Vec::new();
        }
        let rows: Vec<(KindRow<'a>, Along)> = self.rows().filter_map(|row| Some((row, row.place.along()?))).collect();
        rows.into_iter()
            .flat_map(|(row, along)| ways.iter().flat_map(move |way| self.fitted(row, &along, ways, way)))
            .collect()
    }

    /// How something that is fitted like this is built into the passages, if it is.
    pub fn along_fitted(&self, fit: Fit) -> Option<Along> {
        self.rows().filter_map(|row| row.place.along()).find(|along| along.fit == fit)
    }

    /// Whether the stretch of a passage has this.
    pub fn has(&self, along: &Along, at: Point3<f64>) -> bool {
        let [low, high] = along.range;
        let source = Source::new(salt(self.setting.seed, along.stretch));
        let noise = roughness(source, &[[at.x as f32, at.y as f32, at.z as f32]], STRETCH_M)[0];
        // About evenly distributed: the standard deviation of this noise is a third.
        let share = 0.5 * libm::erfc(-f64::from(noise) * 3.0 / std::f64::consts::SQRT_2);
        low <= share && share < low + (high - low) * self.settings.sets
    }

    /// Room that posts take at the wall, in metres: pipes and cables pass on their inside.
    fn posts_m(&self, at: Point3<f64>) -> f64 {
        let is_timbered = self.along_fitted(Fit::Post).is_some_and(|posts| self.has(&posts, at));
        if is_timbered { 2.0 * POST_M[0] + POST_M[1] } else { 0.0 }
    }

    /// What there is of a kind along a way.
    fn fitted(&self, row: KindRow<'a>, along: &Along, ways: &[Way], way: &Way) -> Vec<Built<'a>> {
        let at_stops = |fitted: &dyn Fn(&Stop) -> Vec<Fitted>| {
            let stops = way.stops(along).filter(|stop| self.has(along, way.at(stop.middle())));
            stops.map(|stop| (stop, fitted(&stop))).collect()
        };
        let fitted: Vec<(Stop, Vec<Fitted>)> = match along.fit {
            Fit::Post => at_stops(&|stop| self.set(way, stop.middle()).map_or(Vec::new(), |set| set.posts.to_vec())),
            Fit::Beam => at_stops(&|stop| self.set(way, stop.middle()).map(|set| set.beam).into_iter().collect()),
            Fit::OnBeams => at_stops(&|stop| self.lagging(along, stop)),
            Fit::Roof => at_stops(&|stop| self.bolts(stop)),
            Fit::AgainstRoof => at_stops(&|stop| self.roof_mesh(stop)),
            Fit::Rail => at_stops(&|stop| self.rails(stop)),
            Fit::Sleeper => at_stops(&|stop| self.sleeper(stop).into_iter().collect()),
            Fit::FootOfWall => at_stops(&|stop| self.drum(stop).into_iter().collect()),
            Fit::RightWall | Fit::LeftWall | Fit::UnderRoof => self.run(along, ways, way),
            Fit::IntoRightWall | Fit::IntoLeftWall => self.ends_of_run(along, ways, way),
        };
        fitted.into_iter().flat_map(|(stop, poses)| self.built_at(row, along, &stop, poses)).collect()
    }

    /// Things of a kind at a stop, those that leave the way free.
    fn built_at(&self, row: KindRow<'a>, along: &Along, stop: &Stop, poses: Vec<Fitted>) -> Vec<Built<'a>> {
        let key =
            |n: usize| u64::from(salt(self.setting.seed, row.name)) | (u64::from(stop.number) * 64 + n as u64) << 32;
        let numbered = poses.into_iter().enumerate();
        let built = numbered.filter_map(|(n, (scale, pose, embedding_m))| {
            let mut lots = Lots::new(key(n), stop.way.key);
            let candidate = Candidate {
                id: lots.id(0.0),
                row,
                prototype: lots.one_of(self.setting.library.of(&row))?,
                scale,
                yaw_rad: 0.0,
                at: pose.translation.vector.into(),
                embedding_m,
                stands: matches!(along.fit, Fit::Post | Fit::Sleeper | Fit::FootOfWall),
                // Stones make room for it.
                rank: f64::INFINITY,
            };
            Some(Built { candidate, pose })
        });
        built.filter(|built| self.leaves_the_way(built, stop.way.at(stop.middle()))).collect()
    }

    /// Whether it is beside the way or high enough over it.
    pub fn leaves_the_way(&self, built: &Built, axis: Point3<f64>) -> bool {
        // The floor may rise towards another passage.
        let [Some(floor), below] = [axis, built.candidate.at].map(|at| self.walls.floor_below(at)) else {
            return false;
        };
        let floor = below.unwrap_or(floor).max(floor);
        let Candidate { prototype, scale, .. } = &built.candidate;
        let hull = &prototype.hull;
        let points = || hull.corners.iter().copied().chain(hull.middles_of_edges()).map(|p| built.pose * (p * *scale));
        let low = points().map(|point| point.z).fold(f64::INFINITY, f64::min);
        low > floor + self.settings.headroom_m || points().all(|point| !self.corridor.is_within(point, 0.0))
    }

    /// Heights of the floor below a point of a passage and of the roof above it, where something can be built in.
    pub fn height(&self, at: Point3<f64>) -> Option<[f64; 2]> {
        self.column(at).filter(|[floor, roof]| (HEIGHT_M[0]..HEIGHT_M[1]).contains(&(roof - floor)))
    }

    /// Heights of the floor below a point of a passage and of the roof above it.
    fn column(&self, at: Point3<f64>) -> Option<[f64; 2]> {
        let hits = self.walls.hits(at.x, at.y);
        let roof = hits.iter().find(|hit| hit.z > at.z && hit.normal.z < 0.0)?.z;
        let floor = hits.iter().rev().find(|hit| hit.z < roof && hit.normal.z > 0.0)?.z;
        Some([floor, roof])
    }

    /// Distance of the nearest wall on a side of a way, at heights over the floor.
    pub fn aside(&self, way: &Way, along_m: f64, side: f64, heights_m: &[f64]) -> Option<f64> {
        let at = way.at(along_m);
        let [floor, roof] = self.column(at)?;
        let heights = heights_m.iter().filter(|height| floor + **height < roof - 0.2);
        let ray = |height: &f64| self.walls.ray(Point3::new(at.x, at.y, floor + height), way.right * side, ASIDE_M);
        let distances: Option<Vec<f64>> = heights.map(ray).collect();
        distances?.into_iter().reduce(f64::min)
    }

    /// The middle of the track on its bed, if there is room for it between the way and the wall.
    fn track(&self, way: &Way, along_m: f64) -> Option<Point3<f64>> {
        let offset_m = 0.5 * (self.settings.corridor_m + SLEEPER_M) + 0.06;
        let room_m = offset_m + 0.5 * SLEEPER_M + 0.08 + self.posts_m(way.at(along_m));
        if self.aside(way, along_m, 1.0, &[0.3])? < room_m {
            return None;
        }
        let place = |dx: f64, dy: f64| way.at(along_m + dx) + way.right * (offset_m + dy);
        let shifts = [-0.5, 0.0, 0.5].into_iter().flat_map(|dx| [-0.3, 0.3].map(|dy| (dx, dy)));
        let floors: Option<Vec<f64>> = shifts.map(|(dx, dy)| Some(self.height(place(dx, dy))?[0])).collect();
        // Ballast evens out what is lower.
        let high = floors?.into_iter().reduce(f64::max)?;
        let at = place(0.0, 0.0);
        Some(Point3::new(at.x, at.y, high + 0.01))
    }

    fn rails(&self, stop: &Stop) -> Vec<Fitted> {
        let side = |offset: f64| {
            let place = |along_m: f64| Some(self.track(stop.way, along_m)? + stop.way.right * offset);
            Some((1.0, self.between(stop, place)?, 0.0))
        };
        [-HALF_GAUGE_M, HALF_GAUGE_M].into_iter().flat_map(side).collect()
    }

    /// A sleeper under the rails, which run straight between the ends of their pieces.
    fn sleeper(&self, stop: &Stop) -> Option<Fitted> {
        let (rail, way, along_m) = (self.along_fitted(Fit::Rail)?, stop.way, stop.middle());
        let rails = way.stops(&rail).find(|rails| along_m < rails.reach[1])?;
        if !self.has(&rail, way.at(rails.middle())) {
            return None;
        }
        let [first_m, last_m] = rails.reach;
        let [a, b] = [self.track(way, first_m)?, self.track(way, last_m)?];
        let at = a + (b - a) * ((along_m - first_m) / (last_m - first_m));
        Some((1.0, Isometry3::from_parts(Translation3::from(at), facing(b - a)), 0.0))
    }

    /// A place at a wall, this high over the floor.
    pub fn on_wall(&self, way: &Way, along_m: f64, side: f64, height_m: f64) -> Option<Point3<f64>> {
        let aside = |shift: f64| self.aside(way, along_m + shift, side, &[height_m - 0.1, height_m + 0.1]);
        let wall_m = [-0.4, 0.0, 0.4].into_iter().map(aside).collect::<Option<Vec<f64>>>()?;
        let wall_m = wall_m.into_iter().reduce(f64::min)?;
        let at = way.at(along_m);
        let place = at + way.right * (side * (wall_m - OFF_WALL_M - self.posts_m(at)));
        Some(Point3::new(place.x, place.y, self.height(at)?[0] + height_m))
    }

    /// A place for a duct, left of the way.
    pub fn under_roof(&self, way: &Way, along_m: f64) -> Option<Point3<f64>> {
        /// Room for beams and for the ropes of the duct, in metres.
        const BELOW_ROOF_M: f64 = 0.42;
        let offset_m = 0.5 * self.settings.corridor_m + DUCT_M + 0.05;
        let place = |shift: f64, aside: f64| way.at(along_m + shift) - way.right * (offset_m + aside);
        let shifts = [-0.5, 0.0, 0.5].into_iter().flat_map(|dx| [-0.25, 0.25].map(|dy| (dx, dy)));
        let columns: Option<Vec<[f64; 2]>> = shifts.map(|(dx, dy)| self.height(place(dx, dy))).collect();
        let roof = columns?.into_iter().map(|[_, roof]| roof).reduce(f64::min)?;
        let [floor, _] = self.height(way.at(along_m))?;
        let height_m = roof - BELOW_ROOF_M - DUCT_M - floor;
        let is_free = self.aside(way, along_m, -1.0, &[height_m - 0.2, height_m + 0.2])? > offset_m + DUCT_M + 0.05;
        let at = place(0.0, 0.0);
        (is_free && height_m - DUCT_M > 1.6).then(|| Point3::new(at.x, at.y, floor + height_m))
    }

    fn drum(&self, stop: &Stop) -> Option<Fitted> {
        let (way, along_m) = (stop.way, stop.middle());
        self.height(way.at(along_m))?;
        let wall_m = self.aside(way, along_m, -1.0, &FOOT_M)?;
        let (pose, embedding_m) = self.at_foot(way, along_m, -wall_m, [DRUM_M; 2])?;
        Some((1.0, pose, embedding_m))
    }

    /// A place on the floor for something that is half as long and half as wide along the way and across it, and how deep it is
    /// in the floor: on this side of the wall that is `wall_m` to the right of the way, or to the left if negative. `None` beside
    /// posts and where the floor is uneven.
    pub fn at_foot(
        &self,
        way: &Way,
        along_m: f64,
        wall_m: f64,
        [half_along_m, half_across_m]: [f64; 2],
    ) -> Option<(Isometry3<f64>, f64)> {
        /// Most unevenness of its floor in metres.
        const UNEVEN_M: f64 = 0.09;
        let at = way.at(along_m) + way.right * (wall_m - wall_m.signum() * (half_across_m + 0.12));
        if self.posts_m(at) > 0.0 {
            return None;
        }
        let [ahead, right] = [level(way.ahead) * (0.66 * half_along_m), way.right * (0.66 * half_across_m)];
        let around = [Vector3::zeros(), ahead, -ahead, right, -right];
        let floor = |aside: Vector3<f64>| Some(self.column(at + aside)?[0]);
        let floors = around.into_iter().map(floor).collect::<Option<Vec<f64>>>()?;
        let low = floors.iter().copied().reduce(f64::min)?;
        let high = floors.into_iter().reduce(f64::max)?;
        let pose = Isometry3::translation(at.x, at.y, 0.5 * (low + high));
        (high - low < UNEVEN_M).then_some((pose, 0.5 * (high - low)))
    }
}

/// The level direction nearest to one.
pub(super) fn level(direction: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(direction.x, direction.y, 0.0).normalize()
}

/// Turned along a direction, and not rolled.
pub(super) fn facing(direction: Vector3<f64>) -> UnitQuaternion<f64> {
    let flat = level(direction);
    turn(flat, direction.normalize()) * turn(Vector3::x(), flat)
}
