//! The laws of model files: every file gives a thing or an error, in either format.

use std::fs;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::common::damage::damaged;
use insta::assert_snapshot;
use plume::field::Aabb;
use plume::model::{Format, Model, ModelError};
use plume::picture::Wrap;
use plume::things::Replica;
use serde_json::{Value, json};

/// A quad of a box of 0.2 x 0.3 x 0.4 m, y up, with its normal.
type Side = ([[f32; 3]; 4], [f32; 3]);

fn sides() -> [Side; 6] {
    const HALF: [f32; 3] = [0.1, 0.15, 0.2];
    std::array::from_fn(|n| {
        let (axis, way) = (n / 2, if n % 2 == 0 { 1.0 } else { -1.0 });
        let (u, v) = if way > 0.0 { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
        let corner = |a: f32, b: f32| {
            let mut at = HALF;
            (at[axis], at[u], at[v]) = (way * HALF[axis], a * HALF[u], b * HALF[v]);
            at
        };
        let mut normal = [0.0; 3];
        normal[axis] = way;
        ([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], normal)
    })
}

/// An image with two columns, red and green.
fn image() -> Vec<u8> {
    let mut png = Cursor::new(Vec::new());
    let pixels = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [255, 0, 0] } else { [0, 255, 0] }));
    pixels.write_to(&mut png, image::ImageFormat::Png).unwrap();
    png.into_inner()
}

/// The box as GLB, in a node that is moved and mirrored, with a document changed by this.
fn glb(change: impl Fn(&mut Value)) -> Vec<u8> {
    let (mut bin, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    let mut view = |bytes: &[u8]| {
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        bin.extend_from_slice(bytes);
        bin.resize(bin.len().next_multiple_of(4), 0);
        views.len() - 1
    };
    let mut vectors = |rows: Vec<Vec<f32>>, kind: &str| {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let bound = |of: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..rows[0].len()).map(|n| rows.iter().map(|row| row[n]).reduce(of).unwrap()).collect()
        };
        accessors.push(json!({
            "bufferView": view(&bytes), "componentType": 5126, "count": rows.len(), "type": kind,
            "min": bound(f32::min), "max": bound(f32::max),
        }));
    };
    let corners = || sides().into_iter().flat_map(|(corners, _)| corners);
    vectors(corners().map(Vec::from).collect(), "VEC3");
    vectors(sides().iter().flat_map(|(_, normal)| std::iter::repeat_n(normal.to_vec(), 4)).collect(), "VEC3");
    vectors([[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]].repeat(6).into_iter().map(Vec::from).collect(), "VEC2");
    let indices: Vec<u8> =
        (0..6_u16).flat_map(|side| [0, 1, 2, 0, 2, 3].map(|n| 4 * side + n)).flat_map(u16::to_le_bytes).collect();
    accessors.push(json!({"bufferView": view(&indices), "componentType": 5123, "count": 36, "type": "SCALAR"}));
    let picture = view(&image());
    let primitive = json!({"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0});
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [3.0, 2.0, 1.0], "scale": [-1.0, 1.0, 1.0]}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [{"pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "roughnessFactor": 0.25, "baseColorTexture": {"index": 0},
        }}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071}],
        "images": [{"bufferView": picture, "mimeType": "image/png"}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}],
    });
    change(&mut document);
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = [&b"glTF\x02\0\0\0"[..], &((28 + text.len() + bin.len()) as u32).to_le_bytes()].concat();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        file.extend([&(chunk.len() as u32).to_le_bytes()[..], kind, chunk].concat());
    }
    file
}

/// The box as OBJ.
fn obj() -> String {
    let mut text = "mtllib box.mtl\nusemtl paint\n".to_owned();
    for (side, (corners, _)) in sides().into_iter().enumerate() {
        corners.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
        let [a, b, c, d] = [1, 2, 3, 4].map(|n| 4 * side + n);
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

const MTL: &str = "newmtl paint\nKd 0.1 0.2 0.3\nmap_Kd box.png\n";

fn read(format: Format, bytes: &[u8], mtl: &[u8]) -> Result<Model, ModelError> {
    format.read(bytes, &mut |name| match name {
        "box.mtl" => Ok(mtl.to_vec()),
        "box.png" => Ok(image()),
        _ => Err(ModelError::new("there is no such file", "name another")),
    })
}

fn replica(format: Format, bytes: &[u8], mtl: &[u8], scale: f64) -> Result<Replica, ModelError> {
    Replica::new(read(format, bytes, mtl)?, scale)
}

#[test]
fn both_formats_read_with_their_colours() {
    for (format, bytes) in [(Format::Glb, glb(|_| ())), (Format::Obj, obj().into_bytes())] {
        let model = read(format, &bytes, MTL.as_bytes()).unwrap();
        assert_eq!(model.triangles.len(), 12, "{format:?}");
        let places =
            model.triangles.iter().flat_map(|triangle| triangle.corners).map(|corner| <[f64; 3]>::from(corner.at));
        let size = Aabb::from_points(places).unwrap().size();
        assert!(size.iter().zip([0.2, 0.4, 0.3]).all(|(side, wanted)| (side - wanted).abs() < 1e-6), "{size:?}");
        let texture = model.materials[0].texture.as_ref().unwrap();
        let color = |u: f32| texture.image.color([u, 0.5], texture.wrap, 0.0);
        assert_eq!([color(0.25), color(0.75)], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "{format:?}");
        Replica::new(model, 1.0).unwrap();
    }
    let [glb, obj] = [read(Format::Glb, &glb(|_| ()), b""), read(Format::Obj, obj().as_bytes(), MTL.as_bytes())]
        .map(|model| model.unwrap().materials.swap_remove(0));
    assert_eq!((glb.color, glb.roughness), ([0.5; 3], 0.25));
    assert_eq!(glb.texture.unwrap().wrap, [Wrap::Clamp, Wrap::Repeat]);
    assert_eq!((obj.color, obj.roughness), ([1.0; 3], 0.8));
}

#[test]
fn damaged_files_are_read_or_refused() {
    let (glb, obj) = (glb(|_| ()), obj());
    let files = [(Format::Glb, &glb[..], &b""[..]), (Format::Obj, obj.as_bytes(), MTL.as_bytes())];
    for (format, bytes, mtl) in files {
        for (how, bytes) in damaged(bytes, b"9-\n") {
            let made = AssertUnwindSafe(|| replica(format, &bytes, mtl, 1.0).map_err(|error| error.message.is_empty()));
            assert!(!matches!(catch_unwind(made), Err(_) | Ok(Err(true))), "{format:?} {how}");
        }
    }
    for (how, mtl) in damaged(MTL.as_bytes(), b"9-\n") {
        let made =
            AssertUnwindSafe(|| read(Format::Obj, obj.as_bytes(), &mtl).map_err(|error| error.message.is_empty()));
        assert!(!matches!(catch_unwind(made), Err(_) | Ok(Err(true))), "MTL {how}");
    }
}

/// The error for each file that is not fit to be a thing: one golden text.
#[test]
fn unfit_models_are_refused_with_a_message() {
    let text = obj();
    let mirrored = text.replace("v ", "v -").replace("--", "");
    let without = text.rsplit_once("f ").unwrap().0.to_owned();
    let turned = text.replace("f 1 2 3 4", "f 4 3 2 1");
    let shifted = |text: &str, by: [f32; 3]| -> String {
        let line = |line: &str| match line.strip_prefix("v ") {
            Some(at) => {
                let at: Vec<f32> = at.split(' ').map(|number| number.parse().unwrap()).collect();
                format!("v {} {} {}\n", at[0] + by[0], at[1] + by[1], at[2] + by[2])
            }
            None => line.strip_prefix("f ").map_or_else(String::new, |face| {
                let corners = face.split(' ').map(|corner| (corner.parse::<i32>().unwrap() + 24).to_string());
                format!("f {}\n", corners.collect::<Vec<_>>().join(" "))
            }),
        };
        text.lines().map(line).collect()
    };
    let twice = |by: [f32; 3]| text.clone() + &shifted(&text, by);
    let many = text.clone() + &"f 1 2 3\n".repeat(plume::model::MOST_TRIANGLES);
    let objs = [
        ("open", without),
        ("turned face", turned),
        ("inside out", mirrored),
        ("two that share an edge", twice([0.2, 0.3, 0.0])),
        ("two that share a corner", twice([0.2, 0.3, 0.4])),
        ("too many triangles", many),
        ("no number", text.replace("v 0.1 -0.15 -0.2", "v 0.1 wide -0.2")),
        ("no such corner", text.replace("f 1 2 3 4", "f 1 2 3 99")),
        ("corner 0", text.replace("f 1 2 3 4", "f 0 2 3 4")),
        ("two corners", text.replace("f 1 2 3 4", "f 1 2")),
        ("no such file", text.replace("box.mtl", "\u{1b}[2Jlid.mtl")),
        ("empty", String::new()),
    ];
    let mut told = String::new();
    let mut tell = |name: &str, made: Result<Replica, ModelError>| {
        let error = made.expect_err(name);
        told += &format!("{name}: {error}\n  hint: {}\n", error.hint);
    };
    for (name, text) in objs {
        tell(name, replica(Format::Obj, text.as_bytes(), MTL.as_bytes(), 1.0));
    }
    for mtl in ["newmtl paint\nKd 1 2\n", "newmtl paint\nmap_Kd\n", "newmtl paint\nmap_Kd box.mtl\n"] {
        tell(mtl.lines().next_back().unwrap(), replica(Format::Obj, text.as_bytes(), mtl.as_bytes(), 1.0));
    }
    for scale in [6.0, 0.01, 1e300] {
        tell(&format!("scale {scale:e}"), replica(Format::Obj, text.as_bytes(), MTL.as_bytes(), scale));
    }
    let set = |pointer: &'static str, value: Value| {
        glb(move |document| match document.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => document[pointer.trim_start_matches('/')] = value.clone(),
        })
    };
    let glbs = [
        ("extension", set("/extensionsRequired", json!(["KHR_draco_mesh_compression"]))),
        ("circle of nodes", glb(|document| document["nodes"][0]["children"] = json!([0]))),
        ("lines", glb(|document| document["meshes"][0]["primitives"][0]["mode"] = json!(1))),
        ("count of none", set("/accessors/0/count", json!(0))),
        ("count beyond the file", set("/accessors/0/count", json!(u64::MAX))),
        ("offset beyond the file", glb(|document| document["accessors"][0]["byteOffset"] = json!(u64::MAX))),
        ("view beyond the file", set("/bufferViews/0/byteLength", json!(u64::MAX))),
        (
            "sparse",
            glb(|document| {
                let at = json!({"bufferView": 0, "componentType": 5125});
                document["accessors"][0]["sparse"] = json!({"count": 0, "indices": at, "values": {"bufferView": 0}});
            }),
        ),
        ("other type", set("/accessors/0/componentType", json!(5121))),
        ("index beyond the vertices", set("/accessors/0/count", json!(2))),
        ("material that is not there", glb(|document| document["meshes"][0]["primitives"][0]["material"] = json!(7))),
        ("image beside", glb(|document| document["images"][0] = json!({"uri": "wood.png"}))),
        ("image of nothing", set("/images/0/bufferView", json!(0))),
        ("no scene", set("/scenes", json!([]))),
        ("text", b"glTF".to_vec()),
    ];
    for (name, bytes) in glbs {
        tell(name, replica(Format::Glb, &bytes, b"", 1.0));
    }
    assert_snapshot!("unfit_models", told);
}

#[test]
fn formats_go_by_extension() {
    let of = |name: &str| Format::of(Path::new(name));
    assert_eq!(
        [of("a.GLB"), of("b/c.obj"), of("a.gltf"), of("obj")],
        [Some(Format::Glb), Some(Format::Obj), None, None]
    );
    assert!(fs::read_to_string("samples/models/crate.obj").unwrap().contains("MIT OR Apache-2.0"));
}
