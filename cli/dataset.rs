//! `plume dataset`: many caves from one specification.

use std::ffi::OsString;
use std::io::BufReader;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::{env, io, thread};

use clap::Args;
use cpu_time::ProcessTime;
use plume::pipeline::Observer;
use plume_dataset::local::{self, Answer, Worker};
use plume_dataset::{Outcome, Plan, Watch, item, run};
use serde_json::{Value, json};

use super::Host;
use super::fault::CliError;
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
    /// Number of processes that make caves [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    workers: Option<u16>,
    /// Make the caves whose numbers are asked for on standard input
    #[arg(long, hide = true)]
    worker: bool,
}

impl Dataset {
    /// Makes the caves that are missing, then what stands at the top.
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
        let worker = Worker {
            program: program(host)?,
            spec: self.spec.clone(),
            root: root.clone(),
            allows_programs: console.allows_programs(),
            allows_outside_files: console.allows_outside_files(),
        };
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        let outcome = run(&plan, &worker, self.workers.map_or(cores, usize::from), console)?;
        told(console, &root, &outcome)
    }

    /// The first target that needs a USD library.
    pub fn usd_target(&self) -> Option<&'static str> {
        Plan::usd_target(&self.spec)
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

/// The life of a worker.
fn serve(plan: &Plan, root: &Path, console: &Console, host: &Host) -> Result<(), CliError> {
    let make = |number: usize| {
        let clock = ProcessTime::now();
        item::make(plan, number, root, host.library(), console)?;
        Ok(clock.elapsed().as_secs_f64())
    };
    local::serve(BufReader::new(io::stdin()), io::stdout().lock(), console.stop(), make)
        .map_err(|error| CliError::Failed(format!("a worker: {error}")))
}

fn told(console: &Console, root: &Path, outcome: &Outcome) -> Result<(), CliError> {
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

    fn heard(&self, answer: &Answer) {
        if let Some(fault) = &answer.fault {
            self.note(&format!("  left out  {:06}: {fault}", answer.item));
        }
        self.advance_bar();
    }

    fn end_caves(&self) {
        self.clear();
    }
}
