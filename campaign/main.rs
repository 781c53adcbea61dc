//! Attacks on the built program: `cargo xtask campaign [--minutes N]`.
//!
//! Each attack is a row of [`ATTACKS`] and a file of its own. The short campaign makes the same tries each time; the long
//! one makes all of them, and random ones with new numbers until its time is used. What is attacked is the program as
//! users have it, through its command line; what it must withstand is what SECURITY.md promises.
//!
//! Linux only: it stops programs in the middle of system calls, limits their memory and makes read-only mounts.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a campaign reports to whoever started it")]

mod arguments;
mod attack;
mod attacks;
mod cave;
mod desk;
mod folder;
mod packages;
mod program;
mod python;
mod report;
mod rng;
mod scenario;
mod strace;
mod tally;
mod tree;

use std::cmp::Reverse;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::arguments::Arguments;
use crate::attack::{Attack, Context, Length};
use crate::attacks::ATTACKS;
use crate::packages::Packages;
use crate::python::Python;
use crate::report::Row;
use crate::rng::Rng;

fn main() -> ExitCode {
    let arguments = match Arguments::read(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(fault) => {
            eprintln!("error: {fault}");
            return ExitCode::from(2);
        }
    };
    let chosen: Vec<&Attack> = ATTACKS.iter().filter(|attack| arguments.wants(attack.name)).collect();
    let rows = run(&chosen, &arguments);
    print!("{}", report::text(&rows, &arguments));
    if rows.iter().any(|row| row.tally.failed > 0) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Runs the attacks, as many in parallel as requested, and returns their rows in the order of the table.
fn run(chosen: &[&'static Attack], arguments: &Arguments) -> Vec<Row> {
    let scratch = tempfile::Builder::new().prefix("campaign").tempdir().expect("a folder can be made");
    let cave = cave::make(&arguments.plume, scratch.path());
    let packages = Packages::of(&arguments.plume);
    let python = Python::find(&arguments.repository);
    // The longest first, so that none of them runs alone at the end.
    let mut order: Vec<(usize, &&Attack)> = chosen.iter().enumerate().collect();
    order.sort_by_key(|(_, attack)| Reverse(attack.share));
    let next = Mutex::new(order.into_iter());
    let rows = Mutex::new(Vec::new());
    let work = || {
        while let Some((at, attack)) = { next.lock().expect("no worker panics").next() } {
            eprintln!("{} …", attack.name);
            let folder = scratch.path().join(attack.name.replace(' ', "-"));
            std::fs::create_dir(&folder).expect("a folder can be made");
            let started = Instant::now();
            let mut context = Context {
                plume: &arguments.plume,
                repository: &arguments.repository,
                packages: &packages,
                python: python.as_ref(),
                cave: &cave,
                scratch: folder,
                rng: Rng::new(arguments.seed, attack.name),
                length: length(attack, arguments),
            };
            let tally = (attack.run)(&mut context);
            eprintln!("{}: {} tried, {} failed", attack.name, tally.tried, tally.failed);
            rows.lock().expect("no worker panics").push((at, Row { attack, tally, took: started.elapsed() }));
        }
    };
    std::thread::scope(|scope| (0..arguments.jobs).for_each(|_| drop(scope.spawn(work))));
    let mut rows = rows.into_inner().expect("no worker has panicked");
    rows.sort_by_key(|(at, _)| *at);
    rows.into_iter().map(|(_, row)| row).collect()
}

/// The shares of the attacks that are not chosen go to those that are.
fn length(attack: &Attack, arguments: &Arguments) -> Length {
    let Some(minutes) = arguments.minutes else { return Length::Short };
    let all: u32 = ATTACKS.iter().filter(|attack| arguments.wants(attack.name)).map(|attack| attack.share).sum();
    let seconds = minutes * 60.0 * arguments.jobs as f64 * f64::from(attack.share) / f64::from(all.max(1));
    Length::Long(Instant::now() + Duration::from_secs_f64(seconds))
}
