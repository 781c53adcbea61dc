//! Levels of detail of glTF, as found by a reader of MSFT_lod.

use std::f64::consts::PI;

use gltf::{Document, Node};
use plume_exporters::frame::gltf_from_scene;
use plume_exporters::scene::Chunks;
use serde_json::Value;

use crate::sample::Chamber;

/// A coarser level.
pub struct Level {
    chunk: String,
    node: String,
    error_m: f64,
    /// Screen coverage below which it takes over.
    coverage: f64,
    positions: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

/// The levels to which nodes of the scene refer.
pub fn of<'a>(document: &Document, data: impl Fn(gltf::Buffer<'_>) -> Option<&'a [u8]> + Clone) -> Vec<Level> {
    let scene: Vec<usize> = document.default_scene().unwrap().nodes().map(|node| node.index()).collect();
    let mut levels = Vec::new();
    for node in document.nodes().filter(|node| node.extension_value("MSFT_lod").is_some()) {
        let ids = node.extension_value("MSFT_lod").unwrap()["ids"].as_array().unwrap().clone();
        let coverage = extras(&node)["MSFT_screencoverage"].as_array().unwrap().clone();
        assert_eq!(coverage.len(), 1 + ids.len());
        assert_eq!((extras(&node)["error_m"].as_f64(), coverage.last().unwrap().as_f64()), (Some(0.0), Some(0.0)));
        for (id, coverage) in ids.iter().zip(&coverage) {
            let level = document.nodes().nth(id.as_u64().unwrap() as usize).unwrap();
            assert!(scene.contains(&node.index()) && !scene.contains(&level.index()));
            let material = |node: &Node| node.mesh().unwrap().primitives().next().unwrap().material().index();
            assert_eq!(material(&node), material(&level));
            let mesh = level.mesh().unwrap();
            let primitive = mesh.primitives().next().unwrap();
            let reader = primitive.reader(data.clone());
            assert!(reader.read_normals().is_some() && reader.read_tangents().is_some());
            levels.push(Level {
                chunk: node.name().unwrap().to_owned(),
                node: level.name().unwrap().to_owned(),
                error_m: extras(&level)["error_m"].as_f64().unwrap(),
                coverage: coverage.as_f64().unwrap(),
                positions: reader.read_positions().unwrap().collect(),
                indices: reader.read_indices().unwrap().into_u32().collect(),
            });
        }
    }
    levels
}

/// Compares with the scene.
pub fn check(levels: &[Level], chamber: &Chamber) {
    let mut found = levels.iter();
    for index in 0..chamber.len() {
        let chunk = chamber.load(index).unwrap();
        for (number, lod) in (1..).zip(&chunk.lods) {
            let level = found.next().unwrap();
            assert_eq!([&level.chunk, &level.node], [&chunk.name, &format!("{}_LOD{number}", chunk.name)]);
            assert!(level.positions.iter().copied().eq(lod.mesh.positions.iter().copied().map(gltf_from_scene)));
            assert!(level.indices == lod.mesh.indices);
            assert!((level.error_m - f64::from(lod.error_m)).abs() < 1e-6);
            let [min, max] = chunk.visual.bounds();
            let edges = [0, 1, 2].map(|axis| f64::from(max[axis] - min[axis]));
            let radius_squared = edges.iter().map(|edge| edge * edge).sum::<f64>() / 4.0;
            let pixels = PI * radius_squared / (level.error_m * level.error_m);
            assert!((level.coverage - (pixels / (1920.0 * 1080.0)).min(1.0)).abs() < 1e-4);
        }
    }
    assert!(found.next().is_none() && !levels.is_empty());
}

fn extras(node: &Node) -> Value {
    serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap()
}
