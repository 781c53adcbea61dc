//! Laws for every target.

use std::fs;
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::changed;
use crate::ledger;
use crate::sample;
use crate::told;
use crate::touched;
use plume_exporters::ImageFormat;
use plume_exporters::package::{Files, Memory, Package};
use plume_exporters::place::{Existing, Folder};
use plume_exporters::scene::{Chunk, Chunks, Piece, Scene};
use plume_exporters::{ExportError, TARGETS, Target, TargetRow, target};
use serde_json::json;

use changed::Changed;
use ledger::{complete, ledger};
use told::told;
use touched::touched;

#[test]
fn every_target_file_has_its_row() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("targets");
    let mut files: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .filter(|path| fs::read_to_string(path).unwrap().contains("\nimpl Target for "))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    files.sort();
    let mut rows: Vec<&str> = TARGETS.iter().map(|row| row.name).collect();
    rows.sort_unstable();
    assert_eq!(files, rows);
}

#[test]
fn every_row_tells_what_opens_the_package() {
    for row in TARGETS.iter() {
        for text in [row.summary, row.opened_by, row.contents, row.tested_by] {
            assert!(
                !text.is_empty() && !text.contains(['|', '\n']),
                "{}: {text:?} does not fit into a table",
                row.name
            );
        }
        assert!(!row.checks.is_empty(), "{}: `checks` names the interop checks that open the package", row.name);
    }
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for row in complete() {
        let (first, again) = (export(row.name, &folder), export(row.name, &folder));
        assert!(first.bytes == again.bytes, "{}", row.name);
        assert!(!first.bytes.is_empty());
    }
}

#[test]
fn nothing_in_a_text_is_absolute() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    for row in complete() {
        for (path, bytes) in export(row.name, &folder).bytes {
            let text = String::from_utf8_lossy(&bytes);
            assert!(!text.contains(place) && !text.contains("file://"), "{path}");
        }
    }
}

#[test]
fn settings_are_documented_and_unknown_ones_refused() {
    for row in TARGETS.iter() {
        let schema = serde_json::to_value((row.settings)()).unwrap();
        for (name, property) in schema["properties"].as_object().into_iter().flatten() {
            assert!(property["description"].is_string(), "{}.{name}", row.name);
        }
        let error = row.build(json!({ "colour": 1 }), ledger().as_ref()).err().unwrap();
        assert!(error.is_usage() && error.to_string().contains("`colour`"), "{error}");
    }
}

#[test]
fn a_failed_export_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let missing = ["1_base_color.png", "1_normal.png"];
    for image in missing {
        fs::remove_file(folder.path().join(image)).unwrap();
    }
    let unreadable = Changed { inner: &chamber, change: second(|_| Err(io::Error::other("chunks/1.bin: ends early"))) };
    for row in complete() {
        let (chunks, names): (&dyn Chunks, &[&str]) = match row.images {
            [] => (&unreadable, &["1.bin"]),
            _ => (&chamber, &missing),
        };
        let out = folder.path().join(row.name);
        let mut package = Folder::create(&out, Existing::Keep).unwrap();
        let target = row.build(json!({}), ledger().as_ref()).unwrap();
        let error = target.export(&Scene { chunks, ..chamber.scene() }, &mut package).unwrap_err();
        assert!(
            names.iter().any(|name| error.to_string().contains(name)),
            "{}: {error}; a target without images says `images: &[]` in its row",
            row.name
        );
        assert!(!error.is_usage());
        drop(package);
        assert!(!out.exists() && !out.with_extension("partial").exists());
    }
}

#[test]
fn a_missing_usd_library_is_reported() {
    for row in complete() {
        let missing = format!(
            "system: target `{}` needs the Python package usd-core, which this program does not have (hint: use the \
             `plume` command of the Python package plume-caves)",
            row.name
        );
        let text = row.build(json!({}), None).err().map(|error| told(&error));
        assert_eq!(text, row.needs_usd().then_some(missing), "{}", row.name);
    }
}

/// Counts how often chunks are loaded.
struct Counted<'a> {
    inner: &'a sample::Chamber,
    loads: AtomicUsize,
}

impl Chunks for Counted<'_> {
    fn len(&self) -> usize {
        self.inner.len()
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        self.loads.fetch_add(1, Ordering::Relaxed);
        self.inner.load(index)
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        self.inner.neighbors(index)
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        self.inner.pieces(index)
    }
}

/// Loading is not free: once, or twice if a format needs all sizes first.
#[test]
fn no_chunk_is_loaded_more_than_twice() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    for row in complete() {
        let counted = Counted { inner: &chamber, loads: AtomicUsize::new(0) };
        let scene = Scene { chunks: &counted, ..chamber.scene() };
        let target = row.build(json!({}), ledger().as_ref()).unwrap();
        target.export(&scene, &mut Memory::default()).unwrap();
        assert!(counted.loads.into_inner() <= 2 * chamber.len(), "{}", row.name);
    }
}

/// For every target that offers convex pieces, or has nothing else.
fn targets_of_pieces() -> impl Iterator<Item = (&'static str, Box<dyn Target>)> {
    let offers = [json!({ "collision": "pieces" }), json!({})];
    complete().filter_map(move |row| {
        let target = offers.iter().find_map(|offer| row.build(offer.clone(), ledger().as_ref()).ok())?;
        target.wants_pieces().then_some((row.name, target))
    })
}

#[test]
fn packages_with_pieces_have_exactly_those_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let scene = chamber.scene();
    let pieces: Vec<Piece> = (0..chamber.len()).flat_map(|index| scene.pieces(index).unwrap()).collect();
    let mut corners: Vec<usize> = pieces.iter().map(|piece| piece.mesh.positions.len()).collect();
    corners.sort_unstable();
    let triangles: u64 = pieces.iter().map(|piece| piece.mesh.triangles()).sum();
    let mut names = Vec::new();
    for (name, target) in targets_of_pieces() {
        let mut package = Memory::default();
        let summary = target.export(&scene, &mut package).unwrap();
        assert_eq!(summary.collision_triangles, triangles, "{name}");
        let mut found = touched(&package);
        found.sort_unstable();
        assert!(
            found == corners,
            "{name}: {} pieces were read back instead of {}; `tests/it/sample/touched.rs` must know the files that hold them",
            found.len(),
            corners.len()
        );
        names.push(name);
    }
    let stated: Vec<&str> = complete().filter(|row| row.has_pieces).map(|row| row.name).collect();
    assert_eq!(names, stated, "`has_pieces` in the rows says which targets write convex pieces");
}

#[test]
fn pieces_are_only_made_on_request_where_there_is_a_choice() {
    let offers =
        |row: &'static TargetRow, other: &str| row.build(json!({ "collision": other }), ledger().as_ref()).is_ok();
    for row in complete().filter(|row| offers(row, "triangles") || offers(row, "none")) {
        assert!(!row.build(json!({}), ledger().as_ref()).unwrap().wants_pieces(), "{}", row.name);
    }
}

/// A disk that is full after some bytes.
struct FullDisk {
    left: usize,
    files: Files,
}

impl Package for FullDisk {
    fn open(&mut self, _: &str) -> io::Result<Box<dyn io::Write + '_>> {
        Ok(Box::new(FullFile(&mut self.left)))
    }

    fn scratch(&mut self) -> io::Result<tempfile::TempDir> {
        tempfile::tempdir()
    }

    fn files(&mut self) -> &mut Files {
        &mut self.files
    }
}

struct FullFile<'a>(&'a mut usize);

impl io::Write for FullFile<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        if *self.0 < buffer.len() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        *self.0 -= buffer.len();
        Ok(buffer.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_reported_with_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    for row in complete() {
        let mut disk = FullDisk { left: 40, files: Files::default() };
        let target = row.build(json!({}), ledger().as_ref()).unwrap();
        let text = told(&target.export(&chamber.scene(), &mut disk).unwrap_err());
        let path = text
            .strip_prefix("system: ")
            .and_then(|text| text.strip_suffix(": no storage space (hint: free some space, or make smaller textures)"));
        let files = export(row.name, &folder).bytes;
        assert!(path.is_some_and(|path| files.contains_key(path)), "{}: {text}", row.name);
    }
}

/// Spoils the second chunk.
fn second(spoil: fn(Chunk) -> io::Result<Chunk>) -> impl Fn(usize, Chunk) -> io::Result<Chunk> {
    move |index, chunk| if index == 1 { spoil(chunk) } else { Ok(chunk) }
}

#[test]
fn an_invalid_scene_is_refused_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let spoilers: [fn(Chunk) -> io::Result<Chunk>; 5] = [
        |_| Err(io::Error::new(io::ErrorKind::InvalidData, "chunks/1.bin: ends early")),
        |chunk| Ok(Chunk { name: "Chunk 1".to_owned(), ..chunk }),
        |mut chunk| {
            chunk.visual.normals.pop();
            Ok(chunk)
        },
        |mut chunk| {
            chunk.collision.indices[0] = 1_000_000;
            Ok(chunk)
        },
        |mut chunk| {
            chunk.visual.positions[0][2] = f32::NAN;
            Ok(chunk)
        },
    ];
    let mut texts = Vec::new();
    for spoil in spoilers {
        let spoiled = Changed { inner: &chamber, change: second(spoil) };
        let scene = Scene { chunks: &spoiled, ..chamber.scene() };
        let mut errors = complete().map(|row| {
            let target = row.build(json!({}), ledger().as_ref()).unwrap();
            target.export(&scene, &mut Memory::default()).unwrap_err().to_string()
        });
        let first = errors.next().unwrap();
        assert!(errors.all(|error| error == first), "targets disagree about {first}");
        texts.push(first);
    }
    insta::assert_snapshot!(texts.join("\n"), @r"
    cannot load chunk 1 of scene `chamber`: chunks/1.bin: ends early
    scene `chamber`: name of chunk `Chunk 1` is not `[a-z][a-z0-9_]*`
    scene `chamber`: visual mesh of chunk `chunk_1_0_0` has a different number of normals, texture coordinates or tangents than vertices
    scene `chamber`: collision mesh of chunk `chunk_1_0_0` has a triangle whose corner is not a vertex
    scene `chamber`: visual mesh of chunk `chunk_1_0_0` has a vertex that is not finite
    ");
}

#[test]
fn webp_images_are_written_or_refused_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let chamber = sample::Chamber::in_webp(folder.path()).unwrap();
    let (scene, place) = (chamber.scene(), folder.path().to_str().unwrap());
    for row in complete().filter(|row| !row.images.is_empty()) {
        let mut package = Memory::default();
        let exported = row.build(json!({}), ledger().as_ref()).unwrap().export(&scene, &mut package);
        if row.images.contains(&ImageFormat::WebP) {
            exported.unwrap();
            assert!(package.bytes.values().any(|bytes| holds(bytes, b"image/webp")), "{}", row.name);
            continue;
        }
        let names: Vec<&str> = row.images.iter().map(|format| format.name()).collect();
        let refused = format!(
            "usage: target `{}` supports only {} images: DIR/0_base_color.webp (hint: make the cave with another image format: \
             `--set texture.format=png`)",
            row.name,
            names.join(" and ")
        );
        assert_eq!(told(&exported.unwrap_err()).replace(place, "DIR"), refused);
    }
}

fn holds(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|window| window == word)
}

#[test]
fn only_targets_that_need_a_format_accept_one() {
    let choice = target("assimp:x3d").unwrap();
    assert_eq!((choice.name(), choice.folder()), ("assimp:x3d".to_owned(), "assimp-x3d".to_owned()));
    assert_eq!(target("glb").unwrap().folder(), "glb");
    for name in ["glb:x3d", "assimpx3d", ":x3d", ""] {
        assert!(matches!(target(name), Err(ExportError::UnknownTarget { .. })), "{name}");
    }
}

/// The workspace denies unsafe code; here is where it is allowed.
#[test]
fn unsafe_code_is_in_one_file() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut found: Vec<String> = ["exporters", "python/src", "src", "tests", "xtask/src"]
        .iter()
        .flat_map(|folder| sources(&root.join(folder)))
        .filter(|path| fs::read_to_string(path).unwrap().contains(&["allow(", "unsafe_code"].concat()))
        .map(|path| path.strip_prefix(root).unwrap().to_str().unwrap().to_owned())
        .collect();
    found.sort();
    assert_eq!(found, ["exporters/targets/assimp/library.rs"]);
    let text = fs::read_to_string(root.join(&found[0])).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    for (number, line) in lines.iter().enumerate().filter(|(_, line)| line.contains("unsafe {")) {
        let reason = lines[number.saturating_sub(4)..number].iter().any(|line| line.contains("// SAFETY:"));
        assert!(reason, "line {}: {line}", number + 1);
    }
}

fn sources(folder: &std::path::Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let below = entries.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    below.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

fn export(name: &str, folder: &tempfile::TempDir) -> Memory {
    let chamber = sample::Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    let target = target(name).unwrap().build(json!({}), ledger().as_ref()).unwrap();
    target.export(&chamber.scene(), &mut memory).unwrap();
    memory
}
