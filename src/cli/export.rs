//! `plume export`: the main job in one line.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use plume_exporters::bundle::Bundle;
use plume_exporters::package::Existing;
use plume_exporters::place::Place;
use plume_exporters::{Choice, Target};

use super::fault::CliError;
use super::progress::Console;
use super::summary::Summary;
use super::{Host, Source};
use crate::cave::{self, Cave, Input, Order};
use crate::pipeline::{Observer, PipelineError};
use crate::store::CaveFolder;

/// Makes a cave and hands it to simulators.
#[derive(Args)]
pub struct Export {
    #[command(flatten)]
    source: Source,
    /// Targets, separated by commas; `plume list targets` names them
    #[arg(long, short, value_name = "TARGET", value_delimiter = ',', required = true)]
    target: Vec<String>,
    /// Where the package goes; with several targets, the folder above theirs [default: NAME-TARGET]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set an option of a target, for example --option gazebo.lights=false
    #[arg(long, value_name = "TARGET.KEY=VALUE")]
    option: Vec<String>,
    /// Make one file of each package: zip, tar.zst, tgz for npm and Unity, mjz for MuJoCo
    #[arg(long, value_name = "KIND")]
    bundle: Option<String>,
    /// Keep the cave folder here, to export from it again
    #[arg(long, value_name = "CAVE_DIR")]
    keep: Option<PathBuf>,
}

impl Export {
    /// Makes the cave if need be, then each package.
    ///
    /// # Errors
    /// Bad input, the disk, Ctrl-C, a missing USD library.
    pub fn run(&self, console: &Console, host: &Host) -> Result<(), CliError> {
        let choices = self.target.iter().map(|name| cave::target(name)).collect::<Result<Vec<_>, _>>()?;
        let targets = cave::build(&choices, &self.option, host.library())?;
        let input = self.source.resolve(console)?;
        let bundle = self.bundle.as_ref().map(|name| cave::bundle(name, &choices)).transpose()?;
        let outputs = self.outputs(&input.recipe.name, &choices, bundle);
        self.refuse_same_place(&outputs)?;
        let orders = self.orders(choices, targets, &outputs, bundle);
        orders.iter().try_for_each(|order| order.place.check())?;
        let work = self.work_folder(&input, &outputs[0]);
        let folder = CaveFolder::open_or_new(&work.path)?;
        let mut summary = Summary::start();
        let force = self.source.force || work.is_temporary;
        let made =
            Cave::make(input, folder, force, console, &mut |stage, pipeline| summary.stage_done(stage, pipeline));
        let cave = made.inspect_err(|error| work.clear_if_hopeless(error))?;
        if orders.iter().any(|order| order.target.wants_pieces()) {
            cave.make_pieces(console, &mut |stage, pipeline| summary.stage_done(stage, pipeline))?;
        }
        let chunks = cave.chunks(console.stop());
        let scene = cave.scene(&chunks);
        for (order, exported) in orders.iter().zip(cave::export(&scene, &orders)?) {
            summary.package(order, &exported);
        }
        work.clear();
        summary.print(console)
    }

    /// The first target that needs a USD library.
    pub fn usd_target(&self) -> Option<&'static str> {
        let wanted = self.target.iter().filter_map(|name| cave::target(name).ok());
        wanted.filter(|choice| choice.row.needs_usd()).map(|choice| choice.row.name).next()
    }

    /// Refuses a place that two would write to.
    fn refuse_same_place(&self, outputs: &[PathBuf]) -> Result<(), CliError> {
        let places: Vec<&PathBuf> = outputs.iter().chain(&self.keep).collect();
        let twice = places.iter().enumerate().find(|(i, place)| places[..*i].contains(place));
        twice.map_or(Ok(()), |(_, place)| {
            Err(CliError::Usage {
                message: format!("{}: two things cannot both be written here", place.display()),
                hint: "name each target once, and a folder of its own for --keep".into(),
            })
        })
    }

    fn outputs(&self, name: &str, targets: &[Choice], bundle: Option<Bundle>) -> Vec<PathBuf> {
        let folders = match (&self.output, targets) {
            (Some(output), [_]) => vec![output.clone()],
            (Some(output), _) => targets.iter().map(|choice| output.join(choice.folder())).collect(),
            (None, _) => targets.iter().map(|choice| PathBuf::from(format!("{name}-{}", choice.folder()))).collect(),
        };
        match bundle {
            Some(bundle) => folders.iter().map(|folder: &PathBuf| bundle.file(folder)).collect(),
            None => folders,
        }
    }

    fn orders(
        &self,
        choices: Vec<Choice>,
        targets: Vec<Box<dyn Target>>,
        outputs: &[PathBuf],
        bundle: Option<Bundle>,
    ) -> Vec<Order> {
        let existing = if self.source.force { Existing::Replace } else { Existing::Keep };
        let places = outputs.iter().map(|path| Place { path: path.clone(), bundle, existing });
        let whole = choices.into_iter().zip(targets).zip(places);
        whole.map(|((choice, target), place)| Order { choice, target, place }).collect()
    }

    /// A named cave folder serves as it is; else the cave is made in a hidden folder beside the package, which goes when
    /// the package is whole and stays after a kill, so that the next run goes on.
    fn work_folder(&self, input: &Input, output: &Path) -> WorkFolder {
        if let Some(path) = self.keep.as_ref().or(input.folder.as_ref()) {
            return WorkFolder { path: path.clone(), is_temporary: false };
        }
        // A folder that is there, perhaps as `.`, gets a neighbour and not something inside it.
        let output = output.canonicalize().unwrap_or_else(|_| output.to_path_buf());
        let name = output.file_name().unwrap_or_default().to_string_lossy();
        WorkFolder { path: output.with_file_name(format!(".{name}.cave")), is_temporary: true }
    }
}

struct WorkFolder {
    path: PathBuf,
    is_temporary: bool,
}

impl WorkFolder {
    fn clear(&self) {
        if self.is_temporary {
            // What is left over costs space only.
            let _ = fs::remove_dir_all(&self.path);
        }
    }

    /// What no second run could finish is not kept for it.
    fn clear_if_hopeless(&self, error: &CliError) {
        if let CliError::Pipeline(PipelineError::Grid(_)) = error {
            self.clear();
        }
    }
}
