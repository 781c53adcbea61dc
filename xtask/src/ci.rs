//! `cargo xtask ci`: everything that must hold before a change lands, and a table of minutes per step.

use std::process::Command;
use std::thread::ScopedJoinHandle;
use std::time::{Duration, Instant};

use crate::plume::cargo;
use crate::tools::{Result, show};
use crate::{campaign, interop, test};

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
    let lint = ["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"];
    table.step("clippy", || cargo_task(&lint))?;
    table.step("documentation and packages", documentation_and_packages)?;
    table.step("compiling the tests", || cargo_task(&["test", "--workspace", "--no-run", "--quiet"]))?;
    table.step("Rust tests", || test::rust(&[]))?;
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
    documentation.args(["doc", "--workspace", "--lib", "--no-deps", "--exclude", "plume-python", "--quiet"]);
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
    has_failed: bool,
}

impl Table {
    fn step(&mut self, step: &'static str, run: impl FnOnce() -> Result<()>) -> Result<()> {
        println!("== {step}");
        let started = Instant::now();
        let outcome = run();
        self.0.push(Row { step, took: started.elapsed(), has_failed: outcome.is_err() });
        outcome
    }

    fn print(&self) {
        println!("\n{:<32} minutes", "step");
        for Row { step, took, has_failed } in &self.0 {
            println!("{step:<32} {:>7.1}{}", minutes(*took), if *has_failed { "  FAILED" } else { "" });
        }
        println!("{:<32} {:>7.1}", "all", minutes(self.0.iter().map(|row| row.took).sum()));
    }
}

fn minutes(time: Duration) -> f64 {
    time.as_secs_f64() / 60.0
}
