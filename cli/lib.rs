//! The command line, as a library: `main` and the Python package call [`run`].
//!
//! The only code that prints. Results go to stdout; progress, notes and errors go to stderr.

mod access;
mod certify;
mod check;
mod chunk;
mod completions;
mod dataset;
mod export;
mod fault;
mod flight;
mod generate;
mod graph;
mod handover;
mod likeness;
mod list;
mod manual;
mod measure;
mod new;
mod output;
mod path;
mod preview;
mod progress;
mod publish;
mod record;
mod signals;
mod status;
mod summary;
mod truth;

use std::ffi::OsString;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use clap::error::{ContextKind, ContextValue};
use clap::{Args, Parser, Subcommand};
use plume_dataset::Engine;
use plume_exporters::stage::Library;
use plume_exporters::{TARGETS, TargetRow};

use self::access::{Access, Making};
pub use self::dataset::RayTasks;
pub use self::fault::CliError;
use self::handover::Need;
use self::progress::Console;
pub use self::publish::Publish;
use plume::cave::Input;
use plume::store::Stage;
use plume_graph::echo;
use serde_json::{Value, json};

/// Procedural caves, mines and lava tubes for robot simulators.
#[derive(Parser)]
#[command(name = "plume", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: Common,
}

/// Options of every command.
#[derive(Args)]
pub struct Common {
    /// Print only errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Print the result as JSON on stdout, and errors as JSON on stderr
    #[arg(long, global = true)]
    json: bool,
}

/// What a cave is made from.
#[derive(Args, Clone)]
pub struct Named {
    /// A recipe (TOML), a graph or survey (see `plume list formats`), or a cave folder [default: the default cave]
    #[arg(value_name = "RECIPE|GRAPH|CAVE_DIR")]
    input: Option<PathBuf>,
    /// Set a key of the recipe, for example --set graph.nodes=100
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Set the seed
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<String>,
    #[command(flatten)]
    making: Making,
}

/// What a cave is made from, and whether it may replace another.
#[derive(Args, Clone)]
pub struct Source {
    #[command(flatten)]
    named: Named,
    /// Replace existing output
    #[arg(long)]
    force: bool,
}

impl Named {
    /// The `key=value` pairs, the seed last.
    fn overrides(&self) -> Vec<String> {
        let seed = self.seed.as_ref().map(|seed| format!("seed={seed}"));
        self.set.iter().cloned().chain(seed).collect()
    }

    /// Reads the input. The work that follows can leave files behind, so from here on signals stop it cleanly.
    fn resolve(&self, console: &Console) -> Result<Input, CliError> {
        let input = Input::read(self.input.as_deref(), &self.overrides(), console.disk());
        signals::listen();
        input
    }
}

impl Source {
    /// Reads the input.
    fn resolve(&self, console: &Console) -> Result<Input, CliError> {
        self.named.resolve(console)
    }
}

#[derive(Subcommand)]
enum Command {
    /// Make a cave and export it for simulators
    Export(export::Export),
    /// Make a cave folder: graph, plan and profile, mesh, things and textures
    Generate(generate::Generate),
    /// Make or update the graph of a cave folder; import and export graphs
    Graph(graph::GraphCommand),
    /// Make the graph and the mesh of a cave folder
    Mesh(generate::Generate),
    /// Make the graph, the mesh and the things (stones, dripstone) of a cave folder
    Things(generate::Generate),
    /// Make the graph, the mesh, the things and the textures of a cave folder
    Texture(generate::Generate),
    /// Make the graph, the mesh and the convex pieces of a cave folder
    Pieces(generate::Generate),
    /// Make some chunks of a cave, so that many machines can share a large one
    Chunk(chunk::Chunk),
    /// Draw a cave within seconds, before it is made
    Preview(preview::Preview),
    /// Record what sensors on a body measure along a path through a cave
    Record(record::Record),
    /// Make many caves from one specification, for training and benchmarks
    Dataset(dataset::Dataset),
    /// Copy a finished dataset to an object store or another folder, as it is or as shards
    Publish(Publish),
    /// Print a commented recipe to start from
    New(new::New),
    /// Print the JSON Schema of recipes, for editors
    Schema,
    /// List targets and their options, generators, formats, materials, things, presets, views and robots
    List(list::List),
    /// Check that a package is intact and refers to nothing outside itself
    Check(check::Check),
    /// Make a cave and write its ground truth: floor, maps, distances, points
    Truth(truth::Truth),
    /// Certify where a robot gets in a finished cave, and what stops it
    Certify(certify::Certify),
    /// Find a path for a robot through a finished cave
    Path(path::PathCommand),
    /// Show the progress of a cave folder and what is left to do
    Status(status::Status),
    /// Compare a graph with real caves; check the mesh of a cave folder (closed, manifold, consistent)
    Measure(measure::Measure),
    /// Print completions of the command line for a shell
    Completions(completions::Completions),
    /// Print a page of the manual
    Manual(manual::Manual),
}

impl Command {
    /// What it needs of the Python package.
    fn need(&self) -> Option<Need> {
        match self {
            Self::Export(export) => export.usd_target().map(Need::Usd),
            Self::Dataset(dataset) => dataset.need(),
            Self::Publish(_) => Some(Need::Publish),
            _ => None,
        }
    }

    /// What it may use.
    fn access(&self) -> Access {
        match self {
            Self::Export(export) => export.source.named.making.into(),
            Self::Generate(make) | Self::Mesh(make) | Self::Things(make) | Self::Texture(make) | Self::Pieces(make) => {
                make.source.named.making.into()
            }
            Self::Graph(graph) => graph.access(),
            Self::Chunk(chunk) => chunk.source.named.making.into(),
            Self::Preview(preview) => preview.named.making.into(),
            Self::Truth(truth) => truth.source.named.making.into(),
            Self::Dataset(dataset) => dataset.making.into(),
            Self::Certify(certify) => certify.threads.into(),
            Self::Path(path) => path.threads.into(),
            Self::Record(record) => record.threads.into(),
            Self::Measure(measure) => measure.access(),
            Self::Status(status) => status.outside.into(),
            Self::Publish(_)
            | Self::New(_)
            | Self::Schema
            | Self::List(_)
            | Self::Check(_)
            | Self::Completions(_)
            | Self::Manual(_) => Access::default(),
        }
    }

    /// Whether it only prints built-in information, which needs no threads.
    fn only_prints(&self) -> bool {
        matches!(self, Self::New(_) | Self::Schema | Self::List(_) | Self::Completions(_) | Self::Manual(_))
    }
}

/// The program that runs the command line.
pub enum Host {
    /// The `plume` binary, which has no Python inside: for USD it hands over to the other.
    Binary,
    /// The `plume` command of the Python package.
    Python {
        /// Its USD library.
        library: Arc<dyn Library>,
        /// The interpreter: `sys.executable`, which knows its environment, as the program of the process may not.
        interpreter: PathBuf,
        /// Its engine ray.
        ray: fn(RayTasks) -> Box<dyn Engine>,
        /// Publishes a dataset and returns how many files it wrote.
        publish: fn(&Publish) -> Result<usize, CliError>,
    },
}

impl Host {
    fn library(&self) -> Option<&Arc<dyn Library>> {
        match self {
            Self::Binary => None,
            Self::Python { library, .. } => Some(library),
        }
    }
}

/// Runs a command line and returns the exit code: 0 done, 1 a disk error or a failed check, 2 usage or bad input, 69 a
/// missing dependency, 128 plus the signal number after an interrupt: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP.
pub fn run(arguments: impl IntoIterator<Item = OsString>, host: &Host) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    signals::survive_file_limit();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(usage) => {
            let is_json = arguments.iter().any(|argument| argument == "--json");
            return answer(&naming_targets(clipped(usage)), is_json);
        }
    };
    let access = cli.command.access();
    let console = Console::new(&cli.common, access);
    if !cli.command.only_prints() {
        start_threads(access.threads.map_or(0, usize::from));
    }
    let result = match (host, cli.command.need()) {
        (Host::Binary, Some(need)) => handover::to_python(&need, &arguments),
        _ => dispatch(&cli.command, &console, host).map(|()| 0),
    };
    result.unwrap_or_else(|error| {
        console.fault(&error);
        fault::exit_code(&error)
    })
}

/// Starts the thread pool, with one thread per core if `count` is 0. If the system refuses, this thread works alone. A pool
/// that exists already, as in a host program, stays.
fn start_threads(count: usize) {
    let threads = if count > 0 { count } else { std::thread::available_parallelism().map_or(1, NonZero::get) };
    let pool = rayon::ThreadPoolBuilder::new();
    // Asked first, because a program whose global pool has failed to start can have none any more.
    let pool = if can_start(threads) { pool.num_threads(count) } else { pool.num_threads(1).use_current_thread() };
    let _ = pool.build_global();
}

/// Whether this many threads can run at once.
fn can_start(count: usize) -> bool {
    let gate = Mutex::new(());
    let closed = gate.lock();
    std::thread::scope(|scope| {
        let wait = || drop(gate.lock());
        let all = (0..count).all(|_| std::thread::Builder::new().spawn_scoped(scope, wait).is_ok());
        drop(closed);
        all
    })
}

/// Prints the help or the version, or what is wrong with the command line.
fn answer(usage: &clap::Error, is_json: bool) -> u8 {
    if usage.use_stderr() {
        match is_json {
            true => progress::print_fault(&usage_json(usage)),
            false => drop(usage.print()),
        }
        return usage.exit_code() as u8;
    }
    match progress::told(usage.print()) {
        Ok(()) => usage.exit_code() as u8,
        Err(error) => {
            progress::fault(&error);
            fault::exit_code(&error)
        }
    }
}

/// What is wrong with the command line, for programs; the usage is the hint.
fn usage_json(usage: &clap::Error) -> Value {
    let text = usage.render().to_string();
    let (error, hint) = text.split_once("\n\n").unwrap_or((&text, ""));
    json!({"error": error.trim_start_matches("error: "), "hint": hint.trim()})
}

/// The same with the user's input clipped.
fn clipped(mut usage: clap::Error) -> clap::Error {
    let typed = [ContextKind::InvalidArg, ContextKind::InvalidSubcommand, ContextKind::InvalidValue];
    for kind in typed {
        if let Some(ContextValue::String(text)) = usage.get(kind) {
            let text = echo::plain(text);
            usage.insert(kind, ContextValue::String(text));
        }
    }
    usage
}

/// The same with the names of all targets if none is given.
fn naming_targets(mut usage: clap::Error) -> clap::Error {
    let Some(ContextValue::Strings(missing)) = usage.get(ContextKind::InvalidArg) else { return usage };
    if missing.iter().any(|argument| argument.starts_with("--target ")) {
        let names: Vec<String> = TARGETS.iter().map(TargetRow::usage).collect();
        let tip = format!("known targets: {}", names.join(", "));
        usage.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    usage
}

fn dispatch(command: &Command, console: &Console, host: &Host) -> Result<(), CliError> {
    match command {
        Command::Export(export) => export.run(console, host),
        Command::Generate(stage) | Command::Texture(stage) => stage.run(Stage::Texture, console),
        Command::Graph(graph) => graph.run(console),
        Command::Mesh(stage) => stage.run(Stage::Mesh, console),
        Command::Things(stage) => stage.run(Stage::Things, console),
        Command::Pieces(stage) => stage.run(Stage::Pieces, console),
        Command::Chunk(chunk) => chunk.run(console),
        Command::Preview(preview) => preview.run(console),
        Command::Record(record) => record.run(console),
        Command::Dataset(dataset) => dataset.run(console, host),
        Command::Publish(publish) => publish.run(console, host),
        Command::New(new) => new.run(console),
        Command::Schema => console.result(&format!("{:#}\n", plume::recipe::editor_schema())),
        Command::List(list) => list.run(console),
        Command::Check(check) => check.run(console),
        Command::Truth(truth) => truth.run(console, host),
        Command::Certify(certify) => certify.run(console),
        Command::Path(path) => path.run(console),
        Command::Status(status) => status.run(console),
        Command::Measure(measure) => measure.run(console),
        Command::Completions(completions) => completions.run(console),
        Command::Manual(manual) => manual.run(console),
    }
}
