//! How far is rock: a field over space, negative in air and positive in rock, in metres near the surface.
//!
//! A field knows no grid: whoever samples it chooses the points. Values are functions of the point alone, bit for bit,
//! whatever the batch or the bounds they are asked in.

mod analytic;
mod cave;
mod index;
mod passage;

pub use analytic::Analytic;
pub use cave::CaveField;
pub use passage::{PassageSettings, Reach};

/// An axis-aligned box in metres, cave frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: [f32; 3],
    /// Highest corner.
    pub max: [f32; 3],
}

impl Bounds {
    /// The smallest box around points, of which there is at least one.
    pub fn around(points: &[[f32; 3]]) -> Self {
        let first = Self { min: points[0], max: points[0] };
        points.iter().fold(first, |all, &point| all.joined(Self { min: point, max: point }))
    }

    /// The smallest box around both.
    pub fn joined(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|i| self.min[i].min(other.min[i])),
            max: std::array::from_fn(|i| self.max[i].max(other.max[i])),
        }
    }

    /// The box with `margin_m` more on every side.
    pub fn grown(self, margin_m: f32) -> Self {
        Self { min: self.min.map(|c| c - margin_m), max: self.max.map(|c| c + margin_m) }
    }

    /// Centre and radius of the smallest ball around it.
    pub fn ball(self) -> ([f32; 3], f32) {
        let half: [f32; 3] = std::array::from_fn(|i| (self.max[i] - self.min[i]) / 2.0);
        let radius = (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt();
        (std::array::from_fn(|i| self.min[i] + half[i]), radius)
    }
}

/// What a box holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Air everywhere.
    Air,
    /// Rock everywhere.
    Rock,
    /// Perhaps both.
    Mixed,
}

/// A scalar field whose zero set is the wall of the cave.
pub trait Field: Sync {
    /// What the box holds; `Air` and `Rock` are promises, `Mixed` is not.
    fn region(&self, bounds: Bounds) -> Region;

    /// The field at `points`, all of which lie in `bounds`; `out` has the same length.
    fn distances(&self, bounds: Bounds, points: &[[f32; 3]], out: &mut [f32]);

    /// Unit normals at `points` (in `bounds`): the direction of steepest descent, from the wall into the air.
    fn normals(&self, bounds: Bounds, points: &[[f32; 3]], out: &mut [[f32; 3]]);
}

/// What a camera sees of the wall at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Base colour, linear RGB in 0–1.
    pub color: [f32; 3],
    /// Unit normal in the cave frame, with all detail, pointing into the air.
    pub normal: [f32; 3],
    /// Perceptual roughness, 0–1.
    pub roughness: f32,
    /// Ambient occlusion, 0 (buried) to 1 (open).
    pub occlusion: f32,
    /// How far from the point the wall lies with all detail but without water, metres; positive towards the air. To first
    /// order: the field over its steepness.
    pub height_m: f32,
}

/// A wall that can be looked at.
pub trait Surface: Sync {
    /// Looks at `points` (in `bounds`, on or near the wall). `normals` are the unit normals of the mesh there, into the
    /// air; `texel_m` is the distance between neighbouring points, so finer detail than twice that can be left out.
    fn texels(&self, bounds: Bounds, texel_m: f32, points: &[[f32; 3]], normals: &[[f32; 3]], out: &mut [Texel]);
}
