//! Rest of a stone on a floor, without physics.
//!
//! A stone that comes down on a floor stops in the lowest position in which nothing of it is below the floor. Among the
//! planes above all contacts, that of the lowest height at the centre of mass is a linear programme in three variables; at
//! its optimum three supports surround the centre of mass. The stone then turns into that plane, and again, until it no
//! longer turns. Promised of a result: three supports around the centre of mass, none so steep that the stone slides off, with a
//! margin that what nearly touches may widen, and nothing of the samples below the floor. Not promised: edges that cross the edge of a triangle between samples.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector2, Vector3};

use super::facets::Facet;
use super::library::{Body, STARTS};

/// Rounds until a stone must be at rest.
const MOST_ROUNDS: usize = 12;
/// Turn below which a stone is at rest, as a slope.
const LEAST_TURN: f64 = 0.004;
/// Least slope by which the floor must be tipped until a stone falls over: 10°. Tuned for Bullet.
const LEAST_TIP: f64 = 0.17;
/// The same of a stone that still turns. Tuned: of the stones that come to rest 97 % do so nevertheless, and the others are given
/// up after a third of the rounds.
const LEAST_TIP_TURNING: f64 = 0.085;
/// Gap in metres below which something carries a stone as soon as it rocks. Tuned: without, a third of the shapes had no side on
/// which they lie, though each has a flat one; with 2 mm ten times as many stones roll in Bullet.
const TOUCH_M: f64 = 0.001;
/// Margin around the centre on all that is so near, relative to that on three supports. Tuned: with 1.5 eight times as many stones
/// roll in Bullet.
const BASE_MARGIN: f64 = 2.0;
/// Least upward component of the normal at a support: 34°. Tuned: on steeper ones stones slide in Bullet, at a friction of 0.8.
pub(super) const LEAST_LEVEL: f64 = 0.85;
/// The same under a stone that still turns.
const LEAST_LEVEL_TURNING: f64 = 0.825;
/// The angle by which turns are spread best.
pub(super) const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;
/// Samples of the underside along either axis, in addition to those under corners and middles of edges.
const SAMPLES: usize = 4;
/// Length in metres from which on the middle of an edge is a sample. Tuned: half of the samples of pebbles were on shorter ones.
const LONG_EDGE_M: f64 = 0.05;

/// A stone over the floor on which it is to lie.
pub(super) struct Bed<'a> {
    corners: Vec<Vector3<f64>>,
    faces: &'a [[u32; 3]],
    /// The long ones.
    edges: Vec<[usize; 2]>,
    floor: Floor,
    /// The corners of the floor by their place on the map, relative to `at`, and the height of the floor there.
    peaks: Vec<(Vector2<f64>, f64)>,
    at: Point3<f64>,
}

/// What faces upwards around a stone, found by cells of the map.
struct Floor {
    facets: Vec<Facet>,
    /// The facets over each cell of a square around the stone.
    cells: Vec<Vec<Incline>>,
    /// Cells along either side of the square.
    side: usize,
    reach_m: f64,
}

/// A facet as heights over the map, relative to the middle of the square.
#[derive(Clone, Copy)]
struct Incline {
    corner: Vector2<f64>,
    /// Rows of the matrix that gives the shares of the other two corners.
    shares: [Vector2<f64>; 2],
    /// Height of the corner, and what the others add.
    height: [f64; 3],
    /// Upward component of its normal.
    level: f64,
}

impl<'a> Bed<'a> {
    /// A stone of this size over a point of the floor; `floor_near` gives what faces upwards within a distance from there.
    pub fn new(body: &'a Body, scale: f64, at: Point3<f64>, floor_near: impl Fn(f64) -> Vec<Facet>) -> Self {
        let corners: Vec<Vector3<f64>> = body.corners.iter().map(|corner| corner.coords * scale).collect();
        let reach_m = corners.iter().map(Vector3::norm).fold(0.0, f64::max);
        let (faces, edges) = (&body.faces, long_edges(body, scale).collect());
        let floor = Floor::new(floor_near(reach_m), at, reach_m);
        let on_map = floor.facets.iter().flat_map(|facet| facet.corners).map(|corner| (corner - at).xy());
        let mut in_reach: Vec<Vector2<f64>> = on_map.filter(|place| place.norm_squared() < reach_m * reach_m).collect();
        // A corner belongs to some six triangles.
        in_reach.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        in_reach.dedup();
        let peaks = in_reach.into_iter().filter_map(|place| Some((place, floor.top(place)?.0))).collect();
        Self { corners, faces, edges, floor, peaks, at }
    }

    /// The pose of the stone, around its centre of mass, that is let down on a side on which it lies on level ground; `None` if it
    /// would not stay.
    pub fn rest(&self, turn: UnitQuaternion<f64>) -> Option<Isometry3<f64>> {
        self.settle(turn, |supports, gaps| supports.hold(gaps, LEAST_TIP_TURNING, LEAST_LEVEL_TURNING))
    }

    /// The pose of the stone that is let down like this and turns until it stays; `None` if that does not end well, or is given up.
    fn settle(
        &self,
        mut turn: UnitQuaternion<f64>,
        may_go_on: fn(&Supports, &[Gap]) -> bool,
    ) -> Option<Isometry3<f64>> {
        for _ in 0..MOST_ROUNDS {
            let gaps = self.gaps(turn);
            let supports = supports(&gaps)?;
            let plane = supports.plane()?;
            let slope = Vector2::new(plane.x, plane.y);
            if slope.norm() < LEAST_TURN {
                let position = Translation3::new(self.at.x, self.at.y, plane.z);
                return supports.hold(&gaps, LEAST_TIP, LEAST_LEVEL).then(|| Isometry3::from_parts(position, turn));
            }
            if !may_go_on(&supports, &gaps) {
                return None;
            }
            turn = tilt(slope) * turn;
        }
        None
    }

    /// The gaps under corners and middles of long edges of the underside, over the corners of the floor, and on a grid.
    fn gaps(&self, turn: UnitQuaternion<f64>) -> Vec<Gap> {
        let corners: Vec<Vector3<f64>> = self.corners.iter().map(|corner| turn * corner).collect();
        let (mut under, mut is_under) = (Vec::new(), vec![false; corners.len()]);
        for face in self.faces {
            let [a, b, c] = face.map(|corner| corners[corner as usize]);
            let normal = (b - a).cross(&(c - a));
            if normal.z < 0.0 {
                under.push(Plane::through(a, normal));
                face.iter().for_each(|corner| is_under[*corner as usize] = true);
            }
        }
        let bound = |axis: usize, of: fn(f64, f64) -> f64| corners.iter().map(|c| c[axis]).reduce(of).unwrap_or(0.0);
        let (min, max) = ([0, 1].map(|axis| bound(axis, f64::min)), [0, 1].map(|axis| bound(axis, f64::max)));
        let is_inside = |p: &Vector2<f64>| (0..2).all(|i| min[i] <= p[i] && p[i] <= max[i]);
        let along = |axis: usize, n: usize| min[axis] + (max[axis] - min[axis]) * (n as f64 + 0.5) / SAMPLES as f64;
        // The underside of a convex body is the highest of its planes, which beside the body are higher than any of it.
        let bottom = |place: Vector2<f64>| {
            let higher = |a: (f64, f64), b: (f64, f64)| if b.0 > a.0 { b } else { a };
            under.iter().map(|plane| (plane.height(place), plane.level)).fold((f64::NEG_INFINITY, 0.0), higher)
        };
        let gap = |place, top: f64, bottom: f64, level| Gap { place, height: top - bottom, level, below: -bottom };
        // A corner stands on a face: the stone's on one of the floor, or the floor's under one of the stone.
        let is_lower = |edge: &&[usize; 2]| edge.iter().all(|corner| is_under[*corner]);
        let middles = self.edges.iter().filter(is_lower).map(|[a, b]| 0.5 * (corners[*a] + corners[*b]));
        let lower = corners.iter().zip(&is_under).filter(|(_, is_under)| **is_under).map(|(corner, _)| *corner);
        let own = lower.chain(middles).filter_map(|point| {
            let (top, level) = self.floor.top(point.xy())?;
            Some(gap(point.xy(), top, point.z, level))
        });
        let grid = (0..SAMPLES * SAMPLES).map(|n| Vector2::new(along(0, n % SAMPLES), along(1, n / SAMPLES)));
        let on_floor = grid.filter_map(|place| {
            let (top, level) = self.floor.top(place)?;
            Some(gap(place, top, bottom(place).0, level))
        });
        let under_stone = self.peaks.iter().filter(|(place, _)| is_inside(place)).map(|&(place, top)| {
            let (bottom, level) = bottom(place);
            gap(place, top, bottom, level)
        });
        let mut gaps = Vec::with_capacity(2 * corners.len() + SAMPLES * SAMPLES + self.peaks.len());
        gaps.extend(own);
        gaps.extend(on_floor);
        gaps.extend(under_stone);
        gaps
    }
}

/// The edges of a body of this size that are so long that something may be between their ends.
pub(super) fn long_edges(body: &Body, scale: f64) -> impl Iterator<Item = [usize; 2]> {
    let length_m = move |[a, b]: [usize; 2]| (body.corners[a] - body.corners[b]).norm() * scale;
    body.edges().filter(move |edge| length_m(*edge) > LONG_EDGE_M)
}

/// How a body lies on a level floor, in all ways in which it stays and its upper side is up; those with the lowest centre of
/// mass come first.
pub(super) fn stable_turns(body: &Body) -> Vec<UnitQuaternion<f64>> {
    /// Half the width of the floor in metres.
    const HALF_M: f64 = 10.0;
    /// Cosine of the angle between two sides that are not told apart.
    const ALIKE: f64 = 0.95;
    /// Least upward component of the upper side, on which there is dust.
    const UPRIGHT: f64 = 0.6;
    let corner = |x: f64, y: f64| Point3::new(x * HALF_M, y * HALF_M, 0.0);
    let half = |side: f64| Facet {
        corners: [corner(-side, -side), corner(side, -side), corner(side, side)],
        normal: Vector3::z(),
    };
    let bed = Bed::new(body, 1.0, Point3::origin(), |_| vec![half(1.0), half(-1.0)]);
    let down = |turn: &UnitQuaternion<f64>| turn.inverse() * -Vector3::z();
    let mut found: Vec<Isometry3<f64>> = Vec::new();
    for start in STARTS.into_iter().filter(|start| start[2] < 0) {
        let start = turn(Vector3::from(start.map(f64::from)).normalize(), -Vector3::z());
        // It starts on its edge or corner, so it must turn.
        let lying = bed.settle(start, |_, _| true).filter(|lying| down(&lying.rotation).z < -UPRIGHT);
        let Some(lying) = lying else { continue };
        if found.iter().all(|known| down(&known.rotation).dot(&down(&lying.rotation)) < ALIKE) {
            found.push(lying);
        }
    }
    found.sort_by(|a, b| a.translation.z.total_cmp(&b.translation.z));
    found.into_iter().map(|lying| lying.rotation).collect()
}

impl Floor {
    /// Most cells along either side of the square.
    const MOST_CELLS: usize = 8;

    fn new(facets: Vec<Facet>, at: Point3<f64>, reach_m: f64) -> Self {
        let middle = at.coords.xy();
        let side = facets.len().isqrt().clamp(1, Self::MOST_CELLS);
        let mut floor = Self { facets, cells: vec![Vec::new(); side * side], side, reach_m };
        for facet in &floor.facets {
            let Some(incline) = Incline::new(facet, middle) else { continue };
            let [a, b, c] = facet.corners.map(|corner| corner.coords.xy() - middle);
            let low = a.inf(&b).inf(&c).map(|along| floor.cell(along));
            let high = a.sup(&b).sup(&c).map(|along| floor.cell(along));
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    floor.cells[y * side + x].push(incline);
                }
            }
        }
        floor
    }

    /// The cell along an axis; the outermost reach to infinity.
    fn cell(&self, along_m: f64) -> usize {
        let cell = (along_m / self.reach_m + 1.0) * 0.5 * self.side as f64;
        (cell.max(0.0) as usize).min(self.side - 1)
    }

    /// Height of the floor at a place relative to the middle, and the upward component of its normal there.
    fn top(&self, place: Vector2<f64>) -> Option<(f64, f64)> {
        let [x, y] = [place.x, place.y].map(|along| self.cell(along));
        let cell = self.cells[y * self.side + x].iter();
        let heights = cell.filter_map(|incline| Some((incline.height(place)?, incline.level)));
        heights.reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}

impl Incline {
    /// A facet around a place of the map; `None` if it is upright.
    fn new(facet: &Facet, middle: Vector2<f64>) -> Option<Self> {
        let [a, b, c] = facet.corners.map(|corner| corner.coords.xy() - middle);
        let (u, v) = (b - a, c - a);
        let area = u.perp(&v);
        let [low, first, second] = facet.corners.map(|corner| corner.z);
        (area != 0.0).then(|| Self {
            corner: a,
            shares: [Vector2::new(v.y, -v.x) / area, Vector2::new(-u.y, u.x) / area],
            height: [low, first - low, second - low],
            level: facet.normal.z,
        })
    }

    /// Its height at a place, if that is above or below it.
    fn height(&self, place: Vector2<f64>) -> Option<f64> {
        let [first, second] = self.shares.map(|row| row.dot(&(place - self.corner)));
        let is_inside = first >= 0.0 && second >= 0.0 && first + second <= 1.0;
        is_inside.then(|| self.height[0] + first * self.height[1] + second * self.height[2])
    }
}

/// A plane that is not upright, as a height over the map.
struct Plane {
    slope: Vector2<f64>,
    at_origin: f64,
    /// Upward component of its normal.
    level: f64,
}

impl Plane {
    fn through(point: Vector3<f64>, normal: Vector3<f64>) -> Self {
        let (slope, at_origin) = (-normal.xy() / normal.z, normal.dot(&point) / normal.z);
        Self { slope, at_origin, level: 1.0 / (1.0 + slope.norm_squared()).sqrt() }
    }

    fn height(&self, place: Vector2<f64>) -> f64 {
        self.at_origin + self.slope.dot(&place)
    }
}

/// A turn about the vertical.
pub(super) fn about_z(angle_rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(libm::cos(angle_rad / 2.0), 0.0, 0.0, libm::sin(angle_rad / 2.0)))
}

/// The turn that brings the level plane into one of this slope.
fn tilt(slope: Vector2<f64>) -> UnitQuaternion<f64> {
    turn(Vector3::z(), Vector3::new(-slope.x, -slope.y, 1.0).normalize())
}

/// The shortest turn from one direction to another that is not its opposite.
pub(super) fn turn(from: Vector3<f64>, to: Vector3<f64>) -> UnitQuaternion<f64> {
    // The half-way vector gives the quaternion without an angle.
    let half = (to + from).normalize();
    let axis = from.cross(&half);
    UnitQuaternion::new_normalize(Quaternion::new(from.dot(&half), axis.x, axis.y, axis.z))
}

/// How high the centre of mass must be so that the stone does not go below the floor, by place relative to it.
#[derive(Clone, Copy)]
struct Gap {
    place: Vector2<f64>,
    height: f64,
    /// Upward component of the normal of what would touch.
    level: f64,
    /// How far below the centre of mass it would touch.
    below: f64,
}

/// Three places around the centre of mass.
struct Supports([Gap; 3]);

/// The supports in the lowest position: the facet above the centre of the upper hull of the gaps, by the dual simplex method.
fn supports(gaps: &[Gap]) -> Option<Supports> {
    /// Far supports below everything, so that the centre is surrounded from the start.
    const FAR_M: f64 = 1e3;
    let low = gaps.iter().map(|gap| gap.height).fold(f64::INFINITY, f64::min) - FAR_M;
    let corner =
        |x: f64, y: f64| Gap { place: Vector2::new(x * FAR_M, y * FAR_M), height: low, level: 0.0, below: 0.0 };
    let mut held = Supports([corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)]);
    for _ in 0..4 * gaps.len() {
        let plane = held.plane()?;
        let excess = |gap: &Gap| gap.height - (plane.z + plane.x * gap.place.x + plane.y * gap.place.y);
        let by_excess = gaps.iter().map(|gap| (excess(gap), gap));
        let (most, worst) = by_excess.reduce(|a, b| if b.0 > a.0 { b } else { a })?;
        if most <= 1e-9 {
            let is_real = held.0.iter().all(|gap| gap.place.norm() < FAR_M / 2.0);
            return is_real.then_some(held);
        }
        held = held.with(*worst)?;
    }
    None
}

impl Supports {
    /// The plane through them: slopes along x and y, and the height at the centre.
    fn plane(&self) -> Option<Vector3<f64>> {
        let [(a, ha), (b, hb), (c, hc)] = self.0.map(|gap| (gap.place, gap.height));
        let (u, v) = (b - a, c - a);
        let area = u.x * v.y - u.y * v.x;
        if area == 0.0 {
            return None;
        }
        let slope_x = ((hb - ha) * v.y - (hc - ha) * u.y) / area;
        let slope_y = ((hc - ha) * u.x - (hb - ha) * v.x) / area;
        Some(Vector3::new(slope_x, slope_y, ha - slope_x * a.x - slope_y * a.y))
    }

    /// The triangle with one corner replaced that still surrounds the centre, with the largest margin.
    fn with(&self, new: Gap) -> Option<Self> {
        let replaced = (0..3).map(|corner| {
            let mut three = self.0;
            three[corner] = new;
            Self(three)
        });
        replaced.filter(|three| three.margin() >= 0.0).max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// Whether a stone neither tips over, the floor being tipped by this slope, nor slides off, on supports at least so level.
    fn hold(&self, gaps: &[Gap], tip: f64, level: f64) -> bool {
        let high = self.0.iter().map(|gap| gap.below).fold(0.0, f64::max);
        let is_level = self.0.iter().all(|gap| gap.level >= level);
        is_level && (self.margin() > tip * high || self.base_margin(gaps) > BASE_MARGIN * tip * high)
    }

    /// Distance of the centre from the nearest side of all that touches or nearly does, in the least of 16 directions.
    fn base_margin(&self, gaps: &[Gap]) -> f64 {
        const STEP: (f64, f64) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);
        let Some(plane) = self.plane() else { return 0.0 };
        let under = |gap: &&Gap| plane.z + plane.xy().dot(&gap.place) - gap.height < TOUCH_M;
        let base: Vec<Vector2<f64>> = gaps.iter().filter(under).map(|gap| gap.place).collect();
        let turned =
            |way: &Vector2<f64>| Some(Vector2::new(STEP.0 * way.x - STEP.1 * way.y, STEP.1 * way.x + STEP.0 * way.y));
        let ways = std::iter::successors(Some(Vector2::x()), turned).take(16);
        let furthest = |way: Vector2<f64>| base.iter().map(|place| way.dot(place)).fold(f64::NEG_INFINITY, f64::max);
        ways.map(furthest).fold(f64::INFINITY, f64::min)
    }

    /// Distance of the centre from the nearest side, negative outside.
    fn margin(&self) -> f64 {
        let [a, b, c] = self.0.map(|gap| gap.place);
        let area = (b - a).perp(&(c - a));
        let side = |p: Vector2<f64>, q: Vector2<f64>| (q - p).perp(&-p) * area.signum() / (q - p).norm();
        side(a, b).min(side(b, c)).min(side(c, a))
    }
}
