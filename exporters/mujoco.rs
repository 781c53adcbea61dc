//! Target `mujoco`: MJCF for MuJoCo 4 and later.
//!
//! ```text
//! <name>.xml          the cave alone, ready to compile
//! <name>_world.xml    the cave without options, for a model of the user's
//! <name>_rover.xml    the cave with the rover at the first start pose
//! rover.xml           the rover alone
//! assets/             fragments (.mjcf), meshes (.msh) and textures
//! README.md
//! ```
//! Names begin with that of the scene, and what is included sets no option, so that nothing clashes with a model of the
//! user's. Fragments are not called `.xml` because MuJoCo takes the last file of that name in an archive for the model.
//! Paths are relative to the model that is opened; there is no `meshdir`, which would rule over the user's meshes, too.

use minijinja::context;
use minijinja::value::Serde;
use nalgebra::{Isometry3, Translation3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::frame::{self, micro};
use crate::package::Package;
use crate::scene::{Light, Scene, Zone};
use crate::{Build, Summary, Target, TargetRow, settings, template};

use self::chunk::Collision;

mod chunk;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "mujoco",
    summary: "MJCF with convex pieces for collision, PBR textures, start poses and a sample rover",
    opened_by: "MuJoCo 4 and later",
    settings: || schemars::schema_for!(MujocoSettings),
    build: Build::Plain(|table| Ok(Box::new(Mujoco(settings("mujoco", table)?)))),
};

/// Settings of target `mujoco`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct MujocoSettings {
    /// How many lamps of the scene shine, those nearest to the first start pose; the others are there but off. MuJoCo's
    /// own renderer shows eight lights, of which the headlight takes one and the rover two.
    #[schemars(range(max = 100))]
    pub lights: u32,
    /// Ambient light, 0 (black) to 1, the same everywhere: not physical underground, but without any a camera without
    /// a lamp sees nothing.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub ambient: f64,
    /// Physics step in seconds.
    #[schemars(range(min = 0.0001, max = 0.01))]
    pub physics_step_s: f64,
}

impl Default for MujocoSettings {
    fn default() -> Self {
        Self { lights: 4, ambient: 0.1, physics_step_s: 0.002 }
    }
}

/// The rover starts this far above the ground and drops, since the ground under its wheels is not flat. Tuned.
const START_HEIGHT_M: f64 = 0.05;
/// What MuJoCo scales its view by: about as far as one sees in a passage. Tuned.
const EXTENT_M: f64 = 10.0;
/// The nearest that is drawn, metres.
const NEAR_M: f64 = 0.05;
/// The furthest that is drawn, metres.
const FAR_M: f64 = 500.0;

/// The target.
pub struct Mujoco(
    /// Its settings.
    pub MujocoSettings,
);

impl Target for Mujoco {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (mut parts, mut triangles) = (Vec::new(), [0, 0]);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            let collision = Collision::Pieces(scene.pieces(index)?);
            triangles[0] += chunk.visual.triangles();
            triangles[1] += collision.triangles();
            chunk::write(&scene.name, &chunk, &collision, out)?;
            parts.push(chunk::path(&chunk.name));
        }
        self.write_texts(scene, &parts, out)?;
        Ok(Summary {
            visual_triangles: triangles[0],
            collision_triangles: triangles[1],
            open: format!("python -m mujoco.viewer --mjcf={}_rover.xml", scene.name),
        })
    }

    fn wants_pieces(&self) -> bool {
        true
    }
}

impl Mujoco {
    fn write_texts(&self, scene: &Scene, parts: &[String], out: &mut dyn Package) -> Result<(), ExportError> {
        let name = &scene.name;
        let start = scene.spawns[0] * Translation3::new(0.0, 0.0, START_HEIGHT_M);
        let zones = Zone::ALL.map(|zone| context! { name => zone.name(), friction => micro(scene.friction.of(zone)) });
        let values = context! {
            name,
            description => &scene.description,
            generator => &scene.generator,
            parts => parts.to_vec(),
            zones => zones.to_vec(),
            spawns => scene.spawns.iter().map(spawn_text).collect::<Vec<_>>(),
            lights => Serde(self.lights(scene)),
            gravity => micro(scene.gravity),
            ambient => micro(self.0.ambient),
            step_s => micro(self.0.physics_step_s),
            extent_m => micro(EXTENT_M),
            center => position(&scene.viewpoint()),
            near => micro(NEAR_M / EXTENT_M),
            far => micro(FAR_M / EXTENT_M),
        };
        let cave = context! { name, qpos => format!("{} {}", position(&start), quaternion(&start)) };
        let none = minijinja::Value::from(());
        let rover = |cave, pose: &Isometry3<f64>| context! { cave, pose => pose_text(pose) };
        let (alone, in_cave) = (rover(none, &Isometry3::identity()), rover(cave, &start));
        let rover = include_str!("../templates/mujoco/rover.xml.jinja");
        for (path, template, values) in [
            (format!("assets/{name}.mjcf"), include_str!("../templates/mujoco/parts.mjcf.jinja"), &values),
            (format!("{name}_world.xml"), include_str!("../templates/mujoco/world.xml.jinja"), &values),
            ("rover.xml".to_owned(), rover, &alone),
            (format!("{name}_rover.xml"), rover, &in_cave),
            (format!("{name}.xml"), include_str!("../templates/mujoco/cave.xml.jinja"), &values),
            ("README.md".to_owned(), include_str!("../templates/mujoco/README.md.jinja"), &values),
        ] {
            out.text(&path, &template::fill(&path, template, values))?;
        }
        Ok(())
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

/// A light as the templates see it.
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
        // MuJoCo's own renderer adds light as the screen shows it, where the inverse square of the distance looks about
        // like the inverse. The constant keeps rock beside a lamp from burning out.
        let attenuation = [1.0, libm::sqrt(std::f64::consts::PI / light.intensity_cd), 0.0];
        Self {
            name: light.name.clone(),
            is_lit,
            position: text(light.position.into()),
            color: text(light.color),
            attenuation: text(attenuation),
            intensity_cd: micro(light.intensity_cd),
            range_m: micro(light.range_m),
        }
    }
}

fn spawn_text(spawn: &Isometry3<f64>) -> minijinja::Value {
    let camera = frame::camera_from_body(&(spawn * Translation3::new(0.0, 0.0, 1.0)));
    context! { site => pose_text(spawn), camera => pose_text(&camera) }
}

/// A pose as attributes.
fn pose_text(pose: &Isometry3<f64>) -> minijinja::Value {
    let text = format!(r#"pos="{}" quat="{}""#, position(pose), quaternion(pose));
    minijinja::Value::from_safe_string(text)
}

fn position(pose: &Isometry3<f64>) -> String {
    <[f64; 3]>::from(pose.translation.vector).map(micro).join(" ")
}

/// The rotation as w, x, y, z.
fn quaternion(pose: &Isometry3<f64>) -> String {
    let turn = pose.rotation.quaternion();
    [turn.w, turn.i, turn.j, turn.k].map(micro).join(" ")
}
