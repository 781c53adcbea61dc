//! Destinations of packages: what is refused, what is replaced, and which paths a package may contain.

use std::fs;

use crate::told;
use plume_exporters::package::{MANIFEST, Memory, Package};
use plume_exporters::place::{Existing, Folder};
use plume_exporters::target;

use told::told;

#[test]
fn output_folders_are_refused_with_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap().to_owned();
    fs::create_dir(folder.path().join("home")).unwrap();
    fs::write(folder.path().join("home/letter.txt"), "dear").unwrap();
    let refused = [
        Folder::create(&folder.path().join("home"), Existing::Keep).unwrap_err(),
        Folder::create(&folder.path().join("home/"), Existing::Replace).unwrap_err(),
        Folder::create(&folder.path().join("home/letter.txt"), Existing::Replace).unwrap_err(),
        Folder::create(&folder.path().join("home/letter.txt/cave"), Existing::Keep).unwrap_err(),
        target("gazebi").err().unwrap(),
    ];
    let texts: Vec<String> = refused.iter().map(|error| told(error).replace(&place, "DIR")).collect();
    insta::assert_snapshot!(texts.join("\n"), @r"
    usage: output folder is not empty: DIR/home (hint: choose a new folder, or replace the package with `--force`)
    usage: output was not written by an export and is not replaced: DIR/home/ (hint: choose another path, or remove this one yourself)
    usage: output is not a folder: DIR/home/letter.txt
    system: DIR/home/letter.txt/cave: Not a directory (os error 20)
    usage: unknown target `gazebi`; known targets are gazebo, isaac, mujoco, unity, unreal, urdf, usd, usdz, glb, gltf, tiles, fbx, obj, ply, stl, assimp:<id>, truth
    ");
    assert_eq!(fs::read(folder.path().join("home/letter.txt")).unwrap(), b"dear");
}

#[test]
fn only_a_package_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("cave");
    let of_first_format = "{\"old.txt\": {\"bytes\": 3, \"sha256\": \"0\"}}";
    let of_tomorrow = "{\"format\": 9, \"generator\": \"plume 9\", \"target\": \"gltf\", \"more\": 1, \
                       \"files\": {\"new.txt\": {\"bytes\": 3, \"sha256\": \"0\"}}}";
    for (text, manifest) in [("old", of_first_format), ("new", of_tomorrow), ("newest", of_tomorrow)] {
        let mut package = Folder::create(&out, Existing::Replace).unwrap();
        let sink: &mut dyn Package = &mut package;
        sink.text(&format!("{text}.txt"), text).unwrap();
        sink.text(MANIFEST, manifest).unwrap();
        package.finish().unwrap();
    }
    assert!(out.join("newest.txt").exists());
    assert_eq!(fs::read_dir(&out).unwrap().count(), 2);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A file of one package must not stay as one of the user's in the next.
#[test]
fn runs_that_replace_a_package_at_once_leave_a_whole_one() {
    const RUNS: usize = 8;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("cave");
    let replace = |text: &str| {
        let mut package = Folder::create(&out, Existing::Replace).unwrap();
        let sink: &mut dyn Package = &mut package;
        sink.text(&format!("{text}.txt"), text).unwrap();
        sink.text(MANIFEST, &format!("{{\"{text}.txt\": {{\"bytes\": 1, \"sha256\": \"0\"}}}}")).unwrap();
        package.finish().unwrap();
    };
    replace("first");
    std::thread::scope(|scope| {
        (0..RUNS).for_each(|run| drop(scope.spawn(move || (0..60).for_each(|_| replace(&run.to_string())))));
    });
    assert_eq!(fs::read_dir(&out).unwrap().count(), 2);
}

#[test]
fn paths_with_dots_and_links_are_resolved() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("real/cave")).unwrap();
    let out = folder.path().join("real/../real/./cave/");
    let mut package = Folder::create(&out, Existing::Keep).unwrap();
    let sink: &mut dyn Package = &mut package;
    sink.text("a.txt", "a").unwrap();
    package.finish().unwrap();
    assert!(folder.path().join("real/cave/a.txt").exists());
    assert_eq!(fs::read_dir(folder.path().join("real")).unwrap().count(), 1);
}

#[test]
fn paths_cannot_leave_the_package() {
    let mut memory = Memory::default();
    let sink: &mut dyn Package = &mut memory;
    sink.text("a/b.txt", "").unwrap();
    let bad = ["/etc/passwd", "../up", "a/../../up", "a//b", "c:\\d", "a/b.txt", "."];
    let texts: Vec<String> = bad.iter().map(|path| sink.text(path, "").unwrap_err().to_string()).collect();
    insta::assert_snapshot!(texts.join("\n"), @r"
    package path is not relative with forward slashes: `/etc/passwd`
    package path has an empty, `.` or `..` part: `../up`
    package path has an empty, `.` or `..` part: `a/../../up`
    package path has an empty, `.` or `..` part: `a//b`
    package path is not relative with forward slashes: `c:\d`
    package path is written twice: `a/b.txt`
    package path has an empty, `.` or `..` part: `.`
    ");
}
