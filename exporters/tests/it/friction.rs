//! Walls and ceilings have the friction of the scene where `docs/formats.md` says so, and that of the floor elsewhere.

use crate::ledger::ledger;
use crate::sample::Chamber;
use plume_exporters::package::Memory;
use plume_exporters::scene::{ByZone, Scene};
use plume_exporters::target;
use serde_json::json;

/// Targets with physics: whether walls have a friction of their own by default, and with pieces.
const TARGETS: [(&str, [bool; 2]); 8] = [
    ("gazebo", [false, true]),
    ("isaac", [false, true]),
    ("mujoco", [true, true]),
    ("unity", [false, true]),
    ("unreal", [false, false]),
    ("urdf", [false, false]),
    ("usd", [false, true]),
    ("usdz", [false, true]),
];

#[test]
fn walls_have_a_friction_of_their_own_where_we_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let scene = Scene { friction: ByZone { floor: 0.71, wall: 0.123_45, ceiling: 0.234_56 }, ..chamber.scene() };
    for (name, expected) in TARGETS {
        for (settings, expected) in [json!({}), json!({ "collision": "pieces" })].into_iter().zip(expected) {
            let mut package = Memory::default();
            target(name).unwrap().build(settings, ledger().as_ref()).unwrap().export(&scene, &mut package).unwrap();
            for friction in ["0.12345", "0.23456"] {
                let holds = |bytes: &Vec<u8>| bytes.windows(friction.len()).any(|found| found == friction.as_bytes());
                assert_eq!(package.bytes.values().any(holds), expected, "{name} {friction}");
            }
        }
    }
}
