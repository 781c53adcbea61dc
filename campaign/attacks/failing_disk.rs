//! A disk that is full or broken.

use crate::attack::{Attack, Context};
use crate::scenario::{self, Reference, Scenario};
use crate::strace::{self, Point};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "failing disk",
    tries: "a write or fsync that fails; it is told, and nothing half-written has a final name",
    share: 8,
    run,
};

/// Failures of each kind and command in a short campaign.
const FEW: usize = 2;

const WRITES: [&str; 4] = ["write", "writev", "pwrite64", "copy_file_range"];
const SYNCS: [&str; 2] = ["fsync", "fdatasync"];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    if let Err(reason) = strace::works(context) {
        tally.skip(reason);
        return tally;
    }
    for scenario in scenario::all(context.packages) {
        match scenario.reference(context) {
            Ok(reference) => {
                fail(context, &mut tally, &scenario, &reference, &WRITES, "error=ENOSPC");
                fail(context, &mut tally, &scenario, &reference, &SYNCS, "error=EIO");
            }
            Err(fault) => tally.enter(&scenario.line(), Err(fault)),
        }
    }
    tally
}

fn fail(context: &Context, tally: &mut Tally, scenario: &Scenario, reference: &Reference, calls: &[&str], what: &str) {
    let words = scenario::strs(&scenario.words);
    let points = scenario.desk(context).and_then(|desk| strace::points(&desk, &words, calls));
    let points = points.and_then(|points| match points.is_empty() {
        true => Err(format!("makes no {}", calls.join(" and no "))),
        false => Ok(points),
    });
    match points {
        Ok(points) => context.length.some_of(&points, FEW).iter().for_each(|point| {
            let title = format!("`{}` with {what} at its {} number {}", scenario.line(), point.call, point.number);
            tally.enter(&title, fails_well(context, scenario, reference, point, what));
        }),
        Err(fault) => tally.enter(&format!("`{}`", scenario.line()), Err(fault)),
    }
}

/// Some runs make a call less often than the one that was counted; they get the failure at the last they make.
fn fails_well(
    context: &Context,
    scenario: &Scenario,
    reference: &Reference,
    point: &Point,
    what: &str,
) -> Result<(), String> {
    for number in (1..=point.number).rev() {
        let desk = scenario.desk(context)?;
        let point = Point { number, ..point.clone() };
        let (outcome, reached) = strace::inject(&desk, &scenario::strs(&scenario.words), &point, what);
        outcome.decent()?;
        if reached && outcome.is_done() {
            return Err(outcome.told("passed over it"));
        }
        if reached {
            return scenario.withstands(&desk, &outcome, reference);
        }
        outcome.done()?;
    }
    Err(format!("makes no {}", point.call))
}
