//! With EXT_mesh_gpu_instancing, things are where they are without it.

use crate::strewn::Strewn;
use nalgebra::{Matrix4, Point3, Quaternion, UnitQuaternion};
use plume_exporters::frame::gltf_from_scene;
use plume_exporters::package::Memory;
use plume_exporters::target;
use serde_json::{Value, json};

const EXTENSION: &str = "EXT_mesh_gpu_instancing";

fn export(settings: Value) -> (Memory, Strewn, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), false).unwrap();
    let mut memory = Memory::default();
    target("glb").unwrap().build(settings, None).unwrap().export(&strewn.scene(), &mut memory).unwrap();
    (memory, strewn, folder)
}

/// JSON and payload of a GLB.
fn parts(bytes: &[u8]) -> (Value, &[u8]) {
    let json_bytes = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..20 + json_bytes]).unwrap(), &bytes[28 + json_bytes..])
}

/// The rows of an accessor of floats.
fn rows(json: &Value, payload: &[u8], accessor: &Value, width: usize) -> Vec<Vec<f32>> {
    let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
    assert_eq!(accessor["type"], ["", "SCALAR", "", "VEC3", "VEC4"][width]);
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let number = |key: &str| view[key].as_u64().unwrap_or_default() as usize;
    let bytes = &payload[number("byteOffset")..][..number("byteLength")];
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|&four| f32::from_le_bytes(four)).collect();
    let rows: Vec<Vec<f32>> = numbers.chunks(width).map(<[f32]>::to_vec).collect();
    assert_eq!(rows.len() as u64, accessor["count"].as_u64().unwrap());
    rows
}

/// Nodes with instances.
fn instanced(json: &Value) -> Vec<&Value> {
    let nodes = json["nodes"].as_array().unwrap();
    nodes.iter().filter(|node| node["extensions"].get(EXTENSION).is_some()).collect()
}

#[test]
fn every_thing_is_an_instance_at_its_place() {
    for path in ["chamber.glb", "chunks/things_0_0_0.glb"] {
        let per_chunk = path != "chamber.glb";
        let (memory, strewn, _folder) = export(json!({ "instancing": true, "per_chunk": per_chunk }));
        let (json, payload) = parts(&memory.bytes[path]);
        assert_eq!(json["extensionsRequired"], json!([EXTENSION]));
        let [node] = instanced(&json)[..] else { panic!("one prototype at one level is one node") };
        assert_eq!(json["meshes"][node["mesh"].as_u64().unwrap() as usize]["name"], "box_0_level0");
        assert!(node.get("translation").is_none() && node.get("children").is_none());
        let attributes = &node["extensions"][EXTENSION]["attributes"];
        let read = |key: &str, width| rows(&json, payload, &attributes[key], width);
        let (moves, turns, scales, numbers) =
            (read("TRANSLATION", 3), read("ROTATION", 4), read("SCALE", 3), read("_ID", 1));
        assert_eq!(numbers, [[0.0], [1.0], [2.0]]);
        let things = strewn.things();
        assert_eq!(moves.len(), things.len());
        let corner = Point3::new(0.1, -0.05, 0.02);
        for (row, thing) in things.iter().enumerate() {
            let [x, y, z, w] = turns[row][..] else { unreachable!() };
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_homogeneous();
            let [dx, dy, dz] = moves[row][..] else { unreachable!() };
            let scale = Matrix4::new_scaling(scales[row][0]);
            let matrix = Matrix4::new_translation(&[dx, dy, dz].into()) * turn * scale;
            let found = matrix.transform_point(&Point3::from(gltf_from_scene(corner.into()).map(|c: f64| c as f32)));
            let expected: Point3<f64> = thing.pose * (corner * thing.scale);
            let expected = Point3::from(gltf_from_scene(expected.into()).map(|c: f64| c as f32));
            assert!((found - expected).norm() < 1e-5, "{found} is not {expected}");
        }
    }
}

#[test]
fn hulls_are_instances_beside_what_is_seen() {
    let (memory, ..) = export(json!({ "instancing": true, "collision": "pieces" }));
    let (json, _) = parts(&memory.bytes["chamber.glb"]);
    let names: Vec<&str> = instanced(&json).iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["UCX_box_0_00_things_0_0_0", "box_0_level0_things_0_0_0"]);
}

#[test]
fn by_default_every_thing_is_a_node() {
    let (memory, strewn, _folder) = export(json!({}));
    let (json, _) = parts(&memory.bytes["chamber.glb"]);
    assert!(instanced(&json).is_empty() && json.get("extensionsRequired").is_none());
    let nodes = json["nodes"].as_array().unwrap();
    let boxes = nodes.iter().filter(|node| node["name"].as_str().unwrap().starts_with("box_"));
    assert_eq!(boxes.count(), strewn.things().len());
}
