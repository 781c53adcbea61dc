//! A kill at every system call that creates, renames or removes a file.

use crate::attack::{Attack, Context};
use crate::scenario::{self, Reference, Scenario};
use crate::strace::{self, Point};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "stops",
    tries: "a kill before every rename, link, unlink and mkdir; the next run ends as if there had been none",
    share: 15,
    run,
};

const CALLS: [&str; 9] = ["rename", "renameat", "renameat2", "link", "linkat", "unlink", "unlinkat", "mkdir", "rmdir"];

/// Kills per command and system call in a short campaign: at the first call, the last, and one in between.
const FEW: usize = 3;

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    if let Err(reason) = strace::works(context) {
        tally.skip(reason);
        return tally;
    }
    for scenario in scenario::all(context.packages) {
        let points =
            scenario.desk(context).and_then(|desk| strace::points(&desk, &scenario::strs(&scenario.words), &CALLS));
        match (points, scenario.reference(context)) {
            (Ok(points), Ok(reference)) => {
                let by_call = points.chunk_by(|one, other| one.call == other.call);
                for point in by_call.flat_map(|points| context.length.some_of(points, FEW)) {
                    stop(context, &mut tally, &scenario, &reference, &point);
                }
            }
            (Err(fault), _) | (_, Err(fault)) => tally.enter(&scenario.line(), Err(fault)),
        }
    }
    tally
}

fn stop(context: &Context, tally: &mut Tally, scenario: &Scenario, reference: &Reference, point: &Point) {
    let what = format!("`{}` killed before its {} number {}", scenario.line(), point.call, point.number);
    let desk = match scenario.desk(context) {
        Ok(desk) => desk,
        Err(fault) => return tally.enter(&what, Err(fault)),
    };
    let (outcome, reached) = strace::inject(&desk, &scenario::strs(&scenario.words), point, "signal=KILL");
    if !reached && outcome.is_done() {
        // Threads ran in a different order and the call was not made this time.
        return tally.set_apart("not reached");
    }
    tally.enter(&what, scenario.withstands(&desk, &outcome, reference));
}
