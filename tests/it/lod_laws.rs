//! The laws of levels of detail, on real caves: every generator in every rock.

use std::collections::BTreeSet;
use std::io;
use std::sync::LazyLock;

use crate::common::chunks;
use crate::common::distance::Distances;
use crate::common::world;
use crate::texture_support::Gradient;
use plume::field::{CaveField, PassageSettings};
use plume::generators::{GENERATORS, GeneratorRow};
use plume::material::{Look, MATERIALS, MaterialRow};
use plume::mesh::measure::{Report, weld};
use plume::mesh::{Mesh, MeshSettings};
use plume::texture::{Level, LodSettings, Maps, TextureSettings, Textured, levels, texture};
use rayon::prelude::*;
use serde_json::json;
use world::{kinds, small};

/// A chunk and its levels.
struct Detailed {
    mesh: Mesh,
    textured: Textured,
    levels: Vec<Level>,
}

impl Detailed {
    fn new(mesh: Mesh, settings: &LodSettings) -> Self {
        let small = TextureSettings { size_px: Some(256), ..TextureSettings::default() };
        let sinks =
            Maps { base_color: io::sink(), normal: io::sink(), orm: io::sink(), roughness: io::sink(), height: None };
        let textured = texture(&mesh, &Gradient { tilt: [0.0; 3] }, &small, sinks).unwrap();
        let levels = levels(&mesh, &textured, settings);
        Self { mesh, textured, levels }
    }

    /// The triangles of a level over the vertices of the chunk's mesh; 0 is full detail.
    fn level(&self, level: usize) -> Mesh {
        let Some(level) = level.checked_sub(1) else { return self.mesh.clone() };
        let source = |copy: u32| self.textured.source[copy as usize];
        let triangles = self.levels[level].triangles.iter().map(|t| t.map(source)).collect();
        Mesh { triangles, ..self.mesh.clone() }
    }
}

fn cave(generator: &GeneratorRow, material: &MaterialRow, seed: u64, chunk_m: f32) -> Vec<Mesh> {
    let graph = small(generator, 10, seed);
    let rock = (material.read)(json!({})).unwrap();
    let field = CaveField::new(&graph, &PassageSettings::default(), rock, Look::default(), seed);
    // Coarser than the default, which takes three times as long.
    let settings =
        MeshSettings { voxel_m: 0.2, simplify_error_m: 0.02, chunk_m: [chunk_m; 3], ..MeshSettings::default() };
    chunks(&field, field.bounds(), &settings).into_iter().map(|chunk| chunk.visual).collect()
}

/// Chunks of caves of every kind, cave by cave, in two sizes by turns.
fn caves(settings: &LodSettings) -> Vec<(String, Vec<Detailed>)> {
    let sized = kinds().into_iter().zip([(1, 8.0), (2, 16.0)].into_iter().cycle());
    let detail = |((g, m), (seed, chunk_m)): ((&GeneratorRow, &MaterialRow), (u64, f32))| {
        let meshes = cave(g, m, seed, chunk_m);
        let chunks = meshes.into_par_iter().map(|mesh| Detailed::new(mesh, settings)).collect();
        (format!("{} in {}, seed {seed}", g.name, m.name), chunks)
    };
    sized.map(detail).collect()
}

fn deep() -> LodSettings {
    LodSettings { levels: 6, reduction: 2.0 }
}

/// Those caves with many levels, made once for all laws of their shape.
static DEEP: LazyLock<Vec<(String, Vec<Detailed>)>> = LazyLock::new(|| caves(&deep()));

#[test]
fn any_mix_of_levels_is_closed_and_keeps_its_handles() {
    for (name, chunks) in &*DEEP {
        let whole: Vec<Mesh> = chunks.iter().map(|chunk| chunk.level(0)).collect();
        let whole = Report::of(&weld(&whole));
        for shift in 0..=deep().levels as usize {
            let mix: Vec<Mesh> = chunks
                .iter()
                .enumerate()
                .map(|(i, chunk)| chunk.level((i * i + shift) % (chunk.levels.len() + 1)))
                .collect();
            let report = Report::of(&weld(&mix));
            assert!(report.is_clean(), "{name}: {report:#?}");
            assert_eq!((report.components, report.genus), (whole.components, whole.genus), "{name}");
        }
    }
}

#[test]
fn every_level_has_fewer_triangles_and_the_same_border() {
    let mut deepest = 0;
    for (name, chunks) in &*DEEP {
        for chunk in chunks {
            for level in 1..=chunk.levels.len() {
                let [before, after] = [level - 1, level].map(|level| chunk.level(level));
                assert!(5 * after.triangles.len() <= 4 * before.triangles.len(), "{name}");
                assert_eq!(border(&before), border(&after), "{name}");
                assert!(border_chords(&after).is_subset(&border_chords(&before)), "{name}: two chunks could add one");
            }
            deepest = deepest.max(chunk.levels.len());
        }
    }
    assert!(deepest >= 3, "{deepest}");
}

/// Border vertices that a triangle uses.
fn border(mesh: &Mesh) -> BTreeSet<u32> {
    mesh.triangles.iter().flatten().copied().filter(|&vertex| mesh.border[vertex as usize]).collect()
}

/// Edges between two border vertices.
fn border_chords(mesh: &Mesh) -> BTreeSet<[u32; 2]> {
    let edges = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let chords = edges.filter(|edge| edge.iter().all(|&vertex| mesh.border[vertex as usize]));
    chords.map(|[a, b]| [a.min(b), a.max(b)]).collect()
}

#[test]
fn every_triangle_lies_in_its_chart_and_faces_the_viewer() {
    for (name, chunks) in &*DEEP {
        for Detailed { textured, levels, .. } in chunks {
            let mut chart_of = vec![u32::MAX; textured.source.len()];
            for (triangle, &chart) in textured.triangles.iter().zip(&textured.charts) {
                triangle.iter().for_each(|&copy| chart_of[copy as usize] = chart);
            }
            for level in levels {
                assert_eq!(level.triangles.len(), level.charts.len());
                for (triangle, &chart) in level.triangles.iter().zip(&level.charts) {
                    assert_eq!(triangle.map(|copy| chart_of[copy as usize]), [chart; 3], "{name}");
                    assert!(uv_area(textured, *triangle) > 0.0, "{name}: {triangle:?}");
                }
            }
        }
    }
}

fn uv_area(textured: &Textured, triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|copy| textured.uvs[copy as usize].map(f64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn the_error_of_a_level_holds_both_ways_and_is_hardly_more_than_that() {
    const SPACING_M: f64 = 0.1;
    let measured = |chunk: &Detailed, level: usize| {
        let (full, coarse) = (chunk.level(0), chunk.level(level));
        let reach_m = 1.5 * f64::from(chunk.levels[level - 1].error_m);
        let [there, back] = [(&full, &coarse), (&coarse, &full)]
            .map(|(from, to)| Distances::between(from, to, SPACING_M, reach_m).greatest());
        there.max(back)
    };
    for (name, chunks) in caves(&LodSettings { levels: 2, ..LodSettings::default() }) {
        chunks.par_iter().for_each(|chunk| {
            for level in 1..=chunk.levels.len() {
                let (error_m, found_m) = (f64::from(chunk.levels[level - 1].error_m), measured(chunk, level));
                assert!(found_m <= error_m, "{name}: {found_m} found, {error_m} claimed");
                assert!(error_m <= 1.05 * (found_m + 0.6 * SPACING_M) + 0.001, "{name}: {found_m}, not {error_m}");
            }
        });
    }
}

#[test]
fn no_levels_are_made_of_nothing_or_when_none_are_wanted() {
    let made = |mesh: Mesh, levels| Detailed::new(mesh, &LodSettings { levels, ..LodSettings::default() }).levels;
    assert!(made(Mesh::default(), 3).is_empty());
    let mesh = cave(GENERATORS.default_row(), MATERIALS.default_row(), 1, 16.0).swap_remove(0);
    assert!(made(mesh, 0).is_empty());
}
