//! Gravel is small and lies on the floor. Nothing collides with it, so it may lie on the way.

use super::{Cave, gap, near};
use nalgebra::Point3;
use plume::things::{Thing, strew};

/// Widths of gravel in metres, which come in steps.
const WIDTHS_M: [f64; 2] = [0.018, 0.055];

/// All gravel of a cave, chunk by chunk.
fn gravel(cave: &Cave) -> Vec<Thing> {
    let all = || cave.walls.iter().map(|(_, wall)| wall);
    cave.walls.iter().flat_map(|(bounds, _)| strew(&cave.setting(), *bounds, all())).collect()
}

pub(super) fn assert_it_lies(cave: &Cave) {
    let stones = gravel(cave);
    assert!(stones.len() > 10, "{}: {} stones of gravel", cave.name, stones.len());
    for stone in &stones {
        let width_m = cave.prototype(stone).width_m() * stone.scale;
        assert!((WIDTHS_M[0]..WIDTHS_M[1]).contains(&width_m), "{}: {width_m} m wide", cave.name);
        assert!(stone.is_gravel() && stone.kind == "gravel", "{}: {stone:?}", cave.name);
    }
    // Going through every triangle takes long.
    for stone in stones.iter().step_by(stones.len() / 16 + 1) {
        let floor = near(cave, &[], stone, WIDTHS_M[1]);
        let over = |at: Point3<f64>| gap(&floor, at, 0.1);
        let middle = over(stone.pose.translation.vector.into()).expect("gravel is over a floor");
        let heights: Vec<f64> = cave.hull(stone).into_iter().filter_map(over).collect();
        let [low, high] = [f64::min, f64::max].map(|pick| heights.iter().copied().reduce(pick).unwrap());
        assert!(0.0 < middle && middle < WIDTHS_M[1], "{}: its middle is {middle} m over the floor", cave.name);
        assert!(-0.02 < low && low < 0.001 && high > middle, "{}: from {low} m to {high} m", cave.name);
    }
}

#[test]
fn its_amount_is_that_of_the_setting() {
    let graph = super::small(plume::generators::GENERATORS.default_row(), 4, 3);
    let mut cave = Cave::new("strewn".to_owned(), graph, "limestone", 16.0);
    let counts = [0.0, 0.5, 1.0].map(|amount| {
        cave.settings.gravel = amount;
        gravel(&cave).len()
    });
    assert!(counts[0] == 0 && counts[1] > 10 && counts[2] > 3 * counts[1] / 2, "{counts:?}");
    cave.settings.cover = 0.0;
    assert!(gravel(&cave).is_empty());
}
