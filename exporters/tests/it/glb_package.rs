//! The `gltf` crate reads the GLB files back and finds the scene in them.

use crate::levels;
use crate::sample;
use gltf::Semantic;
use nalgebra::Vector3;
use plume_exporters::Target;
use plume_exporters::collision::NamedCollision;
use plume_exporters::frame::{gltf_from_scene, gltf_tangent_from_scene, upper_left_uv};
use plume_exporters::package::Memory;
use plume_exporters::scene::Chunks;
use plume_exporters::targets::glb::{Glb, GlbSettings};

fn export(settings: GlbSettings) -> (Memory, sample::Chamber, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    Glb(settings).export(&chamber.scene(), &mut memory).unwrap();
    (memory, chamber, folder)
}

#[test]
fn a_single_file_has_every_chunk_bit_for_bit() {
    let (memory, chamber, _folder) = export(GlbSettings::default());
    let (document, buffers, images) = gltf::import_slice(&memory.bytes["chamber.glb"]).unwrap();
    assert_eq!(images.len(), 6);
    let meshes: Vec<_> = document.nodes().filter_map(|node| node.mesh()).collect();
    assert_eq!(meshes.len(), chamber.len());
    for (index, mesh) in meshes.iter().enumerate() {
        let chunk = chamber.load(index).unwrap();
        assert_eq!(mesh.name(), Some(chunk.name.as_str()));
        let primitive = mesh.primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        let expected = chunk.visual;
        assert!(reader.read_positions().unwrap().eq(expected.positions.iter().map(|&p| gltf_from_scene(p))));
        assert!(reader.read_normals().unwrap().eq(expected.normals.iter().map(|&n| gltf_from_scene(n))));
        assert!(reader.read_tangents().unwrap().eq(expected.tangents.iter().map(|&t| gltf_tangent_from_scene(t))));
        assert!(reader.read_tex_coords(0).unwrap().into_f32().eq(expected.uvs.iter().map(|&uv| upper_left_uv(uv))));
        assert!(reader.read_indices().unwrap().into_u32().eq(expected.indices.iter().copied()));
    }
}

#[test]
fn images_are_embedded_byte_for_byte() {
    let (memory, chamber, _folder) = export(GlbSettings::default());
    let glb = gltf::Gltf::from_slice(&memory.bytes["chamber.glb"]).unwrap();
    let blob = glb.blob.as_deref().unwrap();
    let material = chamber.load(1).unwrap().material;
    let found = glb.materials().nth(1).unwrap();
    let base_color = found.pbr_metallic_roughness().base_color_texture().unwrap().texture();
    for (texture, image) in [
        (base_color, material.base_color),
        (found.normal_texture().unwrap().texture(), material.normal),
        (found.occlusion_texture().unwrap().texture(), material.orm),
    ] {
        let gltf::image::Source::View { view, mime_type } = texture.source().unwrap().source() else {
            panic!("an image is not embedded")
        };
        assert_eq!(mime_type, "image/png");
        let bytes = &blob[view.offset()..view.offset() + view.length()];
        assert!(bytes == std::fs::read(image.path).unwrap());
    }
}

/// The bitangent that a renderer builds must run up the image: against the v of glTF.
#[test]
fn the_bitangent_runs_up_the_image() {
    let (memory, ..) = export(GlbSettings::default());
    let (document, buffers, _) = gltf::import_slice(&memory.bytes["chamber.glb"]).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    let points: Vec<Vector3<f32>> = reader.read_positions().unwrap().map(Vector3::from).collect();
    let normals: Vec<Vector3<f32>> = reader.read_normals().unwrap().map(Vector3::from).collect();
    let tangents: Vec<[f32; 4]> = reader.read_tangents().unwrap().collect();
    let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).unwrap().into_f32().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    for corners in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| corners[i] as usize);
        let [x, y, z, w] = tangents[a];
        let bitangent = normals[a].cross(&Vector3::new(x, y, z)) * w;
        let ([du1, dv1], [du2, dv2]) = (edge(&uvs, a, b), edge(&uvs, a, c));
        let along_v = ((points[c] - points[a]) * du1 - (points[b] - points[a]) * du2) / (du1 * dv2 - du2 * dv1);
        assert!(bitangent.dot(&along_v) < 0.0);
    }
}

fn edge(uvs: &[[f32; 2]], from: usize, to: usize) -> [f32; 2] {
    [uvs[to][0] - uvs[from][0], uvs[to][1] - uvs[from][1]]
}

#[test]
fn one_file_per_chunk_holds_the_same() {
    let (single, ..) = export(GlbSettings::default());
    let (memory, chamber, _folder) = export(GlbSettings { per_chunk: true, ..GlbSettings::default() });
    let (document, _, _) = gltf::import_slice(&single.bytes["chamber.glb"]).unwrap();
    for (index, node) in document.nodes().filter(|node| node.mesh().is_some()).enumerate() {
        let path = format!("chunks/{}.glb", chamber.load(index).unwrap().name);
        let (alone, _, images) = gltf::import_slice(&memory.bytes[&path]).unwrap();
        let bounds = |mesh: gltf::Mesh| {
            let primitive = mesh.primitives().next().unwrap();
            (primitive.bounding_box(), primitive.get(&Semantic::Positions).unwrap().count())
        };
        assert_eq!(bounds(alone.meshes().next().unwrap()), bounds(node.mesh().unwrap()));
        assert_eq!(images.len(), 3);
    }
    assert_eq!(memory.bytes.len(), 4);
}

#[test]
fn the_recipe_and_the_lights_are_included() {
    let (memory, chamber, _folder) = export(GlbSettings::default());
    let glb = gltf::Gltf::from_slice(&memory.bytes["chamber.glb"]).unwrap();
    let extras = glb.document.as_json().extras.as_ref().unwrap().get();
    let extras: serde_json::Value = serde_json::from_str(extras).unwrap();
    assert_eq!(extras["recipe"], chamber.scene().recipe);
    let lights: Vec<_> = glb.document.lights().unwrap().collect();
    assert_eq!(lights.len(), 2);
    assert_eq!(lights[0].intensity(), 8.0);

    let (dark, ..) = export(GlbSettings { lights: false, ..GlbSettings::default() });
    assert!(gltf::Gltf::from_slice(&dark.bytes["chamber.glb"]).unwrap().lights().is_none());
}

#[test]
fn pieces_read_back_bit_for_bit_and_convex() {
    for per_chunk in [false, true] {
        let settings = GlbSettings { per_chunk, collision: NamedCollision::Pieces, ..GlbSettings::default() };
        let (memory, chamber, _folder) = export(settings);
        let files = memory.bytes.iter().filter(|(path, _)| path.ends_with(".glb"));
        let read = files.map(|(_, bytes)| gltf::import_slice(bytes).unwrap());
        let found: Vec<_> = read.flat_map(|(document, buffers, _)| pieces(&document, &buffers)).collect();
        let expected = (0..chamber.len()).flat_map(|index| chamber.pieces(index).unwrap());
        let expected: Vec<_> = expected
            .map(|piece| (piece.mesh.positions.into_iter().map(gltf_from_scene).collect(), piece.mesh.indices))
            .collect();
        assert!(found == expected);
        assert!(found.iter().all(is_convex));
    }
}

#[test]
fn coarser_levels_are_outside_the_scene_with_their_errors() {
    for per_chunk in [false, true] {
        let (memory, chamber, _folder) = export(GlbSettings { per_chunk, lods: true, ..GlbSettings::default() });
        let files = memory.bytes.iter().filter(|(path, _)| path.ends_with(".glb"));
        let read: Vec<_> = files.map(|(_, bytes)| gltf::import_slice(bytes).unwrap()).collect();
        let found: Vec<levels::Level> = read
            .iter()
            .flat_map(|(document, buffers, _)| {
                levels::of(document, |buffer| Some(buffers[buffer.index()].0.as_slice()))
            })
            .collect();
        levels::check(&found, &chamber);
        assert!(read.iter().all(|(document, ..)| document.images().count() == 3 * document.materials().count()));
    }
}

#[test]
fn without_levels_every_node_is_in_the_scene() {
    let (memory, ..) = export(GlbSettings::default());
    let document = gltf::Gltf::from_slice(&memory.bytes["chamber.glb"]).unwrap();
    assert_eq!(document.nodes().count(), document.default_scene().unwrap().nodes().count());
    assert!(document.extensions_used().all(|name| name == "KHR_lights_punctual"));
}

type Solid = (Vec<[f32; 3]>, Vec<u32>);

fn pieces(document: &gltf::Document, buffers: &[gltf::buffer::Data]) -> Vec<Solid> {
    let meshes = document.meshes().filter(|mesh| mesh.name().unwrap().starts_with("UCX_"));
    let read = |mesh: gltf::Mesh| {
        let primitive = mesh.primitives().next().unwrap();
        assert!(primitive.attributes().count() == 1 && primitive.material().index().is_none());
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        (reader.read_positions().unwrap().collect(), reader.read_indices().unwrap().into_u32().collect())
    };
    meshes.map(read).collect()
}

/// No corner is more than 0.1 mm outside of a face: the corners are rounded.
fn is_convex((points, indices): &Solid) -> bool {
    let points: Vec<Vector3<f32>> = points.iter().copied().map(Vector3::from).collect();
    indices.chunks_exact(3).all(|corners| {
        let [a, b, c] = [0, 1, 2].map(|i| points[corners[i] as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        points.iter().all(|point| (point - a).dot(&normal) < 1e-4)
    })
}
