//! The plane nearest to heights around a place.

/// A plane over the map, around a place.
pub(super) struct Plane {
    /// Its height at the place.
    pub height: f64,
    /// How steeply it rises along either axis.
    pub slopes: [f64; 2],
    /// How far a height is below it and above it at most, in metres.
    pub off_m: [f64; 2],
}

impl Plane {
    /// Through heights on a grid with these steps along either axis, which must be symmetric about 0; `None` if one is missing.
    pub fn through(steps: &[f64], height: impl Fn([f64; 2]) -> Option<f64>) -> Option<Self> {
        let places = steps.iter().flat_map(|u| steps.iter().map(|v| [*u, *v]));
        let heights: Vec<([f64; 2], f64)> = places.map(|at| Some((at, height(at)?))).collect::<Option<_>>()?;
        let mean = heights.iter().map(|(_, z)| z).sum::<f64>() / heights.len() as f64;
        // Since steps are symmetric, each slope is found by itself.
        let slope = |axis: usize| {
            let product: f64 = heights.iter().map(|(at, z)| at[axis] * z).sum();
            product / heights.iter().map(|(at, _)| at[axis] * at[axis]).sum::<f64>()
        };
        let slopes = [slope(0), slope(1)];
        let above = heights.iter().map(|([u, v], z)| z - (mean + slopes[0] * u + slopes[1] * v));
        let off_m = above.fold([0.0_f64; 2], |[low, high], above| [low.max(-above), high.max(above)]);
        Some(Self { height: mean, slopes, off_m })
    }
}
