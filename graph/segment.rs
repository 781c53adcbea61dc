//! Distances between line segments.

use nalgebra::{Point3, Vector3};

/// Distance between two segments.
pub fn segment_distance(first: [&Point3<f64>; 2], second: [&Point3<f64>; 2]) -> f64 {
    let between = first[0] - second[0];
    let [s, t] = nearest_shares(first, second);
    (between + (first[1] - first[0]) * s - (second[1] - second[0]) * t).norm()
}

/// Where two segments are nearest to each other, as a parameter from 0 to 1 on each (Ericson, Real-Time Collision
/// Detection, 2005, §5.1.9).
pub fn nearest_shares(first: [&Point3<f64>; 2], second: [&Point3<f64>; 2]) -> [f64; 2] {
    const SHORT: f64 = 1e-12;
    let along: Vector3<f64> = first[1] - first[0];
    let other: Vector3<f64> = second[1] - second[0];
    let between = first[0] - second[0];
    let (a, e) = (along.norm_squared(), other.norm_squared());
    let (b, c, f) = (along.dot(&other), along.dot(&between), other.dot(&between));
    let on_first = |s: f64| {
        if a > SHORT { (s / a).clamp(0.0, 1.0) } else { 0.0 }
    };
    let slant = a * e - b * b;
    let mut s = if slant > SHORT { ((b * f - c * e) / slant).clamp(0.0, 1.0) } else { 0.0 };
    let mut t = if e > SHORT { (b * s + f) / e } else { 0.0 };
    if t < 0.0 {
        (s, t) = (on_first(-c), 0.0);
    } else if t > 1.0 {
        (s, t) = (on_first(b - c), 1.0);
    } else if e <= SHORT {
        s = on_first(-c);
    }
    [s, t]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(first: [Point3<f64>; 2], second: [Point3<f64>; 2]) -> f64 {
        segment_distance(first.each_ref(), second.each_ref())
    }

    #[test]
    fn distances_of_segments() {
        let point = Point3::new;
        let x = [Point3::origin(), point(2.0, 0.0, 0.0)];
        let beside = [point(1.0, 2.0, 0.0); 2];
        assert_eq!(distance(x, [point(1.0, -1.0, 3.0), point(1.0, 1.0, 3.0)]), 3.0);
        assert_eq!(distance(x, [point(5.0, 4.0, 0.0), point(5.0, 9.0, 0.0)]), 5.0);
        assert_eq!(distance(x, [point(1.0, 2.0, 0.0), point(3.0, 2.0, 0.0)]), 2.0);
        assert_eq!((distance(x, beside), distance(beside, x)), (2.0, 2.0));
        assert_eq!(distance([Point3::origin(); 2], [point(3.0, 4.0, 0.0); 2]), 5.0);
    }
}
