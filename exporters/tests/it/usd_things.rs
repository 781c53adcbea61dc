//! What the USD library is told of things: which of them are bodies, and how they move.

use crate::ledger::ledger;
use crate::strewn::Strewn;
use nalgebra::Quaternion;
use plume_exporters::package::Memory;
use plume_exporters::{Target, target};
use serde_json::{Value, json};

fn built(name: &str, settings: Value) -> Box<dyn Target> {
    target(name).unwrap().build(settings, ledger().as_ref()).unwrap()
}

/// The things of the layer that target `usd` writes.
fn told(movable: bool, settings: Value) -> (Vec<Value>, Strewn) {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), movable).unwrap();
    let mut memory = Memory::default();
    built("usd", settings).export(&strewn.scene(), &mut memory).unwrap();
    let layer = &memory.bytes["chunks/things_0_0_0.usdc"];
    let call = b"write_things\n";
    let start = layer.windows(call.len()).position(|window| window == call).unwrap() + call.len();
    let spec: Value = serde_json::Deserializer::from_slice(&layer[start..]).into_iter().next().unwrap().unwrap();
    (spec["things"].as_array().unwrap().clone(), strewn)
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect();
    numbers.try_into().unwrap()
}

#[test]
fn movable_things_are_bodies_of_their_mass_and_inertia() {
    let (told, strewn) = told(true, json!({}));
    assert_eq!(told.len(), strewn.things().len());
    for (told, thing) in told.iter().zip(strewn.things()) {
        let body = &told["body"];
        assert_eq!(body["mass_kg"], thing.mass_kg);
        assert!(numbers::<3>(&body["center"]).iter().all(|offset| offset.abs() < 1e-9));
        let edge_m = 0.2 * thing.scale;
        let expected = thing.mass_kg * edge_m * edge_m / 6.0;
        assert!(numbers::<3>(&body["inertia_kg_m2"]).iter().all(|moment| (moment - expected).abs() < 1e-7), "{body}");
        let [w, x, y, z] = numbers(&body["axes_wxyz"]);
        assert!((Quaternion::new(w, x, y, z).norm() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn nothing_else_is_a_body() {
    for (movable, settings) in [(false, json!({})), (true, json!({ "physics": false }))] {
        let (told, _) = told(movable, settings);
        assert!(told.iter().all(|thing| thing.get("body").is_none()));
    }
}

/// The mesh has the triangles of all chunks, whose layers have no collider; of the things, only those that move have one.
#[test]
fn all_that_does_not_move_can_be_one_mesh() {
    let folder = tempfile::tempdir().unwrap();
    for (movable, scope) in [(false, "Prototypes"), (true, "Bodies")] {
        let strewn = Strewn::new(folder.path(), movable).unwrap();
        let export = |collision: &str| {
            let mut package = Memory::default();
            let target = built("isaac", json!({ "collision": collision }));
            (target.export(&strewn.scene(), &mut package).unwrap(), package)
        };
        let ((apart, _), (merged, package)) = (export("triangles"), export("merged"));
        assert_eq!(merged, apart, "the triangles are the same, whether movable: {movable}");
        let bodies: u64 = if movable { 12 * strewn.things().len() as u64 } else { 0 };
        let said = |path: &str| String::from_utf8_lossy(&package.bytes[path]).into_owned();
        let normals = format!("Collision.normals {}\n", merged.collision_triangles - bodies);
        assert!(said("chunks/collision.usdc").contains(&normals), "not {normals}");
        assert!(said("chamber.usda").contains("./chunks/collision.usdc"));
        assert!(said("chunks/chunk_0_0_0.usdc").contains("\"colliders\": []"));
        assert!(said("chunks/things_0_0_0.usdc").contains(&format!("\"/{scope}/box_0\"")));
    }
}

#[test]
fn bodies_are_told_of_where_there_is_physics() {
    for name in ["isaac", "usd", "usdz"] {
        assert!(built(name, json!({})).moves_things(), "{name}");
    }
    for name in ["usd", "usdz"] {
        assert!(!built(name, json!({ "physics": false })).moves_things(), "{name}");
    }
}
