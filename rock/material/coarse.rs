//! The coarse surface at points: what varies so slowly that it can be interpolated between the nodes of a lattice.

use super::floor::Sediment;
use super::rock::Wall;
use super::site::{BLOCK, Ground, Site, Sites, variables};
use crate::noise::{Jet, Lanes, Real, Source, Value, inlined, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// The coarse surface at a point: everything that has no wavelength below 0.4 m.
#[derive(Clone, Copy, Debug)]
pub struct Coarse<S: Simd> {
    /// Position relative to the passage; only the point, the height and the direction around the axis have a gradient.
    pub site: Site<Jet<S>>,
    /// The field without detail, metres.
    pub field: Jet<S>,
    /// The field of the wall alone, metres.
    pub wall_field: Jet<S>,
    /// The shape of the wall.
    pub wall: Wall<Value<S>>,
    /// The sediment on the floor.
    pub sediment: Sediment<Jet<S>>,
    /// See [`super::Debris::patch`].
    pub patch: Value<S>,
    /// See [`super::Rock::level`].
    pub level: Jet<S>,
    /// Variations that every rock has.
    pub tone: CoarseTone<S>,
    /// See [`super::Rock::marks`].
    pub marks: [Value<S>; MARKS],
}

/// Variations of the colour of every rock, each about ±1.
#[derive(Clone, Copy, Debug)]
pub struct CoarseTone<S: Simd> {
    /// Water runs: vertically stretched patches.
    pub streak: Value<S>,
    /// About a metre.
    pub broad: Value<S>,
    /// Two metres.
    pub patch: Value<S>,
}

impl<S: Simd> CoarseTone<S> {
    /// The variations at a site.
    #[inline(always)]
    pub(super) fn of(site: &Site<Value<S>>) -> Self {
        let (p, n) = (site.point, site.source);
        Self {
            streak: n.noise(63, p.stretched(3.2, 3.2, 0.28)) * 0.6 + n.noise(65, p.scaled(1.0 / 2.8)) * 0.9,
            broad: n.fbm(69, p.scaled(1.1), 2, 0.57),
            patch: n.noise(70, p.scaled(0.5)),
        }
    }
}

/// Numbers in [`super::Rock::marks`].
pub const MARKS: usize = 10;

/// Quantities with a gradient.
pub const JETS: usize = 9;
/// Which of them are the fields.
const FIELD: usize = 0;
const WALL_FIELD: usize = 1;
/// Quantities without.
pub const SCALARS: usize = 13 + MARKS;
/// The channel of the state of the wall.
const STATE: usize = 4 * JETS + 2;
/// Numbers that describe the coarse surface at a point: each jet as its value and its three derivatives, then the scalars.
pub const CHANNELS: usize = 4 * JETS + SCALARS;

/// Lanes that a vector at the last point of a block can read or write beyond it: the widest vector.
pub const OVERSHOOT: usize = 16;

/// A block of points and the coarse surface there.
#[derive(Clone, Debug)]
pub struct CoarseBlock {
    /// Number of points; the rest of the block is padding.
    pub count: usize,
    /// Coordinates in metres.
    pub point: [[f32; BLOCK + OVERSHOOT]; 3],
    channels: [[f32; BLOCK + OVERSHOOT]; CHANNELS],
    ground: Ground,
    source: Source,
}

impl CoarseBlock {
    /// An empty block.
    pub fn new(ground: Ground, source: Source) -> Self {
        let channels = [[0.0; BLOCK + OVERSHOOT]; CHANNELS];
        Self { count: 0, point: [[0.0; BLOCK + OVERSHOOT]; 3], channels, ground, source }
    }

    /// Stores at most [`BLOCK`] points.
    pub fn place(&mut self, points: [&[f32]; 3]) {
        self.count = points[0].len();
        for (to, from) in self.point.iter_mut().zip(points) {
            to[..from.len()].copy_from_slice(from);
        }
    }

    /// Stores the points of these sites, with their padding.
    pub(super) fn place_sites(&mut self, sites: &Sites) {
        self.place(sites.point.each_ref().map(|column| &column[..]));
        self.count = sites.count;
    }

    /// All numbers at a point.
    pub fn record(&self, lane: usize) -> [f32; CHANNELS] {
        std::array::from_fn(|channel| self.channels[channel][lane])
    }

    /// Writes one channel from lane `at` on.
    #[inline(always)]
    pub fn put<S: Simd>(&mut self, channel: usize, at: usize, lanes: Lanes<S>) {
        lanes.store_slice(&mut self.channels[channel][at..at + Lanes::<S>::LEN]);
    }

    /// Raises the state of the wall, as of [`Wall::state`], to at least these values.
    pub fn raise_state(&mut self, least: &[f32]) {
        for (state, least) in self.channels[STATE].iter_mut().zip(least) {
            *state = state.max(*least);
        }
    }

    /// Replaces the shape of the wall by a surface through the points with these normals, into the air. Detail and colour
    /// remain.
    pub fn shape_as(&mut self, normals: &[[f32; BLOCK]; 3]) {
        for field in [FIELD, WALL_FIELD] {
            self.channels[4 * field][..BLOCK].fill(0.0);
            for (axis, normal) in normals.iter().enumerate() {
                for (slope, normal) in self.channels[4 * field + 1 + axis].iter_mut().zip(normal) {
                    *slope = -normal;
                }
            }
        }
    }

    /// Repeats the last point in the padding.
    pub fn pad(&mut self) {
        for axis in &mut self.point {
            let last = axis[self.count - 1];
            axis[self.count..].fill(last);
        }
        for channel in &mut self.channels {
            let last = channel[self.count - 1];
            channel[self.count..BLOCK].fill(last);
        }
    }

    /// Writes the coarse surface from lane `at` on.
    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, at: usize, coarse: &Coarse<S>) {
        let Coarse { site, field, wall_field, wall, sediment, patch, level, tone, marks } = coarse;
        let bent = [sediment.at.x - site.point.x, sediment.at.y - site.point.y];
        let jets =
            [*field, *wall_field, site.height, site.up, bent[0], bent[1], sediment.ragged, sediment.roll, *level];
        for (n, jet) in jets.into_iter().enumerate() {
            self.put::<S>(4 * n, at, jet.value);
            for (axis, slope) in jet.gradient.into_iter().enumerate() {
                self.put::<S>(4 * n + 1 + axis, at, slope);
            }
        }
        let flow = site.flow;
        let wall = [wall.recess, wall.cavity, wall.state, wall.band];
        let place = [site.wall, site.half_width, flow.x, flow.y, flow.z];
        let tone = [tone.streak, tone.broad, tone.patch];
        for (n, scalar) in wall.into_iter().enumerate() {
            self.put::<S>(4 * JETS + n, at, scalar.0);
        }
        for (n, scalar) in place.into_iter().enumerate() {
            self.put::<S>(4 * JETS + 4 + n, at, scalar.value);
        }
        for (n, scalar) in tone.into_iter().enumerate() {
            self.put::<S>(4 * JETS + 9 + n, at, scalar.0);
        }
        self.put::<S>(4 * JETS + 12, at, patch.0);
        for (n, scalar) in marks.iter().enumerate() {
            self.put::<S>(4 * JETS + 13 + n, at, scalar.0);
        }
    }

    /// The coarse surface from lane `at` on.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, at: usize) -> Coarse<S> {
        let lanes =
            inlined!(|channel: usize| Lanes::<S>::from_slice(simd, &self.channels[channel][at..at + Lanes::<S>::LEN]));
        let jet = inlined!(|n: usize| Jet {
            value: lanes(4 * n),
            gradient: [lanes(4 * n + 1), lanes(4 * n + 2), lanes(4 * n + 3)],
        });
        let scalar = inlined!(|n: usize| Value::<S>(lanes(4 * JETS + n)));
        let still = inlined!(|n: usize| Jet::constant(lanes(4 * JETS + n)));
        let point = variables(simd, &self.point, at);
        // Between nodes that are all in the second state, interpolation rounds to a little more or less than 1.
        let state = scalar(2).within(0.0, 1.0);
        Coarse {
            site: Site {
                point,
                wall: still(4),
                height: jet(2),
                up: jet(3),
                half_width: still(5),
                flow: vec3(still(6), still(7), still(8)),
                ground: self.ground,
                source: self.source,
            },
            field: jet(0),
            wall_field: jet(1),
            wall: Wall { recess: scalar(0), cavity: scalar(1), state, band: scalar(3) },
            sediment: Sediment { at: vec3(point.x + jet(4), point.y + jet(5), point.z), ragged: jet(6), roll: jet(7) },
            patch: scalar(12),
            level: jet(8),
            tone: CoarseTone { streak: scalar(9), broad: scalar(10), patch: scalar(11) },
            marks: std::array::from_fn(
                #[inline(always)]
                |n| scalar(13 + n),
            ),
        }
    }
}
