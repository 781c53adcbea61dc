//! `plume dataset`: many caves from one specification.

use std::ffi::OsString;
use std::io::BufReader;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::{env, io, thread};

use clap::{Args, ValueEnum};
use cpu_time::ProcessTime;
use plume::pipeline::Observer;
use plume_dataset::local::{self, Processes, Worker};
use plume_dataset::{Engine, Outcome, Plan, Reply, Watch, item, run};
use serde_json::{Value, json};

use super::Host;
use super::access::Making;
use super::fault::CliError;
use super::handover::Need;
use super::progress::Console;
use super::signals;

/// Makes many caves from one specification: their packages, an index, a data card, a contact sheet. If interrupted, the same
/// command resumes where it stopped.
#[derive(Args)]
pub struct Dataset {
    /// The specification (TOML)
    #[arg(value_name = "SPEC")]
    spec: PathBuf,
    /// The folder to write [default: the name of the dataset]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// What makes the caves: processes of this machine, or tasks of a Ray cluster
    #[arg(long, value_enum, default_value_t = EngineName::Processes)]
    engine: EngineName,
    /// The Ray cluster, such as `auto` or HOST:PORT [default: one of this machine]
    #[arg(long, value_name = "ADDRESS")]
    address: Option<String>,
    /// Number of processes that make caves [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    workers: Option<u16>,
    /// Make the caves whose numbers come on standard input
    #[arg(long, hide = true)]
    worker: bool,
    #[command(flatten)]
    pub(super) making: Making,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EngineName {
    Processes,
    Ray,
}

/// What the tasks of a Ray cluster need to know.
pub struct RayTasks {
    /// The specification.
    pub spec: PathBuf,
    /// The cluster, as `ray.init` takes it.
    pub address: Option<String>,
    /// Whether recipes may run programs.
    pub allows_programs: bool,
    /// Whether surveys may include files from outside their own folder.
    pub allows_outside_files: bool,
}

impl Dataset {
    /// Makes the caves that are missing, then the files that describe them.
    ///
    /// # Errors
    /// A faulty specification, the disk, another run in the folder, Ctrl-C, a missing USD library.
    pub fn run(&self, console: &Console, host: &Host) -> Result<(), CliError> {
        signals::listen();
        let plan = Plan::read(&self.spec, console.disk())?;
        let root = self.output.clone().unwrap_or_else(|| PathBuf::from(&plan.spec().name));
        if self.worker {
            return serve(&plan, &root, console, host);
        }
        plan.targets(host.library())?;
        let engine = self.engine(console, host)?;
        let outcome = run(&plan, &root, &*engine, console)?;
        summarise(console, &root, &outcome)
    }

    /// What it needs of the Python package.
    pub fn need(&self) -> Option<Need> {
        match self.engine {
            EngineName::Ray => Some(Need::Ray),
            EngineName::Processes => Plan::usd_target(&self.spec).map(Need::Usd),
        }
    }

    fn engine(&self, console: &Console, host: &Host) -> Result<Box<dyn Engine>, CliError> {
        let spec = self.spec.clone();
        let (allows_programs, allows_outside_files) = (console.allows_programs(), console.allows_outside_files());
        if let (EngineName::Ray, Host::Python { ray, .. }) = (self.engine, host) {
            return Ok(ray(RayTasks { spec, address: self.address.clone(), allows_programs, allows_outside_files }));
        }
        let worker = Worker { program: program(host)?, spec, allows_programs, allows_outside_files };
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        Ok(Box::new(Processes { worker, count: self.workers.map_or(cores, usize::from) }))
    }
}

/// The command that this process is.
fn program(host: &Host) -> Result<Vec<OsString>, CliError> {
    let binary = || env::current_exe().map_err(|error| CliError::Failed(format!("cannot find plume: {error}")));
    Ok(match host {
        Host::Binary => vec![binary()?.into_os_string()],
        Host::Python { interpreter, .. } => vec![interpreter.into(), "-m".into(), "plume".into()],
    })
}

/// Serves requests, as a worker.
fn serve(plan: &Plan, root: &Path, console: &Console, host: &Host) -> Result<(), CliError> {
    let make = |number: usize| {
        let clock = ProcessTime::now();
        item::make(plan, number, root, host.library(), console)?;
        Ok(clock.elapsed().as_secs_f64())
    };
    local::serve(BufReader::new(io::stdin()), io::stdout().lock(), console.stop(), make)
        .map_err(|error| CliError::Failed(format!("a worker: {error}")))
}

fn summarise(console: &Console, root: &Path, outcome: &Outcome) -> Result<(), CliError> {
    let Outcome { rows, failures, made, cpu_s } = outcome;
    let caves = rows.len();
    if console.is_json() {
        let failed: Vec<Value> =
            failures.iter().map(|failure| json!({"item": failure.item, "fault": failure.fault})).collect();
        let path = root.to_string_lossy();
        let json = json!({"path": path, "caves": caves, "failed": failed, "made": made, "cpu_s": cpu_s});
        return console.result(&format!("{json:#}\n"));
    }
    let (folder, left_out) = (root.display(), failures.len());
    console.note(&format!("  dataset   {folder}  {caves} caves, {left_out} left out  {cpu_s:.1} CPU s"));
    if left_out > 0 {
        console.note(&format!("  {}: why caves are left out", root.join("failed.csv").display()));
    }
    Ok(())
}

impl Watch for Console {
    fn begin_caves(&self, all: usize, done: usize) {
        self.start_bar_at("caves", all, done);
    }

    fn cave_done(&self, reply: &Reply) {
        if let Some(fault) = &reply.fault {
            self.note(&format!("  left out  {:06}: {fault}", reply.item));
        }
        self.advance_bar();
    }

    fn end_caves(&self) {
        self.clear();
    }
}
