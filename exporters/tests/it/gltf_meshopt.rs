//! meshoptimizer decompresses the compressed documents to the plain ones.

#![cfg(feature = "meshopt")]

use crate::sample;
use plume_exporters::package::Memory;
use plume_exporters::target;
use serde_json::{Value, json};

fn export(compression: &str) -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    let settings = json!({ "compression": compression, "lods": true });
    target("glb").unwrap().build(settings, None).unwrap().export(&chamber.scene(), &mut memory).unwrap();
    memory
}

/// JSON and payload of a GLB.
fn parts(memory: &Memory) -> (Value, &[u8]) {
    let bytes = &memory.bytes["chamber.glb"];
    let json_bytes = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..20 + json_bytes]).unwrap(), &bytes[28 + json_bytes..])
}

fn range<'a>(payload: &'a [u8], place: &Value) -> &'a [u8] {
    let number = |key: &str| place[key].as_u64().unwrap_or_default() as usize;
    &payload[number("byteOffset")..][..number("byteLength")]
}

fn unpacked<const STRIDE: usize>(packed: &[u8], count: usize) -> Vec<u8>
where
    [u8; STRIDE]: Default,
{
    assert_eq!(meshopt::decode_vertex_version(packed), Some(0), "the extension knows no other");
    meshopt::decode_vertex_buffer::<[u8; STRIDE]>(packed, count).unwrap().concat()
}

/// The triangles of two-byte indices, each rotated so that it begins with its lowest corner.
fn triangles(indices: &[u16]) -> Vec<[u16; 3]> {
    let turned = |triangle: &[u16]| {
        let first = (0..3).min_by_key(|&corner| triangle[corner]).unwrap();
        [0, 1, 2].map(|corner| triangle[(first + corner) % 3])
    };
    indices.chunks_exact(3).map(turned).collect()
}

#[test]
fn compression_is_lossless() {
    let (plain, packed) = (export("none"), export("meshopt"));
    let ((plain_json, plain), (json, payload)) = (parts(&plain), parts(&packed));
    let (plain_views, views) = (&plain_json["bufferViews"], &json["bufferViews"]);
    assert_eq!(plain_json["accessors"], json["accessors"]);
    let mut kinds = [0, 0, 0];
    for (view, plain_view) in views.as_array().unwrap().iter().zip(plain_views.as_array().unwrap()) {
        assert_eq!(view["byteLength"], plain_view["byteLength"]);
        let expected = range(plain, plain_view);
        let extension = &view["extensions"]["EXT_meshopt_compression"];
        let (from, count) = (|| range(payload, extension), extension["count"].as_u64().unwrap_or_default() as usize);
        match (extension["mode"].as_str(), extension["byteStride"].as_u64()) {
            (Some("ATTRIBUTES"), Some(12)) => assert!(unpacked::<12>(from(), count) == expected),
            (Some("ATTRIBUTES"), Some(16)) => assert!(unpacked::<16>(from(), count) == expected),
            (Some("ATTRIBUTES"), Some(8)) => assert!(unpacked::<8>(from(), count) == expected),
            (Some("TRIANGLES"), Some(2)) => {
                let found: Vec<u16> = meshopt::decode_index_buffer(from(), count).unwrap();
                let expected: Vec<u16> = expected.as_chunks().0.iter().map(|&pair| u16::from_le_bytes(pair)).collect();
                assert_eq!(triangles(&found), triangles(&expected));
            }
            (None, None) => assert!(range(payload, view) == expected, "an image"),
            other => panic!("{other:?}"),
        }
        kinds[extension["mode"].as_str().map_or(0, |mode| 1 + usize::from(mode == "TRIANGLES"))] += 1;
    }
    assert_eq!(kinds, [6, 16, 4]);
}

#[test]
fn the_extension_is_required() {
    let packed = export("meshopt");
    let (json, payload) = parts(&packed);
    assert_eq!(json["extensionsRequired"], json!(["EXT_meshopt_compression"]));
    let buffers = json["buffers"].as_array().unwrap();
    assert_eq!(buffers[0]["byteLength"], payload.len());
    assert_eq!(buffers[1]["extensions"]["EXT_meshopt_compression"], json!({ "fallback": true }));
    assert!(buffers[1].get("uri").is_none() && buffers.len() == 2);
}
