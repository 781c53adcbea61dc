//! A hostile cave folder, whose records and links lead outside.

use std::path::Path;

use serde_json::Value;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::folder::{self, Seal};
use crate::python;
use crate::tally::Tally;
use crate::tree::Tree;

pub const ATTACK: Attack = Attack {
    name: "hostile folder",
    tries: "a cave folder whose records and links lead outside; nothing outside changes",
    share: 6,
    run,
};

/// Commands run on the folder. The last ones rewrite all of it.
const COMMANDS: &[&[&str]] = &[
    &["generate", "c"],
    &["export", "c", "-t", "obj", "-o", "package"],
    &["pieces", "c"],
    &["mesh", "c"],
    &["status", "c"],
    &["measure", "c"],
    &["preview", "c", "-o", "plan.svg"],
    &["graph", "c"],
    &["generate", "c", "--seed", "9", "--force"],
    &["generate", "c", "--set", "look.humidity=0.9", "--force"],
];

/// Commands that every forgery meets in a short campaign, from the front of [`COMMANDS`].
const ALWAYS: usize = 2;

/// Files of the user's in the cave folder, which no stage writes.
const OWN: [&str; 3] = ["c/notes.txt", "c/textures/photo.png", "c/chunks/survey/pit.svx"];

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    for (number, forgery) in forgeries().iter().enumerate() {
        for place in [Place::Manifest, Place::Journal] {
            for seal in [Seal::Open, Seal::Sealed] {
                let what = format!("{} in the {place:?}, {seal:?}", forgery.what);
                attack(context, &mut tally, number, &what, &|desk| forgery.plant(desk, place, seal));
            }
        }
    }
    for (number, name) in LINKED.iter().enumerate() {
        attack(context, &mut tally, number, &format!("{name} is a link to outside"), &|desk| lead_out(desk, name));
    }
    if context.python.is_none() {
        tally.skip(python::MISSING);
    }
    tally
}

/// Runs each command on a separate folder prepared by `plant`.
fn attack(context: &Context, tally: &mut Tally, number: usize, what: &str, plant: &dyn Fn(&Desk)) {
    let chosen =
        |at: usize| context.length.is_long() || at < ALWAYS || at == ALWAYS + number % (COMMANDS.len() - ALWAYS);
    for (_, command) in COMMANDS.iter().enumerate().filter(|(at, _)| chosen(*at)) {
        let desk = prepared(context, plant);
        let before = Guarded::of(&desk);
        let outcome = desk.run(command);
        let held = outcome.decent().and_then(|()| before.expect(&desk).map_err(|change| outcome.told(&change)));
        tally.enter(what, held);
    }
    if let Some(python) = context.python {
        let desk = prepared(context, plant);
        let before = Guarded::of(&desk);
        let _ = python.open(&desk.path(""), "c");
        tally.enter(&format!("{what}, plume.open"), before.expect(&desk));
    }
}

fn prepared(context: &Context, plant: &dyn Fn(&Desk)) -> Desk {
    let desk = context.desk_with_cave();
    for name in ["outside/victim", "outside/victim.txt", "outside/folder/victim.ply", "victim.png"] {
        desk.file(name, format!("{name} is not Plume's"));
    }
    OWN.iter().for_each(|name| desk.file(name, "the user's"));
    plant(&desk);
    desk
}

/// Files that no command may touch.
struct Guarded {
    outside: Tree,
    victim: Vec<u8>,
    own: Vec<Option<Vec<u8>>>,
}

impl Guarded {
    fn of(desk: &Desk) -> Self {
        let read = |name: &&str| std::fs::read(desk.path(name)).ok();
        Self {
            outside: desk.tree_of("outside"),
            victim: std::fs::read(desk.path("victim.png")).unwrap_or_default(),
            own: OWN.iter().map(read).collect(),
        }
    }

    fn expect(&self, desk: &Desk) -> Result<(), String> {
        let now = Self::of(desk);
        self.outside.expect(&now.outside).map_err(|change| format!("outside {change}"))?;
        if now.victim != self.victim {
            return Err("victim.png has changed".to_owned());
        }
        match OWN.iter().zip(&self.own).zip(&now.own).find(|((_, before), now)| before != now) {
            Some(((name, _), _)) => Err(format!("{name} is gone or has changed")),
            None => Ok(()),
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Manifest,
    Journal,
}

/// Forges units from genuine ones and a path.
type Forge = fn(&[Value], &str) -> Vec<Value>;

/// A record that Plume itself never writes.
struct Forgery {
    what: String,
    units: Forge,
    path: &'static str,
}

impl Forgery {
    fn plant(&self, desk: &Desk, place: Place, seal: Seal) {
        let honest = folder::units(desk);
        let path = self.path.replace("ABSOLUTE", &desk.path("outside").to_string_lossy());
        let forged = (self.units)(&honest, &path);
        match place {
            Place::Manifest => folder::put_manifest(desk, [honest, forged].concat(), seal),
            Place::Journal => folder::put_journal(desk, &forged, seal),
        }
    }
}

/// Paths that a record may name: outside, or inside but not that unit's.
const PATHS: [&str; 12] = [
    "ABSOLUTE/victim.txt",
    "../outside/victim.txt",
    "chunks/../../outside/victim.txt",
    "./../victim.png",
    "..",
    "",
    ".",
    "chunks",
    "notes.txt",
    "textures/photo.png",
    "chunks/survey/pit.svx",
    "chunks//../notes.txt",
];

fn forgeries() -> Vec<Forgery> {
    let stale = PATHS.map(|path| Forgery {
        what: format!("a unit of a chunk that is not there with the file {path:?}"),
        units: |_, path| vec![folder::unit("texture", "chunk_9_9_9", &[path])],
        path,
    });
    let replaced = PATHS.map(|path| Forgery {
        what: format!("a unit that takes the place of another with the file {path:?}"),
        units: |_, path| {
            let first = folder::unit("mesh", "chunk_0_0_0", &[path]);
            vec![first.clone(), folder::unit("mesh", "chunk_0_0_0", &[]), first]
        },
        path,
    });
    let names = ["../../outside/victim", "../victim", "ABSOLUTE/victim", "chunk_0_0_0/../../../outside/folder/victim"];
    let named = names.map(|path| Forgery {
        what: format!("finished units called {path:?}"),
        units: |honest, path| ["mesh", "texture", "pieces"].map(|stage| renamed(honest, stage, path)).to_vec(),
        path,
    });
    let odd: [(&str, Forge); 4] = [
        ("a unit with a name of a megabyte", |_, _| vec![folder::unit("mesh", &"x".repeat(1 << 20), &[])]),
        ("20,000 units", |_, _| {
            (0..20_000).map(|at| folder::unit("mesh", &format!("chunk_{at}_0_0"), &["notes.txt"])).collect()
        }),
        ("a texture unit with the recipe and the graph as files", |_, _| {
            vec![folder::unit("texture", "chunk_9_9_9", &["cave.toml", "graph.json", "manifest.json", "notes.txt"])]
        }),
        ("a record nested a thousand deep", |_, _| {
            vec![(0..1000).fold(Value::Null, |inner, _| Value::Array(vec![inner]))]
        }),
    ];
    let odd = odd.map(|(what, units)| Forgery { what: what.to_owned(), units, path: "" });
    stale.into_iter().chain(replaced).chain(named).chain(odd).collect()
}

/// A valid unit of the first wall under another name; a texture's files take the place of pieces, which do not exist yet.
fn renamed(honest: &[Value], stage: &str, name: &str) -> Value {
    let is_wall = |unit: &&Value| unit["stage"] == "mesh" && unit["files"].as_array().is_some_and(|f| !f.is_empty());
    let wall = honest.iter().find(is_wall).expect("the cave has walls");
    let like = |unit: &&Value| unit["stage"] == stage && unit["name"] == wall["name"];
    let mut unit = honest.iter().find(like).unwrap_or(wall).clone();
    unit["stage"] = stage.into();
    unit["name"] = name.into();
    unit
}

/// Parts of a cave folder that an attacker may replace with links.
const LINKED: [&str; 11] = [
    "chunks",
    "textures",
    "collision",
    "cave.toml",
    "graph.json",
    "manifest.json",
    "journal.jsonl",
    "plan.png",
    "chunks/chunk_0_0_0.ply",
    "textures/chunk_0_0_0_normal.png",
    "pieces",
];

/// Moves a part of the cave folder outside and links to it from where it was.
fn lead_out(desk: &Desk, name: &str) {
    let outside = format!("outside/{}", name.replace('/', "-"));
    if name == "pieces" {
        std::fs::create_dir(desk.path(&outside)).expect("a folder can be made");
    } else if std::fs::rename(desk.path("c").join(name), desk.path(&outside)).is_err() {
        desk.file(&outside, "");
    }
    let up = if name.contains('/') { "../.." } else { ".." };
    desk.link(&format!("c/{name}"), Path::new(up).join(outside));
    OWN.iter().filter(|own| !desk.path(own).exists()).for_each(|own| desk.file(own, "the user's"));
}
