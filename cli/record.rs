//! `plume record`: what sensors on a body measure along a path.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use plume_exporters::ExportError;
use plume_exporters::place::{Existing, Folder};
use plume_record::layout::{self, LAYOUTS, LayoutRow};
use plume_record::rig::{PRESETS, Rig};
use plume_record::trajectory::{Trajectory, tum};
use plume_record::{Order, RecordError, Recording, Watch, record};
use serde_json::json;

use super::access::Threads;
use super::fault::CliError;
use super::progress::Console;
use super::signals;
use plume::cave::Cave;

/// Records what the sensors of a body measure along a path through a cave: images, depth, labels, lidar, IMU, odometry, and the
/// truth.
#[derive(Args)]
pub struct Record {
    /// A cave folder finished by `plume generate`
    #[arg(value_name = "CAVE_DIR", required_unless_present = "print_rig")]
    cave: Option<PathBuf>,
    /// Poses of the body, x forward, z up: lines of `timestamp tx ty tz qx qy qz qw` (TUM)
    #[arg(long, value_name = "FILE", required_unless_present = "print_rig")]
    path: Option<PathBuf>,
    /// The sensors: a file (see --print-rig), or rgbd, stereo, easy, hard, dark
    #[arg(long, value_name = "FILE|NAME", default_value = PRESETS[0].0)]
    rig: PathBuf,
    /// Where to write the recording: a new or empty folder
    #[arg(short, long, value_name = "DIR", required_unless_present = "print_rig")]
    output: Option<PathBuf>,
    /// Layouts, separated by commas: tum, euroc, kitti, mcap; several have a folder each
    #[arg(long, value_name = "NAME", value_delimiter = ',', default_value = LAYOUTS[0].name)]
    layout: Vec<String>,
    /// Seed of the noise of sensors [default: that of the cave]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Print a rig in which every key is explained, or another that is built in
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = PRESETS[0].0)]
    print_rig: Option<String>,
    #[command(flatten)]
    pub(super) threads: Threads,
}

impl Record {
    /// Records, or prints a rig.
    ///
    /// # Errors
    /// Bad input, an unfinished cave, the disk, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        if let Some(name) = &self.print_rig {
            let names = PRESETS.iter().map(|(name, _)| *name);
            let known = PRESETS.iter().find(|(known, _)| known == name);
            let (_, text) = known.ok_or_else(|| CliError::unknown("rig", name, names))?;
            return console.result(text);
        }
        let (Some(cave), Some(path), Some(output)) = (&self.cave, &self.path, &self.output) else { return Ok(()) };
        let started = Instant::now();
        Folder::check(output, Existing::Keep)?;
        let layouts = self.layouts().map_err(cli_error)?;
        let rig = self.rig().map_err(cli_error)?;
        let trajectory = tum::read(path).and_then(|poses| Trajectory::through(&poses)).map_err(cli_error)?;
        signals::listen();
        let cave = Cave::open(cave, console)?;
        let chunks = cave.chunks(signals::stop());
        let scene = cave.scene(&chunks);
        let order = Order { rig: &rig, path: &trajectory, seed: self.seed.unwrap_or(scene.seed), layouts };
        let mut folder = Folder::create(output, Existing::Keep)?;
        let recorded = record(&scene, &order, &mut folder, console as &dyn Watch);
        console.clear();
        let recording = recorded.map_err(cli_error)?;
        folder.finish()?;
        self.report(console, output, &recording, started)
    }

    fn layouts(&self) -> Result<Vec<&'static LayoutRow>, RecordError> {
        let mut rows: Vec<&LayoutRow> = Vec::new();
        for name in &self.layout {
            let row = layout::named(name)?;
            if rows.iter().all(|other| other.name != row.name) {
                rows.push(row);
            }
        }
        Ok(rows)
    }

    /// A built-in rig, unless there is a file of that name.
    fn rig(&self) -> Result<Rig, RecordError> {
        let preset = self.rig.to_str().filter(|_| !self.rig.exists()).and_then(Rig::preset);
        preset.map_or_else(|| Rig::read(&self.rig), Ok)
    }

    fn report(
        &self,
        console: &Console,
        output: &std::path::Path,
        recording: &Recording,
        started: Instant,
    ) -> Result<(), CliError> {
        let wall_s = started.elapsed().as_secs_f64();
        if console.is_json() {
            let told = json!({"path": output.to_string_lossy(), "recording": recording, "wall_s": wall_s});
            return console.result(&format!("{told:#}\n"));
        }
        let counts = recording.counts.iter().map(|(name, count)| format!("{count} {name}"));
        console.note(&format!(
            "  record    {}  {:.1} m in {:.1} s: {}  {wall_s:.1} s",
            output.display(),
            recording.length_m,
            recording.duration_s,
            counts.collect::<Vec<_>>().join(", ")
        ));
        Ok(())
    }
}

fn cli_error(error: RecordError) -> CliError {
    match error {
        RecordError::Scene(error) => error.into(),
        RecordError::Io(error) => ExportError::Io(error).into(),
        RecordError::Input { path, source } => CliError::Input { path, source },
        RecordError::Interrupted => CliError::Interrupted,
        other => CliError::Usage { message: other.to_string(), hint: other.hint() },
    }
}
