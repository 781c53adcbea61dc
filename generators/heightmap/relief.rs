//! The default relief: two families of ridges that cross, each along the lines where a noise changes sign.

use super::{Heightmap, Heights};
use crate::perlin::Perlin;
use plume_graph::rng::Rng;
use plume_graph::seed;

/// Square metres of the plan per metre of ridges, per metre between them (tuned, with a fifth to spare).
const PLAN_PER_LENGTH: f64 = 0.8;
/// Shortest side of the plan, in distances between ridges.
const LEAST_SIDE: f64 = 3.0;
/// Most cells of the plan: enough for a million nodes at the defaults.
const MOST_CELLS: f64 = 1e8;
/// Finest and coarsest cells, in distances between ridges: finer ones only cost time, coarser ones lose ridges.
const FINEST: f64 = 0.02;
const COARSEST: f64 = 0.2;
/// Distances between ridges per unit of the noise.
const RIDGES_PER_UNIT: f64 = 0.7;
/// Approximate maximum of the noise.
const NOISE_REACH: f64 = 0.5;

/// A relief whose ridges are at least `length_m` long.
pub(super) fn ridges(settings: &Heightmap, length_m: f64, seed: u64) -> Heights {
    let mut rng = Rng::new(seed::stream(seed, "heightmap", 0));
    let noises = [Perlin::new(&mut rng), Perlin::new(&mut rng)];
    let spacing_m = settings.ridge_spacing_m;
    let side_m = (length_m * spacing_m * PLAN_PER_LENGTH).sqrt().max(LEAST_SIDE * spacing_m);
    let cell_m =
        settings.metres_per_pixel.clamp(FINEST * spacing_m, COARSEST * spacing_m).max(side_m / MOST_CELLS.sqrt());
    let side = (side_m / cell_m).ceil() as usize;
    let unit = RIDGES_PER_UNIT * cell_m / spacing_m;
    let value = |cell: usize| {
        let [x, y] = [cell % side, cell / side].map(|at| (at as f64 + 0.5) * unit);
        let away = noises.iter().map(|noise| noise.at(x, y).abs()).fold(f64::INFINITY, f64::min);
        (1.0 - (away / NOISE_REACH).min(1.0)) as f32
    };
    Heights { columns: side, values: (0..side * side).map(value).collect(), cell_m, range_m: settings.height_range_m }
}
