//! `plume export`: from recipe to packages in one command.

use std::path::{Path, PathBuf};

use clap::Args;
use plume_exporters::TargetRow;
use plume_exporters::bundle::Bundle;
use plume_exporters::place::Existing;
use plume_exporters::place::Place;

use super::fault::CliError;
use super::generate::note_changes;
use super::progress::Console;
use super::summary::Summary;
use super::{Host, Source};
use plume::cave::{self, Cave, Input, Order, Wanted};
use plume::pipeline::{Observer, Pipeline, PipelineError};
use plume::store::{CaveFolder, TemporaryFolder};

/// Makes a cave and exports it for simulators.
#[derive(Args)]
pub struct Export {
    #[command(flatten)]
    pub(super) source: Source,
    /// Targets, separated by commas; see `plume list targets`
    #[arg(long, short, value_name = "TARGET", value_delimiter = ',', required = true)]
    target: Vec<String>,
    /// Put the packages of these targets inside each package, for example --with truth
    #[arg(long, value_name = "TARGET", value_delimiter = ',')]
    with: Vec<String>,
    /// Where to write the package; with several targets, the parent folder of all packages [default: NAME-TARGET]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set an option of a target, for example --option gazebo.lights=false; see `plume list options`
    #[arg(long, value_name = "TARGET.KEY=VALUE")]
    option: Vec<String>,
    /// Write each package as a single file: zip, tar.zst, tgz (npm, Unity) or mjz (MuJoCo)
    #[arg(long, value_name = "KIND")]
    bundle: Option<String>,
    /// Keep the cave folder here for later exports
    #[arg(long, value_name = "CAVE_DIR")]
    keep: Option<PathBuf>,
}

impl Export {
    /// An export of one target to a folder.
    pub fn of_target(target: &str, source: Source, output: Option<PathBuf>, option: Vec<String>) -> Self {
        Self { source, target: vec![target.to_owned()], with: Vec::new(), output, option, bundle: None, keep: None }
    }

    /// Makes the cave if necessary, then each package.
    ///
    /// # Errors
    /// Bad input, the disk, Ctrl-C, a missing USD library.
    pub fn run(&self, console: &Console, host: &Host) -> Result<(), CliError> {
        let choices = self.target.iter().map(|name| cave::target(name)).collect::<Result<Vec<_>, _>>()?;
        let inside = self.with.iter().map(|name| cave::target(name)).collect::<Result<Vec<_>, _>>()?;
        let bundle = self.bundle.as_ref().map(|name| cave::bundle(name, &choices)).transpose()?;
        let rows: Vec<&TargetRow> = choices.iter().chain(&inside).map(|choice| choice.row).collect();
        let wanted = cave::build(choices, &inside, &self.option, host.library())?;
        let input = self.source.resolve(console)?;
        cave::refuse_unfit_images(&rows, &input.recipe)?;
        let outputs = self.outputs(input.recipe.name(), &wanted, bundle);
        self.refuse_same_place(&outputs)?;
        note_changes(&input, console);
        let mut summary = Summary::start();
        let orders = self.open_orders(wanted, &outputs, bundle, &input, console, &mut summary)?;
        let work = self.work_folder(&input, &outputs[0])?;
        if !orders.is_empty() {
            let made = self.made(input, &orders, &work, console, &mut summary);
            let cave = match made {
                Err(error) if is_hopeless(&error) => {
                    work.clear();
                    return Err(error);
                }
                made => made?,
            };
            let chunks = cave.chunks(console.stop());
            let scene = cave.scene(&chunks);
            for (order, exported) in orders.iter().zip(cave::export(&scene, &orders)?) {
                summary.package(order, &exported);
            }
        }
        work.clear();
        outputs.iter().for_each(|output| plume_disk::sweep_beside(output));
        summary.print(console)
    }

    /// The cave, with the convex pieces if an order needs them.
    fn made(
        &self,
        input: Input,
        orders: &[Order],
        work: &WorkFolder,
        console: &Console,
        summary: &mut Summary,
    ) -> Result<Cave, CliError> {
        let folder = work.open(input.folder.as_deref())?;
        let force = self.source.force || work.is_temporary();
        let mut done = |stage, pipeline: &Pipeline| summary.stage_done(stage, pipeline);
        let cave = Cave::make(input, folder, force, console, &mut done)?;
        if orders.iter().any(|order| order.wanted.target.wants_pieces()) {
            cave.make_pieces(console, &mut done)?;
        }
        Ok(cave)
    }

    /// The first target that needs a USD library.
    pub fn usd_target(&self) -> Option<&'static str> {
        let wanted = self.target.iter().chain(&self.with).filter_map(|name| cave::target(name).ok());
        wanted.filter(|choice| choice.row.needs_usd()).map(|choice| choice.row.name).next()
    }

    /// Refuses a path that two outputs share.
    fn refuse_same_place(&self, outputs: &[PathBuf]) -> Result<(), CliError> {
        let places: Vec<&PathBuf> = outputs.iter().chain(&self.keep).collect();
        let twice = places.iter().enumerate().find(|(i, place)| places[..*i].contains(place));
        twice.map_or(Ok(()), |(_, place)| {
            Err(CliError::Usage {
                message: format!("{}: two outputs have this path", place.display()),
                hint: "name each target only once, and give --keep a separate folder".into(),
            })
        })
    }

    fn outputs(&self, name: &str, targets: &[Wanted], bundle: Option<Bundle>) -> Vec<PathBuf> {
        let folders = match (&self.output, targets) {
            (Some(output), [_]) => vec![output.clone()],
            (Some(output), _) => targets.iter().map(|wanted| output.join(wanted.choice.folder())).collect(),
            (None, _) => {
                targets.iter().map(|wanted| PathBuf::from(format!("{name}-{}", wanted.choice.folder()))).collect()
            }
        };
        match bundle {
            Some(bundle) => folders.iter().map(|folder: &PathBuf| bundle.file(folder)).collect(),
            None => folders,
        }
    }

    /// The orders still to be done: an interrupted export may have completed some.
    fn open_orders(
        &self,
        wanted: Vec<Wanted>,
        outputs: &[PathBuf],
        bundle: Option<Bundle>,
        input: &Input,
        console: &Console,
        summary: &mut Summary,
    ) -> Result<Vec<Order>, CliError> {
        let existing = if self.source.force { Existing::Replace } else { Existing::Keep };
        let places = outputs.iter().map(|path| Place { path: path.clone(), bundle, existing });
        let orders = wanted.into_iter().zip(places).map(|(wanted, place)| Order { wanted, place });
        let (mut open, mut fingerprint) = (Vec::new(), None);
        for order in orders {
            let Err(refusal) = order.place.check() else {
                open.push(order);
                continue;
            };
            if fingerprint.is_none() {
                fingerprint = Some(cave::fingerprint(input, console)?);
            }
            if !fingerprint.as_ref().is_some_and(|cave| order.is_done(cave)) {
                return Err(refusal.into());
            }
            summary.kept(&order);
        }
        Ok(open)
    }

    /// A cave folder given as input is used directly. Otherwise, or if overrides change its recipe, the cave is made in a
    /// hidden folder next to the package.
    fn work_folder(&self, input: &Input, output: &Path) -> Result<WorkFolder, CliError> {
        if let Some(path) = &self.keep {
            return Ok(WorkFolder::Named(path.clone()));
        }
        if let Some(path) = input.folder.as_ref().filter(|_| !input.is_overridden) {
            return Ok(WorkFolder::Named(path.clone()));
        }
        // Resolved so that the hidden folder of an existing output, perhaps `.`, goes next to it and not inside.
        let output = output.canonicalize().unwrap_or_else(|_| output.to_path_buf());
        let name = output.file_name().unwrap_or_default().to_string_lossy();
        Ok(WorkFolder::Hidden(TemporaryFolder::claim(&output.with_file_name(format!(".{name}.cave")))?))
    }
}

/// Whether no second run could finish the work either, so that nothing is kept for one.
fn is_hopeless(error: &CliError) -> bool {
    matches!(error, CliError::Pipeline(PipelineError::Grid(_) | PipelineError::TooLarge { .. } | PipelineError::Empty))
}

/// The folder in which the cave is made. A hidden one is removed once the packages are complete and stays after a kill, so
/// that the next run can resume.
enum WorkFolder {
    Named(PathBuf),
    Hidden(TemporaryFolder),
}

impl WorkFolder {
    /// The folder, which reuses whatever still fits from the cave folder `named`.
    fn open(&self, named: Option<&Path>) -> Result<CaveFolder, CliError> {
        let folder = match self {
            Self::Named(path) => CaveFolder::open_or_new(path)?,
            Self::Hidden(folder) => CaveFolder::open(folder.path())?.ephemeral(),
        };
        match named.filter(|named| *named != folder.root()) {
            Some(named) => Ok(folder.based_on(CaveFolder::open(named)?)),
            None => Ok(folder),
        }
    }

    fn is_temporary(&self) -> bool {
        matches!(self, Self::Hidden(_))
    }

    fn clear(self) {
        if let Self::Hidden(folder) = self {
            folder.remove();
        }
    }
}
