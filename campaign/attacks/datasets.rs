//! Datasets whose runs are killed, meet a second run, or fill the disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use rustix::process::{Signal, kill_process};

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::tally::Tally;
use crate::tree::Tree;

pub const ATTACK: Attack = Attack {
    name: "datasets",
    tries: "kills of a run, of its driver or of a worker at random moments, a second run, a full disk; the dataset ends as if undisturbed",
    share: 6,
    run,
};

const SPEC: &str = r#"
name = "tiny"
seeds = [1, 6]
targets = ["obj"]
set = ["graph.nodes=3", "mesh.voxel_m=0.5", "texture.size_px=256", "things.cover=0"]
sheet = 1
[[vary]]
key = "look.humidity"
draw = "uniform"
values = [0.0, 1.0]
"#;
const COMMAND: [&str; 7] = ["dataset", "tiny.toml", "-o", "out", "--workers", "2", "--quiet"];
/// Kills in a short campaign, and at least in a long one.
const KILLS: [usize; 2] = [12, 60];
/// Sizes of full disks in a short campaign, and at least in a long one.
const SIZES: [usize; 2] = [2, 12];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    let desk = desk(context);
    let outcome = desk.run(&COMMAND);
    if let Err(fault) = outcome.done() {
        tally.enter("an undisturbed run", Err(fault));
        return tally;
    }
    let (reference, took) = (result(&desk.path("out")), outcome.took);
    let size = |file: &PathBuf| fs::metadata(desk.path("out").join(file)).map_or(0, |data| data.len());
    let whole_kb = reference.files().iter().map(size).sum::<u64>() / 1024;
    for round in context.length.rounds(KILLS[0], KILLS[1]) {
        let (part, victim) = (context.rng.unit(), [Victim::All, Victim::Driver, Victim::Worker][round % 3]);
        let what = format!("{victim:?} killed after {part:.3} of the time of a run");
        tally.enter(&what, kill(context, victim, took.mul_f64(part), &reference));
    }
    tally.enter("two runs at once", two_at_once(context, &reference));
    full_disks(context, &mut tally, &reference, whole_kb);
    tally
}

/// Who is killed.
#[derive(Clone, Copy, Debug)]
enum Victim {
    All,
    Driver,
    Worker,
}

fn desk(context: &Context) -> Desk {
    let desk = context.desk();
    desk.file("tiny.toml", SPEC);
    desk
}

/// What follows from the specification: not what caves took, and not the lock.
fn result(folder: &Path) -> Tree {
    Tree::of(folder).without("costs.csv").without("dataset.lock")
}

fn kill(context: &Context, victim: Victim, after: Duration, reference: &Tree) -> Result<(), String> {
    let desk = desk(context);
    let running = desk.call(&COMMAND).start();
    sleep(after);
    match victim {
        Victim::All => drop(running.kill()),
        Victim::Driver => {
            running.send(Signal::KILL);
            // The next run starts while workers may not have noticed yet.
            drop(running.wait_alone());
        }
        Victim::Worker => {
            if let Some(worker) = running.children().first() {
                let _ = kill_process(*worker, Signal::KILL);
            }
            running.wait().done()?;
        }
    }
    desk.run(&COMMAND).done().map_err(|fault| format!("the next run: {fault}"))?;
    reference.expect(&result(&desk.path("out"))).map_err(|change| format!("in the end {change}"))?;
    desk.check("out")
}

/// The second is refused while the first works, and the first is not disturbed.
fn two_at_once(context: &Context, reference: &Tree) -> Result<(), String> {
    let desk = desk(context);
    let first = desk.call(&COMMAND).start();
    while !desk.path("out/dataset.json").is_file() {
        sleep(Duration::from_millis(1));
    }
    let second = desk.run(&COMMAND);
    first.wait().done()?;
    second.refused()?;
    if !second.stderr.contains("another run is using") {
        return Err(second.told("should have named the other run"));
    }
    reference.expect(&result(&desk.path("out"))).map_err(|change| format!("in the end {change}"))
}

/// A disk that is full at some moment: the run says so; with more space the next one goes on.
fn full_disks(context: &mut Context, tally: &mut Tally, reference: &Tree, whole_kb: u64) {
    let shell = |desk: &Desk, script: &str, size_kb: u64| {
        let plume = context.plume.to_string_lossy().into_owned();
        desk.run_other("unshare", &["-m", "sh", "-c", script, &plume, &size_kb.to_string()])
    };
    let mount = "mkdir out && mount -t tmpfs -o size=\"$1\"k plume out";
    let can = shell(&desk(context), mount, 64);
    if !can.is_done() {
        return tally.skip(format!("full disks: {}", can.stderr.trim()));
    }
    let command = COMMAND.join(" ");
    let script = format!(
        "{mount} && ! \"$0\" {command} 2>fault && mount -o remount,size=1g out && \"$0\" {command} && cp -r out result"
    );
    for round in context.length.rounds(SIZES[0], SIZES[1]) {
        // The first sizes are of a disk that is full almost at once, and almost never.
        let part = [0.1, 0.8].get(round).copied().unwrap_or_else(|| context.rng.unit() * 0.9);
        let size_kb = ((whole_kb as f64 * part) as u64).max(8);
        let desk = desk(context);
        let outcome = shell(&desk, &script, size_kb);
        let fault = fs::read_to_string(desk.path("fault")).unwrap_or_default();
        let held = match outcome.done() {
            Ok(()) if !fault.contains("space") => Err(format!("the full disk is not named: {}", fault.trim())),
            Ok(()) => reference.expect(&result(&desk.path("result"))).map_err(|change| format!("in the end {change}")),
            Err(fault) => Err(fault),
        };
        tally.enter(&format!("`plume {command}` on a disk of {size_kb} kB"), held);
    }
}
