//! Position of points relative to the cave: the input of a rock.

use crate::noise::{Jet, LACUNARITY, Lanes, Real, Source, Value, Vec3, inlined, vec3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Sites per block; a multiple of every vector width.
pub const BLOCK: usize = 64;

/// A quantity at every site of a block, with its gradient over space.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Values.
    pub value: [f32; BLOCK],
    /// Derivatives along x, y and z; undefined if only values were computed.
    pub gradient: [[f32; BLOCK]; 3],
}

impl Channel {
    const ZERO: Self = Self { value: [0.0; BLOCK], gradient: [[0.0; BLOCK]; 3] };

    /// Writes lanes from `at` on.
    #[inline(always)]
    pub fn store<S: Simd, T: Stored<S>>(&mut self, at: usize, number: T) {
        number.store(self, at);
    }
}

/// The floor of a passage, the same for the whole cave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Height of stones in the driving lane, in metres; up to [`Ground::BANK`] times that at the foot of a wall.
    pub roughness_m: f32,
    /// Strength of the floor's undulation and rubble, 0–1.
    pub natural: f32,
}

impl Ground {
    /// Height of rubble at the foot of a wall relative to that in the driving lane.
    pub const BANK: f32 = 4.0;
    /// Maximum undulation in metres.
    pub const UNDULATION_M: f32 = 0.10;

    /// Maximum height of the floor above its plane, in metres.
    pub fn highest_m(&self) -> f32 {
        self.natural * Self::UNDULATION_M + self.roughness_m * Self::BANK
    }
}

/// A block of points with their passage data.
#[derive(Clone, Debug)]
pub struct Sites {
    /// Number of sites; the rest of the block is padding.
    pub count: usize,
    /// Coordinates in metres.
    pub point: [[f32; BLOCK]; 3],
    /// Distance to the smooth wall of the passage, negative in air, metres.
    pub wall: Channel,
    /// Height above the plane of the floor, metres.
    pub height: Channel,
    /// Direction from the axis of the passage to the point: 1 ceiling, 0 side, −1 floor.
    pub up: Channel,
    /// Half the width of the passage, metres.
    pub half_width: Channel,
    /// Direction in which water or lava flows: a unit vector in a passage, shorter where several meet, 0 in rooms.
    pub flow: [[f32; BLOCK]; 3],
    /// The floor.
    pub ground: Ground,
    /// The noise of the rock.
    pub source: Source,
}

impl Sites {
    /// An empty block.
    pub fn new(ground: Ground, source: Source) -> Self {
        Self {
            count: 0,
            point: [[0.0; BLOCK]; 3],
            wall: Channel::ZERO,
            height: Channel::ZERO,
            up: Channel::ZERO,
            half_width: Channel::ZERO,
            flow: [[0.0; BLOCK]; 3],
            ground,
            source,
        }
    }

    /// Stores at most [`BLOCK`] points; padding repeats the last.
    pub fn place(&mut self, points: &[[f32; 3]]) {
        self.count = points.len();
        self.point = by_axis(points);
    }

    /// The lanes from `at` on.
    #[inline(always)]
    pub fn site<S: Simd, T: Stored<S>>(&self, simd: S, at: usize) -> Site<T> {
        Site {
            point: T::point(simd, &self.point, at),
            wall: T::load(simd, &self.wall, at),
            height: T::load(simd, &self.height, at),
            up: T::load(simd, &self.up, at),
            half_width: T::load(simd, &self.half_width, at),
            flow: T::constants(simd, &self.flow, at),
            ground: self.ground,
            source: self.source,
        }
    }
}

/// Coordinates of a block of points; padding repeats the last.
pub fn by_axis(points: &[[f32; 3]]) -> [[f32; BLOCK]; 3] {
    let last = points.len() - 1;
    std::array::from_fn(|axis| std::array::from_fn(|lane| points[lane.min(last)][axis]))
}

/// One site per lane; see [`Sites`] for the meaning of the fields.
#[derive(Clone, Copy, Debug)]
pub struct Site<T> {
    /// The point itself.
    pub point: Vec3<T>,
    /// Distance to the smooth wall.
    pub wall: T,
    /// Height above the floor plane.
    pub height: T,
    /// Direction around the axis.
    pub up: T,
    /// Half the width of the passage.
    pub half_width: T,
    /// Direction of flow, without a gradient.
    pub flow: Vec3<T>,
    /// The floor.
    pub ground: Ground,
    /// The noise.
    pub source: Source,
}

impl<T> Site<T> {
    /// The vector type of the site.
    #[inline(always)]
    pub fn simd<S: Simd>(&self) -> S
    where
        T: Real<S>,
    {
        self.wall.value().token()
    }
}

impl<S: Simd> Site<Jet<S>> {
    /// The site without gradients.
    #[inline(always)]
    pub fn values(&self) -> Site<Value<S>> {
        let value = inlined!(|number: Jet<S>| Value(number.value));
        let vector = inlined!(|v: Vec3<Jet<S>>| vec3(value(v.x), value(v.y), value(v.z)));
        Site {
            point: vector(self.point),
            wall: value(self.wall),
            height: value(self.height),
            up: value(self.up),
            half_width: value(self.half_width),
            flow: vector(self.flow),
            ground: self.ground,
            source: self.source,
        }
    }
}

/// A number that can be stored in a [`Channel`].
pub trait Stored<S: Simd>: Real<S> {
    /// The coordinates from `at` on, as variables of space.
    fn point(simd: S, point: &[[f32; BLOCK]; 3], at: usize) -> Vec3<Self>;
    /// Reads lanes from `at` on.
    fn load(simd: S, channel: &Channel, at: usize) -> Self;
    /// Reads the lanes of a vector from `at` on, as constants in space.
    #[inline(always)]
    fn constants(simd: S, vector: &[[f32; BLOCK]; 3], at: usize) -> Vec3<Self> {
        let axis = inlined!(|i: usize| Self::constant(lanes(simd, &vector[i], at)));
        vec3(axis(0), axis(1), axis(2))
    }
    /// Writes lanes from `at` on.
    fn store(self, channel: &mut Channel, at: usize);
}

/// Coordinates from lane `at` on, as variables of space.
#[inline(always)]
pub(super) fn variables<S: Simd, const N: usize>(simd: S, point: &[[f32; N]; 3], at: usize) -> Vec3<Jet<S>> {
    let one = inlined!(|here: bool| Lanes::<S>::splat(simd, f32::from(u8::from(here))));
    let axis = inlined!(|i: usize| Jet {
        value: lanes(simd, &point[i], at),
        gradient: [one(i == 0), one(i == 1), one(i == 2)],
    });
    vec3(axis(0), axis(1), axis(2))
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, from: &[f32], at: usize) -> Lanes<S> {
    Lanes::<S>::from_slice(simd, &from[at..at + Lanes::<S>::LEN])
}

#[inline(always)]
fn put<S: Simd>(lanes: Lanes<S>, to: &mut [f32; BLOCK], at: usize) {
    lanes.store_slice(&mut to[at..at + Lanes::<S>::LEN]);
}

impl<S: Simd> Stored<S> for Value<S> {
    #[inline(always)]
    fn point(simd: S, point: &[[f32; BLOCK]; 3], at: usize) -> Vec3<Self> {
        let axis = inlined!(|i: usize| Value(lanes(simd, &point[i], at)));
        vec3(axis(0), axis(1), axis(2))
    }

    #[inline(always)]
    fn load(simd: S, channel: &Channel, at: usize) -> Self {
        Value(lanes(simd, &channel.value, at))
    }

    #[inline(always)]
    fn store(self, channel: &mut Channel, at: usize) {
        put::<S>(self.0, &mut channel.value, at);
    }
}

impl<S: Simd> Stored<S> for Jet<S> {
    #[inline(always)]
    fn point(simd: S, point: &[[f32; BLOCK]; 3], at: usize) -> Vec3<Self> {
        variables(simd, point, at)
    }

    #[inline(always)]
    fn load(simd: S, channel: &Channel, at: usize) -> Self {
        let [x, y, z] = &channel.gradient;
        Jet {
            value: lanes(simd, &channel.value, at),
            gradient: [lanes(simd, x, at), lanes(simd, y, at), lanes(simd, z, at)],
        }
    }

    #[inline(always)]
    fn store(self, channel: &mut Channel, at: usize) {
        put::<S>(self.value, &mut channel.value, at);
        for (lanes, to) in self.gradient.into_iter().zip(&mut channel.gradient) {
            put::<S>(lanes, to, at);
        }
    }
}

/// The appearance of the wall at every site of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSamples {
    /// Distance of the wall with all detail from the site, metres; positive towards the air. First-order estimate.
    pub height_m: [f32; BLOCK],
    /// Unit normal of the wall with all detail, into the air.
    pub normal: [[f32; BLOCK]; 3],
    /// Base colour, linear RGB.
    pub color: [[f32; BLOCK]; 3],
    /// Perceptual roughness.
    pub roughness: [f32; BLOCK],
    /// Ambient occlusion: 0 buried, 1 open.
    pub occlusion: [f32; BLOCK],
}

impl Default for SurfaceSamples {
    fn default() -> Self {
        Self {
            height_m: [0.0; BLOCK],
            normal: [[0.0; BLOCK]; 3],
            color: [[0.0; BLOCK]; 3],
            roughness: [0.0; BLOCK],
            occlusion: [0.0; BLOCK],
        }
    }
}

impl SurfaceSamples {
    /// Writes lanes of one quantity from `at` on.
    #[inline(always)]
    pub fn put<S: Simd>(to: &mut [f32; BLOCK], at: usize, lanes: Lanes<S>) {
        put::<S>(lanes, to, at);
    }
}

/// Sampling resolution of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Distance between neighbouring texels in metres.
    pub texel_m: f32,
}

impl Footprint {
    /// Weight of a layer with this wavelength: 1 from two and a half texels on, 0 below two (Nyquist). Tuned: with a wider
    /// ramp maps lack a quarter of the contrast that texels can show, with a narrower one noise is mostly alias.
    pub fn keep(self, wavelength_m: f32) -> f32 {
        (2.0 * (wavelength_m / self.texel_m - 2.0)).clamp(0.0, 1.0)
    }

    /// Weight of noise whose lattice has this spacing: most of its power is at one and a half times that wavelength.
    pub fn keep_noise(self, spacing_m: f32) -> f32 {
        self.keep(1.5 * spacing_m)
    }

    /// A line where `distance_m` is 0, fading out at `half_width_m`: its full width at half maximum is at least two texels,
    /// and it is fainter by the factor by which it had to be widened.
    #[inline(always)]
    pub fn line<S: Simd, T: Real<S>>(self, distance_m: T, half_width_m: f32) -> T {
        /// Full width at half maximum of a bump, relative to its support.
        const HALF_HEIGHT: f32 = 0.454;
        let drawn_m = half_width_m.max(self.texel_m / HALF_HEIGHT);
        (distance_m * (1.0 / drawn_m)).bump() * (half_width_m / drawn_m)
    }

    /// Noise of wavelength `wavelength_m` and of all shorter ones that texels can show; each octave is `gain` as high as the
    /// one before. `at` is in metres, possibly stretched.
    #[inline(always)]
    pub fn fbm<S: Simd, T: Real<S>>(self, source: Source, layer: u32, at: Vec3<T>, wavelength_m: f32, gain: f32) -> T {
        source.octaves(layer, at.scaled(1.0 / wavelength_m), self.amplitudes(wavelength_m, gain))
    }

    /// Amplitudes of successive octaves, down to [`Footprint::FINEST_M`].
    fn amplitudes(self, wavelength_m: f32, gain: f32) -> [f32; Self::OCTAVES] {
        let (mut wavelength_m, mut amplitude) = (wavelength_m, 1.0);
        std::array::from_fn(|_| {
            let kept = if wavelength_m < Self::FINEST_M { 0.0 } else { amplitude * self.keep_noise(wavelength_m) };
            (wavelength_m, amplitude) = (wavelength_m / LACUNARITY, amplitude * gain);
            kept
        })
    }

    /// Most octaves of [`Footprint::fbm`].
    const OCTAVES: usize = 8;
    /// Finest wavelength of rock, metres.
    const FINEST_M: f32 = 0.004;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::dispatched;

    /// Height of a line at its middle, its half width, and its integral across.
    fn drawn<S: Simd>(simd: S, texel_m: f32, half_width_m: f32) -> [f32; 3] {
        let at = |x: f32| {
            let distance = Value::<S>(Lanes::<S>::splat(simd, x));
            Footprint { texel_m }.line(distance, half_width_m).0[0]
        };
        let across: Vec<f32> = (0..4000).map(|i| i as f32 * 1e-4).collect();
        let reach = across.iter().copied().filter(|x| at(*x) > 0.0).fold(0.0, f32::max);
        [at(0.0), reach, across.iter().map(|x| at(*x) * 2e-4).sum()]
    }

    #[test]
    fn a_line_is_widened_and_keeps_its_weight() {
        let line = |texel_m| dispatched!(simd => drawn(simd, texel_m, 0.02));
        let ([height, reach, weight], [faint, wide, same]) = (line(0.001), line(0.025));
        assert!((height - 1.0).abs() < 1e-3 && (reach - 0.02).abs() < 1e-3);
        assert!(faint < 0.5 && wide > 2.0 * 0.025);
        assert!((same / weight - 1.0).abs() < 0.02, "{same} against {weight}");
    }
}
