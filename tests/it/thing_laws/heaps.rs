//! The laws of heaps.

use super::{Cave, assert_the_corridor_is_free};
use crate::common::world::small;
use plume::things::{KINDS, Place, Thing};

fn is_heap(thing: &Thing) -> bool {
    matches!(KINDS.find(&thing.kind).unwrap().place, Place::Heaped(_))
}

/// The foot of every heap is in the rock, and stones lie on some.
#[test]
fn heaps_stand_in_the_floor_and_carry_stones() {
    for (generator, rock) in [("gaussian-perlin", "limestone"), ("worms", "basalt"), ("mine", "drilled")] {
        let row = plume::generators::GENERATORS.find(generator).unwrap();
        let cave = Cave::new(format!("{generator} in {rock}"), small(row, 30, 2), rock, 16.0);
        let things = cave.things();
        let heaps: Vec<&Thing> = things.iter().filter(|thing| is_heap(thing)).collect();
        assert!(heaps.len() > 2, "{}: {} heaps", cave.name, heaps.len());
        let carried = heaps.iter().filter(|heap| {
            let reach_m = 0.6 * cave.prototype(heap).reach_m * heap.scale;
            let is_on = |thing: &&Thing| {
                let from = thing.pose.translation.vector - heap.pose.translation.vector;
                cave.is_loose(thing) && from.xy().norm() < reach_m && (0.1..1.5).contains(&from.z)
            };
            things.iter().any(|thing| is_on(&thing))
        });
        assert!(carried.count() > 0, "{}: no stones on {} heaps", cave.name, heaps.len());
        for heap in &heaps {
            let hull = cave.hull(heap);
            let low = hull.iter().map(|at| at.z).fold(f64::MAX, f64::min);
            let foot: Vec<[f32; 3]> =
                hull.iter().filter(|at| at.z < low + 0.03).map(|at| at.coords.map(|c| c as f32).into()).collect();
            let depths = cave.field.scattered(&foot);
            assert!(depths.iter().all(|depth| *depth > -0.04), "{}: {heap:?} hangs over: {depths:?}", cave.name);
        }
        let heaps: Vec<Thing> = heaps.into_iter().cloned().collect();
        assert_the_corridor_is_free(&cave, &heaps);
    }
}
