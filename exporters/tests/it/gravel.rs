//! Gravel is drawn in every target, nothing collides with it, and the manifest counts its stones.

use std::io;
use std::path::Path;

use crate::ledger::{complete, ledger};
use crate::sample::Chamber;
use crate::told::told;
use crate::touched::touched;
use nalgebra::Isometry3;
use plume_exporters::manifest::Manifest;
use plume_exporters::package::{MANIFEST, Memory};
use plume_exporters::place;
use plume_exporters::scene::{Chunk, Chunks, Content, Gravel, Lod, Mesh, Piece, Scene, Stone};
use serde_json::json;

/// Where the two stones are along x, in metres.
const PLACES_M: [f32; 2] = [0.0, 1.0];

/// The chamber and, if wanted, gravel in it as the last chunk.
struct Strewn {
    chamber: Chamber,
    gravel: Option<Gravel>,
}

impl Strewn {
    fn new(folder: &Path, has_gravel: bool) -> Self {
        let stone = |x: &f32| Stone { shape: 0, pose: Isometry3::translation(f64::from(*x), 0.0, 0.0), scale: 1.0 };
        let stones = PLACES_M.iter().map(stone).collect();
        let gravel = Gravel { shapes: vec![tetrahedra(&PLACES_M[..1])], stones, shown: vec![2, 1] };
        Self { chamber: Chamber::new(folder).unwrap(), gravel: has_gravel.then_some(gravel) }
    }

    fn scene(&self) -> Scene<'_> {
        Scene { chunks: self, ..self.chamber.scene() }
    }
}

impl Chunks for Strewn {
    fn len(&self) -> usize {
        self.chamber.len() + usize::from(self.gravel.is_some())
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        if index < self.chamber.len() {
            return self.chamber.load(index);
        }
        Ok(Chunk {
            name: "gravel_0_0_0".to_owned(),
            content: Content::Gravel { stones: 2 },
            visual: tetrahedra(&PLACES_M),
            lods: vec![Lod { mesh: tetrahedra(&PLACES_M[..1]), error_m: 0.1 }],
            collision: Mesh::default(),
            material: self.chamber.load(0)?.material,
        })
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        if index < self.chamber.len() { self.chamber.neighbors(index) } else { Vec::new() }
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        if index < self.chamber.len() { self.chamber.pieces(index) } else { Ok(Vec::new()) }
    }

    fn gravel(&self, index: usize) -> io::Result<Gravel> {
        let own = self.gravel.clone().filter(|_| index >= self.chamber.len());
        Ok(own.unwrap_or_default())
    }
}

/// A tetrahedron at each place.
fn tetrahedra(places_m: &[f32]) -> Mesh {
    const CORNERS: [[f32; 3]; 4] = [[0.1, 0.1, 0.1], [-0.1, -0.1, 0.1], [-0.1, 0.1, -0.1], [0.1, -0.1, -0.1]];
    let mut mesh = Mesh::default();
    for x_m in places_m {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(CORNERS.map(|[x, y, z]| [x + x_m, y, z - 1.0]));
        mesh.normals.extend(CORNERS.map(|corner| corner.map(|c| c / 0.1 / 3.0_f32.sqrt())));
        mesh.uvs.extend(CORNERS.map(|[x, y, _]| [0.5 + x, 0.5 + y]));
        mesh.tangents.extend([[1.0, 0.0, 0.0, 1.0]; 4]);
        mesh.indices.extend([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3].map(|corner| corner + first));
    }
    mesh
}

/// Every kind of collision shape that some target offers.
const COLLISIONS: [&str; 5] = ["none", "triangles", "pieces", "flex", "floor_field"];

#[test]
fn gravel_is_drawn_and_not_collided_with_in_every_target() {
    let folder = tempfile::tempdir().unwrap();
    let [bare, strewn] = [false, true].map(|has_gravel| Strewn::new(folder.path(), has_gravel));
    let mut seen = 0;
    for row in complete() {
        let offers = COLLISIONS.map(|name| json!({ "collision": name }));
        for settings in [json!({}), json!({ "per_chunk": true })].into_iter().chain(offers) {
            let Ok(target) = row.build(settings.clone(), ledger().as_ref()) else { continue };
            let at = format!("{} with {settings}", row.name);
            let export = |scene: &Scene| {
                let mut memory = Memory::default();
                let summary = place::fill(row.name, &*target, scene, &mut memory)
                    .unwrap_or_else(|error| panic!("{at}: {}", told(&error)));
                (summary, memory)
            };
            let [(without, before), (with, after)] = [&bare, &strewn].map(|world| export(&world.scene()));
            assert_eq!(with.visual_triangles, without.visual_triangles + 8, "{at}");
            assert_eq!(with.collision_triangles, without.collision_triangles, "{at}");
            let [mut touched_before, mut touched_after] = [touched(&before), touched(&after)];
            touched_before.sort_unstable();
            touched_after.sort_unstable();
            assert_eq!(touched_after, touched_before, "{at}");
            let manifest = Manifest::from_text(&after.bytes[MANIFEST]).unwrap();
            let entry = manifest.chunks.last().unwrap();
            assert_eq!((entry.gravel, entry.collision_triangles), (Some(2), 0), "{at}");
            assert!(manifest.things.is_none() && !after.bytes.contains_key("instances.json"), "{at}");
            seen += 1;
        }
    }
    assert!(seen > 20, "only {seen} kinds of packages");
}

#[test]
fn a_stone_without_its_shape_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut strewn = Strewn::new(folder.path(), true);
    strewn.gravel.as_mut().unwrap().stones[1].shape = 1;
    let index = strewn.chamber.len();
    let error = strewn.scene().gravel(index).unwrap_err();
    let expected = format!("a shape of the gravel of chunk {index} is missing");
    assert!(told(&error).contains(&expected), "{}", told(&error));
}
