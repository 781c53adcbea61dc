//! The fuzzers of `fuzz/`, each from its corpus and the seed files of its reader.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::attack::{Attack, Context};
use crate::program::{Call, Outcome};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "fuzz",
    tries: "every reader of untrusted files, on inputs that follow its branches; no panic, no flood, no hang",
    share: 35,
    run,
};

/// A fuzzer that does not end by itself is stopped.
const PATIENCE: Duration = Duration::from_secs(120);

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    if !context.length.is_long() {
        tally.skip("fuzzers take minutes to build: in the long campaign only");
        return tally;
    }
    let folder = context.repository.join("fuzz");
    let found = [folder.clone(), folder.join("whole")].map(|package| targets(&package)).concat();
    let (ready, missing): (Vec<_>, Vec<_>) =
        found.into_iter().map(|name| (program(&folder, &name), name)).partition(|(program, _)| program.exists());
    if !missing.is_empty() {
        let names: Vec<&str> = missing.iter().map(|(_, name)| name.as_str()).collect();
        tally.skip(format!("not built: {}", names.join(", ")));
    }
    for (at, (program, name)) in ready.iter().enumerate() {
        // Time that one fuzzer leaves unused goes to the others.
        let share = context.length.left() / (ready.len() - at) as u32;
        fuzz(context, &mut tally, program, name, share);
    }
    tally
}

/// The names of the fuzzers of a package.
fn targets(package: &Path) -> Vec<String> {
    let files = std::fs::read_dir(package.join("fuzz_targets")).into_iter().flatten().flatten();
    let mut names: Vec<String> = files.filter_map(|file| Some(file.path().file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

fn program(folder: &Path, name: &str) -> PathBuf {
    folder.join("target").join(format!("{}-unknown-linux-gnu/release", std::env::consts::ARCH)).join(name)
}

fn fuzz(context: &mut Context, tally: &mut Tally, program: &Path, name: &str, share: Duration) {
    let desk = context.desk();
    std::fs::create_dir(desk.path("found")).expect("a folder can be made");
    let found = context.repository.join("target/campaign");
    let _ = std::fs::create_dir_all(&found);
    let mut words = vec![
        format!("-seed={}", 1 + context.rng.below(1 << 31)),
        "-max_len=4096".to_owned(),
        "-timeout=20".to_owned(),
        "-rss_limit_mb=2048".to_owned(),
        "-print_final_stats=1".to_owned(),
        format!("-artifact_prefix={}/{name}-", found.display()),
        format!("-max_total_time={}", share.as_secs().max(1)),
        "found".to_owned(),
    ];
    let seeds = [format!("fuzz/corpus/{name}"), format!("tests/data/formats/{name}")];
    words.extend(
        seeds
            .iter()
            .map(|seed| context.repository.join(seed))
            .filter(|path| path.is_dir())
            .map(|path| path.display().to_string()),
    );
    let started = Instant::now();
    let outcome = Call::new(program, &words, &desk.path("")).within(share + PATIENCE).run();
    let executed = executed(&outcome);
    tally.note(format!("{name}: {executed} executions in {} s", started.elapsed().as_secs()));
    tally.tried += executed;
    if !outcome.is_done() {
        tally.enter(name, Err(fault(&outcome)));
    }
}

fn executed(outcome: &Outcome) -> usize {
    let line = outcome.stderr.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
    line.and_then(|number| number.trim().parse().ok()).unwrap_or_default()
}

/// The failure and the input that caused it.
fn fault(outcome: &Outcome) -> String {
    let telling = ["panicked at", "ERROR:", "SUMMARY:", "Test unit written to", "Base64:"];
    let lines = outcome.stderr.lines().filter(|line| telling.iter().any(|start| line.contains(start)));
    let lines: Vec<&str> = lines.collect();
    if lines.is_empty() { outcome.told("failed") } else { lines.join(" / ").chars().take(600).collect() }
}
