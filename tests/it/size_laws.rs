//! The size of a cave, estimated from its graph, against that of the folder.

use std::fs;
use std::path::Path;

use plume::cave::{Cave, CaveError, Input};
use plume::pipeline::{Disk, Needs, Unobserved};
use plume::recipe::Recipe;
use plume::store::CaveFolder;

fn make(recipe: Option<&Path>, settings: &[&str], folder: &Path) -> Result<Cave, CaveError> {
    let settings: Vec<String> = settings.iter().map(|&pair| pair.to_owned()).collect();
    let input = Input::read(recipe, &settings, Disk::default())?;
    Cave::make(input, CaveFolder::open_or_new(folder)?, false, &Unobserved::default(), &mut |_, _| ())
}

/// Names and sizes of the files in these folders of a cave.
fn files(cave: &Path, folders: &[&str]) -> Vec<(String, u64)> {
    let entries = folders.iter().flat_map(|folder| fs::read_dir(cave.join(folder)).unwrap()).map(Result::unwrap);
    let mut files: Vec<_> =
        entries.map(|entry| (entry.file_name().into_string().unwrap(), entry.metadata().unwrap().len())).collect();
    files.sort();
    files
}

/// Estimated relative to real: meshes, maps, chunks.
fn ratios(recipe: &Path, settings: &[&str]) -> [f64; 3] {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("cave");
    let cave = make(Some(recipe), settings, &root).unwrap();
    let needs = Needs::estimate(cave.recipe(), cave.graph());
    let is_mesh = |name: &str| name.ends_with(".ply");
    let all = files(&root, &["chunks", "collision", "textures"]);
    let bytes = |of_mesh| all.iter().filter(|file| is_mesh(&file.0) == of_mesh).map(|file| file.1).sum::<u64>() as f64;
    let chunks = all.iter().filter(|file| file.0.contains("_normal.")).count();
    [needs.mesh_bytes / bytes(true), needs.map_bytes / bytes(false), needs.chunks as f64 / chunks as f64]
}

#[test]
fn sizes_are_estimated_within_a_factor_of_two() {
    let coarse = ["mesh.voxel_m=0.5", "texture.density_px_per_m=20"];
    let sized = ["mesh.voxel_m=0.5", "texture.size_px=512", "graph.nodes=20"];
    let png = ["mesh.voxel_m=0.5", "texture.density_px_per_m=20", "texture.format=png", "graph.nodes=20"];
    let cases: [(&str, &[&str]); 6] = [
        ("cave", &coarse),
        ("cave", &sized),
        ("cave", &png),
        ("lava-tube", &coarse),
        ("mine", &coarse),
        ("original", &coarse),
    ];
    for (sample, settings) in cases {
        let ratios = ratios(Path::new(&format!("samples/{sample}.toml")), settings);
        let is_near = |ratio: &f64| (0.5..2.0).contains(ratio);
        assert!(ratios.iter().all(is_near), "{sample} {settings:?}: {ratios:.2?}");
    }
}

#[test]
fn too_large_a_cave_is_refused_before_work() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("cave");
    let told = |settings: &[&str]| {
        let error = make(None, &[&["graph.nodes=800"], settings].concat(), &root).err().unwrap();
        format!("{error}\n hint: {}\n", error.hint())
    };
    let texts = [
        told(&["texture.density_px_per_m=500", "output.max_gb=2"]),
        told(&["texture.size_px=16384", "output.max_gb=2"]),
        told(&["mesh.voxel_m=0.05", "texture.density_px_per_m=80", "output.max_gb=0.01"]),
    ];
    insta::assert_snapshot!(texts.concat(), @r"
    meshes with voxels of 0.12 m and textures of 500 px/m on about 22,000 m² of wall need about 18 GB on the disk, but the limit is 2 GB
     hint: lower texture.density_px_per_m to 155, or raise output.max_gb
    meshes with voxels of 0.12 m and textures of 16384 px in about 100 chunks on about 22,000 m² of wall need about 64 GB on the disk, but the limit is 2 GB
     hint: lower texture.size_px to 2858, or raise output.max_gb
    meshes with voxels of 0.05 m and textures of 80 px/m on about 22,000 m² of wall need about 0.68 GB on the disk, but the limit is 0.01 GB
     hint: raise mesh.voxel_m, make a smaller cave, or raise output.max_gb
    ");
    assert!(!root.join("cave.toml").exists());
}

#[test]
fn an_ephemeral_folder_has_no_maps_and_the_same_chunks() {
    let input =
        || Input::of(Recipe::from_overrides(&["graph.nodes=3".to_owned(), "mesh.voxel_m=0.5".to_owned()]).unwrap());
    let home = tempfile::tempdir().unwrap();
    let [kept, passing] = ["kept", "passing"].map(|name| home.path().join(name));
    let make = |folder| Cave::make(input(), folder, false, &Unobserved::default(), &mut |_, _| ()).unwrap();
    make(CaveFolder::open_or_new(&kept).unwrap());
    make(CaveFolder::open_or_new(&passing).unwrap().ephemeral());
    let maps = |root: &Path| ["plan.png", "profile.png"].map(|map| root.join(map).exists());
    assert_eq!((maps(&kept), maps(&passing)), ([true; 2], [false; 2]));
    let chunks = ["chunks", "collision", "textures"];
    assert_eq!(files(&kept, &chunks), files(&passing, &chunks));
}
