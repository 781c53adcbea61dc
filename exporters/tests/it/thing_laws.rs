//! Laws of things for every target.

use crate::ledger::{complete, ledger};
use crate::strewn::Strewn;
use plume_exporters::instances::INSTANCES;
use plume_exporters::package::Memory;
use plume_exporters::{Summary, TargetRow, place};
use serde_json::{Value, json};

fn filled(row: &'static TargetRow, strewn: &Strewn) -> (Memory, Summary) {
    let target = row.build(json!({}), ledger().as_ref()).unwrap();
    let mut memory = Memory::default();
    let summary = place::fill(row.name, &*target, &strewn.scene(), &mut memory).unwrap();
    (memory, summary)
}

#[test]
fn the_same_things_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for movable in [false, true] {
        let strewn = Strewn::new(folder.path(), movable).unwrap();
        for row in complete() {
            assert!(filled(row, &strewn).0.bytes == filled(row, &strewn).0.bytes, "{}", row.name);
        }
    }
}

#[test]
fn cameras_see_things_whether_they_move_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let [fixed, loose] = [false, true].map(|movable| Strewn::new(folder.path(), movable).unwrap());
    for row in complete() {
        let bare = row.build(json!({}), ledger().as_ref()).unwrap();
        let walls = bare.export(&fixed.chamber.scene(), &mut Memory::default()).unwrap().visual_triangles;
        for strewn in [&fixed, &loose] {
            let seen = filled(row, strewn).1.visual_triangles;
            assert_eq!(seen - walls, 12 * strewn.things().len() as u64, "{}", row.name);
        }
    }
}

#[test]
fn things_are_listed_as_movable_where_they_move() {
    let folder = tempfile::tempdir().unwrap();
    for movable in [false, true] {
        let strewn = Strewn::new(folder.path(), movable).unwrap();
        for row in complete() {
            let moves = movable && row.build(json!({}), ledger().as_ref()).unwrap().moves_things();
            let list: Value = serde_json::from_slice(&filled(row, &strewn).0.bytes[INSTANCES]).unwrap();
            let listed: Vec<bool> =
                list["things"].as_array().unwrap().iter().map(|thing| thing["movable"].as_bool().unwrap()).collect();
            assert_eq!(listed, vec![moves; strewn.things().len()], "{}", row.name);
        }
    }
}
