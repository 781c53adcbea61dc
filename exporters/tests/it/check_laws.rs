//! A package of any target passes the check, as a folder and as every kind of archive; no damaged one does.

use std::fs;
use std::path::{Path, PathBuf};

use crate::ledger;
use crate::sample;
use plume_exporters::bundle::Bundle;
use plume_exporters::check::{Report, check};
use plume_exporters::frame::Axes;
use plume_exporters::manifest::{FORMAT, Manifest};
use plume_exporters::package::{Entry, MANIFEST};
use plume_exporters::place::Existing;
use plume_exporters::place::{LICENSE, Place};
use plume_exporters::{ExportError, TargetRow};
use serde_json::json;
use sha2::{Digest, Sha256};
use tempfile::TempDir;

use ledger::{complete, ledger};

/// A table with the sample on it.
struct Desk {
    folder: TempDir,
    chamber: sample::Chamber,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let chamber = sample::Chamber::new(folder.path()).unwrap();
        Self { folder, chamber }
    }

    /// Writes the sample for a target, and returns its path.
    fn write(&self, row: &'static TargetRow, bundle: Option<Bundle>) -> Result<PathBuf, ExportError> {
        let folder = self.folder.path().join(row.name);
        let path = bundle.map_or(folder.clone(), |bundle| bundle.file(&folder));
        let place = Place { path: path.clone(), bundle, existing: Existing::Replace };
        let target = row.build(json!({}), ledger().as_ref()).unwrap();
        place.write(row.name, &*target, &self.chamber.scene()).map(|_| path)
    }

    fn package(&self, row: &'static TargetRow) -> PathBuf {
        self.write(row, None).unwrap()
    }
}

/// The faults, a line each.
fn told(report: &Report) -> String {
    report.faults.iter().map(|fault| format!("{}: {}\n", fault.path, fault.what)).collect()
}

fn faults(package: &Path) -> String {
    told(&check(package).unwrap())
}

fn manifest(package: &Path) -> Manifest {
    Manifest::from_text(&fs::read(package.join(MANIFEST)).unwrap()).unwrap()
}

/// Updates the manifest for changed files.
fn amend(package: &Path, change: impl FnOnce(&mut Manifest)) {
    let mut manifest = manifest(package);
    change(&mut manifest);
    fs::write(package.join(MANIFEST), manifest.to_text().unwrap()).unwrap();
}

fn entry(bytes: &[u8]) -> Entry {
    let sha256 = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Entry { bytes: bytes.len() as u64, sha256, source: None }
}

#[test]
fn every_package_is_intact() {
    let desk = Desk::new();
    for row in complete() {
        for bundle in std::iter::once(None).chain(Bundle::ALL.map(Some)) {
            let package = desk.write(row, bundle).unwrap();
            let report = check(&package).unwrap();
            assert!(report.is_whole(), "{package:?}\n{}", told(&report));
            assert_eq!((&*report.target, &*report.generator), (row.name, "plume test"));
        }
    }
}

#[test]
fn a_manifest_tells_where_everything_is() {
    let desk = Desk::new();
    for row in complete() {
        let package = desk.package(row);
        let manifest = manifest(&package);
        let scene = desk.chamber.scene();
        assert_eq!((manifest.format, &*manifest.target, manifest.seed), (FORMAT, row.name, 7));
        assert_eq!((manifest.recipe, manifest.axes.manifest), (scene.recipe.clone(), Axes::SCENE));
        assert_eq!(manifest.spawns[0].position, <[f64; 3]>::from(scene.spawns[0].translation.vector));
        let [west, east] = &manifest.chunks[..] else { panic!("{}: two chunks", row.name) };
        assert_eq!((&west.neighbors[..], &east.neighbors[..]), (&[east.name.clone()][..], &[west.name.clone()][..]));
        let chunk = scene.chunk(0).unwrap();
        assert_eq!((west.triangles, west.lods[0].error_m), (chunk.visual.triangles(), chunk.lods[0].error_m));
        assert_eq!((west.bounds.min, manifest.bounds.max), (chunk.visual.bounds()[0], east.bounds.max));
        for (role, path) in west.textures.iter().chain(&east.textures) {
            assert!(path.ends_with(&format!("_{role}.png")) && manifest.files.0.contains_key(path), "{path}");
        }
        assert!(manifest.files.0.contains_key(LICENSE));
    }
}

#[test]
fn a_flipped_byte_is_found() {
    let desk = Desk::new();
    for row in complete() {
        let package = desk.package(row);
        let files = manifest(&package).files;
        for (number, path) in files.0.keys().map(String::as_str).chain([MANIFEST]).enumerate() {
            let whole = fs::read(package.join(path)).unwrap();
            let at = [0, whole.len() / 2, whole.len() - 1][number % 3];
            let mut spoiled = whole.clone();
            spoiled[at] ^= 1;
            fs::write(package.join(path), spoiled).unwrap();
            let found = check(&package).map_or_else(|error| error.to_string(), |report| told(&report));
            assert!(found.contains(path) || found.contains("manifest"), "{}/{path} at {at}: {found}", row.name);
            fs::write(package.join(path), whole).unwrap();
        }
        assert_eq!(faults(&package), "");
    }
}

#[test]
fn missing_and_extra_files_are_found() {
    let desk = Desk::new();
    for row in complete() {
        let package = desk.package(row);
        for path in manifest(&package).files.0.keys() {
            let aside = desk.folder.path().join("aside");
            fs::rename(package.join(path), &aside).unwrap();
            // Files that refer to the GUID of the missing one are reported too.
            assert!(faults(&package).contains(&format!("{path}: is missing\n")), "{}/{path}", row.name);
            fs::rename(&aside, package.join(path)).unwrap();
        }
        fs::create_dir(package.join("more")).unwrap();
        fs::write(package.join("more/virus.exe"), "MZ").unwrap();
        assert_eq!(faults(&package), "more/virus.exe: is not in the manifest\n");
    }
}

/// Referenced files are renamed, as a user might do, with a matching manifest.
#[test]
fn a_dangling_reference_is_found() {
    let desk = Desk::new();
    for row in complete() {
        let package = desk.package(row);
        let is_named = |path: &&String| [".png", ".glb", ".usdc", ".msh", ".mtl"].iter().any(|end| path.ends_with(end));
        let mut renamed = 0;
        for path in manifest(&package).files.0.keys().filter(is_named) {
            let other = path.replace("chunk_", "chunky_").replace("chamber.", "chambers.").replace("map_", "maps_");
            rename(&package, path, &other);
            let found = faults(&package);
            assert!(found.contains("which does not exist"), "{}: {path}: {found}", row.name);
            rename(&package, &other, path);
            renamed += 1;
        }
        assert_eq!(faults(&package), "");
        assert_eq!(
            renamed == 0,
            row.is_single_file,
            "{}: {renamed} files are named by others, as far as `is_named` knows; `is_single_file` in the row says whether \
             there are any",
            row.name
        );
    }
}

fn rename(package: &Path, from: &str, to: &str) {
    fs::rename(package.join(from), package.join(to)).unwrap();
    amend(package, |manifest| {
        let entry = manifest.files.0.remove(from).unwrap();
        manifest.files.0.insert(to.to_owned(), entry);
        for path in manifest.chunks.iter_mut().flat_map(|chunk| chunk.textures.values_mut()) {
            *path = path.replace(from, to);
        }
    });
}

#[test]
fn a_reference_inside_an_archive_stays_in_it() {
    let desk = Desk::new();
    let row = plume_exporters::target("usdz").unwrap().row;
    let package = desk.package(row);
    let path = package.join("chamber.usdz");
    let text = fs::read(&path).unwrap();
    let name = b"chunks/textures/chunk_0_0_0_base_color.png";
    let mut spoiled = text.clone();
    for at in (0..text.len() - name.len()).filter(|&at| text[at..].starts_with(name)) {
        spoiled[at + name.len() - 5] = b'u';
    }
    assert_ne!(spoiled, text);
    fs::write(&path, &spoiled).unwrap();
    amend(&package, |manifest| *manifest.files.0.get_mut("chamber.usdz").unwrap() = entry(&spoiled));
    insta::assert_snapshot!(faults(&package), @"chamber.usdz/chunks/chunk_0_0_0.usdc: refers to `./textures/chunk_0_0_0_base_color.png`, which does not exist");
}

#[test]
fn a_file_with_the_wrong_format_is_found() {
    let desk = Desk::new();
    for row in complete() {
        let package = desk.package(row);
        for path in manifest(&package).files.0.keys().filter(|path| !path.ends_with(".txt")) {
            let whole = fs::read(package.join(path)).unwrap();
            let cut = [&whole[..whole.len() / 2], b"\xff"].concat();
            fs::write(package.join(path), &cut).unwrap();
            amend(&package, |manifest| drop(manifest.files.0.insert(path.clone(), entry(&cut))));
            let told = faults(&package);
            // Files that refer to the GUID of a broken file, or need more of a buffer than there is, are reported too.
            assert!(
                told.contains(path.as_str()),
                "{}/{path}: {told}; every extension needs a row in `READERS` of `check/readers.rs`",
                row.name
            );
            fs::write(package.join(path), &whole).unwrap();
            amend(&package, |manifest| drop(manifest.files.0.insert(path.clone(), entry(&whole))));
        }
        assert_eq!(faults(&package), "");
    }
}

#[test]
fn the_same_scene_gives_the_same_archive() {
    let desk = Desk::new();
    for row in complete() {
        for bundle in Bundle::ALL {
            let [first, again] = [(); 2].map(|()| fs::read(desk.write(row, Some(bundle)).unwrap()).unwrap());
            assert!(first == again, "{} {}", row.name, bundle.name());
        }
    }
}

/// The manifest does not cover the headers of a tar and the gaps between its files; gzip always has a checksum.
#[test]
fn a_zstd_archive_has_a_checksum_of_its_whole_content() {
    let desk = Desk::new();
    let path = desk.write(plume_exporters::target("obj").unwrap().row, Some(Bundle::TarZst)).unwrap();
    let mut archive = fs::read(&path).unwrap();
    // The flag of the frame header: RFC 8878, 3.1.1.1.1.5.
    assert_eq!(archive[4] >> 2 & 1, 1);
    *archive.last_mut().unwrap() ^= 1;
    fs::write(&path, &archive).unwrap();
    assert!(!check(&path).unwrap().is_whole());
}

#[cfg(unix)]
#[test]
fn a_link_under_a_temporary_name_is_not_followed() {
    let desk = Desk::new();
    let row = plume_exporters::target("gazebo").unwrap().row;
    let victim = desk.folder.path().join("victim");
    fs::write(&victim, "dear").unwrap();
    for bundle in Bundle::ALL {
        let path = bundle.file(&desk.folder.path().join("packed"));
        let partial = path.with_file_name(format!("packed.{}.partial", bundle.name()));
        std::os::unix::fs::symlink(&victim, &partial).unwrap();
        let place = Place { path: path.clone(), bundle: Some(bundle), existing: Existing::Keep };
        let target = row.build(json!({}), None).unwrap();
        place.write(row.name, &*target, &desk.chamber.scene()).unwrap();
        assert!(path.is_file() && partial.is_symlink());
    }
    assert_eq!(fs::read(victim).unwrap(), b"dear");
}
