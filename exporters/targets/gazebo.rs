//! Target `gazebo`: a model and a world for Gazebo Sim (Harmonic and later), in SDF 1.9.
//!
//! ```text
//! models/<name>/{model.config, model.sdf, meshes/, materials/textures/}   everything that is static
//! worlds/<name>.sdf                                                       that, and a model per movable thing
//! README.md
//! models/<name>_rover/, ros2/                                         with `ros2`: see `gazebo/ros2.rs`
//! ```
//! Meshes are OBJ, which every Gazebo since Classic reads, Z up. The model is static, so its collision meshes may be
//! concave. All URIs are `model://`: the package works from any folder on `GZ_SIM_RESOURCE_PATH`. Occlusion is omitted,
//! because ogre2 does not show it. Lamps and frames belong to the model, so that a world that only includes it has them.
//!
//! Convex pieces are the objects of an OBJ file per chunk and zone: Bullet makes a hull of each, DART uses their triangles.
//! With a collision element per piece every reader would see convex meshes, but DART tests all pairs of its shapes in every
//! step: 2000 of them took 9 times as long to parse as triangles and 90 times as long to step, while such files with 4000
//! took 1.2 and 6 times as long. Elements that select objects of a file (`<submesh>`) do not help: the Physics system of
//! Gazebo attaches the whole file for each.
//!
//! Static things are merged by chunk, like the wall. A movable one is a model of its own, whose meshes are shared by all
//! copies of a prototype: the visual mesh at its level of detail, and the convex hull as collision.

use std::f64::consts::PI;

use minijinja::value::Serde;
use minijinja::{Value, context};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::Collision;
use crate::error::ExportError;
use crate::format::obj;
use crate::frame::{Axes, micro, sdf_pose};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Image, Landmark, Light, Material, Mesh, Piece, Scene, Zone};
use crate::{Build, Open, Summary, Target, TargetRow, template};

use self::bodies::Bodies;

mod bodies;
mod ros2;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "gazebo",
    summary: "SDF 1.9 world and model with PBR textures and triangle collisions",
    revision: 0,
    opened_by: "Gazebo Sim Harmonic and later",
    contents: "model and world (SDF 1.9), an OBJ per chunk, a model per movable stone, PBR maps, collision meshes, lamps, \
        start pose; with `gazebo.ros2=true` also launch files for ROS 2: bridge, rover, RTAB-Map, Nav2 and its map",
    tested_by: "libsdformat with unknown elements as errors; Gazebo's own physics (ign-physics, dartsim) drops a ball; \
        pybullet drops a ball onto the concave triangles, and lets go of every loose stone: 95 of 100 stay. For ROS 2, without \
        ROS: that physics drives the rover; launch files run on stand-ins, and topics, types, frames and parameters agree",
    checks: &["gazebo", "ros2", "pybullet", "rest", "trimesh", "orient"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<GazeboSettings>,
    build: Build::Plain(|table| ros2::build(serde_json::from_value(table)?)),
};

/// Settings of target `gazebo`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct GazeboSettings {
    /// Include the lights of the scene; without them only the robot's own lights shine.
    pub lights: bool,
    /// Ambient light, 0 (black) to 1: not physical underground, but without it a camera without a light sees nothing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub ambient: f64,
    /// Collision shapes. Pieces have separate friction for floor, wall and ceiling; triangles have that of the floor.
    pub collision: Collision,
    /// Maximum physics time step in seconds.
    #[schemars(range(min = 0.0001, max = 0.05))]
    pub physics_step_s: f64,
    /// Add what ROS 2 (Jazzy, with Gazebo Harmonic) needs to drive, map and navigate: launch files, a rover with lamps, RGB-D
    /// camera, IMU and lidar, the bridge, parameters of RTAB-Map and Nav2, and the map of the floor.
    pub ros2: bool,
}

impl Default for GazeboSettings {
    fn default() -> Self {
        Self { lights: true, ambient: 0.1, collision: Collision::Triangles, physics_step_s: 0.001, ros2: false }
    }
}

/// The target.
pub struct Gazebo(
    /// Its settings.
    pub GazeboSettings,
);

impl Target for Gazebo {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let model = format!("models/{}", scene.name);
        let (mut parts, mut triangles, mut bodies) = (Vec::new(), [0, 0], Bodies::of(scene)?);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            chunk.material.refuse_unless(ROW.name, ROW.images)?;
            if chunk.content == (Content::Things { movable: true }) {
                let added = bodies.add_chunk(&model, scene, index, out)?;
                triangles = [0, 1].map(|part| triangles[part] + added[part]);
                continue;
            }
            let mut part = write_visual(&model, &chunk, out)?;
            part.collisions = match self.0.collision {
                _ if !chunk.collides() => Vec::new(),
                Collision::Triangles => vec![write_triangles(&model, scene, &chunk, out)?],
                Collision::Pieces => write_pieces(&model, scene, &chunk.name, &scene.pieces(index)?, out)?,
            };
            triangles[0] += chunk.visual.triangles();
            triangles[1] += part.collisions.iter().map(|collision| collision.triangles).sum::<u64>();
            parts.push(part);
        }
        self.write_texts(&model, scene, &parts, &bodies, out)?;
        if self.0.ros2 {
            ros2::write(scene, out)?;
        }
        Ok(Summary {
            visual_triangles: triangles[0],
            collision_triangles: triangles[1],
            open: Open::Command(open_command(&scene.name)),
        })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn references(&self) -> &'static [&'static str] {
        &["The world names plugins of Gazebo Sim (Apache-2.0), which come with Gazebo."]
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == Collision::Pieces
    }

    fn moves_things(&self) -> bool {
        true
    }
}

impl Gazebo {
    fn write_texts(
        &self,
        model: &str,
        scene: &Scene,
        parts: &[Part],
        bodies: &Bodies,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let lights: &[Light] = if self.0.lights { &scene.lights } else { &[] };
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            parts => Serde(parts),
            bodies => Serde(bodies.texts()),
            collision => Serde(self.0.collision),
            zones => Serde(Zone::ALL.map(|zone| ZoneText::new(scene, zone))),
            gravity => micro(scene.gravity),
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            spawns => scene.spawns.iter().map(sdf_pose).collect::<Vec<_>>(),
            stations => scene.network.landmarks().iter().map(station_text).collect::<Vec<_>>(),
            camera => sdf_pose(&scene.viewpoint()),
            lights => Serde(lights.iter().map(LightText::new).collect::<Vec<_>>()),
            ambient => micro(self.0.ambient),
            step_s => micro(self.0.physics_step_s),
            open => open_command(&scene.name),
            ros2 => self.0.ros2,
        };
        for (path, template) in [
            (format!("{model}/model.config"), include_str!("../templates/gazebo/model.config.jinja")),
            (format!("{model}/model.sdf"), include_str!("../templates/gazebo/model.sdf.jinja")),
            (format!("worlds/{}.sdf", scene.name), include_str!("../templates/gazebo/world.sdf.jinja")),
            ("README.md".to_owned(), include_str!("../templates/gazebo/README.md.jinja")),
        ] {
            out.text(&path, &template::fill(&path, template, &values))?;
        }
        Ok(())
    }
}

/// A chunk for the templates.
#[derive(Serialize)]
struct Part {
    name: String,
    maps: MapTexts,
    collisions: Vec<CollisionText>,
}

/// Files of a material for the templates, in the folder of textures.
#[derive(Clone, Serialize)]
struct MapTexts {
    base_color: String,
    normal: String,
    roughness: String,
}

/// A collision for the templates.
#[derive(Serialize)]
struct CollisionText {
    name: String,
    friction: String,
    triangles: u64,
}

/// A zone for the templates.
#[derive(Serialize)]
struct ZoneText {
    name: &'static str,
    friction: String,
    reach_m: String,
}

impl ZoneText {
    fn new(scene: &Scene, zone: Zone) -> Self {
        let reach_m = micro(scene.piece_tolerance_m.of(zone));
        Self { name: zone.name(), friction: micro(scene.friction.of(zone)), reach_m }
    }
}

fn write_visual(model: &str, chunk: &Chunk, out: &mut dyn Package) -> Result<Part, ExportError> {
    let name = &chunk.name;
    let maps = write_material(model, name, &chunk.material, out)?;
    write_mesh(model, name, name, &chunk.material, &chunk.visual, out)?;
    Ok(Part { name: name.clone(), maps, collisions: Vec::new() })
}

/// Writes the images of a material, and the library `<library>.mtl` with it.
fn write_material(
    model: &str,
    library: &str,
    material: &Material,
    out: &mut dyn Package,
) -> Result<MapTexts, ExportError> {
    let texture = |role, image: &Image| format!("{}_{role}.{}", material.name, image.format.extension());
    let texts = MapTexts {
        base_color: texture("base_color", &material.base_color),
        normal: texture("normal", &material.normal),
        roughness: texture("roughness", &material.roughness),
    };
    let textures = format!("{model}/materials/textures");
    for (file, image) in [
        (&texts.base_color, &material.base_color),
        (&texts.normal, &material.normal),
        (&texts.roughness, &material.roughness),
    ] {
        out.share(&format!("{textures}/{file}"), image)?;
    }
    let from_meshes = |file: &str| format!("../materials/textures/{file}");
    let maps = obj::Maps {
        base_color: &from_meshes(&texts.base_color),
        normal: &from_meshes(&texts.normal),
        roughness: &from_meshes(&texts.roughness),
    };
    out.write(&format!("{model}/meshes/{library}.mtl"), |file| Ok(obj::write_material(file, &material.name, &maps)?))?;
    Ok(texts)
}

/// Writes the visual mesh `<name>.obj` with a material of the library `<library>.mtl`.
fn write_mesh(
    model: &str,
    name: &str,
    library: &str,
    material: &Material,
    mesh: &Mesh,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    out.write(&format!("{model}/meshes/{name}.obj"), |file| {
        obj::write_library(file, &format!("{library}.mtl"))?;
        Ok(obj::write_visual(file, name, &material.name, mesh, 0)?)
    })
}

fn write_triangles(
    model: &str,
    scene: &Scene,
    chunk: &Chunk,
    out: &mut dyn Package,
) -> Result<CollisionText, ExportError> {
    let name = format!("{}_collision", chunk.name);
    out.write(&format!("{model}/meshes/{name}.obj"), |file| {
        Ok(obj::write_collision(file, &chunk.name, &chunk.collision, 0)?)
    })?;
    Ok(CollisionText { name, friction: micro(scene.friction.floor), triangles: chunk.collision.triangles() })
}

/// A file for each zone that has pieces.
fn write_pieces(
    model: &str,
    scene: &Scene,
    chunk: &str,
    pieces: &[Piece],
    out: &mut dyn Package,
) -> Result<Vec<CollisionText>, ExportError> {
    let mut collisions = Vec::new();
    for zone in Zone::ALL {
        let meshes: Vec<&Mesh> = pieces.iter().filter(|piece| piece.zone == zone).map(|piece| &piece.mesh).collect();
        if meshes.is_empty() {
            continue;
        }
        let name = format!("{chunk}_{}", zone.name());
        out.write(&format!("{model}/meshes/{name}.obj"), |file| Ok(obj::write_pieces(file, &name, &meshes)?))?;
        let triangles = meshes.iter().map(|mesh| mesh.triangles()).sum();
        collisions.push(CollisionText { name, friction: micro(scene.friction.of(zone)), triangles });
    }
    Ok(collisions)
}

/// A surveyed station for the templates.
fn station_text(landmark: &Landmark) -> Value {
    context! { frame => &landmark.frame, pose => sdf_pose(&landmark.pose()) }
}

/// A light for the templates.
#[derive(Serialize)]
struct LightText {
    name: String,
    position: String,
    color: String,
    intensity: String,
    range: String,
}

impl LightText {
    fn new(light: &Light) -> Self {
        let text = |numbers: [f64; 3]| numbers.map(micro).join(" ");
        Self {
            name: light.name.clone(),
            position: text(light.position.into()),
            color: text(light.color),
            intensity: micro(intensity(light.intensity_cd)),
            range: micro(light.range_m),
        }
    }
}

/// The intensity of a light in SDF. Gazebo drives ogre2 with power scale pi, which cancels the 1/pi of a Lambertian surface.
fn intensity(luminous_cd: f64) -> f64 {
    luminous_cd / PI
}

fn open_command(name: &str) -> String {
    format!("GZ_SIM_RESOURCE_PATH=$PWD/models gz sim worlds/{name}.sdf")
}
