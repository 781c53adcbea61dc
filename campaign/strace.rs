//! Fault injection by `strace`: system calls that fail or kill the program.

use std::collections::BTreeMap;
use std::fs;

use crate::attack::Context;
use crate::desk::Desk;
use crate::program::Outcome;

/// A call of one thread: the name, and which of its calls of that name, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Point {
    /// System call.
    pub call: String,
    /// Number.
    pub number: usize,
}

/// `Ok` if programs can be traced here, else the reason.
pub fn works(context: &Context) -> Result<(), String> {
    let desk = context.desk();
    let outcome = desk.run_other("sh", &["-c", "command -v strace >&2 && strace -qq -e trace=none true"]);
    outcome.done().map_err(|_| format!("strace: {}", outcome.stderr.trim()))
}

/// The calls of these names that a run makes, by the thread that makes most of each.
pub fn points(desk: &Desk, words: &[&str], calls: &[&str]) -> Result<Vec<Point>, String> {
    let trace = desk.path("tmp/trace");
    let filter = format!("trace={}", calls.join(","));
    let prefix = ["strace", "-f", "-qq", "-e", &filter, "-o", &trace.to_string_lossy()].map(str::to_owned);
    desk.call(words).under(&prefix).run().done()?;
    let text = fs::read_to_string(trace).map_err(|error| format!("strace has written nothing: {error}"))?;
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (thread, call) in text.lines().filter_map(call) {
        *counts.entry((call, thread)).or_default() += 1;
    }
    let mut most: BTreeMap<&str, usize> = BTreeMap::new();
    for ((call, _), count) in counts {
        let known = most.entry(call).or_default();
        *known = count.max(*known);
    }
    let points = |(call, count): (&str, usize)| {
        let call = call.to_owned();
        (1..=count).map(move |number| Point { call: call.clone(), number })
    };
    Ok(most.into_iter().flat_map(points).collect())
}

/// The thread and the call of a line such as `12 rename("a", "b") = 0`.
fn call(line: &str) -> Option<(&str, &str)> {
    let (thread, rest) = line.split_once(' ')?;
    let (call, _) = rest.trim_start().split_once('(')?;
    call.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_').then_some((thread, call))
}

/// Runs a command while `what` (`signal=KILL`, `error=EIO`) happens at a point. Also returns whether the run came that far: how
/// often a thread makes a call depends on how soon others are done.
pub fn inject(desk: &Desk, words: &[&str], point: &Point, what: &str) -> (Outcome, bool) {
    let Point { call, number } = point;
    let trace = desk.path("tmp/injected");
    let [calls, fault] = [format!("trace={call}"), format!("inject={call}:{what}:when={number}")];
    let prefix = ["strace", "-f", "-qq", "-e", &calls, "-e", &fault, "-o", &trace.to_string_lossy()].map(str::to_owned);
    let outcome = desk.call(words).under(&prefix).run();
    let reached =
        fs::read_to_string(&trace).is_ok_and(|text| text.contains("(INJECTED)") || text.contains("killed by"));
    // What withstands a fault is judged by all that it leaves, so nothing else may lie there.
    let _ = fs::remove_file(trace);
    (outcome, reached)
}
