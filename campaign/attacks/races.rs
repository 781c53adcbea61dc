//! Several processes writing to the same output at once.

use std::time::Duration;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::program::Outcome;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "races",
    tries: "two or three processes to one output; whatever says that it worked is whole, and nothing else stays",
    share: 6,
    run,
};

/// An output that several processes write to.
struct Race {
    /// In the command line of a process, `#` is its number from 0, and `@` a target for each.
    line: &'static str,
    targets: [&'static str; MOST],
    /// How the output is verified.
    check: fn(&Desk) -> Result<(), String>,
}

/// Maximum number of processes.
const MOST: usize = 3;
/// Targets whose packages differ in every file.
const THREE: [&str; MOST] = ["obj", "gazebo", "stl"];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    for round in context.length.rounds(3, 12) {
        for race in races() {
            let count = 2 + round % (MOST - 1);
            // Processes that start together do not always collide in their writes.
            let delay = Duration::from_micros(context.rng.below(1 + 15_000 * (round % 3)) as u64);
            let what = format!("{count} times `plume {}`, {} µs apart", race.line, delay.as_micros());
            tally.enter(&what, several(context, &race, count, delay));
        }
    }
    tally
}

fn several(context: &Context, race: &Race, count: usize, delay: Duration) -> Result<(), String> {
    let desk = context.desk();
    (0..MOST).for_each(|number| desk.copy(context.cave, &format!("c{number}")));
    let start = |number: usize| {
        std::thread::sleep(delay);
        let line = race.line.replace('#', &number.to_string()).replace('@', race.targets[number]);
        desk.call(&line.split(' ').collect::<Vec<_>>()).start()
    };
    let running: Vec<_> = (0..count).map(start).collect();
    let outcomes: Vec<Outcome> = running.into_iter().map(|run| run.wait()).collect();
    outcomes.iter().try_for_each(Outcome::decent)?;
    let done = outcomes.iter().filter(|outcome| outcome.is_done()).count();
    // Each package may be written by a different process, so it is possible that no process writes them all.
    if done == 0 && !race.line.contains("-t obj,stl") {
        return Err(outcomes[0].told("and no other one worked"));
    }
    (race.check)(&desk).map_err(|fault| format!("{done} said that they had worked, but {fault}"))?;
    match desk.tree().temporaries().as_slice() {
        [] => Ok(()),
        [first, ..] => Err(format!("{} is left", first.display())),
    }
}

fn races() -> [Race; 12] {
    let race = |line, targets, check| Race { line, targets, check };
    [
        race("export c# -t @ -o out", THREE, |desk| desk.check("out")),
        race("export c# -t @ -o out --force", THREE, |desk| desk.check("out")),
        race("export c# -t @ --bundle zip -o out", THREE, |desk| desk.check("out.zip")),
        race("export c# -t @ --bundle zip -o out --force", THREE, |desk| desk.check("out.zip")),
        race("export c# -t @ --bundle tar.zst -o out", THREE, |desk| desk.check("out.tar.zst")),
        race("export c# -t unity --bundle tgz -o out", THREE, |desk| desk.check("out.tgz")),
        race("export c# -t mujoco --bundle mjz -o out", THREE, |desk| desk.check("out.mjz")),
        race("export c# -t obj,stl -o out", THREE, |desk| desk.check("out/obj").and_then(|()| desk.check("out/stl"))),
        race("export c0 -t @ -o out-@", THREE, |_| Ok(())),
        race(
            "generate -o new --set graph.nodes=4 --set mesh.voxel_m=0.4 --set texture.size_px=256 --set mesh.chunk_m=[12,12,12]",
            THREE,
            whole_cave,
        ),
        race("export c0/graph.json -t @ -o out", THREE, |desk| desk.check("out")),
        race("preview c# -o plan.png", THREE, picture),
    ]
}

/// A cave folder with the same content as one made by a single process.
fn whole_cave(desk: &Desk) -> Result<(), String> {
    desk.run(&["measure", "new"]).done()?;
    desk.tree_of("c0").expect(&desk.tree_of("new"))
}

/// The same picture as a single process draws.
fn picture(desk: &Desk) -> Result<(), String> {
    desk.run(&["preview", "c0", "-o", "alone.png"]).done()?;
    let [alone, raced] = ["alone.png", "plan.png"].map(|name| std::fs::read(desk.path(name)).ok());
    if alone == raced { Ok(()) } else { Err("plan.png is not what one process draws".to_owned()) }
}
