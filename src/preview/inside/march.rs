//! Ray marching: sphere tracing (Hart 1996) of many rays in batches.
//!
//! The field is not an exact distance. In low wide passages it grows up to twice as fast as the distance, and at the lips of
//! ledges it jumps; so a step is only a fraction of its value, and a step into rock is refined between its ends. Rays of a
//! block stay near each other and share the search for passages.

use super::camera::Ray;
use crate::field::Field;

/// Step length of a thin ray relative to the field's value. Tuned: larger ones leave holes in ledges, smaller ones no fewer.
pub const BRISK: f32 = 0.7;
/// The same for rays from which others start. Tuned: with more, these start behind ledges.
pub const CAREFUL: f32 = 0.35;
/// Maximum number of steps: rays that have not arrived by then graze the wall, and end where they are.
const MOST_STEPS: usize = 72;
/// Refinement iterations between the ends of a step into rock. Tuned: with less, arches seen edge-on show rings.
const REFINEMENTS: usize = 8;
/// A ray that starts in rock goes back to this share of its distance.
const BACK: f32 = 0.8;
/// Minimum distance, metres.
const NEAREST_M: f32 = 0.01;
/// Maximum distance, metres.
pub const FAR_M: f32 = 70.0;

/// How near to rock a ray ends, relative to its length plus a constant, and its step length.
#[derive(Clone, Copy)]
pub struct Approach {
    /// Relative to the distance.
    pub share: f32,
    /// Constant, metres.
    pub least_m: f32,
    /// Step length relative to the field's value.
    pub step: f32,
}

impl Approach {
    fn at(self, t: f32) -> f32 {
        self.least_m + self.share * t
    }
}

/// A ray in progress.
#[derive(Clone, Copy)]
struct Walk {
    ray: usize,
    t: f32,
    /// The previous position, and the field there.
    last: [f32; 2],
}

/// A step that ended in rock: the ends and the fields there.
struct Crossing {
    ray: usize,
    air: [f32; 2],
    rock: [f32; 2],
}

/// The length of each ray, metres; at least [`FAR_M`] if it hits nothing.
pub fn march(field: &dyn Field, rays: &[Ray], approach: Approach) -> Vec<f32> {
    let mut ends: Vec<f32> = rays.iter().map(|ray| ray.start).collect();
    let mut crossings = Vec::new();
    let walk = |(ray, &t): (usize, &f32)| Walk { ray, t, last: [t, 0.0] };
    let mut walks: Vec<Walk> = ends.iter().enumerate().map(walk).collect();
    for _ in 0..MOST_STEPS {
        if walks.is_empty() {
            break;
        }
        let points: Vec<[f32; 3]> = walks.iter().map(|walk| rays[walk.ray].at(walk.t)).collect();
        let mut values = field.distances_at(&points).into_iter();
        walks.retain_mut(|walk| {
            let value = values.next().unwrap_or(0.0);
            if value > 0.0 && walk.last[1] == 0.0 {
                // Its start was not as safe as assumed.
                walk.t *= BACK;
                walk.last[0] = walk.t;
                return walk.t > NEAREST_M;
            }
            ends[walk.ray] = walk.t;
            if value > 0.0 {
                ends[walk.ray] = walk.last[0];
                crossings.push(Crossing { ray: walk.ray, air: walk.last, rock: [walk.t, value] });
                return false;
            }
            if -value < approach.at(walk.t) || walk.t > FAR_M {
                return false;
            }
            walk.last = [walk.t, value];
            walk.t += -value * approach.step;
            true
        });
    }
    refine(field, rays, approach, crossings, &mut ends);
    ends
}

/// Finds the wall between the ends of each crossing by false position.
fn refine(field: &dyn Field, rays: &[Ray], approach: Approach, mut crossings: Vec<Crossing>, ends: &mut [f32]) {
    for round in 0..REFINEMENTS {
        crossings.retain(|crossing| crossing.rock[0] - crossing.air[0] > approach.at(crossing.air[0]));
        if crossings.is_empty() {
            return;
        }
        let guess = |crossing: &Crossing| {
            let ([t0, v0], [t1, v1]) = (crossing.air, crossing.rock);
            // False position may converge slowly; bisection does not.
            if round % 2 == 1 { (t0 + t1) / 2.0 } else { t0 + (t1 - t0) * v0 / (v0 - v1) }
        };
        let guesses: Vec<f32> = crossings.iter().map(guess).collect();
        let points: Vec<[f32; 3]> = crossings.iter().zip(&guesses).map(|(c, &t)| rays[c.ray].at(t)).collect();
        let values = field.distances_at(&points);
        for ((crossing, t), value) in crossings.iter_mut().zip(guesses).zip(values) {
            let side = if value > 0.0 { &mut crossing.rock } else { &mut crossing.air };
            *side = [t, value];
            ends[crossing.ray] = crossing.air[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{CaveField, PassageSettings};
    use crate::material::{Look, MATERIALS, MaterialRow};
    use plume_graph::NoOutside;
    use serde_json::json;

    /// Steps of the slow reference search, metres.
    const SLOW_M: f32 = 0.004;

    /// Where a ray meets rock, found by dense sampling.
    fn slow(field: &CaveField, ray: &Ray) -> f32 {
        let ways: Vec<f32> = (0..6000).map(|step| step as f32 * SLOW_M).collect();
        let points: Vec<[f32; 3]> = ways.iter().map(|&t| ray.at(t)).collect();
        let hit = points.chunks(256).position(|part| field.distances_at(part).iter().any(|&value| value > 0.0));
        let first = hit.expect("a cave is closed") * 256;
        let values = field.distances_at(&points[first..points.len().min(first + 256)]);
        ways[first + values.iter().position(|&value| value > 0.0).expect("it was found")]
    }

    /// How many of 200 rays from the middle of a cave in this rock end more than 2 cm from the reference.
    fn strays(rock: &MaterialRow) -> usize {
        let row = plume_generators::GENERATORS.find("gaussian-perlin").expect("the table has it");
        let generator = (row.read)(json!({"nodes": 20})).expect("settings of its own");
        let graph = generator.generate(3, &NoOutside).expect("a small cave");
        let material = (rock.read)(json!({})).expect("settings of its own");
        let field = CaveField::new(&graph, &PassageSettings::default(), material, Look::default(), 3);
        let from = graph.nodes[5].position.coords.map(|c| c as f32).into();
        let ray = |i: usize| {
            let (turn, rise) = (2.4 * i as f32, (i as f32 / 200.0 - 0.5) * 1.8);
            let level = libm::sqrtf(1.0 - rise * rise);
            Ray { from, along: [level * libm::cosf(turn), level * libm::sinf(turn), rise], start: 0.0 }
        };
        let rays: Vec<Ray> = (0..200).map(ray).collect();
        let ends = march(&field, &rays, Approach { share: 0.001, least_m: 0.001, step: BRISK });
        rays.iter().zip(ends).filter(|(ray, end)| (slow(&field, ray) - end).abs() > 0.02).count()
    }

    #[test]
    fn rays_end_where_rock_begins() {
        let strays: Vec<usize> = MATERIALS.iter().map(strays).collect();
        // Lips of a few millimetres are missed.
        assert!(strays.iter().all(|&count| count <= 10), "{strays:?} of 200 rays end elsewhere");
    }
}
