//! The distance between two passages.

use nalgebra::Point3;

/// Distance between two segments by ternary search: slow, and independent of the method of the generators.
pub fn distance(first: [Point3<f64>; 2], second: [Point3<f64>; 2]) -> f64 {
    let at = |t: f64| first[0] + (first[1] - first[0]) * t;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        if to_segment(at(low + third), second) < to_segment(at(high - third), second) {
            high -= third;
        } else {
            low += third;
        }
    }
    to_segment(at(0.5 * (low + high)), second)
}

fn to_segment(point: Point3<f64>, [a, b]: [Point3<f64>; 2]) -> f64 {
    let along = b - a;
    let t = ((point - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (point - (a + along * t)).norm()
}
