//! The command line, as a library: `main` and the Python package call [`run`].
//!
//! The only code that prints. What was asked for goes to stdout; progress, notes and faults go to stderr.

mod check;
mod export;
mod fault;
mod flight;
mod generate;
mod graph;
mod handover;
mod likeness;
mod list;
mod measure;
mod new;
mod preview;
mod progress;
mod signals;
mod status;
mod summary;

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use clap::error::{ContextKind, ContextValue};
use clap::{Args, Parser, Subcommand};
use plume_exporters::stage::Library;

pub use self::fault::CliError;
use self::progress::Console;
use plume::cave::Input;
use plume::store::Stage;
use plume_graph::echo;

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
    /// Print nothing but faults
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Print the result as JSON on stdout
    #[arg(long, global = true)]
    json: bool,
    /// Number of threads [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Let recipes run programs, as the generator `external` does
    #[arg(long, global = true)]
    allow_run: bool,
    /// Let surveys include files that do not lie below their own folder
    #[arg(long, global = true)]
    allow_outside: bool,
}

/// What a cave is made from.
#[derive(Args)]
pub struct Named {
    /// A recipe (TOML), a graph or survey (`plume list formats`) or a cave folder [default: the default cave]
    #[arg(value_name = "RECIPE|GRAPH|CAVE_DIR")]
    input: Option<PathBuf>,
    /// Set a key of the recipe, for example --set graph.nodes=100
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Set the seed
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<String>,
}

/// What a cave is made from, and whether it may take the place of another.
#[derive(Args)]
pub struct Source {
    #[command(flatten)]
    named: Named,
    /// Replace what is in the way
    #[arg(long)]
    force: bool,
}

impl Named {
    /// The `key=value` pairs, the seed last.
    fn overrides(&self) -> Vec<String> {
        let seed = self.seed.as_ref().map(|seed| format!("seed={seed}"));
        self.set.iter().cloned().chain(seed).collect()
    }

    /// Reads what was named. Work may follow that leaves things behind, so from now on signals stop that.
    fn resolve(&self, console: &Console) -> Result<Input, CliError> {
        let input = Input::read(self.input.as_deref(), &self.overrides(), console.disk());
        signals::listen();
        input
    }
}

impl Source {
    /// Reads what was named.
    fn resolve(&self, console: &Console) -> Result<Input, CliError> {
        self.named.resolve(console)
    }
}

#[derive(Subcommand)]
enum Command {
    /// Make a cave and hand it to simulators
    Export(export::Export),
    /// Make a cave folder: graph, plan and profile, mesh and textures
    Generate(generate::Generate),
    /// Make or renew the graph of a cave folder; import and export graphs
    Graph(graph::GraphCommand),
    /// Make the graph and the mesh of a cave folder
    Mesh(generate::Generate),
    /// Make the graph, the mesh and the textures of a cave folder
    Texture(generate::Generate),
    /// Make the graph, the mesh and the convex pieces of a cave folder
    Pieces(generate::Generate),
    /// Show a cave in seconds, before it is made
    Preview(preview::Preview),
    /// Print a commented recipe
    New(new::New),
    /// Print the JSON Schema of recipes, for editors
    Schema,
    /// List targets, generators, formats, materials, presets and views
    List(list::List),
    /// Check that a package is whole and names nothing outside itself
    Check(check::Check),
    /// Say how far a cave folder is and what is left to do
    Status(status::Status),
    /// Tell how like a real cave a graph is; check the mesh of a cave folder: closed, manifold, consistent
    Measure(measure::Measure),
}

impl Command {
    /// Targets that need the USD library of a host program.
    fn usd_target(&self) -> Option<&'static str> {
        match self {
            Self::Export(export) => export.usd_target(),
            _ => None,
        }
    }

    /// Whether it prints what the program knows by itself, for which it takes no threads.
    fn only_prints(&self) -> bool {
        matches!(self, Self::New(_) | Self::Schema | Self::List(_))
    }
}

/// The program that runs the command line.
pub enum Host {
    /// The `plume` binary, which holds no Python: for USD it hands over to the other.
    Binary,
    /// The `plume` command of the Python package, with its USD library.
    Python(Arc<dyn Library>),
}

impl Host {
    fn library(&self) -> Option<&Arc<dyn Library>> {
        match self {
            Self::Binary => None,
            Self::Python(library) => Some(library),
        }
    }
}

/// Runs a command line and gives the exit code: 0 done, 1 the disk or a failed check, 2 usage or bad input, 69 a needed
/// part is missing, 128 and the number of the signal that interrupted it: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP.
pub fn run(arguments: impl IntoIterator<Item = OsString>, host: &Host) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    signals::survive_file_limit();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(usage) => return answer(clipped(usage)),
    };
    let console = Console::new(&cli.common);
    if !cli.command.only_prints() {
        start_threads(cli.common.threads.map_or(0, usize::from));
    }
    let result = match (host, cli.command.usd_target()) {
        (Host::Binary, Some(target)) => handover::to_python(target, &arguments),
        _ => dispatch(&cli.command, &console, host).map(|()| 0),
    };
    result.unwrap_or_else(|error| {
        console.fault(&error);
        fault::exit_code(&error)
    })
}

/// Starts the pool of threads, as many as there are cores where `count` is 0. Where the system gives none, this thread works
/// alone. A pool that exists already, as in a host program, stays.
fn start_threads(count: usize) {
    if rayon::ThreadPoolBuilder::new().num_threads(count).build_global().is_err() {
        let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    }
}

/// Prints what was asked for in place of a command, such as the help, or what is wrong with the command line.
fn answer(usage: clap::Error) -> u8 {
    let printed = usage.print();
    if usage.use_stderr() {
        return usage.exit_code() as u8;
    }
    match progress::told(printed) {
        Ok(()) => usage.exit_code() as u8,
        Err(error) => {
            progress::fault(&error);
            fault::exit_code(&error)
        }
    }
}

/// The same with what the user has typed clipped.
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

fn dispatch(command: &Command, console: &Console, host: &Host) -> Result<(), CliError> {
    match command {
        Command::Export(export) => export.run(console, host),
        Command::Generate(stage) | Command::Texture(stage) => stage.run(Stage::Texture, console),
        Command::Graph(graph) => graph.run(console),
        Command::Mesh(stage) => stage.run(Stage::Mesh, console),
        Command::Pieces(stage) => stage.run(Stage::Pieces, console),
        Command::Preview(preview) => preview.run(console),
        Command::New(new) => new.run(console),
        Command::Schema => console.result(&format!("{:#}\n", plume::recipe::editor_schema())),
        Command::List(list) => list.run(console),
        Command::Check(check) => check.run(console),
        Command::Status(status) => status.run(console),
        Command::Measure(measure) => measure.run(console),
    }
}
