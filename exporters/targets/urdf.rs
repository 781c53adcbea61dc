//! Target `urdf`: a ROS 2 package with the world as a URDF with a single static link.
//!
//! ```text
//! <name>/{package.xml, CMakeLists.txt, urdf/<name>.urdf, meshes/, meshes/textures/}
//! README.md
//! ```
//! Paths of meshes are always `package://<name>/`, and the package is in a folder of its name, because Bullet and pinocchio
//! find packages by folder names. All chunks belong to one link: separate links would exceed the limit of Bullet, fewer than
//! 128 joints per body. The link has no mass, by which Bullet knows that it is fixed. Start poses are links without
//! geometry, so that joints and tf can refer to them.
//!
//! Movable things are part of that link as well. URDF describes one robot and has no world in which others could stand, and as
//! links with floating joints they would not move in Bullet, which makes each of these a fixed one. What spawns robots can
//! spawn stones: `instances.json` lists them, as not movable.
//!
//! URDF does not define whether a collision mesh may be concave. Bullet uses the triangles if the attribute `concave` is
//! present, otherwise a convex hull of each object of the OBJ. Friction is not part of URDF either: Bullet reads one value
//! per link, which is that of the floor. Images other than the base colour are referenced, but hardly any reader uses them.

use minijinja::context;
use minijinja::value::Serde;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::Collision;
use crate::error::ExportError;
use crate::format::obj;
use crate::frame::{Axes, micro, sdf_pose};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Landmark, Mesh, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, template};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "urdf",
    summary: "ROS 2 package with a static URDF world, triangle or convex collisions, start poses as frames",
    revision: 0,
    opened_by: "ROS 2, Bullet, pinocchio and other readers of URDF",
    contents: "ROS 2 package: a static world with `package://` paths, an OBJ per chunk, triangles marked concave for \
        Bullet or convex pieces, start poses as frames",
    tested_by: "urdf-rs, check_urdf, pinocchio (every mesh), yourdfpy, catkin_pkg; a Husky drives 20 m in Bullet on either \
        kind of collision shape",
    checks: &["check_urdf", "pinocchio", "yourdfpy", "trimesh", "orient"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<UrdfSettings>,
    build: Build::Plain(|table| Ok(Box::new(Urdf(serde_json::from_value(table)?)))),
};

/// Joints that Bullet holds in a body: with more it loads the world, but tells no more where its frames are.
const MOST_JOINTS: usize = 127;

/// Settings of target `urdf`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct UrdfSettings {
    /// Collision shapes: `triangles` for readers that support concave meshes, `pieces` for those that only support convex
    /// ones.
    pub collision: Collision,
}

/// The target.
pub struct Urdf(
    /// Its settings.
    pub UrdfSettings,
);

impl Target for Urdf {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (mut chunks, mut triangles) = (Vec::new(), [0, 0]);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            triangles[0] += chunk.visual.triangles();
            write_visual(&scene.name, &chunk, out)?;
            let collides = chunk.collides();
            triangles[1] += if collides { self.write_collision(scene, index, &chunk, out)? } else { 0 };
            chunks.push(ChunkText { name: chunk.name, collides });
        }
        self.write_texts(scene, &chunks, out)?;
        Ok(Summary {
            visual_triangles: triangles[0],
            collision_triangles: triangles[1],
            open: Open::Words(how_to_open(&scene.name)),
        })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == Collision::Pieces
    }
}

impl Urdf {
    /// Writes the collision shapes of a chunk; returns their number of triangles.
    fn write_collision(
        &self,
        scene: &Scene,
        index: usize,
        chunk: &Chunk,
        out: &mut dyn Package,
    ) -> Result<u64, ExportError> {
        let path = format!("{}/meshes/{}_collision.obj", scene.name, chunk.name);
        match self.0.collision {
            Collision::Triangles => {
                out.write(&path, |file| Ok(obj::write_collision(file, &chunk.name, &chunk.collision, 0)?))?;
                Ok(chunk.collision.triangles())
            }
            Collision::Pieces => {
                let pieces = scene.pieces(index)?;
                let meshes: Vec<&Mesh> = pieces.iter().map(|piece| &piece.mesh).collect();
                out.write(&path, |file| Ok(obj::write_pieces(file, &chunk.name, &meshes)?))?;
                Ok(meshes.iter().map(|mesh| mesh.triangles()).sum())
            }
        }
    }

    fn write_texts(&self, scene: &Scene, chunks: &[ChunkText], out: &mut dyn Package) -> Result<(), ExportError> {
        let name = &scene.name;
        let stations = scene.network.foremost(MOST_JOINTS.saturating_sub(scene.spawns.len()));
        let is_short = stations.len() < scene.network.named().len();
        let values = context! {
            name,
            description => &scene.description,
            generator => &scene.generator,
            chunks => Serde(chunks),
            concave => self.0.collision == Collision::Triangles,
            friction => micro(scene.friction.floor),
            gravity => micro(scene.gravity),
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            spawns => Serde(scene.spawns.iter().map(|pose| Origin::new(&sdf_pose(pose))).collect::<Vec<_>>()),
            stations => Serde(stations.into_iter().map(StationText::new).collect::<Vec<_>>()),
            is_short => is_short,
        };
        for (path, template) in [
            (format!("{name}/package.xml"), include_str!("../templates/urdf/package.xml.jinja")),
            (format!("{name}/CMakeLists.txt"), include_str!("../templates/urdf/CMakeLists.txt.jinja")),
            (format!("{name}/urdf/{name}.urdf"), include_str!("../templates/urdf/world.urdf.jinja")),
            ("README.md".to_owned(), include_str!("../templates/urdf/README.md.jinja")),
        ] {
            out.text(&path, &template::fill(&path, template, &values))?;
        }
        Ok(())
    }
}

/// A chunk for the templates.
#[derive(Serialize)]
struct ChunkText {
    name: String,
    collides: bool,
}

/// A pose for the templates.
#[derive(Serialize)]
struct Origin {
    xyz: String,
    rpy: String,
}

/// A surveyed station for the templates.
#[derive(Serialize)]
struct StationText {
    frame: String,
    origin: Origin,
}

impl StationText {
    fn new(landmark: Landmark) -> Self {
        Self { origin: Origin::new(&sdf_pose(&landmark.pose())), frame: landmark.frame }
    }
}

impl Origin {
    fn new(pose: &str) -> Self {
        let numbers: Vec<&str> = pose.split(' ').collect();
        Self { xyz: numbers[..3].join(" "), rpy: numbers[3..].join(" ") }
    }
}

fn write_visual(package: &str, chunk: &Chunk, out: &mut dyn Package) -> Result<(), ExportError> {
    let name = &chunk.name;
    chunk.material.refuse_unless(ROW.name, ROW.images)?;
    let meshes = format!("{package}/meshes");
    let mut copy = |role, image| out.texture(&format!("{meshes}/"), &chunk.material.name, role, image);
    let base_color = copy("base_color", &chunk.material.base_color)?;
    let normal = copy("normal", &chunk.material.normal)?;
    let roughness = copy("roughness", &chunk.material.roughness)?;
    let maps = obj::Maps { base_color: &base_color, normal: &normal, roughness: &roughness };
    let library = format!("{name}.mtl");
    out.write(&format!("{meshes}/{library}"), |file| Ok(obj::write_material(file, &chunk.material.name, &maps)?))?;
    out.write(&format!("{meshes}/{name}.obj"), |file| {
        obj::write_library(file, &library)?;
        Ok(obj::write_visual(file, name, &chunk.material.name, &chunk.visual, 0)?)
    })
}

fn how_to_open(name: &str) -> String {
    format!("copy {name} into the src folder of a ROS 2 workspace, or load {name}/urdf/{name}.urdf in Bullet")
}
