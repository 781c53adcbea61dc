//! Points scattered through the rock with a minimum distance, more densely on the horizons.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::Karst;
use super::host_rock::HostRock;
use plume_graph::Rows;
use plume_graph::rng::Rng;

/// Attempts per cell of the size of the point spacing (tuned: more of them find no room).
const THROWS_PER_CELL: f64 = 2.5;
/// Share of the attempts that aim at a horizon.
const ON_HORIZON: f64 = 0.7;
/// Vertical stretch of distances: beds are thin.
const FLATNESS: f32 = 2.0;
/// Maximum distance of a point from its horizon, in metres.
const BED_M: f64 = 0.6;
/// Maximum distance of neighbours, in point spacings, with heights stretched.
const REACH: usize = 2;

/// The points, column by column of a grid over the plan, so that points near in the rock are near in memory.
pub(super) struct Cloud {
    /// With heights relative to the dipping plane, ascending within a column.
    columns: Rows<Point3<f32>>,
    /// Columns on a side of the plan.
    side: usize,
    column_m: f64,
    apart_m: f32,
}

impl Cloud {
    /// Draws points and keeps those that have room (dart throwing: Cook, "Stochastic sampling in computer graphics",
    /// 1986).
    pub(super) fn scatter(settings: &Karst, rock: &HostRock, side_m: f64, rng: &mut Rng) -> Self {
        let [bottom, top] = rock.extremes();
        let apart_m = settings.sample_spacing_m;
        // No narrower than the point spacing, so that only adjacent columns matter.
        let side = (side_m / apart_m).floor().max(1.0) as usize;
        let column_m = side_m / side as f64;
        let storeys = (f64::from(FLATNESS) * (top - bottom + 2.0 * BED_M) / apart_m).ceil();
        let mut cloud = Self { columns: Rows::default(), side, column_m, apart_m: apart_m as f32 };
        for column in 0..side * side {
            let corner = [column % side, column / side].map(|at| at as f64 * column_m - 0.5 * side_m);
            let mut points = Vec::new();
            for _ in 0..(THROWS_PER_CELL * storeys) as usize {
                let [x, y] = corner.map(|low| rng.between(low, low + column_m));
                let z = if rng.chance(ON_HORIZON) {
                    rock.some_horizon(rng) + rng.between(-BED_M, BED_M)
                } else {
                    rng.between(bottom, top)
                };
                let point = Point3::new(x, y, z).cast();
                if cloud.has_room(point, &points) {
                    points.push(point);
                }
            }
            points.sort_unstable_by(|a, b| a.z.total_cmp(&b.z));
            cloud.columns.push(points);
        }
        cloud
    }

    /// Whether a point is near to no other: to none of the next column, nor of those before it.
    fn has_room(&self, point: Point3<f32>, next_column: &[Point3<f32>]) -> bool {
        let is_far = |other: &Point3<f32>| stretched(other - point).norm_squared() >= self.apart_m * self.apart_m;
        next_column.iter().all(is_far) && self.runs(point, 1).all(|run| self.points()[run].iter().all(is_far))
    }

    fn points(&self) -> &[Point3<f32>] {
        self.columns.items()
    }

    pub(super) fn len(&self) -> usize {
        self.points().len()
    }

    /// A point with its height relative to the dipping plane.
    pub(super) fn point(&self, point: usize) -> Point3<f64> {
        self.points()[point].cast()
    }

    /// The minimum distance of two points.
    pub(super) fn least_m(&self) -> f64 {
        f64::from(self.apart_m / FLATNESS)
    }

    /// The point nearest to a position, or the first one if it is far from all.
    pub(super) fn nearest(&self, [x, y]: [f64; 2], z: f64) -> usize {
        let place = Point3::new(x, y, z).cast();
        let away = |point: &usize| stretched(self.points()[*point] - place).norm_squared();
        let within = |reach| {
            let near = self.runs(place, reach).flatten();
            near.min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b)))
        };
        [1, 3, 9].into_iter().find_map(within).unwrap_or(0)
    }

    /// Fills `found` with the neighbours of a point, nearest first: points within range by an allowed edge, with no third
    /// one in the ball between them that both have allowed edges to (after Gabriel, Sokal: "A new statistical approach to
    /// geographic variation analysis", 1969). So edges hardly cross, no two leave a point in nearly the same direction, and
    /// reachability is preserved.
    pub(super) fn neighbours(&self, point: usize, may_take: impl Fn(Vector3<f64>) -> bool, found: &mut Vec<Neighbour>) {
        let place = self.points()[point];
        let most = REACH as f32 * self.apart_m;
        found.clear();
        for other in self.runs(place, REACH).flatten() {
            let way = self.points()[other] - place;
            let square = stretched(way).norm_squared();
            if other != point && square <= most * most && may_take(way.cast()) {
                found.push(Neighbour { point: other, way, square });
            }
        }
        found.sort_unstable_by(|a, b| a.square.total_cmp(&b.square).then(a.point.cmp(&b.point)));
        for last in (1..found.len()).rev() {
            let way = found[last].way;
            let is_detour = |between: &Neighbour| {
                stretched(between.way).dot(&stretched(way)) > between.square && may_take((way - between.way).cast())
            };
            if found[..last].iter().any(is_detour) {
                found.remove(last);
            }
        }
    }

    /// Points at most `reach` columns and as many distances of height away, in runs; of the columns that are filled.
    fn runs(&self, point: Point3<f32>, reach: usize) -> impl Iterator<Item = Range<usize>> {
        let half_m = 0.5 * self.column_m * self.side as f64;
        let around = |at: f32| {
            let middle = ((f64::from(at) + half_m) / self.column_m).max(0.0) as usize;
            middle.saturating_sub(reach)..(middle + reach + 1).min(self.side)
        };
        let (xs, ys) = (around(point.x), around(point.y));
        let off = reach as f32 * self.apart_m / FLATNESS;
        let columns = ys.flat_map(move |y| xs.clone().map(move |x| y * self.side + x));
        columns.take_while(move |&column| column < self.columns.len()).map(move |column| {
            let heights = &self.columns[column];
            let start = self.columns.range(column).start;
            let low = heights.partition_point(|other| other.z < point.z - off);
            let high = heights.partition_point(|other| other.z <= point.z + off);
            start + low..start + high
        })
    }
}

/// A point near another one.
pub(super) struct Neighbour {
    pub(super) point: usize,
    way: Vector3<f32>,
    square: f32,
}

/// An edge vector with its height stretched.
fn stretched(way: Vector3<f32>) -> Vector3<f32> {
    Vector3::new(way.x, way.y, FLATNESS * way.z)
}
