//! How far is rock: a field over space, negative in air and positive in rock, in metres near the surface.
//!
//! A field knows no grid: whoever samples it chooses the points. Values are functions of the point alone, bit for bit,
//! whatever the batch or the bounds they are asked in.

/// An axis-aligned box in metres, cave frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner.
    pub min: [f32; 3],
    /// Highest corner.
    pub max: [f32; 3],
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
}

/// A wall that can be looked at.
pub trait Surface: Sync {
    /// Looks at `points` (in `bounds`, on or near the wall). `normals` are the unit normals of the mesh there, into the
    /// air; `texel_m` is the distance between neighbouring points, so finer detail than twice that can be left out.
    fn texels(
        &self,
        bounds: Bounds,
        texel_m: f32,
        points: &[[f32; 3]],
        normals: &[[f32; 3]],
        out: &mut [Texel],
    );
}
