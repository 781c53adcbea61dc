//! A cave folder that the user keeps is an input: exports and previews leave it unchanged.

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "kept folders",
    tries: "overrides, edited images and read-only mounts; the folder's bytes are the same before and after",
    share: 1,
    run,
};

const COMMANDS: [&str; 16] = [
    "export c -t obj -o out",
    "export c -t obj -o out --set name=north",
    "export c -t obj -o out --set graph.nodes=5",
    "export c -t obj -o out --seed 9",
    "export c -t obj -o out --set texture.format=jpg",
    "export c -t obj -o out --set look.humidity=0.9 --force",
    "export c -t obj -o out --set mesh.voxel_m=0.5",
    "export c -t gazebo,obj --bundle zip -o out --seed 9",
    "export c/graph.json -t obj -o out --seed 9",
    "preview c -o plan.png",
    "preview c -o plan.png --seed 9",
    "preview c -o plan.png --set graph.nodes=5",
    "graph export c -o graph.graphml",
    "status c",
    "measure c",
    "graph import c/graph.json -o graph.json",
];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    for command in COMMANDS {
        let desk = context.desk_with_cave();
        tally.enter("a kept folder", unchanged(&desk, command).map(|_| ()));
    }
    for image in ["textures/chunk_0_0_0_base_color.jpg", "textures/chunk_0_0_0_normal.png", "chunks/chunk_0_0_0.ply"] {
        // `generate` is the command that remakes damaged files.
        for command in ["export c -t gazebo -o out", "measure c", "status c"] {
            tally.enter(&format!("{image} edited by hand"), edited(context, image, command));
        }
    }
    read_only(context, &mut tally);
    tally
}

/// Checks that a command leaves the folder unchanged; returns its output.
fn unchanged(desk: &Desk, command: &str) -> Result<String, String> {
    let before = desk.tree_of("c");
    let outcome = desk.run(&command.split(' ').collect::<Vec<_>>());
    outcome.decent()?;
    before.expect(&desk.tree_of("c")).map_err(|change| outcome.told(&format!("has written into it ({change})")))?;
    Ok(outcome.stdout + &outcome.stderr)
}

/// Files edited by hand in the folder are neither overwritten nor silently exported.
fn edited(context: &Context, image: &str, command: &str) -> Result<(), String> {
    let desk = context.desk_with_cave();
    let other = image.replace("chunk_0_0_0", "chunk_0_1_0");
    std::fs::copy(desk.path("c").join(other), desk.path("c").join(image)).map_err(|error| error.to_string())?;
    let edited = std::fs::read(desk.path("c").join(image)).ok();
    let outcome = desk.run(&command.split(' ').collect::<Vec<_>>());
    outcome.decent()?;
    if std::fs::read(desk.path("c").join(image)).ok() != edited {
        return Err(outcome.told("has written over it"));
    }
    // Numbers of a mesh do not follow from an image.
    let is_read = command != "measure c" || image.ends_with(".ply");
    let is_named = [&outcome.stdout, &outcome.stderr].iter().any(|said| said.contains("chunk_0_0_0"));
    if is_read && !is_named { Err(outcome.told("does not name it")) } else { Ok(()) }
}

/// A finished folder works from a read-only mount.
fn read_only(context: &Context, tally: &mut Tally) {
    let desk = context.desk_with_cave();
    let shell = |script: &str, name: &str| desk.run_other("unshare", &["-m", "sh", "-c", script, name]);
    let mount = "mount --bind c c && mount -o remount,ro,bind c c";
    let can = shell(&format!("{mount} && ! touch c/new 2>/dev/null"), "mount");
    if !can.is_done() {
        return tally.skip(format!("read-only mounts: {}", can.stderr.trim()));
    }
    let plume = context.plume.display().to_string();
    for (command, output) in [("export c -t obj -o out", "out"), ("export c -t stl --bundle zip -o z", "z.zip")] {
        let made = shell(&format!("{mount} && exec \"$0\" {command}"), &plume).done();
        tally.enter(&format!("`{command}` from a read-only mount"), made.and_then(|()| desk.check(output)));
    }
    for command in ["status c", "measure c", "preview c -o plan.png", "graph export c -o g.json"] {
        let done = shell(&format!("{mount} && exec \"$0\" {command}"), &plume).done();
        tally.enter(&format!("`{command}` from a read-only mount"), done);
    }
}
