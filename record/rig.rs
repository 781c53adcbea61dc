//! What the body carries, as a user describes it: `rig.toml`.
//!
//! Poses of sensors are in the frame of the body, which is x forward, y left, z up: `position_m`, and `rpy_deg` as roll, pitch and
//! yaw about fixed x, y, z. A camera without rotation looks along the x axis of the body, a lidar without rotation scans around its
//! z axis.
//!
//! ```
//! use plume_record::rig::Rig;
//!
//! let rig = Rig::preset("rgbd").unwrap();
//! assert_eq!((rig.cameras.len(), rig.lidars.len()), (1, 1));
//! let error = Rig::parse("[imu]\nrate_hz = 0.0\n", "rig.toml".as_ref()).unwrap_err();
//! assert!(error.to_string().contains("imu.rate_hz"));
//! ```

use std::collections::BTreeSet;
use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use plume_graph::echo;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::RecordError;
use crate::trajectory::exp;

mod check;

/// Largest file.
const MOST_BYTES: u64 = 1 << 20;
/// Most sensors of a kind.
const MOST_SENSORS: usize = 16;

/// The rigs that are built in: a name, and a commented text.
pub const PRESETS: [(&str, &str); 5] = [
    ("rgbd", include_str!("rigs/rgbd.toml")),
    ("stereo", include_str!("rigs/stereo.toml")),
    ("easy", include_str!("rigs/easy.toml")),
    ("hard", include_str!("rigs/hard.toml")),
    ("dark", include_str!("rigs/dark.toml")),
];

/// The sensors and the light on a body. A section that is missing is a sensor that it does not have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Rig {
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// Lidars.
    pub lidars: Vec<Lidar>,
    /// Inertial measurement unit.
    pub imu: Option<Imu>,
    /// Wheel odometry.
    pub odometry: Option<Odometry>,
    /// Light by which the images are taken.
    pub light: Lighting,
}

/// A camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Name: a lower-case letter, then letters, digits and _.
    pub name: String,
    /// Images per second.
    #[schemars(range(min = 0.1, max = 240.0))]
    pub rate_hz: f64,
    /// Width and height in pixels.
    #[schemars(inner(range(min = 8, max = 4096)))]
    pub size_px: [u32; 2],
    /// Horizontal field of view of the lens without its distortion, in degrees; below 180 for a pinhole.
    #[schemars(range(min = 5.0, max = 240.0))]
    pub fov_deg: f64,
    /// Place in the body, in metres.
    #[serde(default)]
    #[schemars(inner(range(min = -100.0, max = 100.0)))]
    pub position_m: [f64; 3],
    /// Rotation in the body: roll, pitch, yaw in degrees.
    #[serde(default)]
    #[schemars(inner(range(min = -360.0, max = 360.0)))]
    pub rpy_deg: [f64; 3],
    /// The lens.
    #[serde(default)]
    pub lens: Lens,
    /// What is recorded.
    #[serde(default = "Camera::usual_outputs")]
    pub outputs: Vec<Output>,
    /// The depth sensor.
    #[serde(default)]
    pub depth: Depth,
}

/// A lens and its distortion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "lowercase", tag = "model")]
pub enum Lens {
    /// Perspective with the radial and tangential distortion of Brown and Conrady, as in OpenCV.
    Pinhole {
        /// `k1, k2, p1, p2, k3`.
        #[serde(default)]
        #[schemars(inner(range(min = -10.0, max = 10.0)))]
        distortion: [f64; 5],
    },
    /// The fisheye of Kannala and Brandt (2006), as in OpenCV's `fisheye`: depth is the distance from the camera, not that
    /// along its axis.
    Fisheye {
        /// `k1, k2, k3, k4`.
        #[serde(default)]
        #[schemars(inner(range(min = -10.0, max = 10.0)))]
        distortion: [f64; 4],
    },
}

impl Default for Lens {
    fn default() -> Self {
        Self::Pinhole { distortion: [0.0; 5] }
    }
}

/// Something that is recorded for every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Output {
    /// The colour image.
    Image,
    /// What the depth sensor measures.
    Depth,
    /// Depth without noise and limits.
    ExactDepth,
    /// Unit normal of the surface in the camera's optical frame.
    Normal,
    /// Class of the surface.
    Label,
    /// Number of the thing, 0 for rock and gravel.
    Instance,
    /// Where the point is in the next image, in pixels from here, whether or not something hides it there.
    Flow,
}

/// A depth sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Depth {
    /// Nearest depth that is measured, in metres.
    #[schemars(range(min = 0.0, max = 100.0))]
    pub min_m: f64,
    /// Farthest depth that is measured, in metres.
    #[schemars(range(min = 0.1, max = 1000.0))]
    pub max_m: f64,
    /// Standard deviation of the noise at a depth of one metre, in metres; it grows with the square of the depth.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub noise_m: f64,
}

impl Default for Depth {
    fn default() -> Self {
        Self { min_m: 0.3, max_m: 10.0, noise_m: 0.0025 }
    }
}

/// A lidar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lidar {
    /// Name: a lower-case letter, then letters, digits and _.
    pub name: String,
    /// Sweeps per second.
    #[schemars(range(min = 0.1, max = 100.0))]
    pub rate_hz: f64,
    /// Place in the body, in metres.
    #[serde(default)]
    #[schemars(inner(range(min = -100.0, max = 100.0)))]
    pub position_m: [f64; 3],
    /// Rotation in the body: roll, pitch, yaw in degrees.
    #[serde(default)]
    #[schemars(inner(range(min = -360.0, max = 360.0)))]
    pub rpy_deg: [f64; 3],
    /// Where its beams go.
    pub scan: Scan,
    /// Shortest range in metres.
    #[serde(default = "Lidar::usual_min_m")]
    #[schemars(range(min = 0.0, max = 100.0))]
    pub min_m: f64,
    /// Longest range in metres.
    #[serde(default = "Lidar::usual_max_m")]
    #[schemars(range(min = 0.1, max = 1000.0))]
    pub max_m: f64,
    /// Standard deviation of a range, in metres.
    #[serde(default = "Lidar::usual_noise_m")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub noise_m: f64,
}

/// Where the beams of a lidar go during a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "lowercase", tag = "pattern")]
pub enum Scan {
    /// Beams one above the other that turn once a sweep, anticlockwise from ahead.
    Spinning {
        /// Number of beams, such as 16, 32 or 64.
        #[schemars(range(min = 1, max = 256))]
        beams: u32,
        /// Elevation of the lowest beam in degrees.
        #[schemars(range(min = -90.0, max = 90.0))]
        lowest_deg: f64,
        /// Elevation of the highest beam in degrees.
        #[schemars(range(min = -90.0, max = 90.0))]
        highest_deg: f64,
        /// Number of times that all beams measure in a sweep.
        #[schemars(range(min = 4, max = 8192))]
        columns: u32,
    },
    /// One beam that two turning prisms lead through a cone ahead along a rosette that does not repeat itself from sweep to sweep,
    /// as in solid-state lidars.
    Rosette {
        /// Angle of the cone in degrees.
        #[schemars(range(min = 5.0, max = 120.0))]
        cone_deg: f64,
        /// Points of a sweep.
        #[schemars(range(min = 100, max = 1_000_000))]
        points: u32,
        /// Turns of either prism per second.
        #[serde(default = "Scan::usual_prisms_hz")]
        #[schemars(inner(range(min = -1000.0, max = 1000.0)))]
        prisms_hz: [f64; 2],
    },
}

impl Scan {
    /// Incommensurable, so that the figure drifts; tuned by eye for an even cover within a second.
    pub(crate) fn usual_prisms_hz() -> [f64; 2] {
        [121.567, -77.733]
    }
}

/// An inertial measurement unit: each axis has white noise and a bias that walks at random (see the IMU model of Kalibr).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Imu {
    /// Measurements per second.
    #[schemars(range(min = 1.0, max = 4000.0))]
    pub rate_hz: f64,
    /// Place in the body, in metres.
    #[schemars(inner(range(min = -100.0, max = 100.0)))]
    pub position_m: [f64; 3],
    /// Rotation in the body: roll, pitch, yaw in degrees.
    #[schemars(inner(range(min = -360.0, max = 360.0)))]
    pub rpy_deg: [f64; 3],
    /// Noise density of the gyroscope, in rad/s/√Hz.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub gyro_noise: f64,
    /// Random walk of the bias of the gyroscope, in rad/s²/√Hz.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub gyro_walk: f64,
    /// Noise density of the accelerometer, in m/s²/√Hz.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub accel_noise: f64,
    /// Random walk of the bias of the accelerometer, in m/s³/√Hz.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub accel_walk: f64,
}

impl Default for Imu {
    /// The figures of EuRoC's sensor files for its ADIS16448.
    fn default() -> Self {
        Self {
            rate_hz: 200.0,
            position_m: [0.0; 3],
            rpy_deg: [0.0; 3],
            gyro_noise: 1.6968e-4,
            gyro_walk: 1.9393e-5,
            accel_noise: 2.0e-3,
            accel_walk: 3.0e-3,
        }
    }
}

/// Wheel odometry of a body that moves along its x axis and turns about its z axis: what it does sideways is lost, as on wheels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Odometry {
    /// Measurements per second.
    #[schemars(range(min = 1.0, max = 1000.0))]
    pub rate_hz: f64,
    /// Standard deviation of the speed, as a share of it.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub speed_noise: f64,
    /// Standard deviation of the rate of turn, as a share of it.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub turn_noise: f64,
    /// Standard deviation of the constant errors of both, as a share: wheels that are a little larger, or further apart.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub scale_error: f64,
}

impl Default for Odometry {
    /// Tuned by hand to about 2 % of the way.
    fn default() -> Self {
        Self { rate_hz: 50.0, speed_noise: 0.05, turn_noise: 0.1, scale_error: 0.01 }
    }
}

/// Light, and what a camera makes of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Lighting {
    /// Luminous intensity of the headlamp along its axis, in candela; 0 is none.
    #[schemars(range(min = 0.0, max = 100_000.0))]
    pub headlamp_cd: f64,
    /// Place of the headlamp in the body, in metres.
    #[schemars(inner(range(min = -100.0, max = 100.0)))]
    pub headlamp_position_m: [f64; 3],
    /// Angle of the headlamp's beam within which it has at least half its intensity, in degrees.
    #[schemars(range(min = 5.0, max = 170.0))]
    pub headlamp_beam_deg: f64,
    /// Whether the lamps of the cave are on.
    pub cave_lamps: bool,
    /// Light from all sides on everything, in cd/m² on white: what stray light leaves of darkness.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub ambient_cd_m2: f64,
    /// How much of the light dust in the air scatters per metre.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub dust_per_m: f64,
    /// Exposure: the luminance in cd/m² that is white; 0 measures each image and follows it.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub white_cd_m2: f64,
    /// Electrons that a pixel collects at 1 cd/m² in the longest time of exposure: small ones make dark images noisy.
    #[schemars(range(min = 1.0, max = 1e9))]
    pub electrons_per_cd_m2: f64,
    /// How much gain brightens an image at the most where the longest exposure does not; 16 are 24 dB.
    #[schemars(range(min = 1.0, max = 1e9))]
    pub max_gain: f64,
    /// Electrons of a pixel that is white at the lowest gain.
    #[schemars(range(min = 100.0, max = 1e6))]
    pub full_well: f64,
    /// Noise of reading a pixel, in electrons.
    #[schemars(range(min = 0.0, max = 1e4))]
    pub read_noise: f64,
}

impl Default for Lighting {
    /// Tuned by eye.
    fn default() -> Self {
        Self {
            headlamp_cd: 20.0,
            headlamp_position_m: [0.0, -0.15, 0.15],
            headlamp_beam_deg: 90.0,
            cave_lamps: false,
            ambient_cd_m2: 0.0005,
            dust_per_m: 0.0,
            white_cd_m2: 0.0,
            electrons_per_cd_m2: 30_000.0,
            max_gain: 16.0,
            full_well: 10_000.0,
            read_noise: 4.0,
        }
    }
}

impl Lighting {
    /// The luminance in cd/m² that is white in the longest exposure at the highest gain.
    pub(crate) fn least_white_cd_m2(&self) -> f64 {
        self.full_well / (self.electrons_per_cd_m2 * self.max_gain)
    }
}

impl Camera {
    fn usual_outputs() -> Vec<Output> {
        vec![Output::Image, Output::Depth]
    }

    /// From its optical frame, z ahead, x right, y down, to the body.
    pub fn body_from_optical(&self) -> Isometry3<f64> {
        let mount_from_optical = Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0);
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(mount_from_optical));
        pose(self.position_m, self.rpy_deg) * turn
    }
}

impl Lidar {
    fn usual_min_m() -> f64 {
        0.1
    }

    fn usual_max_m() -> f64 {
        100.0
    }

    fn usual_noise_m() -> f64 {
        0.02
    }

    /// From its frame to the body.
    pub fn body_from_lidar(&self) -> Isometry3<f64> {
        pose(self.position_m, self.rpy_deg)
    }
}

impl Imu {
    /// From its frame to the body.
    pub fn body_from_imu(&self) -> Isometry3<f64> {
        pose(self.position_m, self.rpy_deg)
    }
}

impl Rig {
    /// The rig in a file.
    ///
    /// # Errors
    /// [`RecordError::Input`] if it cannot be read; as [`Rig::parse`].
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let input = |source| RecordError::Input { path: path.to_owned(), source };
        let bytes = plume_disk::regular::read(path, MOST_BYTES).map_err(input)?;
        Self::parse(&String::from_utf8_lossy(&bytes), path)
    }

    /// The built-in rig of this name.
    pub fn preset(name: &str) -> Option<Self> {
        let (_, text) = PRESETS.iter().find(|(known, _)| *known == name)?;
        Self::parse(text, name.as_ref()).ok()
    }

    /// The rig in a text; `file` is its name in messages.
    ///
    /// # Errors
    /// [`RecordError::Rig`] if a key is unknown, has no value of its type, or is out of its range.
    pub fn parse(text: &str, file: &Path) -> Result<Self, RecordError> {
        let fault =
            |fault: String, hint: &str| RecordError::Rig { file: file.to_owned(), fault, hint: hint.to_owned() };
        let rig: Self = toml::from_str(text).map_err(|error| {
            let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            fault(format!("line {line}: {}", echo::sentence(error.message())), HINT)
        })?;
        let value = serde_json::to_value(&rig).expect("a rig is plain data");
        let schema = schemars::schema_for!(Self).to_value();
        if let Some(found) = check::first_fault(&value, &schema) {
            return Err(fault(found, HINT));
        }
        rig.check().map_err(|(found, hint)| fault(found, hint))?;
        Ok(rig)
    }

    /// What ranges cannot say.
    fn check(&self) -> Result<(), (String, &'static str)> {
        if self.cameras.len().max(self.lidars.len()) > MOST_SENSORS {
            return Err((format!("has more than {MOST_SENSORS} sensors of a kind"), "leave some out"));
        }
        let names = self.cameras.iter().map(|camera| &camera.name).chain(self.lidars.iter().map(|lidar| &lidar.name));
        let mut taken = BTreeSet::new();
        for name in names {
            if !is_name(name) {
                return Err((
                    format!("{} is not a name", echo::shown(name)),
                    "a name is a lower-case letter, then letters, digits and _",
                ));
            }
            if !taken.insert(name) {
                return Err((format!("two sensors are called {}", echo::shown(name)), "give each its own name"));
            }
        }
        for camera in &self.cameras {
            let is_wide = camera.fov_deg >= 179.0 && matches!(camera.lens, Lens::Pinhole { .. });
            if is_wide {
                return Err((
                    format!("cameras.{}.fov_deg: a pinhole sees less than 179°", camera.name),
                    "use lens.model = \"fisheye\"",
                ));
            }
            if camera.depth.min_m >= camera.depth.max_m {
                return Err((format!("cameras.{}.depth: min_m is not below max_m", camera.name), "exchange them"));
            }
        }
        match self.lidars.iter().find(|lidar| lidar.min_m >= lidar.max_m) {
            Some(lidar) => Err((format!("lidars.{}: min_m is not below max_m", lidar.name), "exchange them")),
            None => Ok(()),
        }
    }

    /// The farthest that any sensor sees, in metres.
    pub fn reach_m(&self) -> f64 {
        /// How far images show something: no passage is longer in one view.
        const IMAGE_M: f64 = 200.0;
        let of_cameras = self.cameras.iter().map(|camera| match &camera.outputs[..] {
            [Output::Depth] => camera.depth.max_m,
            _ => IMAGE_M,
        });
        of_cameras.chain(self.lidars.iter().map(|lidar| lidar.max_m)).fold(0.0, f64::max)
    }

    /// Whether any sensor sees the colour of things.
    pub fn sees_colour(&self) -> bool {
        !self.lidars.is_empty() || self.cameras.iter().any(|camera| camera.outputs.contains(&Output::Image))
    }
}

const HINT: &str = "`plume record --print-rig` prints a rig in which every key is explained";

fn is_name(name: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(is_letter) && name.len() <= 40
}

/// A pose from its place and its angles about fixed x, y, z in degrees.
fn pose(position_m: [f64; 3], rpy_deg: [f64; 3]) -> Isometry3<f64> {
    let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
    let turn = exp(&(Vector3::z() * yaw)) * exp(&(Vector3::y() * pitch)) * exp(&(Vector3::x() * roll));
    Isometry3::from_parts(Translation3::from(Vector3::from(position_m)), turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_rig() {
        for (name, text) in PRESETS {
            Rig::parse(text, name.as_ref()).unwrap();
        }
    }

    /// The default one explains all keys but those of other lenses and scans.
    #[test]
    fn the_first_preset_names_every_key() {
        let schema = serde_json::to_string(&schemars::schema_for!(Rig)).unwrap();
        let keys = check::keys(&serde_json::from_str(&schema).unwrap());
        let missing: Vec<&String> = keys.iter().filter(|key| !PRESETS[0].1.contains(&**key)).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }

    #[test]
    fn a_faulty_rig_is_told_where_and_why() {
        let camera = "[[cameras]]\nname = \"cam0\"\nrate_hz = 10.0\nsize_px = [64, 48]\nfov_deg = 70.0\n";
        let cases = [
            ("[imu]\nrate = 5\n".to_owned(), "line 2"),
            ("[imu]\nrate_hz = 1e9\n".to_owned(), "imu.rate_hz"),
            (format!("{camera}depth.noise_m = 2.0\n"), "cameras[0].depth.noise_m"),
            (camera.replace("[64, 48]", "[64, 1]"), "cameras[0].size_px[1]"),
            (camera.replace("cam0", "Cam 0"), "is not a name"),
            (format!("{camera}{camera}"), "two sensors"),
            (camera.replace("70.0", "200.0"), "fisheye"),
            (format!("{camera}depth = {{ min_m = 5.0, max_m = 4.0 }}\n"), "min_m"),
            (camera.replace("rate_hz = 10.0", "rate_hz = nan"), "rate_hz"),
            ("[[lidars]]\nname = \"l\"\nrate_hz = 10.0\nscan = { pattern = \"spiral\" }\n".to_owned(), "line"),
            ("[[lidars]]\nname = \"l\"\nrate_hz = 10.0\nscan = { pattern = \"rosette\", cone_deg = 300.0, points = 1000 }\n".to_owned(), "cone_deg"),
        ];
        for (text, part) in cases {
            let error = Rig::parse(&text, "rig.toml".as_ref()).unwrap_err();
            let said = format!("{error}; {}", error.hint());
            assert!(said.contains(part) && !error.hint().is_empty(), "{text}: {said}");
        }
    }

    #[test]
    fn a_camera_looks_along_the_body() {
        let camera = &Rig::preset("rgbd").unwrap().cameras[0];
        let pose = camera.body_from_optical().rotation;
        assert!((pose * Vector3::z() - Vector3::x()).norm() < 1e-12);
        assert!((pose * Vector3::y() + Vector3::z()).norm() < 1e-12);
    }
}
