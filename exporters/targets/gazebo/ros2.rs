//! What ROS 2 needs to drive a rover through the world: see the README of the folder `ros2`.
//!
//! ```text
//! models/<name>_rover/   the rover, with drive, odometry, lamps, RGB-D camera, IMU and lidar
//! ros2/launch/           launch files, which find everything else by their own place
//! ros2/config/           parameters, views, and which topics are bridged
//! ros2/urdf/rover.urdf   the frames of the rover
//! ros2/maps/             target `truth` with nothing but the maps
//! ```
//! There is no ROS package to build: `ros2 launch` takes a path.

use minijinja::value::Serde;
use minijinja::{Value, context};
use nalgebra::Translation3;
use serde_json::json;

use super::{Gazebo, GazeboSettings};
use crate::error::ExportError;
use crate::frame::{euler_pose, micro};
use crate::package::Package;
use crate::rover::{self, Rover};
use crate::scene::Scene;
use crate::target::Built;
use crate::with::With;
use crate::{target, template};

/// Templates by their path in the package, where `{name}` is that of the scene.
const FILES: [(&str, &str); 13] = [
    ("models/{name}_rover/model.config", include_str!("../../templates/gazebo/ros2/model.config.jinja")),
    ("models/{name}_rover/model.sdf", include_str!("../../templates/gazebo/ros2/model.sdf.jinja")),
    ("ros2/README.md", include_str!("../../templates/gazebo/ros2/README.md.jinja")),
    ("ros2/launch/cave.launch.py", include_str!("../../templates/gazebo/ros2/cave.launch.py.jinja")),
    ("ros2/launch/rtabmap.launch.py", include_str!("../../templates/gazebo/ros2/rtabmap.launch.py.jinja")),
    ("ros2/launch/nav2.launch.py", include_str!("../../templates/gazebo/ros2/nav2.launch.py.jinja")),
    ("ros2/config/bridge.yaml", include_str!("../../templates/gazebo/ros2/bridge.yaml.jinja")),
    ("ros2/config/bridge_truth.yaml", include_str!("../../templates/gazebo/ros2/bridge_truth.yaml.jinja")),
    ("ros2/config/rtabmap.yaml", include_str!("../../templates/gazebo/ros2/rtabmap.yaml.jinja")),
    ("ros2/config/nav2.yaml", include_str!("../../templates/gazebo/ros2/nav2.yaml.jinja")),
    ("ros2/config/foxglove.json", include_str!("../../templates/gazebo/ros2/foxglove.json.jinja")),
    ("ros2/config/cave.rviz", include_str!("../../templates/gazebo/ros2/cave.rviz.jinja")),
    ("ros2/urdf/rover.urdf", include_str!("../../templates/gazebo/ros2/rover.urdf.jinja")),
];

/// The image of the camera.
const IMAGE_PX: [u32; 2] = [640, 480];

/// What the rover of the maps gets over, with the lidar on its head.
const MAPS: Robot = Robot { height_m: 0.8, step_m: 0.1, slope_deg: 25.0 };

struct Robot {
    height_m: f64,
    step_m: f64,
    slope_deg: f64,
}

/// The target with these settings, with maps inside if a rover is to be there.
pub fn build(settings: GazeboSettings) -> Built {
    let has_rover = settings.ros2;
    let gazebo = Box::new(Gazebo(settings));
    if !has_rover {
        return Ok(gazebo);
    }
    let Robot { height_m, step_m, slope_deg } = MAPS;
    let maps = json!({ "files": ["maps"], "height_m": height_m, "step_m": step_m, "slope_deg": slope_deg });
    let inside = vec![("ros2/maps".to_owned(), target("truth")?.build(maps, None)?)];
    Ok(Box::new(With { target: gazebo, inside }))
}

/// Writes all of it but the maps.
pub fn write(scene: &Scene, out: &mut dyn Package) -> Result<(), ExportError> {
    let values = values(scene);
    for (path, template) in FILES {
        let path = path.replace("{name}", &scene.name);
        out.text(&path, &template::fill(&path, template, &values))?;
    }
    Ok(())
}

fn values(scene: &Scene) -> Value {
    let rover = Rover::new();
    let [width, height] = IMAGE_PX.map(f64::from);
    let half_view = libm::tan(rover.camera.view_deg.to_radians() / 2.0) * width / height;
    let (at_m, angles) = euler_pose(&(scene.spawns[0] * Translation3::new(0.0, 0.0, rover::START_HEIGHT_M)));
    context! {
        name => &scene.name,
        description => &scene.description,
        generator => &scene.generator,
        rover => Serde(&rover),
        image_px => IMAGE_PX.to_vec(),
        view_rad => micro(2.0 * libm::atan(half_view)),
        start_m => at_m.map(micro).to_vec(),
        start_rad => angles.map(micro).to_vec(),
        cone_rad => [1.0, 2.0].map(|share| micro(share * rover.lamp.half_angle_deg.to_radians())).to_vec(),
        lamp_intensity => micro(super::intensity(rover.lamp.intensity_cd)),
        maps => context! { height_m => MAPS.height_m, step_m => MAPS.step_m, slope_deg => MAPS.slope_deg },
    }
}
