//! `cargo xtask COMMAND`: what the project does to itself. Standard library only, so it builds in a second.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::process::ExitCode;

mod judge;
mod tools;
mod venv;

type Task = fn(&[String]) -> tools::Result<()>;

const TASKS: [(&str, &str, Task); 1] = [(
    "judge",
    "[PACKAGE_DIR...]  open packages with foreign readers",
    judge::run,
)];

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
