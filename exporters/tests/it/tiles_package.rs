//! A package of 3D Tiles has every level of every chunk bit for bit, with images that get smaller.

use crate::sample::Chamber;
use plume_exporters::frame::gltf_from_scene;
use plume_exporters::package::Memory;
use plume_exporters::scene::Chunks;
use plume_exporters::target;
use serde_json::{Value, json};

fn export() -> (Memory, Chamber, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let chamber = Chamber::new(folder.path()).unwrap();
    let mut memory = Memory::default();
    target("tiles").unwrap().build(json!({}), None).unwrap().export(&chamber.scene(), &mut memory).unwrap();
    (memory, chamber, folder)
}

fn read(memory: &Memory, path: &str) -> Value {
    serde_json::from_slice(&memory.bytes[path]).unwrap()
}

/// The tiles of a chunk with their errors, the coarsest first.
fn chain(tile: &Value) -> Vec<(String, f64)> {
    let uri = tile["content"]["uri"].as_str().unwrap().to_owned();
    let below = tile["children"].as_array().into_iter().flatten().flat_map(chain);
    std::iter::once((uri, tile["geometricError"].as_f64().unwrap())).chain(below).collect()
}

#[test]
fn every_level_of_every_chunk_is_a_tile_bit_for_bit() {
    let (memory, chamber, _folder) = export();
    let whole = read(&memory, "tileset.json");
    assert_eq!(whole["extras"]["recipe"], chamber.scene().recipe);
    assert_eq!(whole["root"]["content"]["uri"], "tiles/region_0.json");
    let region = read(&memory, "tiles/region_0.json");
    assert_eq!(region["root"]["boundingVolume"], whole["root"]["boundingVolume"]);
    let mut chains: Vec<_> = region["root"]["children"].as_array().unwrap().iter().map(chain).collect();
    chains.sort_by(|a, b| a[0].0.cmp(&b[0].0));
    assert_eq!(chains.len(), chamber.len());
    for (index, mut tiles) in chains.into_iter().enumerate() {
        let chunk = chamber.load(index).unwrap();
        tiles.reverse();
        assert_eq!(tiles.len(), 1 + chunk.lods.len());
        assert!(tiles.is_sorted_by(|(_, finer), (_, coarser)| finer < coarser), "{tiles:?}");
        for (number, ((mesh, error_m), (uri, told_m))) in chunk.levels().zip(&tiles).enumerate() {
            assert_eq!(uri, &format!("{}_LOD{number}.glb", chunk.name));
            assert!(*told_m >= f64::from(error_m));
            let tile = gltf::Gltf::from_slice(&memory.bytes[&format!("tiles/{uri}")]).unwrap();
            let primitive = tile.meshes().next().unwrap().primitives().next().unwrap();
            let reader = primitive.reader(|_| tile.blob.as_deref());
            assert!(reader.read_positions().unwrap().eq(mesh.positions.iter().map(|&p| gltf_from_scene(p))));
            assert!(reader.read_indices().unwrap().into_u32().eq(mesh.indices.iter().copied()));
        }
    }
}

#[test]
fn images_halve_from_level_to_level() {
    let (memory, chamber, _folder) = export();
    let chunk = chamber.load(0).unwrap();
    for role in ["base_color", "normal", "orm"] {
        let sides: Vec<[u32; 2]> = (0..=chunk.lods.len())
            .map(|number| {
                let tile =
                    gltf::Gltf::from_slice(&memory.bytes[&format!("tiles/{}_LOD{number}.glb", chunk.name)]).unwrap();
                let uris: Vec<_> = tile
                    .images()
                    .map(|image| match image.source() {
                        gltf::image::Source::Uri { uri, .. } => uri.to_owned(),
                        gltf::image::Source::View { .. } => panic!("an image is embedded"),
                    })
                    .collect();
                let uri = uris.iter().find(|uri| uri.ends_with(&format!("_{role}.png"))).unwrap();
                let image = image::load_from_memory(&memory.bytes[&format!("tiles/{uri}")]).unwrap();
                [image.width(), image.height()]
            })
            .collect();
        assert!(sides.len() > 1);
        assert!(sides.windows(2).all(|pair| pair[0].map(|side| side / 2) == pair[1]), "{role}: {sides:?}");
    }
}
