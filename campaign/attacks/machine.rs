//! Another processor.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::attack::{Attack, Context};
use crate::cave::SMALL;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "machine",
    tries: "the same cave and packages by an emulated processor without vector units beyond SSE2, to the byte",
    share: 1,
    run,
};

/// The oldest processor that the target `x86_64` allows.
const EMULATOR: [&str; 3] = ["qemu-x86_64", "-cpu", "qemu64"];
/// Emulation takes some twenty times as long.
const LIMIT: Duration = Duration::from_secs(300);
const OTHER: &str = "aarch64-unknown-linux-gnu";

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    if cfg!(target_arch = "x86_64") {
        match context.desk().run_other("sh", &["-c", "command -v qemu-x86_64"]).is_done() {
            true => tally.enter("qemu-x86_64 -cpu qemu64", same_bytes(context)),
            false => tally.skip("qemu-x86_64: install qemu-user"),
        }
    }
    tally.skip(match has_library() {
        true => format!("{OTHER}: its standard library is here, but nothing builds for it yet"),
        false => format!("{OTHER}: this Rust has no standard library for it"),
    });
    tally
}

fn same_bytes(context: &Context) -> Result<(), String> {
    let desk = context.desk();
    let generate = [&["generate", "-o", "c"][..], &SMALL].concat();
    desk.call(&generate).under(&EMULATOR).within(LIMIT).run().done()?;
    desk.run(&[&["generate", "-o", "native"][..], &SMALL].concat()).done()?;
    desk.tree_of("native").expect(&desk.tree_of("c")).map_err(|change| format!("cave folder: {change}"))?;
    let export = ["export", "c", "-t", "mujoco,obj", "-o"];
    desk.call(&[&export[..], &["emulated"]].concat()).under(&EMULATOR).within(LIMIT).run().done()?;
    desk.run(&[&export[..], &["packages"]].concat()).done()?;
    desk.tree_of("packages").expect(&desk.tree_of("emulated")).map_err(|change| format!("packages: {change}"))
}

fn has_library() -> bool {
    let asked = Command::new("rustc").args(["--print", "target-libdir", "--target", OTHER]).output();
    asked.is_ok_and(|output| Path::new(String::from_utf8_lossy(&output.stdout).trim()).exists())
}
