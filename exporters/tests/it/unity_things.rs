//! In a package for Unity, things are instances of prefabs that share models.

use std::collections::BTreeSet;

use crate::strewn::Strewn;
use plume_exporters::place::{Existing, Place};
use plume_exporters::targets::unity::{Unity, UnitySettings};

/// A package in a folder.
fn export(movable: bool) -> (tempfile::TempDir, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let strewn = Strewn::new(folder.path(), movable).unwrap();
    let place = Place { path: folder.path().join("package"), bundle: None, existing: Existing::Keep };
    let (summary, _) = place.write("unity", &Unity(UnitySettings::default()), &strewn.scene()).unwrap();
    assert_eq!(summary.visual_triangles - 12_096, 3 * 12);
    let entries = ["Meshes", "Things"].map(|part| std::fs::read_dir(place.path.join("Runtime").join(part)).unwrap());
    let names = entries.into_iter().flatten().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| !name.ends_with(".meta")).collect();
    names.sort();
    (folder, names)
}

fn text(folder: &tempfile::TempDir, path: &str) -> String {
    std::fs::read_to_string(folder.path().join("package").join(path)).unwrap()
}

#[test]
fn things_share_a_model_and_a_prefab() {
    for (movable, prefab) in [(false, "box_0_level0.prefab"), (true, "box_0_level0_movable.prefab")] {
        let (folder, names) = export(movable);
        assert_eq!(names, ["box_0.fbx", prefab, "chunk_0_0_0.fbx", "chunk_1_0_0.fbx"]);
        let scene = text(&folder, "Runtime/chamber.prefab");
        assert_eq!(scene.matches("\nPrefabInstance:").count(), 3);
        let meta = text(&folder, &format!("Runtime/Things/{prefab}.meta"));
        let guid = meta.lines().find_map(|line| line.strip_prefix("guid: ")).unwrap();
        assert_eq!(scene.matches(&format!("m_SourcePrefab: {{fileID: 100100000, guid: {guid}")).count(), 3);
        let masses = scene.matches("propertyPath: m_Mass").count();
        assert_eq!((masses, scene.contains("Rigidbody")), (if movable { 3 } else { 0 }, false));
        assert_eq!(text(&folder, &format!("Runtime/Things/{prefab}")).contains("Rigidbody"), movable);
        let listed = text(&folder, "instances.json");
        assert_eq!(listed.matches(&format!("\"movable\":{movable}")).count(), 3);
    }
}

#[test]
fn objects_of_a_prefab_with_instances_have_numbers_of_their_own() {
    let (folder, _) = export(true);
    let scene = text(&folder, "Runtime/chamber.prefab");
    let numbers: Vec<&str> = scene
        .lines()
        .filter_map(|line| line.strip_prefix("--- !u!")?.split_once('&'))
        .map(|(_, number)| number.trim_end_matches(" stripped"))
        .collect();
    assert_eq!(numbers.iter().collect::<BTreeSet<_>>().len(), numbers.len());
}
