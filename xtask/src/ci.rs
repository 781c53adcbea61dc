//! `cargo xtask ci`: everything that must hold before a change lands, and a table of minutes per step, and of minutes of processors
//! where Linux tells them: a step with few of them waits.

use std::fs;
use std::process::Command;
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use crate::plume::cargo;
use crate::tools::{Result, show};
use crate::{campaign, docs, interop, test};

/// Runs all steps. The table is printed even if a step fails.
pub fn run(_arguments: &[String]) -> Result<()> {
    let mut table = Table::default();
    // Foreign programs are downloaded while the compiler keeps the cores busy.
    let outcome = std::thread::scope(|scope| steps(&mut table, scope.spawn(interop::prepare)));
    table.print();
    outcome
}

fn steps(table: &mut Table, foreign_programs: ScopedJoinHandle<()>) -> Result<()> {
    table.step("formatting", || cargo_task(&["fmt", "--all", "--check"]))?;
    table.step("links", docs::check)?;
    let lint = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"];
    table.step("clippy", || cargo_task(&lint))?;
    table.step("documentation and packages", documentation_and_packages)?;
    table.step("compiling the tests", || cargo_task(&["test", "--workspace", "--no-run", "--quiet"]))?;
    table.step("Rust tests", || test::rust(&[]))?;
    table.step("a program without optimisation", test::program)?;
    table.step("waiting for foreign programs", || {
        foreign_programs.join().map_err(|_| "preparing foreign programs panicked".to_owned())
    })?;
    table.step("Python package and its tests", test::python)?;
    table.step("simulators", test::simulators)?;
    table.step("campaign", || campaign::run(&[]))?;
    table.step("interop", || interop::run(&[]))
}

/// Checks that the documentation has no warnings and that every public crate can be packaged.
fn documentation_and_packages() -> Result<()> {
    let mut documentation = cargo();
    // All crates, as for clippy: without one, others would have other features, and be compiled again.
    documentation.args(["doc", "--workspace", "--lib", "--no-deps", "--quiet"]);
    show(documentation.env("RUSTDOCFLAGS", "-D warnings"))?;
    let others = ["xtask", "plume-campaign", "plume-python"].map(|name| ["--exclude", name]).concat();
    let package = ["package", "--workspace", "--no-verify", "--allow-dirty", "--quiet"];
    cargo_task(&[&package[..], &others].concat())
}

fn cargo_task(arguments: &[&str]) -> Result<()> {
    let mut command: Command = cargo();
    show(command.args(arguments))
}

/// Minutes by step.
#[derive(Default)]
struct Table(Vec<Row>);

struct Row {
    step: &'static str,
    took: Duration,
    cpu: Duration,
    has_failed: bool,
}

/// Kernel ticks per second, as all of Linux has them.
const TICKS_PER_S: f64 = 100.0;

/// What all child processes that have ended took of the processors; nothing where there is no `/proc`.
fn cpu_of_children() -> Duration {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the program may hold anything; of the fields after it these are `cutime` and `cstime`.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace();
    let ticks: f64 = fields.skip(13).take(2).filter_map(|field| field.parse::<f64>().ok()).sum();
    Duration::from_secs_f64(ticks / TICKS_PER_S)
}

impl Table {
    fn step(&mut self, step: &'static str, run: impl FnOnce() -> Result<()>) -> Result<()> {
        println!("== {step}");
        let (started, before) = (Instant::now(), cpu_of_children());
        let outcome = run();
        let cpu = cpu_of_children().saturating_sub(before);
        self.0.push(Row { step, took: started.elapsed(), cpu, has_failed: outcome.is_err() });
        outcome
    }

    fn print(&self) {
        println!("\n{:<32} minutes   of CPU", "step");
        for Row { step, took, cpu, has_failed } in &self.0 {
            let failed = if *has_failed { "  FAILED" } else { "" };
            println!("{step:<32} {:>7.1} {:>8.1}{failed}", minutes(*took), minutes(*cpu));
        }
        let sum = |of: fn(&Row) -> Duration| minutes(self.0.iter().map(of).sum());
        println!("{:<32} {:>7.1} {:>8.1}", "all", sum(|row| row.took), sum(|row| row.cpu));
    }
}

fn minutes(time: Duration) -> f64 {
    time.as_secs_f64() / 60.0
}
