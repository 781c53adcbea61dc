//! `cargo xtask COMMAND`: the routine tasks of the project. Few dependencies, so that it builds in seconds.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a task talks to whoever started it")]

use std::process::ExitCode;

mod bench;
mod campaign;
mod ci;
mod demo;
mod docs;
mod drives;
mod gallery;
mod interop;
mod licences;
mod plume;
mod realism;
mod samples;
mod scale;
mod strips;
mod targets;
mod test;
mod tools;
mod venv;
mod vslam;

type Task = fn(&[String]) -> tools::Result<()>;

const TASKS: [(&str, &str, Task); 14] = [
    ("ci", "                    all that must hold before anything lands", ci::run),
    ("demo", "                  make the default cave for Gazebo and Isaac Sim in demo", demo::run),
    ("test", "[ARGUMENT...]     run all tests that need cargo and python3 alone", test::run),
    ("interop", "[--all | PACKAGE_DIR...] open packages with foreign readers", interop::run),
    ("docs", "[check]           check links and build the book of the documentation", docs::run),
    ("gallery", "               renew the pictures beside the samples", gallery::run),
    ("strips", "[NAME...]        renew the rows of previews in the documentation", strips::run),
    ("campaign", "[--minutes N] [ATTACK...] attack the built program; a few minutes unless told more", campaign::run),
    ("drives", "[SEEDS | campaign] hold certificates of many caves to drives in MuJoCo and Bullet", drives::run),
    ("licences", "              write the licences of all crates that are shipped", licences::write),
    ("bench", "[ROW...|usd]     CPU seconds by stage, and the ratio to writing the same images", bench::run),
    ("scale", "[KM...]            CPU seconds, peak memory and disk of large caves by stage and target", scale::run),
    ("realism", "[SEEDS]          how like real caves the graphs of every generator are", realism::run),
    ("vslam", "[VARIANT...|strips] what recorded runs are worth to visual SLAM; 45 CPU minutes", vslam::run),
];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let Some((name, rest)) = words.split_first() else {
        return usage();
    };
    let Some((_, _, task)) = TASKS.iter().find(|task| task.0 == name) else {
        return usage();
    };
    match task(rest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn usage() -> ExitCode {
    eprintln!("usage: cargo xtask COMMAND");
    for (name, summary, _) in TASKS {
        eprintln!("  {name} {summary}");
    }
    ExitCode::from(2)
}
