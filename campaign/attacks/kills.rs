//! A kill at any moment.

use std::thread::sleep;

use crate::attack::{Attack, Context};
use crate::scenario::{self, Reference, Scenario};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "kills",
    tries: "a kill at a random moment of every target, bundle and other writer; the next run ends as if there had been none",
    share: 12,
    run,
};

/// Random kills in a long campaign, at least.
const MANY: usize = 200;

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    let mut known = Vec::new();
    for scenario in scenario::long(context.packages) {
        match scenario.reference(context) {
            Ok(reference) => known.push((scenario, reference)),
            Err(fault) => tally.enter(&scenario.line(), Err(fault)),
        }
    }
    for round in context.length.rounds(known.len(), MANY) {
        let (scenario, reference) = &known[round % known.len()];
        let part = context.rng.unit();
        tally.enter(
            &format!("`{}` killed after {part:.3} of its time", scenario.line()),
            kill(context, scenario, reference, part),
        );
    }
    tally
}

fn kill(context: &Context, scenario: &Scenario, reference: &Reference, part: f64) -> Result<(), String> {
    let desk = scenario.desk(context)?;
    let running = desk.call(&scenario::strs(&scenario.words)).start();
    sleep(reference.took.mul_f64(part));
    let outcome = running.kill();
    scenario.withstands(&desk, &outcome, reference)
}
