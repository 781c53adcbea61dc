//! The laws of rimstone.

use super::{Cave, assert_the_corridor_is_free, floor_gap_m};
use crate::common::world::small;
use plume::things::Thing;

#[test]
fn dams_follow_levels_of_the_floor() {
    /// Most distance of the foot of a dam from the floor, in metres: less than its root is deep.
    const MOST_M: f64 = 0.06;
    let row = plume::generators::GENERATORS.default_row();
    let mut cave = Cave::new("rimstone".to_owned(), small(row, 24, 3), "limestone", 16.0);
    let things = cave.things();
    let dams: Vec<&Thing> = things.iter().filter(|thing| thing.kind == "rimstone").collect();
    assert!(dams.len() > 10, "only {} pieces of dams", dams.len());
    assert_the_corridor_is_free(&cave, &things);
    let mut levels: Vec<f64> = dams.iter().map(|dam| dam.pose.translation.z).collect();
    levels.sort_by(f64::total_cmp);
    let steps = levels.windows(2).map(|pair| pair[1] - pair[0]);
    // A pool ends at the next dam, or the water would run over it.
    assert!(steps.clone().all(|step| !(1e-9..0.1).contains(&step)), "levels are too near: {levels:?}");
    for dam in &dams {
        let gap_m = floor_gap_m(&cave, &things, dam);
        assert!(gap_m.abs() < MOST_M, "{gap_m} m between the floor and {dam:?}");
    }
    cave.settings.dripstone = 0.0;
    assert!(!cave.things().iter().any(|thing| thing.kind == "rimstone"));
}
