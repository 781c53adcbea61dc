//! Episodes in the layout of Habitat's PointNav data sets (Savva et al. 2019), as `PointNav-v1` of habitat-lab reads them: JSON packed
//! by gzip.
//!
//! Habitat is Y up, and a robot that is not turned looks along -z: places are those of the GLB of the same scene, and rotations
//! are `[x, y, z, w]`. Paths have no actions, because robots here turn and move by any amount.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plume_truth::Waypoint;
use serde::Serialize;

use super::TruthSettings;
use super::tasks::{Task, rounded};
use crate::error::ExportError;
use crate::frame;
use crate::package::Package;
use crate::scene::Scene;

/// The file.
pub const PATH: &str = "episodes.json.gz";
/// Its frame.
pub const FRAME: &str = "right-handed, Y up, metres: x, z, -y of the other files; unturned robots look along -z";

/// A data set.
#[derive(Serialize)]
struct Episodes {
    episodes: Vec<Episode>,
}

#[derive(Serialize)]
struct Episode {
    episode_id: String,
    scene_id: String,
    start_position: [f64; 3],
    start_rotation: [f64; 4],
    info: Info,
    goals: [Goal; 1],
    shortest_paths: [Vec<Point>; 1],
    start_room: Option<String>,
}

#[derive(Serialize)]
struct Info {
    geodesic_distance: f64,
    euclidean_distance: f64,
    difficulty: &'static str,
}

#[derive(Serialize)]
struct Goal {
    position: [f64; 3],
    radius: f64,
}

/// A point on a path.
#[derive(Serialize)]
struct Point {
    position: [f64; 3],
    rotation: [f64; 4],
    action: Option<u32>,
}

/// Writes the episodes.
pub fn write(
    scene: &Scene,
    settings: &TruthSettings,
    tasks: &[Task],
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let episode = |(number, task): (usize, &Task)| {
        let (start_position, start_rotation) = pose(&task.start());
        Episode {
            episode_id: number.to_string(),
            scene_id: format!("{}.glb", scene.name),
            start_position,
            start_rotation,
            info: Info {
                geodesic_distance: task.geodesic_m,
                euclidean_distance: task.euclidean_m,
                difficulty: task.difficulty(),
            },
            goals: [Goal { position: frame::gltf_from_scene(task.goal_m), radius: settings.goal_radius_m }],
            shortest_paths: [task.episode.route.waypoints.iter().map(point).collect()],
            start_room: None,
        }
    };
    let episodes = Episodes { episodes: tasks.iter().enumerate().map(episode).collect() };
    out.write(PATH, |file| {
        let mut packed = GzEncoder::new(file, Compression::default());
        packed.write_all(&serde_json::to_vec(&episodes).map_err(std::io::Error::from)?)?;
        Ok(packed.finish().map(drop)?)
    })
}

fn point(waypoint: &Waypoint) -> Point {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), waypoint.heading_rad);
    let (position, rotation) = pose(&Isometry3::from_parts(Vector3::from(waypoint.position_m).into(), turn));
    Point { position: position.map(rounded), rotation: rotation.map(rounded), action: None }
}

/// A pose on the level, of which +x is ahead, as Habitat has it.
fn pose(at: &Isometry3<f64>) -> ([f64; 3], [f64; 4]) {
    let heading_rad = at.rotation.euler_angles().2;
    let half_rad = heading_rad / 2.0 - std::f64::consts::FRAC_PI_4;
    let position = frame::gltf_from_scene(at.translation.vector.into());
    (position, [0.0, libm::sin(half_rad), 0.0, libm::cos(half_rad)])
}
