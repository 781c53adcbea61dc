//! Files of the user next to the output, with names that a writer might take for its own.

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::packages::Packages;
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "neighbours",
    tries: "files and links under temporary names beside every output; they survive byte for byte",
    share: 2,
    run,
};

/// A command and its output.
struct Writing {
    command: Vec<String>,
    output: String,
}

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    for Writing { command, output } in writings(context.packages) {
        for (kind, plant) in PLANTS {
            let desk = context.desk_with_cave();
            plant(&desk, &output);
            let words: Vec<&str> = command.iter().map(String::as_str).collect();
            tally.enter(&format!("{kind} beside {output}"), survives(&desk, &words));
        }
    }
    added_files(context, &mut tally);
    tally
}

/// The user's files survive a command unchanged, and the same command with `--force`.
fn survives(desk: &Desk, words: &[&str]) -> Result<(), String> {
    let before = desk.tree().without("c");
    let outcome = desk.run(words);
    outcome.decent()?;
    before.expect_within(&desk.tree()).map_err(|change| outcome.told(&change))
}

fn writings(packages: &Packages) -> Vec<Writing> {
    let exported = packages.bundles.iter().map(|(bundle, target)| Writing {
        command: line(&format!("export c -t {target} --bundle {bundle} -o z")),
        output: format!("z.{bundle}"),
    });
    let others = [
        ("export c -t obj -o out", "out"),
        ("export -t stl -o out --set graph.nodes=4 --set mesh.voxel_m=0.4 --set texture.size_px=256", "out"),
        ("generate -o new --set graph.nodes=4 --set mesh.voxel_m=0.4 --set texture.size_px=256", "new"),
        ("generate c --set look.humidity=0.9 --force", "c/cave.toml"),
        ("generate c --seed 9 --force", "c/textures/chunk_0_0_0_normal.png"),
        ("generate c --seed 8 --force", "c/chunks/chunk_0_0_0.ply"),
        ("pieces c", "c/pieces"),
        ("preview c -o plan.png", "plan.png"),
        ("preview c -o plan.svg", "plan.svg"),
        ("graph export c -o g.json", "g.json"),
        ("graph export c -o g.graphml", "g.graphml"),
        ("graph export c -o g_nodes.dat", "g_nodes.dat"),
        ("graph import c/graph.json -o g.json", "g.json"),
    ];
    let others = others.map(|(command, output)| Writing { command: line(command), output: output.to_owned() });
    exported.into_iter().chain(others).collect()
}

fn line(command: &str) -> Vec<String> {
    command.split(' ').map(str::to_owned).collect()
}

type Plant = (&'static str, fn(&Desk, &str));

const PLANTS: [Plant; 6] = [
    ("folders called .partial and .old.partial", |desk, output| {
        desk.file(&format!("{output}.partial/thesis.txt"), "the user's");
        desk.file(&format!("{output}.old.partial/thesis.txt"), "the user's");
    }),
    ("files called .partial and .old.partial", |desk, output| {
        desk.file(&format!("{output}.partial"), "the user's");
        desk.file(&format!("{output}.old.partial"), "the user's");
    }),
    ("links called .partial to a victim", |desk, output| {
        desk.file("victim.txt", "the user's");
        desk.link(&format!("{output}.partial"), desk.path("victim.txt"));
        desk.link(&format!("{output}.old.partial"), desk.path("victim.txt"));
    }),
    ("links called .partial to a folder", |desk, output| {
        desk.file("victim/thesis.txt", "the user's");
        desk.link(&format!("{output}.partial"), desk.path("victim"));
        desk.link(&format!("{output}.old.partial"), desk.path("victim"));
    }),
    ("a hidden folder .NAME.cave with a file of the user's", |desk, output| {
        let (folder, name) = output.rsplit_once('/').unwrap_or((".", output));
        desk.file(&format!("{folder}/.{name}.cave/thesis.txt"), "the user's");
    }),
    ("hidden folders like those of a killed run", |desk, output| {
        let folder = output.rsplit_once('/').map_or(".", |(folder, _)| folder);
        desk.file(&format!("{folder}/.tmpAbCdEf/thesis.txt"), "the user's");
        desk.file(&format!("{folder}/.plume-AbCdEfGh/thesis.txt"), "the user's");
        desk.file(&format!("{folder}/.plume-abcdefgh"), "the user's");
        desk.link(&format!("{folder}/.plume-zzzzzzzz"), desk.path("tmp"));
    }),
];

/// Files that the user has put into a package survive `--force`.
fn added_files(context: &Context, tally: &mut Tally) {
    for target in ["obj", "gazebo"] {
        let desk = context.desk_with_cave();
        let export = ["export", "c", "-t", target, "-o", "out"];
        let made = desk.run(&export).done();
        for own in ["out/notes.txt", "out/mine/deep/photo.png", "out/.git/config"] {
            desk.file(own, "the user's");
        }
        let words = [&export[..], &["--force"]].concat();
        let kept = || {
            let before = desk.tree();
            let outcome = desk.run(&words);
            outcome.decent()?;
            let own = |tree: &crate::tree::Tree| {
                ["out/notes.txt", "out/mine/deep/photo.png", "out/.git/config"].map(|path| tree.has(path))
            };
            if own(&before) == own(&desk.tree()) {
                Ok(())
            } else {
                Err(outcome.told("deleted what the user had added"))
            }
        };
        tally.enter("files of the user's in a package, --force", made.and_then(|()| kept()));
    }
}
