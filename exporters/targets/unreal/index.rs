//! `scene.json`: the data for the import script, in Unreal's frame and units.

use nalgebra::{Isometry3, Point3};
use serde::Serialize;
use serde_json::{Value, json};

use super::UnrealSettings;
use super::things::Shape;
use crate::error::ExportError;
use crate::format::fbx;
use crate::frame::{unreal_from_scene, unreal_pose_from_scene};
use crate::package::Package;
use crate::scene::{Landmark, Light, Mesh, Piece, Scene};

/// Width and height of the screen for which levels of detail are chosen, in pixels; its horizontal field of view is 90°.
const SCREEN_PX: [f64; 2] = [1920.0, 1080.0];

/// A mesh for the script: a chunk, or what things share.
#[derive(Serialize)]
pub(super) struct Entry {
    /// Its name.
    pub name: String,
    /// Name of its material, which others may share.
    pub material: String,
    /// Path of the visual mesh.
    pub mesh: String,
    /// Path of the collision mesh, unless there are convex pieces.
    pub collision_mesh: Option<String>,
    /// Paths of the images.
    pub textures: Textures,
    /// Number of convex pieces.
    pub convex_pieces: usize,
    lods: Vec<Level>,
    min_cm: [f64; 3],
    max_cm: [f64; 3],
    /// Number of collision triangles.
    #[serde(skip)]
    pub collision_triangles: u64,
}

/// Images of a chunk.
#[derive(Serialize)]
pub(super) struct Textures {
    /// Base colour.
    pub base_color: String,
    /// Tangent-space normals, green as in DirectX.
    pub normal: String,
    /// Occlusion, roughness and metalness.
    pub orm: String,
}

/// A level of detail.
#[derive(Serialize)]
struct Level {
    triangles: u64,
    error_m: f64,
    screen_size: f64,
}

impl Textures {
    /// The same, relative to an FBX in a sibling folder.
    pub fn maps(&self) -> fbx::Maps {
        let beside = |path: &str| format!("../{path}");
        fbx::Maps {
            base_color: beside(&self.base_color),
            normal: beside(&self.normal),
            roughness: None,
            occlusion_roughness_metalness: Some(beside(&self.orm)),
        }
    }
}

impl Entry {
    /// A mesh without collision so far.
    pub fn new(name: &str, material: &str, full: &Mesh, textures: Textures) -> Self {
        let [min, max] = full.bounds().map(|corner| unreal_from_scene(corner.map(f64::from)));
        let corner = |pick: fn(f64, f64) -> f64| [0, 1, 2].map(|axis| micro(pick(min[axis], max[axis])));
        Self {
            name: name.to_owned(),
            material: material.to_owned(),
            mesh: format!("meshes/{name}.fbx"),
            collision_mesh: None,
            textures,
            convex_pieces: 0,
            lods: Vec::new(),
            min_cm: corner(f64::min),
            max_cm: corner(f64::max),
            collision_triangles: 0,
        }
    }

    /// Sets the levels of detail, and where each takes over.
    pub fn set_levels(&mut self, levels: &[fbx::Level]) {
        let radius_m = levels.first().map_or(0.0, |full| radius_m(full.mesh));
        let level = |level: &fbx::Level| Level {
            triangles: level.mesh.triangles(),
            error_m: micro(f64::from(level.error_m)),
            screen_size: micro(screen_size(radius_m, f64::from(level.error_m))),
        };
        self.lods = levels.iter().map(level).collect();
    }

    /// Sets the collision counts.
    pub fn set_pieces(&mut self, pieces: &[Piece]) {
        self.convex_pieces = pieces.len();
        self.collision_triangles = pieces.iter().map(|piece| piece.mesh.triangles()).sum();
    }

    /// Triangles in full detail.
    pub fn visual_triangles(&self) -> u64 {
        self.lods.first().map_or(0, |level| level.triangles)
    }
}

/// Radius of the bounding sphere of a mesh around the centre of its box, as in Unreal.
fn radius_m(mesh: &Mesh) -> f64 {
    let point = |position: [f32; 3]| Point3::from(position.map(f64::from));
    let [min, max] = mesh.bounds().map(point);
    let centre = nalgebra::center(&min, &max);
    mesh.positions.iter().map(|&position| nalgebra::distance(&centre, &point(position))).fold(0.0, f64::max)
}

/// The largest part of the screen that the bounding sphere of a mesh may cover when a level of detail is shown.
///
/// Unreal measures from the centre of the sphere, but in a cave the camera sees its near side: at the point of the sphere
/// nearest to the camera, the error of the level is a pixel.
fn screen_size(radius_m: f64, error_m: f64) -> f64 {
    let [width_px, height_px] = SCREEN_PX;
    // For an object as high as its distance: its share of half the screen, and its size in pixels.
    let (high, high_px) = (width_px / height_px, width_px / 2.0);
    high * radius_m / (radius_m + error_m * high_px)
}

/// Writes the file.
///
/// # Errors
/// Those of `out`.
pub(super) fn write(
    scene: &Scene,
    settings: &UnrealSettings,
    entries: &[Entry],
    shapes: &[Shape],
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let lights: &[Light] = if settings.lights { &scene.lights } else { &[] };
    let spawn = |(number, pose): (usize, &Isometry3<f64>)| Placed::new(format!("spawn_{number}"), pose);
    let index = Index {
        name: &scene.name,
        description: &scene.description,
        generator: &scene.generator,
        frame: "left-handed, X forward, Y right, Z up, centimetres; rotations are those of a rotator, degrees",
        friction: scene.friction.floor,
        nanite: settings.nanite,
        chunks: entries,
        things: shapes,
        spawns: scene.spawns.iter().enumerate().map(spawn).collect(),
        stations: scene.network.landmarks().iter().map(station).collect(),
        lights: lights.iter().map(light).collect(),
    };
    out.json("scene.json", &index)
}

#[derive(Serialize)]
struct Index<'a> {
    name: &'a str,
    description: &'a str,
    generator: &'a str,
    frame: &'a str,
    friction: f64,
    nanite: bool,
    chunks: &'a [Entry],
    things: &'a [Shape],
    spawns: Vec<Placed>,
    stations: Vec<Value>,
    lights: Vec<Value>,
}

/// A name and a pose.
#[derive(Serialize)]
pub(super) struct Placed {
    name: String,
    location_cm: [f64; 3],
    rotation_deg: Rotator,
}

#[derive(Serialize)]
struct Rotator {
    roll: f64,
    pitch: f64,
    yaw: f64,
}

impl Placed {
    /// A name, and a pose in the frame of the scene.
    pub fn new(name: String, pose: &Isometry3<f64>) -> Self {
        let (location, angles) = unreal_pose_from_scene(pose);
        let [roll, pitch, yaw] = angles.map(micro);
        Self { name, location_cm: location.map(micro), rotation_deg: Rotator { roll, pitch, yaw } }
    }
}

fn station(landmark: &Landmark) -> Value {
    json!({
        "name": landmark.frame,
        "station": landmark.label,
        "location_cm": unreal_from_scene(landmark.position.into()).map(micro),
    })
}

fn light(light: &Light) -> Value {
    json!({
        "name": light.name,
        "location_cm": unreal_from_scene(light.position.into()).map(micro),
        "color": light.color,
        "intensity_cd": light.intensity_cd,
        "attenuation_radius_cm": micro(100.0 * light.range_m),
    })
}

/// A number to six decimals, without minus zero.
pub(super) fn micro(number: f64) -> f64 {
    libm::round(number * 1e6) / 1e6 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_level_is_a_pixel_at_the_near_side_of_the_sphere() {
        let (radius_m, error_m) = (8.0, 0.02);
        let size = screen_size(radius_m, error_m);
        // Unreal's ComputeBoundsScreenSize, with the projection of a camera that sees 90° across.
        let vertical = 1920.0 / 1080.0;
        let distance_m = vertical * radius_m / size;
        let seen_px = error_m / (distance_m - radius_m) * vertical * 1080.0 / 2.0;
        assert!((seen_px - 1.0).abs() < 1e-12, "{seen_px}");
    }

    #[test]
    fn coarser_levels_show_when_smaller() {
        let sizes = [0.0, 0.001, 0.01, 0.1].map(|error_m| screen_size(5.0, error_m));
        assert!(sizes.is_sorted_by(|a, b| a > b));
    }
}
