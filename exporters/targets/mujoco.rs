//! Target `mujoco`: MJCF for MuJoCo 4 and later.
//!
//! ```text
//! <name>.xml          the cave alone, ready to compile
//! <name>_world.xml    the cave without options, for the user's models
//! <name>_shared.xml   what its chunks share: defaults, start poses, lamps, shapes of things
//! <name>_rover.xml    the cave with the rover at the first start pose
//! rover.xml           the rover alone
//! chunks/             a file for each chunk, which the world includes
//! chunks.json         the box of each, for models of a part of a large cave
//! assets/             meshes (.msh), those of things once per shape, and textures (.png, all that MuJoCo reads; JPEG is decoded)
//! README.md
//! ```
//! Names begin with that of the scene, and the included file sets no option, so that nothing clashes with the user's model.
//! Paths are relative to the opened model; there is no `meshdir`, which would also apply to the user's meshes. In an archive
//! the whole cave is in `model.xml`, since `MjSpec.from_zip` does not support includes, and that comes last, since it takes
//! the last `.xml` for the model.

use minijinja::value::Serde;
use minijinja::{Value, context};
use nalgebra::{Isometry3, Translation3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bundle::Bundle;
use crate::error::ExportError;
use crate::frame::{self, Axes, micro};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::rover::{self, Rover};
use crate::scene::{Chunk, Landmark, Light, Scene, Zone};
use crate::{Build, Open, Summary, Target, TargetRow, template};

use self::chunk::Rock;
use self::field::Field;
use self::things::Things;
use self::world::World;

mod chunk;
mod field;
mod things;
mod world;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "mujoco",
    summary: "MJCF with convex pieces for collision, PBR textures, start poses and a sample rover",
    revision: 0,
    opened_by: "MuJoCo 4 and later",
    contents: "MJCF: convex pieces of the rock by zone, PBR layers, start sites and cameras, lamps, a rover to drive in \
        it; to compile, include or attach; `--bundle mjz`",
    tested_by: "MuJoCo 4 compiles every model without a warning; 1,000 balls come to rest inside; 10,000 rays end at the \
        wall within the tolerance; the rover drives 20 m",
    checks: &["compile", "balls", "rays", "things", "sleep", "orient"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[Bundle::Mjz],
    settings: plume_registry::settings_schema::<MujocoSettings>,
    build: Build::Plain(|table| Ok(Box::new(Mujoco(serde_json::from_value(table)?)))),
};

/// Settings of target `mujoco`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct MujocoSettings {
    /// Collision shapes: `pieces`, convex pieces of the rock, fast, for floor, walls and ceiling; `flex`, the triangles
    /// of the collision mesh as a rigid flex, exact but slow; `floor_field`, a height field per chunk, fast, but only
    /// for floors, and refused where passages of a chunk run above one another.
    pub collision: Collision,
    /// Sample spacing of `floor_field` in metres.
    #[schemars(range(min = 0.01, max = 1.0))]
    pub field_spacing_m: f64,
    /// Number of lamps that are switched on, those nearest to the first start pose; the others exist but are off.
    /// MuJoCo's own renderer shows eight lights, of which the headlight takes one and the rover two.
    #[schemars(range(max = 100))]
    pub lights: u32,
    /// Ambient light, 0 (black) to 1: not physical underground, but without it a camera without a light sees nothing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub ambient: f64,
    /// Physics time step in seconds.
    #[schemars(range(min = 0.0001, max = 0.01))]
    pub physics_step_s: f64,
    /// Include what cameras see: visual meshes, gravel and textures. For training without images: the model compiles in less
    /// time, and MuJoCo, which looks at every geom in every step, steps faster along the same trajectory.
    pub visuals: bool,
    /// Things that are shorter than this in every direction have no collision shape, in metres: wheels and feet pass through
    /// them. Movable ones always have one.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub least_hull_m: f64,
}

impl Default for MujocoSettings {
    fn default() -> Self {
        Self {
            collision: Collision::Pieces,
            field_spacing_m: 0.1,
            lights: 4,
            ambient: 0.3,
            physics_step_s: 0.002,
            visuals: true,
            least_hull_m: 0.0,
        }
    }
}

/// Collision shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Collision {
    /// Convex pieces.
    Pieces,
    /// The triangles of the collision mesh.
    Flex,
    /// A height field per chunk.
    FloorField,
}

/// Name of the rover, and prefix of the names of its parts.
const ROVER: &str = "rover";
/// The extent by which MuJoCo scales its view: about the visibility in a passage. Tuned.
const EXTENT_M: f64 = 10.0;
/// MuJoCo's own renderer shows linear colours without gamma, which is too dark; brighter lamps partly compensate. Tuned by
/// eye.
const LIGHT_GAIN: f64 = 2.5;
/// Near clipping plane, metres.
const NEAR_M: f64 = 0.05;
/// Area of floor above another floor that a height field may lose, in square metres: ledges of rock, but no passage.
const MOST_STACKED_M2: f64 = 4.0;
/// Collision geoms from which mujoco-warp takes long to start, because it lists all pairs of them: 2,700 took 1.8 s and
/// 0.9 GB, 12,200 took 46 s and 10.8 GB.
const MOST_GEOMS_OF_WARP: u64 = 4000;
/// Far clipping plane, metres.
const FAR_M: f64 = 500.0;

/// The target.
pub struct Mujoco(
    /// Its settings.
    pub MujocoSettings,
);

impl Target for Mujoco {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        if scene.name == ROVER {
            return Err(ExportError::BadScene {
                scene: scene.name.clone(),
                fault: "its name is the rover's".to_owned(),
            });
        }
        let name = &scene.name;
        let texts = self.values(scene);
        let options = template::fill("options.xml", include_str!("../templates/mujoco/options.xml.jinja"), &texts);
        let world = World::write_files(self, scene, out)?;
        write_rover(None, &format!("{ROVER}.xml"), out)?;
        let shapes = match out.bundle() {
            Some(Bundle::Mjz) => {
                write_rover(Some((scene, "model.xml", &world.things)), &format!("{name}_rover.xml"), out)?;
                world.write_whole("model.xml", &options, out)?
            }
            _ => {
                let cave = format!("{name}.xml");
                write_rover(Some((scene, &cave, &world.things)), &format!("{name}_rover.xml"), out)?;
                let include = format!("  <include file=\"{name}_world.xml\"/>");
                out.text(&cave, &format!("<mujoco model=\"{name}\">\n{options}{include}\n</mujoco>\n"))?;
                world.write_parts(out)?
            }
        };
        let geoms = Some(shapes.geoms).filter(|geoms| *geoms > MOST_GEOMS_OF_WARP);
        let (things, bodies) = (world.things.are_there(), world.things.bodies());
        let texts = context! { things, bodies, geoms, ..texts };
        out.text(
            "README.md",
            &template::fill("README.md", include_str!("../templates/mujoco/README.md.jinja"), &texts),
        )?;
        let open = match out.bundle() {
            Some(Bundle::Mjz) => {
                Open::Words("mujoco.MjSpec.from_zip(path).compile() in Python, or MuJoCo's viewers".to_owned())
            }
            _ => Open::Command(format!("python -m mujoco.viewer --mjcf={name}_rover.xml")),
        };
        Ok(Summary { visual_triangles: world.visual_triangles, collision_triangles: shapes.triangles, open })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == Collision::Pieces
    }

    fn moves_things(&self) -> bool {
        true
    }
}

impl Mujoco {
    fn rock(&self, scene: &Scene, index: usize) -> Result<Rock, ExportError> {
        Ok(match self.0.collision {
            Collision::Pieces => Rock::Pieces(scene.pieces(index)?),
            Collision::Flex => Rock::Flex(scene.chunk(index)?.collision),
            Collision::FloorField => Rock::Field(self.field(&scene.chunk(index)?)?),
        })
    }

    /// The height field of a chunk, unless one field cannot hold its floors.
    fn field(&self, chunk: &Chunk) -> Result<Field, ExportError> {
        let field = Field::new(&chunk.visual, self.0.field_spacing_m);
        match field.stacked_m2() {
            area_m2 if area_m2 > MOST_STACKED_M2 => {
                Err(ExportError::StackedFloors { chunk: chunk.name.clone(), area_m2 })
            }
            _ => Ok(field),
        }
    }

    fn values(&self, scene: &Scene) -> Value {
        let zones = Zone::ALL.map(|zone| context! { name => zone.name(), friction => micro(scene.friction.of(zone)) });
        context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            chunks => scene.chunks.len(),
            visuals => self.0.visuals,
            least_hull_m => (self.0.least_hull_m > 0.0).then(|| micro(self.0.least_hull_m)),
            collision => Serde(self.0.collision),
            zones => zones.to_vec(),
            contact => Value::from_safe_string(chunk::CONTACT.to_owned()),
            spawns => scene.spawns.iter().map(spawn_text).collect::<Vec<_>>(),
            stations => scene.network.landmarks().iter().map(station_text).collect::<Vec<_>>(),
            lights => Serde(self.lights(scene)),
            gravity => micro(scene.gravity),
            ambient => micro(self.0.ambient),
            step_s => micro(self.0.physics_step_s),
            extent_m => micro(EXTENT_M),
            center => position(&scene.viewpoint()),
            near => micro(NEAR_M / EXTENT_M),
            far => micro(FAR_M / EXTENT_M),
        }
    }

    /// The lamps, of which those nearest to the first start pose are lit.
    fn lights(&self, scene: &Scene) -> Vec<LightText> {
        let start = scene.spawns[0].translation.vector;
        let distance = |light: &Light| (light.position.coords - start).norm();
        let mut by_distance: Vec<f64> = scene.lights.iter().map(distance).collect();
        by_distance.sort_by(f64::total_cmp);
        let reach = by_distance.get(self.0.lights as usize).copied().unwrap_or(f64::INFINITY);
        scene.lights.iter().map(|light| LightText::new(light, distance(light) < reach)).collect()
    }
}

/// A light for the templates.
#[derive(Serialize)]
struct LightText {
    name: String,
    is_lit: bool,
    position: String,
    color: String,
    attenuation: String,
    intensity_cd: String,
    range_m: String,
}

impl LightText {
    fn new(light: &Light, is_lit: bool) -> Self {
        let text = |numbers: [f64; 3]| numbers.map(micro).join(" ");
        // MuJoCo's own renderer adds light in display space, where the inverse square of the distance looks about like the
        // inverse. The constant prevents overexposed rock near a lamp.
        let attenuation = [1.0, libm::sqrt(std::f64::consts::PI / light.intensity_cd), 0.0];
        Self {
            name: light.name.clone(),
            is_lit,
            position: text(light.position.into()),
            color: text(light.color.map(|part| part * LIGHT_GAIN)),
            attenuation: text(attenuation),
            intensity_cd: micro(light.intensity_cd),
            range_m: micro(light.range_m),
        }
    }
}

/// Writes the rover, alone or at the first start pose of a scene with the given model file and things.
fn write_rover(cave: Option<(&Scene, &str, &Things)>, path: &str, out: &mut dyn Package) -> Result<(), ExportError> {
    let lift = Translation3::new(0.0, 0.0, rover::START_HEIGHT_M);
    let start = cave.map_or(Isometry3::identity(), |(scene, ..)| scene.spawns[0] * lift);
    let cave = cave.map(|(scene, file, things)| {
        // The model file, and so its free bodies, comes before the rover.
        let qpos = format!("{}{} {}", things.coordinates(), position(&start), quaternion(&start));
        context! { name => &scene.name, file, qpos }
    });
    let values = context! { cave, pose => pose_text(&start), rover => Serde(Rover::new()) };
    out.text(path, &template::fill(path, include_str!("../templates/mujoco/rover.xml.jinja"), &values))
}

fn spawn_text(spawn: &Isometry3<f64>) -> Value {
    let camera = frame::camera_from_body(&(spawn * Translation3::new(0.0, 0.0, 1.0)));
    context! { site => pose_text(spawn), camera => pose_text(&camera) }
}

/// A pose as attributes.
fn station_text(landmark: &Landmark) -> Value {
    context! { frame => &landmark.frame, position => position(&landmark.pose()) }
}

fn pose_text(pose: &Isometry3<f64>) -> Value {
    let text = format!(r#"pos="{}" quat="{}""#, position(pose), quaternion(pose));
    Value::from_safe_string(text)
}

fn position(pose: &Isometry3<f64>) -> String {
    <[f64; 3]>::from(pose.translation.vector).map(micro).join(" ")
}

/// The rotation as w, x, y, z.
fn quaternion(pose: &Isometry3<f64>) -> String {
    let turn = pose.rotation.quaternion();
    [turn.w, turn.i, turn.j, turn.k].map(micro).join(" ")
}
