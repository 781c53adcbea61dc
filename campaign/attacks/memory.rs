//! Little memory.

use std::time::Duration;

use crate::attack::{Attack, Context};
use crate::cave::SMALL;
use crate::program::{End, Outcome};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "memory",
    tries: "commands under falling limits of address space: they work, say what is missing, or the runtime aborts",
    share: 2,
    run,
};

/// Limits in MiB, from ample to barely enough to load the program, or too little for that.
const LIMITS: [u64; 14] = [1024, 512, 256, 192, 128, 96, 80, 64, 56, 48, 40, 36, 32, 28];

const COMMANDS: [&[&str]; 7] = [
    &["generate", "-o", "new"],
    &["export", "c", "-t", "gazebo,obj", "-o", "out"],
    &["export", "c", "-t", "unity", "--bundle", "tgz", "-o", "out"],
    &["export", "c", "-t", "obj", "--bundle", "tar.zst", "-o", "out"],
    &["measure", "c"],
    &["preview", "c", "--view", "inside", "--size", "160x120", "-o", "inside.png"],
    &["check", "c"],
];

const ABORT: i32 = 6;

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    if !context.desk().run_other("prlimit", &["--version"]).is_done() {
        tally.skip("prlimit: there is no such program");
        return tally;
    }
    for command in COMMANDS {
        for mebibytes in context.length.some_of(&LIMITS, 7) {
            let desk = context.desk_with_cave();
            let limit = format!("--as={}", mebibytes << 20);
            if !desk.call(&["--version"]).under(&["prlimit", &limit]).run().is_done() {
                tally.set_apart("too little to load the program");
                continue;
            }
            let words = if command[0] == "generate" { [command, &SMALL[..]].concat() } else { command.to_vec() };
            let outcome = desk.call(&words).under(&["prlimit", &limit]).within(Duration::from_secs(60)).run();
            if is_abort(&outcome) {
                tally.set_apart("aborted by the runtime");
                continue;
            }
            tally.enter(&format!("{mebibytes} MiB of address space"), outcome.decent());
        }
    }
    tally
}

/// What the standard library and that of C say when they abort: an allocation that cannot fail otherwise, and a thread that has
/// started without room for the stack of its signal handler, or for what it does at its end.
const ABORTS: [&str; 3] = [
    "memory allocation of",
    "failed to allocate an alternative stack",
    "failed to register TLS destructor: out of memory",
];

/// Whether one of them has aborted it.
fn is_abort(outcome: &Outcome) -> bool {
    outcome.end == End::Signal(ABORT) && ABORTS.iter().any(|abort| outcome.stderr.contains(abort))
}
