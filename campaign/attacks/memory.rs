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
    let limits = context.length.some_of(&LIMITS, 7);
    let (enough, too_little): (Vec<u64>, Vec<u64>) =
        limits.into_iter().partition(|&mebibytes| loads(context, mebibytes));
    too_little.iter().for_each(|_| tally.set_apart("too little to load the program"));
    for command in COMMANDS {
        for &mebibytes in &enough {
            let desk = context.desk_with_cave();
            let words = if command[0] == "generate" { [command, &SMALL[..]].concat() } else { command.to_vec() };
            let call = desk.call(&words).under(&["prlimit", &limit(mebibytes)]);
            let outcome = call.within(Duration::from_secs(60)).run();
            if is_abort(&outcome) {
                tally.set_apart("aborted by the runtime");
                continue;
            }
            tally.enter(&format!("{mebibytes} MiB of address space"), outcome.decent());
        }
    }
    tally
}

/// Whether the system can load the program, which has segments of some 30 MiB.
fn loads(context: &Context, mebibytes: u64) -> bool {
    context.desk().call(&["--version"]).under(&["prlimit", &limit(mebibytes)]).run().is_done()
}

fn limit(mebibytes: u64) -> String {
    format!("--as={}", mebibytes << 20)
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
