//! A USD stage: a root layer in text, and a binary layer per chunk that it loads as a payload.
//!
//! ```text
//! <name>.usda                /World: chunks, friction, lights, start poses, a camera; /PhysicsScene: gravity
//! chunks/<chunk>.usdc        /Chunk: visual mesh at every level of detail, material, collision mesh
//! chunks/prototypes.usdc     /Prototypes: the shapes of things, each with levels of detail, a material and a convex hull
//! chunks/things_*.usdc       /Chunk: instances of them (`instanceable`), labelled with their class
//! chunks/textures/           images of the chunks
//! ```
//! Z up, metres, kilograms, right-handed; paths are relative, so the folder can be moved. Uses the schemas UsdGeom,
//! UsdShade, UsdLux, UsdPhysics and UsdSemantics (<https://openusd.org/release/api/index.html>). The cave is static:
//! collision meshes have no rigid body and keep their triangles (`approximation = "none"`), so they may be concave. They are
//! separate from the visual meshes. On request, convex pieces replace them (`/Chunk/Collision/<zone>/piece_<n>`,
//! `approximation = "convexHull"`), with friction per zone. Movable things are rigid bodies: the instance itself, with its
//! mass, centre of mass and inertia, while its collider is shared like that of the others. On request, `/World/Collision` is
//! the only collider of all that does not move (`chunks/collision.usdc`).
//!
//! The layers are written by usd-core, a Python package: a host program provides it as [`Library`]. The content of each prim
//! is decided here and in [`SCRIPT`], nowhere else. Memory: one chunk, and that only collider. The bytes follow from scene,
//! settings and the version of usd-core.

use std::path::{Path, PathBuf};

use minijinja::context;
use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::collision::Collision;
use crate::error::ExportError;
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{ByZone, Chunk, Content, Landmark, Light, Material, Mesh, Scene, Zone};
use crate::{Open, Summary, frame, instances, slope, template};

mod colliders;
mod gravel;
mod merged;
mod things;

use colliders::Colliders;
use merged::Merged;
use things::Prototypes;

/// The Python module that authors layers; [`Library::call`] runs its functions.
pub const SCRIPT: &str = include_str!("stage.py");

/// The USD library of a host program: a Python with usd-core.
pub trait Library: Send + Sync {
    /// Whether it can be used; checked before the long work.
    ///
    /// # Errors
    /// [`ExportError::MissingPart`] if usd-core is missing or has an unsupported version.
    fn check(&self) -> Result<(), ExportError>;

    /// Calls `function(spec, arrays)` of [`SCRIPT`]. The arrays are passed without a copy.
    ///
    /// # Errors
    /// [`ExportError::Library`] with what Python raised.
    fn call(&self, function: &'static str, spec: &Value, arrays: Vec<(String, Array)>) -> Result<(), ExportError>;
}

/// An array in the memory layout of USD.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    /// Shape (n, 3).
    Float3(Vec<[f32; 3]>),
    /// Shape (n, 2).
    Float2(Vec<[f32; 2]>),
    /// Shape (n,): vertex or face indices below 2³¹.
    Index(Vec<u32>),
}

/// Settings of the targets that are plain stages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct StageSettings {
    /// Include the lights of the scene.
    pub lights: bool,
    /// Include collision meshes, friction and gravity.
    pub physics: bool,
    /// Collision shapes. Pieces have separate friction for floor, wall and ceiling; triangles have that of the floor.
    pub collision: Collision,
}

impl Default for StageSettings {
    fn default() -> Self {
        Self { lights: true, physics: true, collision: Collision::Triangles }
    }
}

impl StageSettings {
    /// The content of the stage with these settings.
    pub fn contents(&self) -> Contents {
        let light_scale = if self.lights { 1.0 } else { 0.0 };
        let physics = self.physics.then_some(self.collision);
        Contents { physics, is_merged: false, light_scale, omniverse_view: false }
    }
}

/// The content of a stage in addition to rock and start poses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Collision shapes, with gravity and friction, if any.
    pub physics: Option<Collision>,
    /// Whether the triangles of all that does not move are one mesh instead of one per chunk.
    pub is_merged: bool,
    /// Factor on the luminous intensity of the lights; 0 omits them.
    pub light_scale: f64,
    /// Whether an Omniverse viewport starts at the camera instead of outside.
    pub omniverse_view: bool,
}

impl Contents {
    /// Whether convex pieces are written.
    pub fn wants_pieces(&self) -> bool {
        self.physics == Some(Collision::Pieces)
    }

    /// Whether movable things are rigid bodies.
    pub fn moves_things(&self) -> bool {
        self.physics.is_some()
    }
}

/// Writes the README of the package from a template.
///
/// # Errors
/// As [`Package::open`], and if the things of a chunk cannot be read.
pub fn write_readme(
    template: &str,
    scene: &Scene,
    contents: &Contents,
    summary: &Summary,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let values = context! {
        name => &scene.name,
        description => &scene.description,
        generator => &scene.generator,
        open => summary.open.text(),
        chunks => scene.chunks.len(),
        spawns => scene.spawns.iter().map(spawn_text).collect::<Vec<_>>(),
        friction => zone_texts(scene.friction),
        reach_m => zone_texts(scene.piece_tolerance_m),
        gravity => frame::micro(scene.gravity),
        collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
        has_physics => contents.physics.is_some(),
        movable => if contents.moves_things() { instances::movable(scene)? } else { 0 },
        has_pieces => contents.wants_pieces(),
        is_merged => contents.is_merged,
    };
    out.text("README.md", &template::fill("README.md", template, &values))
}

/// Numbers of floor, wall and ceiling.
fn zone_texts(numbers: ByZone) -> [String; 3] {
    Zone::ALL.map(|zone| frame::micro(numbers.of(zone)))
}

/// Position, and rotation as w, x, y, z.
fn spawn_text(pose: &Isometry3<f64>) -> [String; 2] {
    let text = |numbers: &[f64]| numbers.iter().copied().map(frame::micro).collect::<Vec<_>>().join(", ");
    let turn = pose.rotation.quaternion();
    [text(pose.translation.vector.as_slice()), text(&[turn.w, turn.i, turn.j, turn.k])]
}

/// Name of the root layer.
pub fn root_name(scene: &Scene) -> String {
    format!("{}.usda", scene.name)
}

/// Image formats that UsdPreviewSurface requires of every reader, as far as scenes use them.
pub(crate) const IMAGES: [ImageFormat; 2] = [ImageFormat::Png, ImageFormat::Jpeg];

/// Writes the layers and images of a stage into `out` for `target`; `open` goes to the summary.
///
/// # Errors
/// As [`crate::Target::export`], and if the library fails.
pub fn write(
    target: &'static str,
    scene: &Scene,
    contents: &Contents,
    library: &dyn Library,
    out: &mut dyn Package,
    open: Open,
) -> Result<Summary, ExportError> {
    scene.check()?;
    let scratch = out.scratch()?;
    let (mut payloads, mut triangles) = (Vec::new(), [0, 0]);
    let mut merged = contents.is_merged.then(Merged::default);
    let prototypes = Prototypes::write(target, scene, contents, library, scratch.path(), out)?;
    for index in 0..scene.chunks.len() {
        let mut chunk = scene.chunk(index)?;
        chunk.material.refuse_unless(target, &IMAGES)?;
        if let Content::Things { movable } = chunk.content {
            if let Some(merged) = merged.as_mut().filter(|_| !movable) {
                merged.add(std::mem::take(&mut chunk.collision))?;
            }
            let things = scene.instances(index)?;
            let (payload, colliding) = prototypes.write_chunk(&chunk, &things, library, scratch.path(), out)?;
            triangles[0] += chunk.visual.triangles();
            triangles[1] += colliding;
            payloads.push(payload);
            continue;
        }
        if matches!(chunk.content, Content::Gravel { .. }) {
            triangles[0] += chunk.visual.triangles();
            payloads.push(gravel::write(&chunk, scene.gravel(index)?, library, scratch.path(), out)?);
            continue;
        }
        let colliders = match &mut merged {
            Some(merged) => merged.add(std::mem::take(&mut chunk.collision)).map(|()| Colliders::None)?,
            None => Colliders::of(scene, index, &mut chunk, contents.physics)?,
        };
        triangles[0] += chunk.visual.triangles();
        triangles[1] += colliders.triangles();
        let zones = colliders.zones(scene.friction);
        payloads.push(write_chunk(chunk, colliders, zones, library, scratch.path(), out)?);
    }
    let file = root_name(scene);
    let path = scratch.path().join(&file);
    let mut spec = root_spec(scene, contents, payloads, &path);
    if let Some(merged) = merged {
        triangles[1] += merged.triangles();
        spec["collision"] = merged.write(library, scratch.path(), out)?;
    }
    library.call("write_root", &spec, Vec::new())?;
    out.copy(&file, &path)?;
    Ok(Summary { visual_triangles: triangles[0], collision_triangles: triangles[1], open })
}

/// Writes the layer and images of a chunk; returns its description for the root layer.
fn write_chunk(
    chunk: Chunk,
    colliders: Colliders,
    zones: Value,
    library: &dyn Library,
    scratch: &Path,
    out: &mut dyn Package,
) -> Result<Value, ExportError> {
    let (path, extent) = (layer_path(&chunk.name, scratch), chunk.visual.bounds());
    let textures = textures(&chunk.material, out)?;
    let mut spec = json!({ "path": path, "textures": textures, "zones": zones });
    let mut arrays = Vec::new();
    let levels = std::iter::once((chunk.visual, 0.0)).chain(chunk.lods.into_iter().map(|lod| (lod.mesh, lod.error_m)));
    spec["levels"] = levels
        .enumerate()
        .map(|(level, (mesh, error_m))| {
            let name = format!("LOD{level}");
            let mut level = visual(name.clone(), &name, mesh, &mut arrays);
            level["error_m"] = error_m.into();
            level
        })
        .collect();
    spec["colliders"] = colliders.describe(&mut arrays);
    library.call("write_chunk", &spec, arrays)?;
    place_layer(&chunk.name, extent, scratch, out)
}

/// Where the layer of a chunk is made.
fn layer_path(chunk: &str, scratch: &Path) -> PathBuf {
    scratch.join(format!("{chunk}.usdc"))
}

/// Moves the layer of a chunk into the package; returns its description for the root layer.
fn place_layer(
    chunk: &str,
    extent: [[f32; 3]; 2],
    scratch: &Path,
    out: &mut dyn Package,
) -> Result<Value, ExportError> {
    let (path, place) = (layer_path(chunk, scratch), format!("chunks/{chunk}.usdc"));
    out.copy(&place, &path)?;
    std::fs::remove_file(&path)?;
    Ok(json!({ "name": chunk, "layer": format!("./{place}"), "extent": extent }))
}

/// Writes the images of a material; gives their files, as a layer of a chunk names them.
fn textures(material: &Material, out: &mut dyn Package) -> Result<Value, ExportError> {
    let mut textures = serde_json::Map::new();
    for (role, image) in [("base_color", &material.base_color), ("normal", &material.normal), ("orm", &material.orm)] {
        let file = out.texture("chunks/", &material.name, role, image)?;
        textures.insert(role.to_owned(), format!("./{file}").into());
    }
    Ok(textures.into())
}

/// The description of a level of detail; its arrays go to `arrays`, under names that begin with `own`.
fn visual(name: String, own: &str, mut mesh: Mesh, arrays: &mut Vec<(String, Array)>) -> Value {
    let extent = mesh.bounds();
    let zones = slope::zones(&mesh);
    let key = |array: &str| format!("{own}.{array}");
    arrays.push((key("normals"), Array::Float3(std::mem::take(&mut mesh.normals))));
    arrays.push((key("st"), Array::Float2(std::mem::take(&mut mesh.uvs))));
    push_triangles(own, mesh, arrays);
    let parts = zones.into_iter().filter(|(_, faces)| !faces.is_empty()).map(|(zone, faces)| (zone.name(), faces));
    let names: Vec<&str> = parts.map(|(part, faces)| (part, arrays.push((key(part), Array::Index(faces)))).0).collect();
    json!({ "name": name, "arrays": own, "extent": extent, "parts": names })
}

/// The same for a shape of which copies say what they are: no part of it has a label.
fn unlabelled(name: String, own: &str, mesh: Mesh, arrays: &mut Vec<(String, Array)>) -> Value {
    let mut described = visual(name, own, mesh, arrays);
    described["parts"] = json!([]);
    described
}

fn push_triangles(own: &str, mesh: Mesh, arrays: &mut Vec<(String, Array)>) {
    arrays.push((format!("{own}.points"), Array::Float3(mesh.positions)));
    arrays.push((format!("{own}.indices"), Array::Index(mesh.indices)));
}

fn root_spec(scene: &Scene, contents: &Contents, payloads: Vec<Value>, path: &Path) -> Value {
    let view = scene.viewpoint();
    let mut spec = json!({
        "path": path,
        "name": scene.name,
        "description": scene.description,
        "generator": scene.generator,
        "recipe": scene.recipe,
        "chunks": payloads,
        "spawns": scene.spawns.iter().map(describe_pose).collect::<Vec<_>>(),
        "camera": describe_pose(&frame::camera_from_body(&view)),
        "stations": scene.network.landmarks().iter().map(station).collect::<Vec<_>>(),
        "lights": [],
    });
    if contents.light_scale > 0.0 {
        spec["lights"] = scene.lights.iter().map(|lamp| light(lamp, contents.light_scale)).collect();
    }
    if contents.physics.is_some() {
        spec["physics"] = json!({ "gravity_m_s2": scene.gravity });
    }
    // Pieces have the friction of their zone.
    if contents.physics == Some(Collision::Triangles) {
        spec["physics"]["friction"] = scene.friction.floor.into();
    }
    if contents.omniverse_view {
        spec["layer_data"] = omniverse_view(&view);
    }
    spec
}

fn describe_pose(pose: &Isometry3<f64>) -> Value {
    let turn = pose.rotation.quaternion();
    json!({ "position": pose.translation.vector.as_slice(), "orientation_wxyz": [turn.w, turn.i, turn.j, turn.k] })
}

fn station(landmark: &Landmark) -> Value {
    json!({ "frame": landmark.frame, "name": landmark.label, "position": landmark.position.coords.as_slice() })
}

fn light(light: &Light, scale: f64) -> Value {
    json!({
        "name": light.name,
        "position": light.position.coords.as_slice(),
        "color": light.color,
        "intensity_cd": light.intensity_cd * scale,
    })
}

/// Viewport data of Omniverse applications in the root layer.
fn omniverse_view(view: &Isometry3<f64>) -> Value {
    let target = view * nalgebra::Point3::new(2.0, 0.0, 0.0);
    json!({ "cameraSettings": {
        "Perspective": { "position": view.translation.vector.as_slice(), "target": target.coords.as_slice() },
        "boundCamera": "/OmniverseKit_Persp",
    }})
}
