//! Things in pictures, which have no meshes of them.

use nalgebra::{Isometry3, Point3, Vector3};
use plume::field::{CaveField, Field, PassageSettings};
use plume::material::{Look, MATERIALS};
use plume::things::{Dressed, Thing};

use super::{hall, kinds_of, library, outside_m, shelf};

/// Points are this far from the hull or further, in metres: more than the roughness of a shape.
const CLEAR_M: f64 = 0.03;
/// Points on each side of the lattice.
const SIDE: i32 = 10;

#[test]
fn there_is_air_around_things() {
    for rock in MATERIALS.iter() {
        let material = (rock.read)(serde_json::json!({})).unwrap();
        let field = CaveField::new(&hall(), &PassageSettings::default(), material, Look::default(), 7);
        let (library, shelf) = (&library(rock.name).0, shelf(kinds_of(rock.name), &[]));
        for prototype in &library.prototypes {
            let thing = Thing {
                id: 1,
                kind: prototype.row.name.to_owned(),
                prototype: prototype.name.clone(),
                scale: 1.0,
                pose: Isometry3::identity(),
                embedding_m: 0.0,
            };
            let dressed = Dressed::new(&field, &shelf, library, &[thing]);
            let reach_m = prototype.hull.corners.iter().map(|corner| corner.coords.norm()).fold(0.0, f64::max);
            let at = |n: i32| f64::from(n) / f64::from(SIDE) * 1.2 * reach_m;
            let lattice = (-SIDE..=SIDE).flat_map(|x| {
                (-SIDE..=SIDE).flat_map(move |y| (-SIDE..=SIDE).map(move |z| Vector3::new(at(x), at(y), at(z))))
            });
            let clear = lattice.filter(|point| outside_m(&prototype.hull, *point) > CLEAR_M);
            let points: Vec<[f32; 3]> = clear.map(|point| Point3::from(point).cast().into()).collect();
            // Posts reach down to the floor.
            let walls = field.distances_at(&points);
            let solid =
                dressed.distances_at(&points).into_iter().zip(walls).filter(|(with, wall)| *with >= 0.0 && *wall < 0.0);
            let solid = solid.count();
            assert_eq!(solid, 0, "{} of {}: of {} points", prototype.name, rock.name, points.len());
        }
    }
}
