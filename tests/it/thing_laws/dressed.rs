//! Things in pictures, which have no meshes of them.

use nalgebra::{Isometry3, Vector3};
use plume::field::{CaveField, Field, PassageSettings};
use plume::material::{Look, MATERIALS};
use plume::things::{Dressed, Thing};

use super::{hall, kinds_of, library, outside_m, shelf};

/// Points are this far from the hull or further, in metres: more than the roughness of a shape.
const CLEAR_M: f64 = 0.03;
/// Least share of the distance to its hull that is known of the distance to a thing. Rays end where it is short, as if they had arrived.
const LEAST_SHARE: f64 = 0.1;
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
            let outside_m = |point: &[f32; 3]| outside_m(&prototype.hull, Vector3::from(*point).cast());
            let points: Vec<[f32; 3]> = lattice.map(|point| point.cast().into()).collect();
            let with = dressed.distances_at(&points);
            // Posts reach down to the floor.
            let walls = field.distances_at(&points);
            for ((with_m, wall_m), point) in with.into_iter().zip(walls).zip(&points) {
                let away_m = outside_m(point);
                let most_m = -(LEAST_SHARE * away_m.min(1.0)) as f32;
                let is_air = wall_m > most_m || away_m < CLEAR_M || with_m < most_m;
                assert!(is_air, "{} of {} at {point:?}, {away_m} m away: {with_m}", prototype.name, rock.name);
            }
        }
    }
}
