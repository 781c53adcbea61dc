//! OBJ, PLY and STL packages of the sample, read back by third-party crates.

use std::collections::HashMap;
use std::f32::consts::FRAC_1_SQRT_2;
use std::io::{BufReader, Cursor};

use crate::changed;
use crate::sample;
use plume_exporters::format::obj;
use plume_exporters::package::Memory;
use plume_exporters::scene::{Chunk, Chunks, Height, Mesh, Scene, Zone};
use plume_exporters::target;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use serde_json::{Value, json};

use changed::Changed;

fn export(name: &str, settings: Value) -> (Memory, sample::Chamber, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    target(name).unwrap().build(settings, None).unwrap().export(&chamber.scene(), &mut memory).unwrap();
    (memory, chamber, folder)
}

type Read = (Vec<tobj::Model>, Vec<tobj::Material>);

fn read_obj(memory: &Memory, path: &str) -> Read {
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let library = |name: &std::path::Path| {
        let path = [folder, name.to_str().unwrap()].join("/");
        tobj::load_mtl_buf(&mut &memory.bytes[path.trim_start_matches('/')][..])
    };
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let (models, materials) = tobj::load_obj_buf(&mut &memory.bytes[path][..], &options, library).unwrap();
    (models, materials.unwrap_or_default())
}

/// The corners of all triangles in their order.
fn corners(mesh: &Mesh) -> Vec<[f32; 3]> {
    mesh.indices.iter().map(|&vertex| mesh.positions[vertex as usize]).collect()
}

fn corners_of(models: &[tobj::Model]) -> Vec<[f32; 3]> {
    let corner = |mesh: &tobj::Mesh, vertex: usize| [0, 1, 2].map(|axis| mesh.positions[3 * vertex + axis]);
    models.iter().flat_map(|model| model.mesh.indices.iter().map(|&v| corner(&model.mesh, v as usize))).collect()
}

#[test]
fn the_material_of_an_obj_has_its_displacement_and_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let roughness_for_height = |_, mut chunk: Chunk| {
        chunk.material.height = Some(Height { image: chunk.material.roughness.clone(), amplitude_m: 0.25 });
        Ok(chunk)
    };
    let high = Changed { inner: &chamber, change: roughness_for_height };
    let scene = Scene { chunks: &high, ..chamber.scene() };
    let mut memory = Memory::default();
    target("obj").unwrap().build(json!({}), None).unwrap().export(&scene, &mut memory).unwrap();
    for material in read_obj(&memory, "chamber.obj").1 {
        let path = format!("textures/{}_height.png", material.name);
        assert_eq!(material.unknown_param["disp"], format!("-mm -0.25 0.5 {path}"));
        assert!(memory.bytes.contains_key(&path));
    }
}

#[test]
fn an_obj_holds_every_chunk_with_its_material() {
    let (memory, chamber, _folder) = export("obj", json!({}));
    let (models, materials) = read_obj(&memory, "chamber.obj");
    assert_eq!([models.len(), materials.len()], [2, 2]);
    for (index, model) in models.iter().enumerate() {
        let chunk = chamber.load(index).unwrap();
        assert_eq!(model.name, chunk.name);
        assert_eq!(corners_of(std::slice::from_ref(model)), corners(&chunk.visual));
        for (corner, &vertex) in model.mesh.indices.iter().zip(&chunk.visual.indices) {
            let (corner, vertex) = (*corner as usize, vertex as usize);
            for axis in 0..3 {
                let normal = chunk.visual.normals[vertex][axis];
                assert!((model.mesh.normals[3 * corner + axis] - normal).abs() <= 0.6e-4);
            }
            for axis in 0..2 {
                let uv = chunk.visual.uvs[vertex][axis];
                assert!((model.mesh.texcoords[2 * corner + axis] - uv).abs() <= 1e-6);
            }
        }
        let material = &materials[model.mesh.material_id.unwrap()];
        assert_eq!(material.name, chunk.name);
        let keys = ["map_Pr", "norm"].map(|key| material.unknown_param[key].as_str());
        let maps = [material.diffuse_texture.as_deref().unwrap(), keys[0], keys[1]];
        for (map, image) in
            maps.into_iter().zip([&chunk.material.base_color, &chunk.material.roughness, &chunk.material.normal])
        {
            assert!(memory.bytes[map] == std::fs::read(&image.path).unwrap(), "{map}");
        }
        assert_eq!(material.unknown_param["Pm"], "0");
    }
}

#[test]
fn collision_shapes_are_in_a_separate_obj() {
    let (memory, chamber, _folder) = export("obj", json!({}));
    let touched: Vec<_> = (0..2).flat_map(|index| corners(&chamber.load(index).unwrap().collision)).collect();
    assert_eq!(corners_of(&read_obj(&memory, "chamber_collision.obj").0), touched);

    let (memory, chamber, _folder) = export("obj", json!({ "collision": "pieces" }));
    let pieces: Vec<_> = (0..2).flat_map(|index| chamber.pieces(index).unwrap()).collect();
    let (models, _) = read_obj(&memory, "chamber_collision.obj");
    assert_eq!(models.len(), pieces.len());
    let expected: Vec<_> = pieces.iter().flat_map(|piece| corners(&piece.mesh)).collect();
    assert_eq!(corners_of(&models), expected);

    let (memory, ..) = export("obj", json!({ "collision": "none" }));
    assert!(!memory.bytes.contains_key("chamber_collision.obj"));
}

#[test]
fn coarser_levels_are_files_with_the_same_materials() {
    let (memory, chamber, _folder) = export("obj", json!({ "lods": true }));
    let (models, materials) = read_obj(&memory, "chamber_lod1.obj");
    let coarse: Vec<_> = (0..2).flat_map(|index| corners(&chamber.load(index).unwrap().lods[0].mesh)).collect();
    assert_eq!(corners_of(&models), coarse);
    assert!(models.iter().all(|model| materials[model.mesh.material_id.unwrap()].name == model.name));
    assert!(!memory.bytes.contains_key("chamber_lod2.obj"));
}

#[test]
fn a_file_per_chunk_holds_the_same() {
    for name in ["obj", "ply", "stl"] {
        let (whole, chamber, _folder) = export(name, json!({}));
        let (parts, ..) = export(name, json!({ "per_chunk": true }));
        let bytes: usize = (0..2)
            .map(|index| parts.bytes[&format!("chunks/{}.{name}", chamber.load(index).unwrap().name)].len())
            .sum();
        let single = whole.bytes[&format!("chamber.{name}")].len();
        // An additional header, and shorter numbers.
        assert!(bytes.abs_diff(single) < single / 20, "{name}: {bytes} and {single}");
        assert!(!parts.bytes.contains_key(&format!("chamber.{name}")));
    }
    let (memory, chamber, _folder) = export("obj", json!({ "per_chunk": true, "lods": true }));
    for index in 0..2 {
        let chunk = chamber.load(index).unwrap();
        for (ending, mesh) in [("", &chunk.visual), ("_lod1", &chunk.lods[0].mesh), ("_collision", &chunk.collision)] {
            let (models, materials) = read_obj(&memory, &format!("chunks/{}{ending}.obj", chunk.name));
            assert_eq!(corners_of(&models), corners(mesh), "{ending}");
            for material in materials {
                assert!(memory.bytes.contains_key(&format!("chunks/{}", material.diffuse_texture.unwrap())));
            }
        }
    }
}

fn floats<const N: usize>(row: &DefaultElement, names: [&str; N]) -> [f32; N] {
    names.map(|name| match row[name] {
        Property::Float(number) => number,
        ref other => panic!("{name} is {other:?}"),
    })
}

fn bytes<const N: usize>(row: &DefaultElement, names: [&str; N]) -> [u8; N] {
    names.map(|name| match row[name] {
        Property::UChar(number) => number,
        ref other => panic!("{name} is {other:?}"),
    })
}

#[test]
fn a_ply_holds_vertices_with_colours_and_labels() {
    let (memory, chamber, _folder) = export("ply", json!({}));
    let mut source = BufReader::new(&memory.bytes["chamber.ply"][..]);
    let ply = Parser::<DefaultElement>::new().read_ply(&mut source).unwrap();
    let (mut vertices, mut faces, mut before) = (ply.payload["vertex"].iter(), ply.payload["face"].iter(), 0);
    for index in 0..2 {
        let chunk = chamber.load(index).unwrap();
        let image = image::open(&chunk.material.base_color.path).unwrap().into_rgb8();
        for vertex in 0..chunk.visual.positions.len() {
            let row = vertices.next().unwrap();
            assert_eq!(floats(row, ["x", "y", "z"]), chunk.visual.positions[vertex]);
            assert_eq!(floats(row, ["nx", "ny", "nz"]), chunk.visual.normals[vertex]);
            assert_eq!(floats(row, ["s", "t"]), chunk.visual.uvs[vertex]);
            // Each square of the image has one colour, which applies a pixel away from its edge.
            let place = [row["s"].clone(), row["t"].clone()].map(|property| match property {
                Property::Float(number) => number.rem_euclid(1.0) * 64.0,
                _ => unreachable!(),
            });
            if place.iter().all(|pixel| (1.0..15.0).contains(&(pixel % 16.0))) {
                let pixel = image.get_pixel(place[0] as u32, 63 - place[1] as u32);
                assert_eq!(bytes(row, ["red", "green", "blue"]), pixel.0);
            }
        }
        for corners in chunk.visual.indices.chunks_exact(3) {
            let row = faces.next().unwrap();
            let Property::ListInt(found) = &row["vertex_indices"] else { panic!("{row:?}") };
            assert!(found.iter().copied().eq(corners.iter().map(|&corner| (corner + before) as i32)));
            let [a, b, c] = [0, 1, 2].map(|k| nalgebra::Vector3::from(chunk.visual.positions[corners[k] as usize]));
            let up = (b - a).cross(&(c - a)).normalize().z;
            let label = match up {
                up if up.abs() < FRAC_1_SQRT_2 => 2,
                up if up > 0.0 => 1,
                _ => 3,
            };
            assert!(bytes(row, ["label"]) == [label] || (up.abs() - FRAC_1_SQRT_2).abs() < 1e-4, "{up}");
        }
        before += chunk.visual.positions.len() as u32;
    }
    assert!(vertices.next().is_none() && faces.next().is_none());
}

/// The lowest parts of the chamber are floor, the highest are ceiling, and its sides are wall.
#[test]
fn labels_are_floor_wall_and_ceiling() {
    let (memory, ..) = export("ply", json!({}));
    let mut source = BufReader::new(&memory.bytes["chamber.ply"][..]);
    let ply = Parser::<DefaultElement>::new().read_ply(&mut source).unwrap();
    let comments = ply.header.comments.join("\n");
    let number = |zone: Zone| {
        let line = comments.lines().find(|line| line.ends_with(zone.name())).unwrap();
        line.split(' ').rev().nth(1).unwrap().parse::<u8>().unwrap()
    };
    let labels = |wanted: &dyn Fn([f32; 3]) -> bool| {
        let rows = ply.payload["vertex"].iter().filter(|row| wanted(floats(row, ["x", "y", "z"])));
        let mut labels: Vec<u8> = rows.map(|row| bytes(row, ["label"])[0]).collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    };
    assert_eq!(labels(&|[_, _, z]| z < -1.8), [number(Zone::Floor)]);
    assert_eq!(labels(&|[_, _, z]| z > 1.8), [number(Zone::Ceiling)]);
    assert_eq!(labels(&|[_, y, z]| y.abs() > 1.8 && z.abs() < 0.1), [number(Zone::Wall)]);
}

#[test]
fn an_stl_has_the_requested_mesh() {
    for (settings, pick) in [
        (json!({}), (|chunk| chunk.visual) as fn(plume_exporters::scene::Chunk) -> Mesh),
        (json!({ "mesh": "collision" }), |chunk| chunk.collision),
    ] {
        let (memory, chamber, _folder) = export("stl", settings);
        let mut source = Cursor::new(&memory.bytes["chamber.stl"]);
        let solid = stl_io::create_stl_reader(&mut source).unwrap();
        let found: Vec<stl_io::Triangle> = solid.collect::<Result<_, _>>().unwrap();
        let expected: Vec<_> = (0..2).flat_map(|index| corners(&pick(chamber.load(index).unwrap()))).collect();
        let vertices: Vec<[f32; 3]> = found.iter().flat_map(|face| face.vertices.map(|vertex| vertex.0)).collect();
        assert!(vertices == expected);
        for face in &found {
            let [a, b, c] = face.vertices.map(|vertex| nalgebra::Vector3::from(vertex.0));
            let normal = (b - a).cross(&(c - a)).normalize();
            assert!((normal - nalgebra::Vector3::from(face.normal.0)).norm() < 1e-3);
        }
    }
}

#[test]
fn objects_of_one_file_number_their_vertices_consecutively() {
    let triangle =
        Mesh { positions: vec![[0.0; 3], [1.0; 3], [0.0, 1.0, 0.0]], indices: vec![0, 1, 2], ..Mesh::default() };
    let mut text = Vec::new();
    obj::write_pieces(&mut text, "rock", &[&triangle, &triangle]).unwrap();
    let read = tobj::load_obj_buf(&mut &text[..], &tobj::LoadOptions::default(), |_| Ok((Vec::new(), HashMap::new())));
    let (models, _) = read.unwrap();
    assert_eq!([&*models[0].name, &*models[1].name], ["rock_0", "rock_1"]);
    assert_eq!(corners_of(&models), [corners(&triangle), corners(&triangle)].concat());
}
