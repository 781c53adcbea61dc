//! The laws of models of the user, which are things like all others.

use std::fs;
use std::sync::{Arc, LazyLock};

use nalgebra::Vector3;
use plume::field::Surface;
use plume::mesh::Mesh;
use plume::mesh::measure::Report;
use plume::model::{Format, ModelError};
use plume::things::{FileSettings, Kinds, Library, Replica, Shelf, Thing};

use super::{Cave, assert_have_own_identities, assert_the_corridor_is_free, shelf};
use crate::common::assert_whole;
use crate::common::distance::corners;
use crate::common::world::small;

const WANTED: u32 = 9;

/// A crate, and one of another size.
static CRATES: LazyLock<[FileSettings; 2]> = LazyLock::new(|| {
    [("crate", 1.0), ("small_crate", 0.5)].map(|(name, scale)| FileSettings {
        name: name.to_owned(),
        path: "samples/models/crate.obj".into(),
        count: WANTED,
        scale,
    })
});

fn crates() -> Vec<Arc<Replica>> {
    let replica = |file: &FileSettings| {
        let folder = file.path.parent().unwrap();
        let mut beside = |name: &str| -> Result<Vec<u8>, ModelError> { Ok(fs::read(folder.join(name)).unwrap()) };
        let model = Format::of(&file.path).unwrap().read(&fs::read(&file.path).unwrap(), &mut beside).unwrap();
        Arc::new(Replica::new(model, file.scale).unwrap())
    };
    CRATES.iter().map(replica).collect()
}

/// A shelf with the crates, its prototypes, and their mesh.
fn stocked(rock: &'static str) -> (Kinds<'static>, Shelf, Library<'static>, Mesh) {
    let kinds = Kinds { rock, has_artefacts: false, files: &*CRATES };
    let shelf = shelf(kinds, &crates());
    let (library, mesh) = Library::of_shelf(kinds, &shelf);
    (kinds, shelf, library, mesh)
}

#[test]
fn models_are_closed_prototypes_on_their_feet() {
    let (_, _, library, mesh) = stocked("salt");
    assert_whole(&mesh);
    let vertices = mesh.positions_m();
    let cut = library.cut(&vertices, &mesh.triangles);
    for (name, size_m) in [("crate_0", [0.6, 0.4, 0.4]), ("small_crate_0", [0.3, 0.2, 0.2])] {
        let number = library.prototypes.iter().position(|prototype| prototype.name == name).unwrap();
        let (prototype, triangles) = (&library.prototypes[number], &cut[number]);
        let report = Report::of(&Mesh { triangles: triangles.clone(), ..mesh.clone() });
        assert!(report.is_clean() && report.volume_m3 < 0.0, "{name}: {report:#?}");
        assert_eq!((triangles.len(), report.genus), (108, 0), "{name}");
        assert!((prototype.size_m - Vector3::from(size_m)).amax() < 2e-3, "{name}: {}", prototype.size_m);
        let low = prototype.hull.corners.iter().map(|corner| corner.z).fold(f64::MAX, f64::min);
        assert!(low.abs() < 1e-3, "{name} is {low} m over its foot");
        for triangle in triangles {
            let [a, b, c] = corners(&mesh, *triangle);
            let facing = (b - a).cross(&(c - a)).normalize();
            let normals = triangle.map(|vertex| Vector3::from(mesh.normals[vertex as usize].map(f64::from)));
            assert!(normals.iter().all(|normal| normal.dot(&facing) > 0.2), "{name}: {normals:?} at {a}");
        }
    }
}

/// Boards between a painted frame, each as in the file, with the normals of flat sides.
#[test]
fn models_have_their_own_colours() {
    let (_, shelf, library, _) = stocked("salt");
    let origin = library.named("crate_0").unwrap().origin.map(|c| c as f32);
    let at = |x: f32, y: f32, z: f32| [origin.x + x, origin.y + y, origin.z + z];
    let points = [at(0.0, 0.18, 0.2), at(0.0, 0.2, 0.02)];
    let mut texels = [Default::default(); 2];
    shelf.texels(shelf.bounds(), 0.01, &points, &[[0.0, 1.0, 0.0]; 2], &mut texels);
    let [board, frame] = texels.map(|texel| texel.color);
    assert_eq!((board, frame), ([0.30, 0.19, 0.10], [0.02, 0.09, 0.16]));
    for texel in texels {
        assert!(Vector3::from(texel.normal).dot(&Vector3::y()) > 0.999, "{:?}", texel.normal);
    }
}

#[test]
fn models_are_spread_along_the_passages_beside_the_way_and_each_other() {
    for (generator, rock) in [("gaussian-perlin", "limestone"), ("mine", "salt")] {
        let row = plume::generators::GENERATORS.find(generator).unwrap();
        let mut cave = Cave::new(format!("{generator} in {rock}"), small(row, 24, 1), rock, 16.0);
        (cave.kinds, _, cave.library, _) = stocked(rock);
        let things = cave.things();
        assert_have_own_identities(&cave, &things);
        let crates: Vec<Thing> = things.into_iter().filter(|thing| thing.kind.ends_with("crate")).collect();
        assert!((10..=2 * WANTED as usize).contains(&crates.len()), "{}: {}", cave.name, crates.len());
        assert_the_corridor_is_free(&cave, &crates);
        for (n, one) in crates.iter().enumerate() {
            let reach_m = |thing: &Thing| cave.prototype(thing).reach_m;
            let apart_m = |other: &Thing| (other.pose.translation.vector - one.pose.translation.vector).norm();
            let is_apart = |other: &Thing| apart_m(other) > reach_m(one) + reach_m(other);
            assert!(crates[n + 1..].iter().all(is_apart), "{}: {one:?}", cave.name);
        }
    }
}
