//! `plume path`: a path for a robot through a cave.

use std::path::PathBuf;

use clap::Args;
use plume_truth::Class;
use serde_json::json;

use super::access::Threads;
use super::fault::CliError;
use super::output;
use super::progress::Console;
use super::signals;
use plume::Cave;
use plume::cave::{self, Journey};
use plume::pipeline::Observer;
use plume::trajectory::{Format, Ride, Trajectory};

/// Finds a path for a robot through a finished cave: through the middle, smoothed, and held against the floor in every pose.
#[derive(Args)]
pub struct PathCommand {
    /// A cave folder made by `plume generate`
    #[arg(value_name = "CAVE_DIR")]
    folder: PathBuf,
    /// longest (to the furthest station), loop, tour (through all passages and back), or A..B between two stations
    #[arg(long, value_name = "KIND", default_value = "longest")]
    kind: String,
    /// The robot: one of `plume list robots`, or a TOML file
    #[arg(long, value_name = "ROBOT|FILE", default_value = "husky")]
    robot: String,
    /// Height over the floor in metres of a level body, such as a camera [default: on its wheels]
    #[arg(long, value_name = "M", value_parser = height_m)]
    height: Option<f64>,
    /// Speed in metres a second
    #[arg(long, value_name = "M_S", default_value_t = 0.5, value_parser = speed_m_s)]
    speed: f64,
    /// The file to write, replacing an existing one: .tum, .csv, or .yaml for nav_msgs/Path
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    pub(super) threads: Threads,
}

impl PathCommand {
    /// Writes the path and prints how long it is.
    ///
    /// # Errors
    /// An unknown robot, kind or station, a robot that does not get there, an unfinished cave, the disk, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let format = self.format()?;
        let journey: Journey = self.kind.parse()?;
        let robot = cave::named_robot(&self.robot)?;
        signals::listen();
        let cave = Cave::open(&self.folder, console)?;
        let chunks = cave.chunks(console.stop());
        let scene = cave.scene(&chunks);
        let route = cave.route(&scene, &robot, journey)?;
        let ride = self.height.map_or(Ride::OnWheels, Ride::Level);
        let trajectory = Trajectory::of(&route, ride, self.speed);
        output::replace(&self.output, trajectory.text(format).as_bytes())?;
        let clearance_m = route.waypoints.iter().map(|waypoint| waypoint.clearance_m).fold(f64::INFINITY, f64::min);
        let (length_m, time_s) = trajectory.stamps.last().map_or((0.0, 0.0), |last| (last.along_m, last.time_s));
        if console.is_json() {
            let path = self.output.to_string_lossy();
            let class = route.class.name();
            let json = json!({
                "path": path, "poses": trajectory.stamps.len(), "length_m": length_m, "time_s": time_s, "class": class,
                "clearance_m": clearance_m,
            });
            return console.result(&format!("{json:#}\n"));
        }
        let output = self.output.display();
        console.note(&format!(
            "  path      {output}  {length_m:.1} m in {time_s:.0} s, {clearance_m:.2} m clear of the wall"
        ));
        if route.class > Class::Go {
            console.note("  note      it leads over places where the robot may fail: see `plume certify`");
        }
        Ok(())
    }

    fn format(&self) -> Result<Format, CliError> {
        let extension = self.output.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let format = Format::ALL.iter().find(|(name, _)| extension.as_deref() == Some(name));
        format.map(|(_, format)| *format).ok_or_else(|| CliError::Usage {
            message: format!("{}: paths cannot be written to files with this extension", self.output.display()),
            hint: "known extensions: .tum, .csv, .yaml".into(),
        })
    }
}

fn height_m(text: &str) -> Result<f64, String> {
    let height_m = text.parse().ok().filter(|height_m| (0.0..=100.0).contains(height_m));
    height_m.ok_or_else(|| "must be a number from 0 to 100".to_owned())
}

fn speed_m_s(text: &str) -> Result<f64, String> {
    let speed_m_s = text.parse().ok().filter(|speed_m_s| (0.01..=20.0).contains(speed_m_s));
    speed_m_s.ok_or_else(|| "must be a number from 0.01 to 20".to_owned())
}
