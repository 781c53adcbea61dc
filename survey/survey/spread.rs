//! Interpolates measurements along the passages to stations without them.
//!
//! Ordinary kriging (Matheron 1963) from the two nearest stations with a value, by distance along the passages and not
//! through rock, with an exponential variogram that reaches 95 % of its sill at [`RANGE_M`]: the model of Gouy et al. 2024
//! ("KarstNSim") for the sizes of conduits, after Frantz et al. 2021. Between two stations near each other it is nearly
//! linear; far from both it tends to their mean. The nugget is omitted: a measured station keeps its values.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::Point3;

use plume_graph::Rows;

/// Range of the variogram in metres, from KarstNSim.
const RANGE_M: f64 = 50.0;

/// The passages at each station: where they lead, and how far, in micrometres.
pub(super) struct Ways(Rows<(usize, u64)>);

impl Ways {
    pub(super) fn new(places: &[Point3<f64>], lines: &[[usize; 2]]) -> Self {
        let both_ways = lines.iter().flat_map(|&[a, b]| {
            let length_um = ((places[a] - places[b]).norm() * 1e6) as u64;
            [(a, (b, length_um)), (b, (a, length_um))]
        });
        Self(Rows::from_pairs(places.len(), both_ways))
    }
}

/// Fills in missing values. Stations not connected to a value stay without one.
pub(super) fn spread(ways: &Ways, values: &[Option<f64>]) -> Vec<Option<f64>> {
    let nearest = nearest(ways, values);
    let value = |found: &Found| values[found.station].unwrap_or_default();
    let at = |station: usize| match &nearest[station] {
        _ if values[station].is_some() => values[station],
        [None, _] => None,
        [Some(one), None] => Some(value(one)),
        [Some(one), Some(two)] => {
            let share = share(one.away_um as f64 * 1e-6, two.away_um as f64 * 1e-6);
            Some(value(two) + (value(one) - value(two)) * share)
        }
    };
    (0..values.len()).map(at).collect()
}

/// The weight of the nearer of two values at these distances, in opposite directions; the other has the rest.
fn share(near_m: f64, far_m: f64) -> f64 {
    let like = |distance_m: f64| libm::exp(-3.0 * distance_m / RANGE_M);
    let apart = 2.0 * (1.0 - like(near_m + far_m));
    if apart > 0.0 { 0.5 + (like(near_m) - like(far_m)) / apart } else { 0.5 }
}

/// A station with a value, as seen from another.
#[derive(Clone, Copy)]
struct Found {
    station: usize,
    away_um: u64,
}

/// The two nearest stations with a value (Dijkstra 1959, two labels per station). No search continues beyond a station with
/// a value, because that screens what is behind it.
fn nearest(ways: &Ways, values: &[Option<f64>]) -> Vec<[Option<Found>; 2]> {
    let mut nearest = vec![[None; 2]; values.len()];
    let seeds = (0..values.len()).filter(|&station| values[station].is_some());
    let mut ahead: BinaryHeap<Reverse<(u64, usize, usize)>> =
        seeds.map(|station| Reverse((0, station, station))).collect();
    while let Some(Reverse((away_um, at, seed))) = ahead.pop() {
        let found: &mut [Option<Found>; 2] = &mut nearest[at];
        let known = found.iter().flatten().any(|other| other.station == seed);
        let Some(free) = found.iter_mut().find(|slot| slot.is_none()).filter(|_| !known) else { continue };
        *free = Some(Found { station: seed, away_um });
        for &(next, length_um) in &ways.0[at] {
            if values[next].is_none() {
                ahead.push(Reverse((away_um.saturating_add(length_um), next, seed)));
            }
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(places_m: &[f64], values: &[Option<f64>]) -> Vec<Option<f64>> {
        let places: Vec<Point3<f64>> = places_m.iter().map(|&x| Point3::new(x, 0.0, 0.0)).collect();
        let lines: Vec<[usize; 2]> = (1..places.len()).map(|end| [end - 1, end]).collect();
        spread(&Ways::new(&places, &lines), values)
    }

    #[test]
    fn near_values_blend_linearly_and_far_ones_tend_to_the_mean() {
        let near = along(&[0.0, 1.0, 2.0, 3.0, 4.0], &[Some(1.0), None, None, None, Some(3.0)]);
        for (value, expected) in near.iter().zip([1.0, 1.5, 2.0, 2.5, 3.0]) {
            assert!((value.expect("filled") - expected).abs() < 0.01, "{near:?}");
        }
        let far = along(&[0.0, 150.0, 300.0, 500.0], &[Some(1.0), None, Some(3.0), None]);
        assert_eq!(far, [Some(1.0), Some(2.0), Some(3.0), Some(3.0)]);
    }

    #[test]
    fn a_measured_station_screens_what_lies_behind_it_and_parts_do_not_mix() {
        let values = along(&[0.0, 1.0, 2.0, 3.0], &[Some(9.0), Some(1.0), None, None]);
        assert_eq!(values, [Some(9.0), Some(1.0), Some(1.0), Some(1.0)]);
        let places = [0.0, 1.0, 2.0, 3.0].map(|x| Point3::new(x, 0.0, 0.0));
        let apart = Ways::new(&places, &[[0, 1], [2, 3]]);
        assert_eq!(spread(&apart, &[Some(2.0), None, None, None]), [Some(2.0), Some(2.0), None, None]);
    }
}
