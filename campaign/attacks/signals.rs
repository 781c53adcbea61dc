//! Signals, and external programs that outlive the run that started them.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::process::Signal;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::program::{End, Outcome};
use crate::scenario;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "signals",
    tries: "INT, TERM and HUP at a random moment, also while a program of a recipe runs; nothing stays behind",
    share: 4,
    run,
};

const SIGNALS: [(&str, Signal); 3] = [("INT", Signal::INT), ("TERM", Signal::TERM), ("HUP", Signal::HUP)];

/// How long a run may take to stop after a signal.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long a run may take to get going on a busy machine.
const START: Duration = Duration::from_secs(60);

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    for signal in SIGNALS {
        at_work(context, &mut tally, signal);
        for _ in context.length.rounds(1, 40) {
            while_a_program_runs(context, &mut tally, signal);
        }
    }
    grandchild(context, &mut tally);
    environment(context, &mut tally);
    tally
}

/// A run that is asked to stop leaves complete outputs or none, and the next one resumes.
fn at_work(context: &mut Context, tally: &mut Tally, (name, signal): (&str, Signal)) {
    let scenarios = scenario::all(context.packages);
    for round in context.length.rounds(scenarios.len(), 4 * scenarios.len()) {
        let scenario = &scenarios[round % scenarios.len()];
        let part = context.rng.unit();
        let what = format!("`{}`, {name} after {part:.3} of its time", scenario.line());
        let held = scenario.reference(context).and_then(|reference| {
            let desk = scenario.desk(context)?;
            let running = desk.call(&scenario::strs(&scenario.words)).start();
            // Before handlers are installed, signals end a program immediately.
            sleep(Duration::from_millis(15) + reference.took.mul_f64(part));
            running.send(signal);
            let outcome = running.within(PATIENCE).wait();
            ended(&outcome, &desk)?;
            scenario.withstands(&desk, &outcome, &reference)
        });
        tally.enter(&what, held);
    }
}

/// Done, or interrupted: by exit code, or by the signal itself after tidying up. The cave on which the next run goes on may
/// stay.
fn ended(outcome: &Outcome, desk: &Desk) -> Result<(), String> {
    if !matches!(outcome.end, End::Code(0 | 129 | 130 | 143) | End::Signal(1 | 2 | 15)) {
        return Err(outcome.told("did not end in good order"));
    }
    let tree = desk.tree();
    let goes_on = |path: &Path| path.components().any(|part| part.as_os_str().to_string_lossy().ends_with(".cave"));
    let left = tree.temporaries().into_iter().find(|path| !path.ends_with("journal.jsonl") && !goes_on(path));
    left.map_or(Ok(()), |left| Err(outcome.told(&format!("has left {}", left.display()))))
}

/// A recipe whose program is this shell script.
fn desk(context: &Context, script: &str) -> Desk {
    let desk = context.desk();
    desk.file("recipes/make.sh", script);
    let recipe = "[graph]\ngenerator = \"external\"\ncommand = [\"sh\", \"make.sh\"]\ntime_limit_s = 60.0\n";
    desk.file("recipes/cave.toml", recipe);
    desk
}

const GRAPH: [&str; 5] = ["graph", "recipes/cave.toml", "-o", "cave", "--allow-run"];

const ROW: &str = r#"echo '{"nodes": [
{"id": 0, "edges": [1], "coordinates": {"x": 0, "y": 0, "z": 0}},
{"id": 1, "edges": [2], "coordinates": {"x": 5, "y": 0, "z": 0}},
{"id": 2, "edges": [], "coordinates": {"x": 9, "y": 3, "z": 0}}]}'
"#;

/// The external program and its children end with the run.
fn while_a_program_runs(context: &Context, tally: &mut Tally, (name, signal): (&str, Signal)) {
    let desk = desk(context, "sleep 600 & echo $! > child; echo $$ > own; mv own program; wait\n");
    let running = desk.call(&GRAPH).start();
    let program = desk.path("recipes/program");
    let started = Instant::now();
    while !program.exists() && started.elapsed() < START {
        sleep(Duration::from_millis(5));
    }
    running.send(signal);
    let outcome = running.within(PATIENCE).wait();
    let held = ended(&outcome, &desk).and_then(|()| {
        let survivor = ["program", "child"].into_iter().find(|file| survives(&desk, file));
        survivor.map_or(Ok(()), |file| Err(outcome.told(&format!("left its {file} running"))))
    });
    ["program", "child"].into_iter().for_each(|file| end_survivor(&desk, file));
    tally.enter(&format!("{name} while the program of a recipe runs"), held);
}

/// The process id that a script has written down.
fn process(desk: &Desk, file: &str) -> Option<rustix::process::Pid> {
    let text = fs::read_to_string(desk.path("recipes").join(file)).ok()?;
    rustix::process::Pid::from_raw(text.trim().parse().ok()?)
}

fn survives(desk: &Desk, file: &str) -> bool {
    sleep(Duration::from_millis(200));
    let Some(process) = process(desk, file) else { return false };
    let status = fs::read_to_string(format!("/proc/{}/stat", process.as_raw_nonzero())).unwrap_or_default();
    !status.is_empty() && !status.contains(") Z ")
}

fn end_survivor(desk: &Desk, file: &str) {
    if let Some(process) = process(desk, file).filter(|_| survives(desk, file)) {
        let _ = rustix::process::kill_process(process, Signal::KILL);
    }
}

/// A grandchild in a separate session keeps the program's standard output open; the graph is made nevertheless.
fn grandchild(context: &Context, tally: &mut Tally) {
    let desk = desk(context, &format!("{ROW}setsid sh -c 'echo $$ > child; exec sleep 600' &\nsleep 0.3\n"));
    let outcome = desk.call(&GRAPH).within(Duration::from_secs(30)).run();
    end_survivor(&desk, "child");
    tally.enter("a grandchild in a session of its own keeps standard output open", outcome.done());
}

/// An external program gets no environment variables beyond those it needs.
fn environment(context: &Context, tally: &mut Tally) {
    let desk = desk(context, &format!("env > told\n{ROW}"));
    let outcome = desk.call(&GRAPH).under(&["env", "CLOUD_SECRET_KEY=xyzzy", "SSH_AUTH_SOCK=/xyzzy"]).run();
    let told = fs::read_to_string(desk.path("recipes/told")).unwrap_or_default();
    let held = outcome.done().and_then(|()| match told.contains("xyzzy") {
        true => Err(outcome.told("has passed secrets of the environment on")),
        false => Ok(()),
    });
    tally.enter("secrets in the environment", held);
}
