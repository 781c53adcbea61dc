//! Dripstone: bodies of revolution, and sheets. Stalactites and draperies hang from the origin and reach a little above it,
//! into the rock; stalagmites and columns stand on it and reach a little below.
//!
//! Stalactites have the shape to which all of them grow: in units of its own, a height of ¾ r^(4/3) − r^(2/3) − ⅓ ln r above
//! the tip at radius r (Short, Baygents and Goldstein, *Stalactite growth as a free-boundary problem*, 2005).

use nalgebra::Point3;
use plume_graph::rng::Rng;

use super::kind::Shape;
use super::solid::Solid;
use super::substance::{CALCITE, DRAPERY};

/// Length of a stalactite in metres.
const LENGTH_M: f32 = 0.40;
/// Radius of the tip in metres: that of a straw (Curl, *Minimum diameter stalactites*, 1972) at the median length.
const TIP_M: f32 = 0.012;
/// How far roots and feet reach into the rock, in metres.
const ROOT_M: f32 = 0.04;
/// Height of a stalagmite in metres.
const HEIGHT_M: f32 = 0.36;
/// Height of a column in metres.
const COLUMN_M: f32 = 0.80;
/// Knots of a profile.
const KNOTS: usize = 64;

/// Radius by height at evenly spaced knots.
struct Profile {
    low_m: f32,
    high_m: f32,
    radius_m: [f32; KNOTS],
}

impl Profile {
    fn new(low_m: f32, high_m: f32, radius_m: impl Fn(f32) -> f32) -> Self {
        let height = |knot: usize| low_m + (high_m - low_m) * knot as f32 / (KNOTS - 1) as f32;
        Self { low_m, high_m, radius_m: std::array::from_fn(|knot| radius_m(height(knot))) }
    }

    /// Distance to the surface, from the distance along the radius and the slope of the profile.
    fn distance(&self, [x, y, z]: [f32; 3]) -> f32 {
        let span = (self.high_m - self.low_m) / (KNOTS - 1) as f32;
        let place = ((z - self.low_m) / span).clamp(0.0, (KNOTS - 1) as f32 - 0.001);
        let knot = place as usize;
        let (below, above) = (self.radius_m[knot], self.radius_m[knot + 1]);
        let radius = below + (above - below) * (place - knot as f32);
        let slope = (above - below) / span;
        let aside = (radius - (x * x + y * y).sqrt()) / (1.0 + slope * slope).sqrt();
        aside.min(z - self.low_m).min(self.high_m - z)
    }

    /// As a shape whose axis wanders by up to `wander_m`, and that is ribbed.
    fn shape(self, rng: &mut Rng, wander_m: f32, ribs: f32) -> Shape {
        let [phase, turn] = [0, 1].map(|_| rng.between(0.0, std::f64::consts::TAU) as f32);
        let (sine, cosine) = (libm::sinf(turn), libm::cosf(turn));
        Box::new(move |[x, y, z]| {
            // Zero at the origin, where the thing is attached.
            let aside = wander_m * (libm::sinf(z * 9.0 + phase) - libm::sinf(phase));
            // Growth is uneven from year to year and from side to side.
            let turned = if x == 0.0 && y == 0.0 { 0.0 } else { (x * cosine + y * sine) / libm::sqrtf(x * x + y * y) };
            let bulge = 0.6 * libm::sinf(z * 37.0 + 2.0 * phase + turned) + 0.4 * turned * libm::sinf(z * 23.0 + phase);
            let rib = ribs * (libm::sinf(z * 95.0 + phase + 2.0 * libm::sinf(z * 31.0)) + 1.5 * bulge);
            self.distance([x - aside * cosine, y - aside * sine, z]) + rib
        })
    }
}

/// Radius of a stalactite in units of its own, this high above the lowest point of the curve.
fn universal_radius(height: f64) -> f64 {
    let curve = |r: f64| 0.75 * libm::pow(r, 4.0 / 3.0) - libm::pow(r, 2.0 / 3.0) - libm::log(r) / 3.0 + 0.25;
    let (mut low, mut high) = (1.0, 1e6);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curve(middle) < height { low = middle } else { high = middle }
    }
    low
}

/// A stalactite; the longer it is in units of its own, the slimmer.
pub fn stalactite(rng: &mut Rng) -> Shape {
    let units = libm::exp(rng.between(libm::log(900.0), libm::log(9000.0)));
    hanging(rng, units, 0.009)
}

/// A drip of lava: blunt, since it freezes as it falls.
pub fn lavacicle(rng: &mut Rng) -> Shape {
    let units = rng.between(120.0, 500.0);
    hanging(rng, units, 0.006)
}

fn hanging(rng: &mut Rng, units: f64, wander_m: f32) -> Shape {
    let unit_m = f64::from(LENGTH_M) / units;
    let radius = |z: f32| {
        let above_tip_m = (z + LENGTH_M).max(0.0);
        let tip_m = TIP_M * (above_tip_m / TIP_M).min(1.0).sqrt();
        tip_m.max((universal_radius(f64::from(above_tip_m) / unit_m) * unit_m) as f32)
    };
    let profile = Profile::new(-LENGTH_M, ROOT_M, |z| radius(z.min(0.0)) + z.max(0.0) * 0.8);
    profile.shape(rng, wander_m, 0.0016)
}

/// Soda straws that hang from one joint, which is along x: tubes as wide as a drop (Curl 1972). The row collides as its convex
/// hull, so that each straw is nearly as long as the line from the longest one to the outermost has it.
pub fn straws(rng: &mut Rng) -> Solid {
    /// Radius of a straw in metres.
    const STRAW_M: f64 = 0.002_55;
    /// Straws in a row, and which of them is the longest.
    const STRAWS: u32 = 8;
    const LONGEST: u32 = 3;
    /// How much shorter a straw is at most, in metres.
    const SHORTER_M: f64 = 0.032;
    let outer = [0, 1].map(|_| rng.between(0.1, 0.7));
    let straw = |n: u32, rng: &mut Rng| {
        let place = [0.02 * f64::from(n) - 0.07, rng.between(-0.006, 0.006)];
        let outwards = f64::from(n.abs_diff(LONGEST)) / f64::from(STRAWS - 1 - LONGEST);
        let share = 1.0 + (outer[usize::from(n > LONGEST)] - 1.0) * outwards;
        let shorter_m = if n == LONGEST { 0.0 } else { rng.between(0.0, SHORTER_M) };
        let end = |z: f64| Point3::new(place[0], place[1], z);
        let tip = end(shorter_m - share * f64::from(LENGTH_M));
        Solid::tube(&[tip, end(f64::from(ROOT_M))], STRAW_M, 6, &CALCITE)
    };
    (1..STRAWS).fold(straw(0, rng), |all, n| all.and(straw(n, rng)))
}

/// A drapery: a sheet that water builds as it runs down a sloping ceiling, and that is the deeper the further it has run
/// (Hill and Forti, *Cave Minerals of the World*, 1997). Its length is along x, downstream. It collides as its convex hull, so
/// that its folds are shallow.
pub fn drapery(rng: &mut Rng) -> Solid {
    /// Its length, and how deep it hangs at its upper and at its lower end, in metres.
    const ALONG_M: f64 = 0.42;
    const DEPTH_M: [f64; 2] = [0.10, 0.36];
    /// How far its folds are out of its plane at most, in metres.
    const FOLD_M: f64 = 0.018;
    /// Half its thickness at the ceiling and at its lower edge, in metres.
    const HALF_M: [f64; 2] = [0.004_5, 0.002_5];
    /// Steps along it and down it.
    const ALONG: u32 = 20;
    const DOWN: u32 = 6;
    let between = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
    let [wide, narrow] = [0, 1].map(|_| rng.between(0.0, std::f64::consts::TAU));
    let outline = |n: u32| {
        let along = f64::from(n) / f64::from(ALONG);
        let depth_m = between(DEPTH_M, along.sqrt());
        let wave = 0.65 * libm::sin(11.0 * along + wide) + 0.35 * libm::sin(23.0 * along + narrow);
        let side = |row: u32, way: f64| {
            let y = between([-depth_m, f64::from(ROOT_M)], f64::from(row) / f64::from(DOWN));
            let down = (-y / depth_m).max(0.0);
            [FOLD_M * wave * between([0.3, 1.0], down) + way * between(HALF_M, down), y]
        };
        let corners = (0..=DOWN).map(|row| side(row, 1.0)).chain((0..=DOWN).rev().map(|row| side(row, -1.0)));
        (ALONG_M * (along - 0.5), corners.collect())
    };
    Solid::through(&(0..=ALONG).map(outline).collect::<Vec<_>>(), &DRAPERY).lying()
}

/// A stalagmite: a slightly flared foot, nearly even sides, and a dome that the drops flatten. It collides as its convex hull,
/// which a wider foot would take into the open.
pub fn stalagmite(rng: &mut Rng) -> Shape {
    let top_m = HEIGHT_M * rng.between(0.09, 0.22) as f32;
    let flare = rng.between(0.1, 0.35) as f32;
    let taper = rng.between(0.15, 0.6) as f32;
    let profile = Profile::new(-ROOT_M, HEIGHT_M, |z| {
        let share = (z / HEIGHT_M).clamp(0.0, 1.0);
        let side = top_m * (1.0 + taper * (1.0 - share) + flare * libm::expf(-share / 0.13));
        let dome = ((HEIGHT_M - z) / (0.8 * top_m)).clamp(0.0, 1.0);
        side * (dome * (2.0 - dome)).sqrt()
    });
    profile.shape(rng, 0.006, 0.0022)
}

/// A column, slightly wider at both ends, for the same reason.
pub fn column(rng: &mut Rng) -> Shape {
    let waist_m = COLUMN_M * rng.between(0.05, 0.10) as f32;
    let profile = Profile::new(-ROOT_M, COLUMN_M, |z| {
        let share = (z / COLUMN_M).clamp(0.0, 1.0);
        waist_m * (1.0 + 0.2 * libm::expf(-share / 0.08) + 0.3 * libm::expf((share - 1.0) / 0.10))
    });
    let stand = profile.shape(rng, 0.008, 0.0025);
    // Centred on the shelf, on which there is no room for the whole height on one side.
    Box::new(move |[x, y, z]| stand([x, y, z + COLUMN_M / 2.0]))
}
