//! All references of a MuJoCo package resolve, and nothing in it can clash with the user's model.

use std::collections::BTreeSet;
use std::fs::{self, File};

use crate::changed;
use crate::mjcf;
use crate::sample;
use crate::strewn::Strewn;
use crate::told;
use plume_exporters::ImageFormat;
use plume_exporters::bundle::Bundle;
use plume_exporters::package::{Memory, Package};
use plume_exporters::place::Archive;
use plume_exporters::place::Existing;
use plume_exporters::place::Place;
use plume_exporters::scene::{Chunk, Chunks, Image, Scene};
use plume_exporters::targets::mujoco::{self, Collision, Mujoco, MujocoSettings};
use plume_exporters::{ExportError, Target, target};
use roxmltree::{Document, Node};
use serde_json::json;

use changed::Changed;
use told::told;

fn export(settings: MujocoSettings) -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    Mujoco(settings).export(&chamber.scene(), &mut memory).unwrap();
    memory
}

fn with(collision: Collision) -> Memory {
    export(MujocoSettings { collision, ..MujocoSettings::default() })
}

fn text<'a>(package: &'a Memory, path: &str) -> &'a str {
    std::str::from_utf8(&package.bytes[path]).unwrap()
}

fn elements<'a>(document: &'a Document) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(Node::is_element)
}

#[test]
fn every_reference_resolves_and_every_asset_is_referenced() {
    for collision in [Collision::Pieces, Collision::Flex, Collision::FloorField] {
        let package = with(collision);
        let mut named = BTreeSet::new();
        for path in package.bytes.keys().filter(|path| path.ends_with(".xml")) {
            let document = Document::parse(text(&package, path)).unwrap();
            named.extend(elements(&document).filter_map(|node| node.attribute("file")).map(str::to_owned));
        }
        for file in &named {
            assert!(package.bytes.contains_key(file), "{file}");
        }
        let assets = package.bytes.keys().filter(|path| path.starts_with("assets/"));
        assert!(assets.clone().count() > 0 && assets.into_iter().all(|path| named.contains(path)));
    }
}

#[test]
fn every_referenced_name_is_defined() {
    for collision in [Collision::Pieces, Collision::Flex, Collision::FloorField] {
        let package = with(collision);
        for path in ["chamber_world.xml", "rover.xml"] {
            let whole = mjcf::whole(&package, path);
            let document = Document::parse(&whole).unwrap();
            let given = |tag: &str, key: &str| -> BTreeSet<String> {
                let nodes = elements(&document).filter(|node| node.has_tag_name(tag));
                nodes.filter_map(|node| node.attribute(key)).map(str::to_owned).collect()
            };
            for (user, key, tag, name) in [
                ("geom", "mesh", "mesh", "name"),
                ("geom", "hfield", "hfield", "name"),
                ("geom", "material", "material", "name"),
                ("geom", "class", "default", "class"),
                ("layer", "texture", "texture", "name"),
                ("velocity", "joint", "joint", "name"),
                ("accelerometer", "site", "site", "name"),
                ("gyro", "site", "site", "name"),
            ] {
                let missing = &given(user, key) - &given(tag, name);
                assert!(missing.is_empty(), "{path}: {user} {key} {missing:?}");
            }
        }
    }
}

#[test]
fn the_world_uses_only_prefixed_names_and_sets_no_option() {
    for collision in [Collision::Pieces, Collision::Flex, Collision::FloorField] {
        let package = with(collision);
        let world = mjcf::whole(&package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        let mut seen = BTreeSet::new();
        for node in elements(&document) {
            for name in [node.attribute("name"), node.attribute("class")].into_iter().flatten() {
                assert!(name.starts_with("chamber_"), "{name}");
            }
            if let Some(name) = node.attribute("name") {
                assert!(seen.insert((node.tag_name().name(), name)), "{name} is defined twice");
            }
        }
        let sections: BTreeSet<&str> =
            document.root_element().children().filter(Node::is_element).map(|node| node.tag_name().name()).collect();
        let harmless = BTreeSet::from(["default", "asset", "worldbody", "deformable"]);
        assert!(sections.is_subset(&harmless), "{sections:?}");
        // Settings of the main default class would apply to the user's geoms.
        let main = document.root_element().children().filter(|node| node.has_tag_name("default"));
        assert!(
            main.flat_map(|node| node.children()).filter(Node::is_element).all(|node| node.has_tag_name("default"))
        );
    }
}

#[test]
fn every_kind_of_collision_covers_the_chamber() {
    let count = |collision, tag: &str| {
        let package = with(collision);
        let world = mjcf::whole(&package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        elements(&document).filter(|node| node.has_tag_name(tag)).count()
    };
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let pieces: usize = (0..2).map(|index| chamber.pieces(index).unwrap().len()).sum();
    assert_eq!(count(Collision::Pieces, "mesh"), pieces + 2);
    assert_eq!(count(Collision::Flex, "flex"), 2 * 3);
    assert_eq!(count(Collision::FloorField, "hfield"), 2);
    assert_eq!(count(Collision::FloorField, "mesh"), 2);
}

fn strewn(movable: bool) -> Memory {
    strewn_with(MujocoSettings::default(), movable)
}

fn strewn_with(settings: MujocoSettings, movable: bool) -> Memory {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), movable).unwrap();
    let mut memory = Memory::default();
    Mujoco(settings).export(&strewn.scene(), &mut memory).unwrap();
    memory
}

#[test]
fn things_of_one_size_share_their_meshes() {
    for movable in [false, true] {
        let package = strewn(movable);
        let world = mjcf::whole(&package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        let of_boxes = |tag: &str, key: &str| {
            let nodes = elements(&document).filter(|node| node.has_tag_name(tag));
            nodes.filter(|node| node.attribute(key).is_some_and(|name| name.contains("_box_"))).count()
        };
        assert_eq!(of_boxes("mesh", "name"), 2 * 2, "two sizes, each to be seen and to be touched");
        assert_eq!(of_boxes("geom", "mesh"), 2 * 3);
        assert_eq!(package.bytes.keys().filter(|path| path.contains("box_0")).count(), 1);
        assert!(!package.bytes.contains_key("assets/things_0_0_0.msh"));
        assert_eq!(of_boxes("freejoint", "name"), if movable { 3 } else { 0 });
    }
}

#[test]
fn things_that_are_too_short_have_no_hull() {
    let count = |least_hull_m: f64, movable: bool| {
        let package = strewn_with(MujocoSettings { least_hull_m, ..MujocoSettings::default() }, movable);
        let world = mjcf::whole(&package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        let of = |tag: &str, end: &str| {
            let nodes = elements(&document).filter(|node| node.has_tag_name(tag));
            nodes
                .filter(|node| {
                    node.attribute("mesh").or(node.attribute("name")).is_some_and(|name| name.ends_with(end))
                })
                .count()
        };
        [of("mesh", "_hull"), of("geom", "_hull")]
    };
    // The boxes are 0.2, 0.3 and 0.2 m wide.
    assert_eq!([0.0, 0.29, 0.31].map(|least_m| count(least_m, false)), [[2, 3], [1, 1], [0, 0]]);
    assert_eq!(count(9.0, true), [2, 3], "what moves would fall through the floor");
}

#[test]
fn a_model_without_visuals_has_the_same_shapes_to_touch() {
    let settings = MujocoSettings { visuals: false, ..MujocoSettings::default() };
    let [full, bare] = [MujocoSettings::default(), settings].map(|settings| strewn_with(settings, false));
    let touched = |package: &Memory| {
        let world = mjcf::whole(package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        let is_touched = |node: &Node| node.attribute("class").is_some_and(|class| class != "chamber_visual");
        let geoms = elements(&document).filter(|node| node.has_tag_name("geom")).filter(is_touched);
        geoms.map(|node| node.attribute("name").map(str::to_owned)).collect::<Vec<_>>()
    };
    assert_eq!(touched(&bare), touched(&full));
    let world = mjcf::whole(&bare, "chamber_world.xml");
    assert!(!world.contains("_visual\" mesh") && !world.contains("<texture") && !world.contains("file="));
    assert!(bare.bytes.keys().all(|path| !path.starts_with("assets/")));
}

#[test]
fn each_chunk_can_be_included_without_the_others() {
    let package = strewn(false);
    let index: serde_json::Value = serde_json::from_slice(&package.bytes["chunks.json"]).unwrap();
    let shared = text(&package, index["shared"].as_str().unwrap());
    let boxes = index["chunks"].as_array().unwrap();
    assert!(boxes.len() > 2);
    for chunk in boxes {
        let model = format!("<a>{shared}{}</a>", text(&package, chunk["file"].as_str().unwrap()));
        let document = Document::parse(&model).unwrap();
        let given = |tag: &str, key: &str| -> BTreeSet<&str> {
            elements(&document).filter(|node| node.has_tag_name(tag)).filter_map(|node| node.attribute(key)).collect()
        };
        for (key, tag) in [("mesh", "mesh"), ("material", "material")] {
            let missing = &given("geom", key) - &given(tag, "name");
            assert!(missing.is_empty(), "{chunk}: {key} {missing:?}");
        }
    }
}

#[test]
fn the_start_keyframe_has_the_pose_of_every_free_body() {
    for (movable, bodies) in [(false, 1), (true, 4)] {
        let package = strewn(movable);
        let document = Document::parse(text(&package, "chamber_rover.xml")).unwrap();
        let key = elements(&document).find(|node| node.has_tag_name("key")).unwrap();
        assert_eq!(numbers(key, "qpos").len(), 7 * bodies + 4);
    }
}

/// Numbers of an attribute.
fn numbers(node: Node, key: &str) -> Vec<f64> {
    node.attribute(key).unwrap().split(' ').filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_height_field_matches_the_floor() {
    let package = with(Collision::FloorField);
    let world = mjcf::whole(&package, "chamber_world.xml");
    let document = Document::parse(&world).unwrap();
    let spawn = numbers(elements(&document).find(|node| node.has_tag_name("site")).unwrap(), "pos");
    let mut fields = elements(&document).filter(|node| node.attribute("hfield").is_some());
    let geom = fields.find(|node| covers(&document, *node, &spawn)).unwrap();
    let (field, at) = (asset(&document, geom), numbers(geom, "pos"));
    let [columns, rows] = ["ncol", "nrow"].map(|key| field.attribute(key).unwrap().parse::<usize>().unwrap());
    let (size, heights) = (numbers(field, "size"), numbers(field, "elevation"));
    assert_eq!(heights.len(), columns * rows);
    let cell = |x: f64, half: f64, count: usize| ((x + half) / (2.0 * half) * (count - 1) as f64).round() as usize;
    let column = cell(spawn[0] - at[0], size[0], columns);
    // The first row is in the north.
    let row = rows - 1 - cell(spawn[1] - at[1], size[1], rows);
    assert!((at[2] + heights[row * columns + column] - spawn[2]).abs() < 0.1);
    let highest = heights.iter().copied().fold(0.0, f64::max);
    assert!((highest - size[2]).abs() < 1e-5, "MuJoCo scales the highest sample to the size");
}

fn asset<'a>(document: &'a Document, geom: Node) -> Node<'a, 'a> {
    let name = geom.attribute("hfield");
    elements(document).find(|node| node.has_tag_name("hfield") && node.attribute("name") == name).unwrap()
}

fn covers(document: &Document, geom: Node, point: &[f64]) -> bool {
    let (at, size) = (numbers(geom, "pos"), numbers(asset(document, geom), "size"));
    (0..2).all(|axis| (point[axis] - at[axis]).abs() <= size[axis])
}

#[test]
fn the_lamps_nearest_to_the_start_are_lit() {
    for (lights, expected) in
        [(0, vec![]), (1, vec!["chamber_lamp_west"]), (4, vec!["chamber_lamp_west", "chamber_lamp_east"])]
    {
        let package = export(MujocoSettings { lights, ..MujocoSettings::default() });
        let world = mjcf::whole(&package, "chamber_world.xml");
        let document = Document::parse(&world).unwrap();
        let lit =
            elements(&document).filter(|node| node.has_tag_name("light") && node.attribute("active") == Some("true"));
        assert_eq!(lit.filter_map(|node| node.attribute("name")).collect::<Vec<_>>(), expected);
    }
}

/// An archive of the chamber.
fn archive(path: &std::path::Path, existing: Existing) -> Result<(), ExportError> {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let place = Place { path: path.to_owned(), bundle: Some(Bundle::Mjz), existing };
    place.write(mujoco::ROW.name, &Mujoco(MujocoSettings::default()), &chamber.scene()).map(drop)
}

#[test]
fn an_archive_is_reproducible_and_its_model_is_self_contained() {
    let folder = tempfile::tempdir().unwrap();
    let [first, again] = ["first.mjz", "again.mjz"].map(|name| folder.path().join(name));
    archive(&first, Existing::Keep).unwrap();
    archive(&again, Existing::Keep).unwrap();
    assert!(fs::read(&first).unwrap() == fs::read(&again).unwrap());
    let mut zip = zip::ZipArchive::new(File::open(&first).unwrap()).unwrap();
    let model = std::io::read_to_string(zip.by_name("model.xml").unwrap()).unwrap();
    let names: Vec<String> = zip.file_names().map(|name| name.unwrap().into_owned()).collect();
    // MjSpec.from_zip takes the last one for the model.
    assert_eq!(names.iter().rfind(|name| name.ends_with(".xml")).unwrap(), "model.xml");
    let document = Document::parse(&model).unwrap();
    assert!(elements(&document).all(|node| !node.has_tag_name("include")));
    for file in elements(&document).filter_map(|node| node.attribute("file")) {
        assert!(names.iter().any(|name| name == file), "{file}");
    }
}

#[test]
fn only_our_own_archives_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap().to_owned();
    let path = folder.path().join("cave.mjz");
    fs::write(folder.path().join("letter.mjz"), "dear").unwrap();
    archive(&path, Existing::Keep).unwrap();
    archive(&path, Existing::Replace).unwrap();
    let refused = [
        archive(&path, Existing::Keep),
        archive(&folder.path().join("letter.mjz"), Existing::Replace),
        archive(folder.path(), Existing::Replace),
    ];
    let texts: Vec<String> =
        refused.into_iter().map(|result| told(&result.unwrap_err()).replace(&place, "DIR")).collect();
    insta::assert_snapshot!(texts.join("\n"), @r"
    usage: output file already exists: DIR/cave.mjz (hint: choose a new file, or replace this one with `--force`)
    usage: output was not written by an export and is not replaced: DIR/letter.mjz (hint: choose another path, or remove this one yourself)
    usage: output is not a file: DIR
    ");
    assert_eq!(fs::read(folder.path().join("letter.mjz")).unwrap(), b"dear");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_failed_archive_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cave.mjz");
    let mut archive = Archive::create(Bundle::Mjz, &path, Existing::Keep).unwrap();
    let sink: &mut dyn Package = &mut archive;
    sink.text("a.txt", "a").unwrap();
    drop(archive);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn jpeg_images_are_written_as_png() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let jpg = folder.path().join("rock.jpg");
    fs::write(&jpg, include_bytes!("data/rock.jpg")).unwrap();
    let as_jpeg = |_, mut chunk: Chunk| {
        chunk.material.base_color = Image { path: jpg.clone(), format: ImageFormat::Jpeg };
        Ok(chunk)
    };
    let jpegs = Changed { inner: &chamber, change: as_jpeg };
    let mut package = Memory::default();
    let scene = Scene { chunks: &jpegs, ..chamber.scene() };
    Mujoco(MujocoSettings::default()).export(&scene, &mut package).unwrap();
    let written = &package.bytes["assets/chunk_0_0_0_base_color.png"];
    assert_eq!(image::guess_format(written).unwrap(), image::ImageFormat::Png);
    assert!(image::load_from_memory(written).unwrap().into_rgb8() == image::open(&jpg).unwrap().into_rgb8());
    let normal = fs::read(folder.path().join("0_normal.png")).unwrap();
    assert!(package.bytes["assets/chunk_0_0_0_normal.png"] == normal, "PNG is copied");
}

#[test]
fn impossible_exports_are_refused_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let webp = |_, mut chunk: Chunk| {
        chunk.material.base_color = Image { path: "0_base_color.webp".into(), format: ImageFormat::WebP };
        Ok(chunk)
    };
    let webps = Changed { inner: &chamber, change: webp };
    let scene = Scene { chunks: &webps, ..chamber.scene() };
    let image = Mujoco(MujocoSettings::default()).export(&scene, &mut Memory::default()).unwrap_err();
    let called_rover = Scene { name: "rover".to_owned(), ..chamber.scene() };
    let name = Mujoco(MujocoSettings::default()).export(&called_rover, &mut Memory::default()).unwrap_err();
    let option = |table| target("mujoco").unwrap().build(table, None).err().unwrap();
    let errors = [image, name, option(json!({ "collision": "hulls" })), option(json!({ "lights": -1 }))];
    insta::assert_snapshot!(errors.iter().map(told).collect::<Vec<_>>().join("\n"), @r"
    usage: target `mujoco` supports only PNG and JPEG images: 0_base_color.webp (hint: make the cave with another image format: `--set texture.format=png`)
    system: scene `rover`: its name is the rover's
    usage: settings of target `mujoco`: unknown variant `hulls`, expected one of `pieces`, `flex`, `floor_field`
    usage: settings of target `mujoco`: invalid value: integer `-1`, expected u32
    ");
}

/// The full text, so that changes show up in review.
#[test]
fn texts_are_golden() {
    let package = with(Collision::FloorField);
    for path in ["chamber.xml", "chamber_rover.xml", "chamber_world.xml", "chunks.json", "README.md"] {
        insta::assert_snapshot!(path, text(&package, path));
    }
}
