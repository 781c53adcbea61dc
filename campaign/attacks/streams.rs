//! Inputs that never end or never start, and a full output device.

use std::fs::OpenOptions;
use std::time::Duration;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::program::{End, Outcome};
use crate::tally::Tally;

pub const ATTACK: Attack = Attack {
    name: "streams",
    tries: "/dev/full, pipes, /dev/zero, folders and 100 MB for every input; an error within seconds and within memory",
    share: 4,
    run,
};

/// Time limit for refusing a short input.
const LIMIT: Duration = Duration::from_secs(10);
/// Address space of these runs, far more than the small cave takes.
const MEMORY: &str = "--as=1500000000";
/// Maximum length of an error message.
const MOST_WORDS: usize = 4 << 10;

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    full(context, &mut tally);
    for (number, input) in INPUTS.iter().enumerate() {
        for (at, command) in READERS.iter().enumerate() {
            // Over time, each pair of a reader and a file extension.
            let endings: Vec<&str> = match context.length.is_long() {
                true => ENDINGS.to_vec(),
                false => vec![
                    "toml",
                    ENDINGS[(number * 3 + at) % ENDINGS.len()],
                    ENDINGS[(number + at * 2 + 5) % ENDINGS.len()],
                ],
            };
            for ending in endings {
                read(context, &mut tally, input, command, ending);
            }
        }
    }
    named_within(context, &mut tally);
    large(context, &mut tally);
    tally
}

/// Commands that print results report a failed write.
fn full(context: &Context, tally: &mut Tally) {
    let commands = [
        "new",
        "schema",
        "list",
        "list targets",
        "list --json",
        "status c",
        "status c --json",
        "measure c",
        "measure c --json",
        "check p",
        "check p --json",
        "generate c --json",
        "export c -t stl -o q --json",
        "graph c --json",
        "graph import c/graph.json -o g.json --json",
        "preview c -o plan.svg --json",
    ];
    let desk = context.desk_with_cave();
    tally.enter("a package to check", desk.run(&["export", "c", "-t", "stl", "-o", "p"]).done());
    for command in commands {
        let full = OpenOptions::new().write(true).open("/dev/full").expect("there is a /dev/full");
        let outcome = desk.call(&command.split(' ').collect::<Vec<_>>()).to(full).within(LIMIT).run();
        let is_told = if outcome.is_done() { Err(outcome.told("printed to a full disk")) } else { outcome.decent() };
        tally.enter("/dev/full", is_told);
    }
}

/// A thing in the place of a file, made on a desk under a name.
type Input = (&'static str, fn(&Desk, &str));

const INPUTS: [Input; 5] = [
    ("a pipe without a writer", |desk, name| {
        let _ = desk.run_other("mkfifo", &[name]);
    }),
    ("/dev/zero", |desk, name| desk.link(name, "/dev/zero")),
    ("/dev/null", |desk, name| desk.link(name, "/dev/null")),
    ("a folder", |desk, name| std::fs::create_dir(desk.path(name)).expect("a folder can be made")),
    ("a link to itself", |desk, name| desk.link(name, desk.path(name))),
];

/// `@` is the input.
const READERS: [&str; 11] = [
    "generate @ -o c",
    "export @ -t obj -o out",
    "graph @ -o c",
    "mesh @ -o c",
    "preview @ -o plan.svg",
    "measure @",
    "status @",
    "check @",
    "graph import @ -o g.json",
    "graph export @ -o g.json",
    "export c -t obj -o @",
];

const ENDINGS: [&str; 14] =
    ["toml", "json", "graphml", "csv", "3d", "svx", "th", "dat", "mak", "zip", "tar.zst", "tgz", "mjz", "cave"];

fn read(context: &Context, tally: &mut Tally, input: &Input, command: &str, ending: &str) {
    let name = format!("input.{ending}");
    let is_output = command.ends_with('@');
    let desk = if is_output { context.desk_with_cave() } else { context.desk() };
    (input.1)(&desk, &name);
    let words: Vec<&str> = command.split(' ').map(|word| if word == "@" { &name } else { word }).collect();
    let outcome = limited(&desk, &words);
    // An empty file is an empty recipe, and an empty folder a place for a package.
    let may_work = input.0 == "/dev/null" || is_output && input.0 == "a folder";
    let held = if may_work { short(&outcome) } else { outcome.refused().and_then(|()| short(&outcome)) };
    tally.enter(&format!("{} as {name}", input.0), held);
}

fn limited(desk: &Desk, words: &[&str]) -> Outcome {
    desk.call(words).under(&["prlimit", MEMORY]).within(LIMIT).run()
}

fn short(outcome: &Outcome) -> Result<(), String> {
    outcome.decent()?;
    let bytes = outcome.stderr.len();
    if bytes > MOST_WORDS && outcome.end != End::Code(0) {
        Err(outcome.told(&format!("said {bytes} bytes")))
    } else {
        Ok(())
    }
}

/// Files that other files name.
fn named_within(context: &Context, tally: &mut Tally) {
    let fixed = "*fix 1 0 0 0\n*data normal from to tape compass clino\n1 2 10 0 0\n2 3 10 90 0\n";
    let files = [
        ("top.svx", format!("*include odd\n{fixed}")),
        ("top.th", "survey top\ninput odd\nendsurvey\n".to_owned()),
        ("top.mak", "@0.0,0.0,0.0,13,0.0;\n#odd;\n".to_owned()),
        ("file.toml", "[graph]\ngenerator = \"file\"\nfile = \"odd\"\n".to_owned()),
        ("heightmap.toml", "[graph]\ngenerator = \"heightmap\"\npath = \"odd\"\n".to_owned()),
    ];
    for (at, (name, text)) in files.iter().enumerate() {
        for input in &INPUTS {
            // The ending that fits, and one that does not.
            for ending in [FITTING[at], "", ".json"] {
                let desk = context.desk();
                desk.file(name, text.replace("odd", &format!("odd{ending}")));
                (input.1)(&desk, &format!("odd{ending}"));
                let outcome = limited(&desk, &["graph", name, "-o", "c"]);
                tally.enter(&format!("{} as odd{ending}, named by {name}", input.0), short(&outcome));
            }
        }
    }
    secrets(context, tally);
}

/// The endings of files that are named by the files of [`named_within`].
const FITTING: [&str; 5] = [".svx", ".th", ".dat", ".csv", ".png"];

/// A hostile survey reveals nothing of files outside its folder.
fn secrets(context: &Context, tally: &mut Tally) {
    let files = [
        ("in/top.svx", "*include ../secret.txt\n"),
        ("in/top.svx", "*include ABSOLUTE\n"),
        ("in/top.th", "survey top\ninput ../secret.txt\nendsurvey\n"),
        ("in/top.th", "survey top\ninput ABSOLUTE\nendsurvey\n"),
        ("in/top.mak", "@0.0,0.0,0.0,13,0.0;\n#../secret.txt;\n"),
        ("in/top.toml", "[graph]\ngenerator = \"file\"\nfile = \"../secret.json\"\n"),
        ("in/top.toml", "[graph]\ngenerator = \"file\"\nfile = \"../secret.csv\"\n"),
        ("in/top.svx", "*include link\n"),
    ];
    for (name, text) in files {
        let desk = context.desk();
        for secret in ["secret.txt", "secret.json", "secret.csv"] {
            desk.file(secret, "xyzzyplugh:quux\nxyzzyplugh quux\n");
        }
        desk.file(name, text.replace("ABSOLUTE", &desk.path("secret.txt").to_string_lossy()));
        desk.link("in/link.svx", "../secret.txt");
        desk.link("in/link", "../secret.txt");
        let outcome = limited(&desk, &["graph", name, "-o", "c"]);
        let leaks = ["xyzzy", "quux"].iter().any(|word| (outcome.stderr.clone() + &outcome.stdout).contains(word));
        let held = if leaks { Err(outcome.told("shows a file that is not its own")) } else { short(&outcome) };
        tally.enter(&format!("{name} with {text:?}"), held);
    }
}

/// Recipes and other texts of a size that no person writes.
fn large(context: &Context, tally: &mut Tally) {
    let size = 100 << 20;
    let texts: [(&str, &str, String); 8] = [
        ("100 MB of comments", "toml", "# comment\n".repeat(size / 10)),
        ("two million keys", "toml", (0..2_000_000).map(|key| format!("k{key} = 1\n")).collect()),
        ("a name of 100 MB", "toml", format!("name = \"{}\"\n", "x".repeat(size))),
        ("100,000 open brackets", "toml", format!("name = {}", "[".repeat(100_000))),
        ("100,000 dots in a key", "toml", format!("a{} = 1\n", ".a".repeat(100_000))),
        ("100,000 open brackets", "json", "[".repeat(100_000)),
        ("one line of 100 MB", "svx", "x".repeat(size)),
        ("one line of 100 MB", "csv", "x".repeat(size)),
    ];
    for (what, ending, text) in &texts {
        let desk = context.desk();
        let name = format!("large.{ending}");
        desk.file(&name, text);
        for words in [
            &["graph", &name, "-o", "c"][..],
            &["export", &name, "-t", "obj", "-o", "out"],
            &["preview", &name, "-o", "p.svg"],
        ] {
            let outcome = limited(&desk, words);
            tally.enter(&format!("{what} in {name}"), outcome.refused().and_then(|()| short(&outcome)));
        }
    }
    let desk = context.desk();
    let long = "x".repeat(100_000);
    let overrides =
        [format!("name={long}"), format!("{long}=1"), format!("graph.nodes={long}"), format!("graph.generator={long}")];
    for set in &overrides {
        let outcome = limited(&desk, &["graph", "-o", "c", "--set", set]);
        tally.enter("an override of 100,000 letters", outcome.refused().and_then(|()| short(&outcome)));
    }
    for name in [long.get(..300).unwrap_or_default(), "con", "nul", "a\u{7}b"] {
        let outcome = limited(&desk, &["graph", "-o", "c", "--set", &format!("name={name}")]);
        tally.enter("a name that no system takes for a folder", outcome.refused());
    }
}
