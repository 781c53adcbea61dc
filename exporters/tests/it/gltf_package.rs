//! The `gltf` crate resolves every reference of the documents and finds the scene.

use std::collections::BTreeSet;

use crate::levels;
use crate::sample;
use gltf::buffer::Source;
use plume_exporters::Target;
use plume_exporters::frame::{gltf_from_scene, gltf_tangent_from_scene, upper_left_uv};
use plume_exporters::package::Memory;
use plume_exporters::scene::Chunks;
use plume_exporters::targets::gltf::{Gltf, GltfSettings};

fn export(settings: GltfSettings) -> (Memory, sample::Chamber, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    Gltf(settings).export(&chamber.scene(), &mut memory).unwrap();
    (memory, chamber, folder)
}

fn data<'a>(memory: &'a Memory, buffer: &gltf::Buffer) -> Option<&'a [u8]> {
    match buffer.source() {
        Source::Uri(uri) => memory.bytes.get(uri).map(Vec::as_slice),
        Source::Bin => None,
    }
}

/// Files that a document names.
fn named(document: &gltf::Document) -> BTreeSet<&str> {
    let buffers = document.buffers().map(|buffer| match buffer.source() {
        Source::Uri(uri) => uri,
        Source::Bin => panic!("a buffer is embedded"),
    });
    let images = document.images().map(|image| match image.source() {
        gltf::image::Source::Uri { uri, .. } => uri,
        gltf::image::Source::View { .. } => panic!("an image is embedded"),
    });
    buffers.chain(images).collect()
}

#[test]
fn full_detail_reads_back_bit_for_bit_from_a_buffer_per_chunk() {
    let (memory, chamber, _folder) = export(GltfSettings::default());
    let document = gltf::Gltf::from_slice(&memory.bytes["chamber.gltf"]).unwrap();
    assert_eq!(document.buffers().count(), chamber.len());
    for (index, mesh) in document.meshes().enumerate() {
        let chunk = chamber.load(index).unwrap();
        assert_eq!(mesh.name(), Some(chunk.name.as_str()));
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| {
            assert_eq!(buffer.index(), index);
            data(&memory, &buffer)
        });
        let expected = chunk.visual;
        assert!(reader.read_positions().unwrap().eq(expected.positions.iter().map(|&p| gltf_from_scene(p))));
        assert!(reader.read_normals().unwrap().eq(expected.normals.iter().map(|&n| gltf_from_scene(n))));
        assert!(reader.read_tangents().unwrap().eq(expected.tangents.iter().map(|&t| gltf_tangent_from_scene(t))));
        assert!(reader.read_tex_coords(0).unwrap().into_f32().eq(expected.uvs.iter().map(|&uv| upper_left_uv(uv))));
        assert!(reader.read_indices().unwrap().into_u32().eq(expected.indices.iter().copied()));
    }
}

#[test]
fn coarser_levels_are_in_a_separate_document() {
    let (memory, chamber, _folder) = export(GltfSettings::default());
    let document = gltf::Gltf::from_slice(&memory.bytes["chamber_lods.gltf"]).unwrap();
    levels::check(&levels::of(&document, |buffer| data(&memory, &buffer)), &chamber);
    let index: serde_json::Value = serde_json::from_slice(&memory.bytes["scene.json"]).unwrap();
    for chunk in 0..chamber.len() {
        let lods = chamber.load(chunk).unwrap().lods;
        let told = index["chunks"][chunk]["lods"].as_array().unwrap();
        assert_eq!(told.len(), lods.len());
        for (level, lod) in told.iter().zip(&lods) {
            assert_eq!(level["triangles"].as_u64(), Some(lod.mesh.triangles()));
            assert!((level["error_m"].as_f64().unwrap() - f64::from(lod.error_m)).abs() < 1e-6);
        }
    }
}

#[test]
fn every_reference_resolves_and_every_file_is_referenced() {
    for lods in [true, false] {
        let (memory, ..) = export(GltfSettings { lods, ..GltfSettings::default() });
        let documents = memory.bytes.iter().filter(|(path, _)| path.ends_with(".gltf"));
        let documents: Vec<_> = documents.map(|(_, bytes)| gltf::Gltf::from_slice(bytes).unwrap()).collect();
        assert_eq!(documents.len(), 1 + usize::from(lods));
        let named: BTreeSet<&str> = documents.iter().flat_map(|document| named(document)).collect();
        let files: BTreeSet<&str> = memory.bytes.keys().map(String::as_str).filter(|path| path.contains('/')).collect();
        assert_eq!(named, files);
        let full = gltf::Gltf::from_slice(&memory.bytes["chamber.gltf"]).unwrap();
        assert_eq!(full.nodes().count(), full.default_scene().unwrap().nodes().count());
    }
}

#[test]
fn images_are_copied_byte_for_byte() {
    let (memory, chamber, _folder) = export(GltfSettings::default());
    let material = chamber.load(1).unwrap().material;
    for (role, image) in [("base_color", material.base_color), ("normal", material.normal), ("orm", material.orm)] {
        let bytes = &memory.bytes[&format!("textures/chunk_1_0_0_{role}.png")];
        assert!(*bytes == std::fs::read(image.path).unwrap());
    }
}
