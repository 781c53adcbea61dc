//! Reports on intact and broken files of each format; no input makes the check panic.

use std::io::Cursor;
use std::sync::LazyLock;

use crate::forge;
use forge::{Forged, amend, package, package_of, tar, verdict, zip, zstd};
use plume_exporters::format::npy::Archive;
use plume_exporters::package::MANIFEST;
use proptest::prelude::*;

/// The report on a package of one file and an image.
fn of(path: &str, bytes: &[u8]) -> String {
    let image = package("gazebo").into_iter().find(|(path, _)| path.ends_with(".png")).unwrap().1;
    verdict(&zip(&package_of(&[(path, bytes), ("rock.png", &image)]), |_| ()))
}

/// The reports on some files.
fn each(files: &[(&str, &[u8])]) -> String {
    files.iter().map(|(path, bytes)| format!("{}\n", of(path, bytes))).collect()
}

#[test]
fn meshes_are_read() {
    let stl = [&[0; 80][..], &1_u32.to_le_bytes(), &[0; 50]].concat();
    let ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n\0\0\0\0\x01\0\0\0\0";
    let big = b"ply\nformat binary_big_endian 1.0\nelement face 1\nproperty list ushort uchar v\nend_header\n\0\x02ab";
    let text = b"ply\nformat ascii 1.0\ncomment hi\nelement vertex 2\nproperty float x\nend_header\n1\n2\n";
    for (path, bytes) in [("a.stl", &stl[..]), ("a.ply", ply), ("a.ply", big), ("a.ply", text)] {
        assert_eq!(of(path, bytes), "whole");
    }
    insta::assert_snapshot!(each(&[
        ("cut.stl", &stl[..120]),
        ("text.stl", format!("solid a\n{}\n", "facet ".repeat(20)).as_bytes()),
        ("cut.ply", &ply[..ply.len() - 1]),
        ("long.ply", &[&text[..], b"3\n"].concat()),
        ("huge.ply", b"ply\nformat binary_little_endian 1.0\nelement v 18446744073709551615\nproperty double x\nend_header\n"),
        ("odd.ply", b"ply\nformat ascii 1.0\nelement v 1\nproperty text x\nend_header\nhi\n"),
        ("face.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n"),
        ("nan.obj", b"v 0 0 nan\n"),
        ("away.obj", b"mtllib ../../rock.mtl\nv 0 0 0\n"),
        ("a.mtl", b"newmtl rock\nmap_Kd -bm 1 rock.png\nnorm gone.png\nmap_Pr C:\\rock.png\nmap_Ks /rock.png\n"),
    ]), @r"
    cut.stl: states 1 triangles, which does not match its size
    text.stl: ends early
    cut.ply: ends early
    long.ply: has trailing data
    huge.ply: ends early
    odd.ply: has an invalid PLY property
    face.obj: has an invalid OBJ line 3: `f 1 2 3`
    nan.obj: has an invalid OBJ line 1: `v 0 0 nan`
    away.obj: refers to `../../rock.mtl`, which is outside the package
    a.mtl: refers to `/rock.png`, which is not a relative path with forward slashes
    a.mtl: refers to `C:\rock.png`, which is not a relative path with forward slashes
    a.mtl: refers to `gone.png`, which does not exist
    ");
}

#[test]
fn ground_truth_is_read() {
    let mut npz = Cursor::new(Vec::new());
    let mut archive = Archive::new(&mut npz);
    archive.add("z", &[2], [1.0_f32, 2.0]).unwrap();
    archive.finish().unwrap();
    let npz = npz.into_inner();
    let map = "image: rock.png\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    let parameters = b"planner_server:\n  ros__parameters:\n    image: none\n";
    for (path, bytes) in [("a.npz", &npz[..]), ("a.yaml", map.as_bytes()), ("b.yaml", &parameters[..])] {
        assert_eq!(of(path, bytes), "whole");
    }
    let mut damaged = npz.clone();
    let last_of_array = npz.windows(4).position(|bytes| bytes == b"PK\x01\x02").unwrap() - 1;
    damaged[last_of_array - 20] ^= 1;
    insta::assert_snapshot!(each(&[
        ("cut.npz", &npz[..npz.len() / 2]),
        ("damaged.npz", &damaged),
        ("other.npz", &zip(&package_of(&[("a.txt", b"no array")]), |_| ())),
        ("gone.yaml", map.replace("rock", "gone").as_bytes()),
        ("short.yaml", b"image: rock.png\n"),
    ]), @r"
    cut.npz: is not a zip
    damaged.npz: has a damaged array
    other.npz: has an entry that is not an array
    gone.yaml: refers to `gone.png`, which does not exist
    short.yaml: has no `resolution`
    ");
}

#[test]
fn grids_clouds_and_rasters_are_read() {
    let truth = package("truth");
    let cut = |path: &str| truth[path][..truth[path].len() - 1].to_vec();
    let edited = |path: &str, at: usize| {
        let mut bytes = truth[path].clone();
        bytes[at] ^= 1;
        bytes
    };
    let tree_at = truth["occupancy.bt"].windows(6).position(|bytes| bytes == b"\ndata\n").unwrap() + 6;
    insta::assert_snapshot!(each(&[
        ("cut.bt", &cut("occupancy.bt")),
        ("other.bt", &edited("occupancy.bt", tree_at)),
        ("deep.bt", &[&b"# Octomap OcTree binary file\nsize 9\nres 0.1\ndata\n"[..], &[3; 40]].concat()),
        ("no.bt", b"# Octomap OcTree binary file\nres 0.1\ndata\n"),
        ("cut.pcd", &cut("cloud.pcd")),
        ("text.pcd", b"VERSION 0.7\nSIZE 4\nCOUNT 1\nPOINTS 1\nDATA ascii\n1\n"),
        ("huge.pcd", b"SIZE 8\nCOUNT 8\nPOINTS 18446744073709551615\nDATA binary\n"),
        ("no.pcd", b"SIZE 4 4\nCOUNT 1\nPOINTS 1\nDATA binary\n"),
        ("cut.las", &cut("cloud.las")),
        ("more.las", &edited("cloud.las", 247)),
        ("old.las", &edited("cloud.las", 25)),
        ("cut.tif", &truth["elevation_0.tif"][..500]),
        ("other.tif", &edited("elevation_0.tif", 0)),
        ("no.tif", b"II*\0\x08\0\0\0\0\0\0\0\0\0"),
    ]), @r"
    cut.bt: ends early
    other.bt: states 32653 nodes and has 28585
    deep.bt: has a tree that is too deep
    no.bt: does not state its size and resolution
    cut.pcd: ends early
    text.pcd: is not a binary PCD
    huge.pcd: ends early
    no.pcd: has an invalid PCD header
    cut.las: states 12550 points, which does not match its size
    more.las: states 12551 points, which does not match its size
    old.las: is not a LAS 1.4
    cut.tif: refers to something beyond its end
    other.tif: is not a little-endian TIFF
    no.tif: has no strips, or only part of what tells where they are
    ");
}

#[test]
fn markup_is_read() {
    let deep = "<a>".repeat(100_000);
    let many = format!("<a {}/>", (0..2000).map(|n| format!("b{n}=\"\" ")).collect::<String>());
    insta::assert_snapshot!(each(&[
        ("a.sdf", b"<sdf version=\"1.9\"><model name=\"m\"><plugin filename=\"system\"/><uri>model://cave/a.obj</uri></model></sdf>"),
        ("b.sdf", b"<sdf><include><uri>https://fuel.gazebosim.org/a</uri></include><albedo_map>rock.png</albedo_map></sdf>"),
        ("a.urdf", b"<robot><mesh filename=\"package://cave/meshes/a.obj\"/><mesh filename=\"file:///a.obj\"/></robot>"),
        ("a.xml", b"<mujoco><compiler texturedir=\"images\"/><asset><texture file=\"rock.png\"/></asset></mujoco>"),
        ("b.xml", b"<!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]><a>&b;</a>"),
        ("a.dae", b"<COLLADA xmlns=\"a\"><image><init_from>gone.png</init_from></image><surface file=\"b.png\"><init_from>image-1</init_from></surface></COLLADA>"),
        ("deep.xml", deep.as_bytes()),
        ("many.xml", many.as_bytes()),
        ("a.usda", b"#usda 1.0\n(doc = \"mail me @home\") # not @this@\nasset a = @./rock.png@\nasset b = @gone.usdc@\n"),
        ("b.usda", b"#usda 1.0\n(doc = \"never ends)\n"),
        ("a.json", b"{\"chunks\": [{\"file\": \"gone.bin\"}, {\"file\": \"rock.png\"}]}"),
        ("b.json", "[".repeat(1000).as_bytes()),
    ]), @r"
    a.sdf: refers to `model://cave/a.obj`, which does not exist
    b.sdf: refers to `https://fuel.gazebosim.org/a`, which is not a relative path with forward slashes
    a.urdf: refers to `file:///a.obj`, which is not a relative path with forward slashes
    a.urdf: refers to `package://cave/meshes/a.obj`, which does not exist
    a.xml: refers to `images/rock.png`, which does not exist
    b.xml: is not valid XML: XML with DTD detected
    a.dae: refers to `b.png`, which does not exist
    a.dae: refers to `gone.png`, which does not exist
    deep.xml: is not valid XML: the root node was opened but never closed
    many.xml: has an element with more than 1000 attributes
    a.usda: refers to `gone.usdc`, which does not exist
    b.usda: has an unterminated string
    a.json: refers to `gone.bin`, which does not exist
    b.json: is not valid JSON: recursion limit exceeded at line 1 column 128
    ");
}

#[test]
fn gltf_is_read() {
    let document = |more: &str| format!("{{\"asset\": {{\"version\": \"2.0\"}}, {more}}}");
    let files = [
        r#""images": [{"uri": "rock.png"}], "textures": [{"extensions": {"EXT_texture_webp": {"source": 0}}}]"#,
        r#""images": [{"uri": "gone.png"}]"#,
        r#""buffers": [{"uri": "rock.png", "byteLength": 100000000}]"#,
        r#""buffers": [{"byteLength": 4}], "bufferViews": [{"buffer": 0, "byteOffset": 2, "byteLength": 4}]"#,
        r#""buffers": [{"byteLength": 4}], "bufferViews": [{"buffer": 1, "byteLength": 4}]"#,
        r#""buffers": [{"byteLength": 24}], "bufferViews": [{"buffer": 0, "byteLength": 24}],
           "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]"#,
    ];
    let said: String = files.iter().map(|more| format!("{}\n", of("a.gltf", document(more).as_bytes()))).collect();
    insta::assert_snapshot!(said, @r"
    whole
    a.gltf: refers to `gone.png`, which does not exist
    a.gltf: needs 100000000 bytes of `rock.png`, which has 191
    a.gltf: has buffer view 0, which extends beyond its buffer
    a.gltf: is not valid glTF: bufferViews[0].buffer is Index out of bounds
    a.gltf: has accessor 0, which extends beyond its buffer view
    ");
    let glb = package("glb").remove("chamber.glb").unwrap();
    let mut short = glb.clone();
    short.truncate(glb.len() - 4);
    insta::assert_snapshot!(each(&[("a.glb", &short), ("b.glb", b"glTF\x01\0\0\0")]), @r"
    a.glb: has a wrong length in its header
    b.glb: is not a binary glTF 2.0
    ");
}

#[test]
fn files_of_unity_are_read() {
    let guid = "0123456789abcdef0123456789abcdef";
    let meta = format!("fileFormatVersion: 2\nguid: {guid}\n");
    let named =
        |guid: &str| format!("%YAML 1.1\n--- !u!21 &1\nm_Texture: {{fileID: 2800000, guid: {guid}, type: 3}}\n");
    let said = |files: &[(&str, &str)]| {
        let files: Vec<(&str, &[u8])> = files.iter().map(|(path, text)| (*path, text.as_bytes())).collect();
        verdict(&zip(&package_of(&files), |_| ()))
    };
    assert_eq!(said(&[("a.txt", ""), ("a.txt.meta", &meta), ("a.mat", &named(guid))]), "whole");
    assert_eq!(said(&[("manifest.json.meta", &meta)]), "whole");
    assert_eq!(said(&[("a.mat", &named("933532a4fcc9baf4fa0491de14d08ed7"))]), "whole");
    let faults = [
        said(&[("gone.txt.meta", &meta)]),
        said(&[("a.txt", ""), ("a.txt.meta", &meta), ("b.txt", ""), ("b.txt.meta", &meta)]),
        said(&[("a.mat", &named("ffffffffffffffffffffffffffffffff"))]),
        said(&[("a.txt", ""), ("a.txt.meta", "fileFormatVersion: 2\n"), ("a.prefab", "hello: 1\n")]),
    ];
    insta::assert_snapshot!(faults.join("\n"), @r"
    gone.txt.meta: refers to `gone.txt`, which does not exist
    b.txt.meta: has the same GUID as a.txt.meta: 0123456789abcdef0123456789abcdef
    a.mat: refers to GUID ffffffffffffffffffffffffffffffff, which no file of the package has
    a.prefab: is not Unity YAML
    a.txt.meta: has no GUID
    ");
}

/// A node of FBX 7.4 that begins at `start`.
fn node(start: usize, name: &str, properties: &[u8], count: u32, children: &[u8]) -> Vec<u8> {
    let end = start + 13 + name.len() + properties.len() + children.len();
    let numbers = [end as u32, count, properties.len() as u32].map(u32::to_le_bytes).concat();
    [&numbers[..], &[name.len() as u8], name.as_bytes(), properties, children].concat()
}

fn fbx(file: &str) -> Vec<u8> {
    let head = [b"Kaydara FBX Binary  \0\x1a\0".as_slice(), &7400_u32.to_le_bytes()].concat();
    let text = [b"S".as_slice(), &(file.len() as u32).to_le_bytes(), file.as_bytes()].concat();
    let outer = head.len() + 13 + "Texture".len();
    let inner = [node(outer, "RelativeFilename", &text, 1, &[]), vec![0; 13]].concat();
    [head.clone(), node(head.len(), "Texture", &[], 0, &inner), vec![0; 13]].concat()
}

#[test]
fn fbx_is_read() {
    assert_eq!(of("a.fbx", &fbx("rock.png")), "whole");
    let mut lost = fbx("rock.png");
    lost[27] ^= 0x40;
    insta::assert_snapshot!(each(&[
        ("gone.fbx", &fbx("textures/rock.png")),
        ("away.fbx", &fbx("C:\\rock.png")),
        ("cut.fbx", &fbx("rock.png")[..60]),
        ("lost.fbx", &lost),
        ("text.fbx", b"; FBX 7.4.0 project file\n........"),
    ]), @r"
    gone.fbx: refers to `textures/rock.png`, which does not exist
    away.fbx: refers to `C:\rock.png`, which is not a relative path with forward slashes
    cut.fbx: has a node that extends beyond its parent
    lost.fbx: has a node that extends beyond its parent
    text.fbx: is not a binary FBX
    ");
}

#[test]
fn images_are_read() {
    let png = package("gazebo").into_iter().find(|(path, _)| path.ends_with(".png")).unwrap().1;
    let mut flipped = png.clone();
    flipped[png.len() / 2] ^= 1;
    let jpeg = b"\xff\xd8\xff\xc0\0\x02\xff\xda\0\x02\x00\xff\xd9";
    let webp = b"RIFF\x0c\0\0\0WEBPVP8L\0\0\0\0";
    assert_eq!(each(&[("a.jpg", jpeg), ("a.webp", webp)]), "whole\nwhole\n");
    insta::assert_snapshot!(each(&[
        ("flipped.png", &flipped),
        ("cut.png", &png[..png.len() - 20]),
        ("cut.jpg", &jpeg[..jpeg.len() - 1]),
        ("no.jpg", b"\xff\xd8\xff\xe0\0\x00"),
        ("cut.webp", &webp[..webp.len() - 1]),
        ("no.ktx2", b"\xabKTX 20\xbb\r\n\x1a\n"),
        ("no.msh", &[1; 64]),
    ]), @r"
    flipped.png: is not an intact PNG: CRC error: expected 0xb83c5e90 have 0xa41bc685 while decoding ChunkType { type: IDAT, critical: true, private: false, reserved: false, safecopy: false } chunk.
    cut.png: is not an intact PNG: unexpected end of file
    cut.jpg: is not an intact JPEG
    no.jpg: has an invalid JPEG segment
    cut.webp: is not an intact WebP
    no.ktx2: ends early
    no.msh: has counts that do not match its size
    ");
}

/// Packages with files of every format.
static PACKAGES: LazyLock<Vec<Forged>> = LazyLock::new(|| {
    let mut more = package("mujoco");
    more.insert("a.fbx".to_owned(), fbx("rock.png"));
    more.insert("a.ply".to_owned(), b"ply\nformat ascii 1.0\nelement v 1\nproperty float x\nend_header\n1\n".to_vec());
    more.insert("a.stl".to_owned(), [&[0; 80][..], &1_u32.to_le_bytes(), &[0; 50]].concat());
    more.insert("a.usda".to_owned(), b"#usda 1.0\nasset a = @./rock.png@\n".to_vec());
    more.insert("a.txt.meta".to_owned(), b"guid: 0123456789abcdef0123456789abcdef\n".to_vec());
    amend(&mut more, |_| ());
    let mut truth = package("truth");
    truth.retain(|path, _| {
        path == MANIFEST || [".bt", ".pcd", ".las", ".tif"].iter().any(|format| path.ends_with(format))
    });
    amend(&mut truth, |_| ());
    vec![package("gazebo"), package("gltf"), more, truth]
});

/// A change of some bytes: where, relative to the length, and to what; then how much is kept.
type Change = (Vec<(f64, u8)>, f64);

fn change() -> impl Strategy<Value = Change> {
    (prop::collection::vec((0.0..1.0, any::<u8>()), 0..20), prop_oneof![Just(1.0), 0.0..1.0])
}

fn changed(bytes: &[u8], (bits, kept): &Change) -> Vec<u8> {
    let mut changed = bytes.to_vec();
    for (at, byte) in bits.iter().filter(|_| !bytes.is_empty()) {
        changed[(at * bytes.len() as f64) as usize] ^= byte;
    }
    changed.truncate((kept * bytes.len() as f64) as usize);
    changed
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_make_the_check_panic(head in 0..4_usize, bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let heads: [&[u8]; 4] = [b"", b"PK\x03\x04", b"\x28\xb5\x2f\xfd", b"\x1f\x8b\x08"];
        prop_assert_ne!(verdict(&[heads[head], &bytes].concat()), "whole");
    }

    #[test]
    fn no_damage_makes_the_check_panic(is_zip: bool, change in change()) {
        let package = package_of(&[("a.txt", b"Mind your head."), ("b.json", b"[1, 2, 3]")]);
        let archive = if is_zip { zip(&package, |_| ()) } else { zstd(&tar(&package, |_| ())) };
        let _ = verdict(&changed(&archive, &change));
    }

    #[test]
    fn no_file_makes_the_check_panic(which in 0..4_usize, place: prop::sample::Index, change in change()) {
        let mut package = PACKAGES[which].clone();
        let paths: Vec<String> = package.keys().filter(|path| *path != MANIFEST).cloned().collect();
        let path = place.get(&paths);
        let bytes = changed(&package[path], &change);
        package.insert(path.clone(), bytes);
        amend(&mut package, |_| ());
        let _ = verdict(&zip(&package, |_| ()));
    }
}
