//! Floor and ceiling straight below and above a point in the air.

use nalgebra::Point3;

use crate::field::{Aabb, Field};

/// Distance between probes, m: finer than any stone that matters to a wheel.
const STEP_M: f32 = 0.05;
/// Search distance, m.
const REACH_M: f32 = 8.0;

/// Height of the floor below `from`, if `from` is in the air and there is a floor within 8 m.
pub fn floor_z(field: &dyn Field, from: Point3<f64>) -> Option<f64> {
    first_rock(field, from, -STEP_M)
}

/// Height of the ceiling above `from`, with the same conditions.
pub fn ceiling_z(field: &dyn Field, from: Point3<f64>) -> Option<f64> {
    first_rock(field, from, STEP_M)
}

fn first_rock(field: &dyn Field, from: Point3<f64>, step_m: f32) -> Option<f64> {
    let [x, y, z] = [from.x as f32, from.y as f32, from.z as f32];
    let count = (REACH_M / STEP_M) as usize;
    let points: Vec<[f32; 3]> = (0..count).map(|i| [x, y, z + i as f32 * step_m]).collect();
    let end = z + count as f32 * step_m;
    let bounds = Aabb { min: [x, y, z.min(end)], max: [x, y, z.max(end)] };
    let mut distances = vec![0.0; count];
    field.distances(bounds, &points, &mut distances);
    if distances[0] >= 0.0 {
        return None;
    }
    let hit = distances.iter().position(|d| *d >= 0.0)?;
    let (before, after) = (distances[hit - 1], distances[hit]);
    let share = before / (before - after);
    Some(f64::from(points[hit - 1][2] + share * step_m))
}
