//! When Unity switches between levels of detail.

use crate::scene::Mesh;

/// Tangent of half the vertical field of view for which levels are chosen: tan 30°, for 60°.
const TAN_HALF_VIEW: f64 = 0.577_350_269_189_625_8;
/// Lines of the image for which they are chosen.
const LINES: f64 = 1080.0;
/// Heights must decrease from level to level.
const LESS: f64 = 0.99;

/// The bounds of what is seen, as in Unity's `LODGroup`.
pub struct Extent {
    /// Its middle, metres, scene frame.
    pub middle: [f64; 3],
    /// Its longest edge, metres.
    pub size: f64,
    /// Half its diagonal, metres.
    radius: f64,
}

impl Extent {
    /// The bounds of the full detail.
    pub fn new(full: &Mesh) -> Self {
        let [low, high] = full.bounds().map(|corner| corner.map(f64::from));
        let edges: [f64; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
        let diagonal = edges.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
        Self {
            middle: std::array::from_fn(|axis| f64::midpoint(low[axis], high[axis])),
            size: edges.into_iter().fold(0.0, f64::max),
            radius: diagonal / 2.0,
        }
    }

    /// The minimum height on the screen at which each level is shown, relative to the screen: `screenRelativeHeight`.
    ///
    /// Unity measures `size / (2 · distance · tan(fov / 2))` from the centre of the group. A level is good enough where its
    /// error is at most a line of the image, even at the nearest point of the box. The last level is always shown. `errors_m`
    /// are those of the coarser levels.
    pub fn heights(&self, errors_m: impl IntoIterator<Item = f32>) -> Vec<f64> {
        let mut heights: Vec<f64> = Vec::new();
        for error_m in errors_m {
            let one_line_at_m = f64::from(error_m) * LINES / (2.0 * TAN_HALF_VIEW);
            let height = self.size / (2.0 * (self.radius + one_line_at_m) * TAN_HALF_VIEW);
            let before = heights.last().copied().unwrap_or(1.0);
            heights.push(height.min(before * LESS));
        }
        heights.push(0.0);
        heights
    }
}
