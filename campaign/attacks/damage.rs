//! Files damaged on disk: truncated, emptied, partly zeroed, or with one bit flipped.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::attack::{Attack, Context};
use crate::desk::Desk;
use crate::program::Outcome;
use crate::python;
use crate::rng::Rng;
use crate::tally::Tally;
use crate::tree::Tree;

pub const ATTACK: Attack = Attack {
    name: "damage",
    tries: "every file of a cave folder and of packages cut, emptied, zeroed in part, one bit turned; never used in silence",
    share: 14,
    run,
};

fn run(context: &mut Context) -> Tally {
    let mut tally = Tally::default();
    damage_cave(context, &mut tally, &["gazebo", "glb"], "", &USES);
    // Measuring pieces takes long, and what reads them is a target.
    damage_cave(context, &mut tally, &["mujoco"], "pieces", &USES[..1]);
    edit_facts(context, &mut tally);
    damage_packages(context, &mut tally);
    if context.python.is_none() {
        tally.skip(python::MISSING);
    }
    tally
}

/// Results of the commands on an undamaged folder.
struct Undamaged {
    desk: Desk,
    cave: Tree,
    packages: BTreeMap<&'static str, Tree>,
    measured: String,
    status: String,
    arrays: String,
}

impl Undamaged {
    /// A folder from which these targets have been exported.
    fn of(context: &Context, targets: &[&'static str]) -> Result<Self, String> {
        let desk = context.desk_with_cave();
        let mut packages = BTreeMap::new();
        for &target in targets {
            desk.run(&["export", "c", "-t", target, "-o", target]).done()?;
            packages.insert(target, desk.tree_of(target));
        }
        let said = |words: &[&str]| {
            let outcome = desk.run(words);
            outcome.done().map(|()| outcome.stdout)
        };
        let is_measured = !targets.contains(&"mujoco");
        let measured = if is_measured { said(&["measure", "c"])? } else { String::new() };
        let status = said(&["status", "c"])?;
        let arrays = context.python.map(|python| python.open(&desk.path(""), "c").stdout).unwrap_or_default();
        let cave = desk.tree_of("c");
        Ok(Self { desk, cave, packages, measured, status, arrays })
    }

    /// A desk with a copy of the cave folder.
    fn copied(&self, context: &Context) -> Desk {
        let desk = context.desk();
        desk.copy(&self.desk.path("c"), "c");
        desk
    }
}

/// Damages every file below `part` of the folder in every way and runs each of these commands on it.
fn damage_cave(context: &mut Context, tally: &mut Tally, targets: &[&'static str], part: &str, uses: &[Use]) {
    let undamaged = match Undamaged::of(context, targets) {
        Ok(undamaged) => undamaged,
        Err(fault) => return tally.enter("the undamaged cave", Err(fault)),
    };
    let files = undamaged.cave.at(part).files();
    let all: Vec<_> = files.iter().flat_map(|file| KINDS.map(|kind| (file, kind))).collect();
    for round in context.length.rounds(all.len(), 4 * all.len()) {
        let (file, kind) = all[round % all.len()];
        let bytes = fs::read(undamaged.desk.path("c").join(file)).expect("a file can be read");
        let damaged = (kind.1)(&bytes, &mut context.rng);
        if damaged == bytes {
            continue;
        }
        let target = targets[(round + round / all.len()) % targets.len()];
        for (name, read) in uses {
            let desk = undamaged.copied(context);
            fs::write(desk.path("c").join(file), &damaged).expect("a file can be written");
            let (name, place) = (name.replace('@', target), place(&bytes, &damaged));
            let what = format!("{name} of a cave folder whose {} is {} ({place})", file.display(), kind.0);
            let case = Case { context, undamaged: &undamaged, desk, file, before: &bytes, target };
            tally.enter(&what, read(&case));
        }
    }
}

type Kind = (&'static str, fn(&[u8], &mut Rng) -> Vec<u8>);

const KINDS: [Kind; 4] = [
    ("cut", |bytes, rng| bytes[..rng.below(bytes.len())].to_vec()),
    ("emptied", |_, _| Vec::new()),
    ("zeroed in part", |bytes, rng| {
        let mut bytes = bytes.to_vec();
        let from = rng.below(bytes.len());
        let end = (from + 1 + rng.below(4096)).min(bytes.len());
        bytes[from..end].fill(0);
        bytes
    }),
    ("changed in one bit", |bytes, rng| {
        let mut bytes = bytes.to_vec();
        let at = rng.below(bytes.len());
        bytes[at] ^= 1 << rng.below(8);
        bytes
    }),
];

/// A damaged folder on its desk.
struct Case<'a> {
    context: &'a Context<'a>,
    undamaged: &'a Undamaged,
    desk: Desk,
    file: &'a Path,
    /// The file before it was damaged.
    before: &'a [u8],
    target: &'static str,
}

type Use = (&'static str, fn(&Case) -> Result<(), String>);

const USES: [Use; 5] = [
    ("export -t @", |case| {
        let now = fs::read(case.desk.path("c").join(case.file)).unwrap_or_default();
        let outcome = case.desk.run(&["export", "c", "-t", case.target, "-o", "out"]);
        let same = case.undamaged.packages[case.target].expect(&case.desk.tree_of("out"));
        case.judge(&outcome, &now, same)?;
        if outcome.is_done() { case.desk.check("out") } else { Ok(()) }
    }),
    ("generate", |case| {
        let now = fs::read(case.desk.path("c").join(case.file)).unwrap_or_default();
        let outcome = case.desk.run(&["generate", "c"]);
        case.judge(&outcome, &now, case.undamaged.cave.expect(&case.desk.tree_of("c")))
    }),
    ("measure", |case| {
        let outcome = case.desk.run(&["measure", "c"]);
        let same = if outcome.stdout == case.undamaged.measured { Ok(()) } else { Err("other numbers".to_owned()) };
        case.judge(&outcome, &[], same)
    }),
    ("status", |case| {
        let outcome = case.desk.run(&["status", "c"]);
        outcome.decent()?;
        let is_silent = outcome.is_done() && outcome.stdout == case.undamaged.status;
        if is_silent && !case.is_editable() { Err(outcome.told("did not notice")) } else { Ok(()) }
    }),
    ("plume.open", |case| {
        let Some(python) = case.context.python else { return Ok(()) };
        let outcome = python.open(&case.desk.path(""), "c");
        let is_same = !outcome.is_done() || outcome.stdout == case.undamaged.arrays || case.is_editable();
        outcome.decent()?;
        if is_same { Ok(()) } else { Err("other arrays without a word".to_owned()) }
    }),
];

impl Case<'_> {
    /// Whether people may edit the file by hand.
    fn is_editable(&self) -> bool {
        [Path::new("cave.toml"), Path::new("graph.json")].contains(&self.file)
    }

    /// A run either refuses and names the file, or gives the same result as for the undamaged folder. Editable files may
    /// also have become another recipe or graph, which the run must report.
    fn judge(&self, outcome: &Outcome, now: &[u8], same: Result<(), String>) -> Result<(), String> {
        outcome.decent()?;
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let is_named =
            outcome.stderr.contains(&*name) || self.is_editable() && self.names_a_change(&outcome.stderr, now);
        match (outcome.is_done(), same) {
            (true, Err(_)) if self.is_editable() && is_named => Ok(()),
            (true, Err(change)) => Err(outcome.told(&format!("used it in silence ({change})"))),
            (true, Ok(())) => Ok(()),
            (false, _) if is_named => Ok(()),
            (false, _) => Err(outcome.told("does not name the file")),
        }
    }

    /// Whether a text names a key of the recipe that has another value now, or none.
    fn names_a_change(&self, text: &str, now: &[u8]) -> bool {
        let now = settings(now);
        let is_changed = |(key, line): &(String, String)| now.get(key) != Some(line);
        settings(self.before).into_iter().filter(is_changed).any(|(key, _)| text.contains(&key))
    }
}

/// The lines of a recipe by their keys, `section.key`; keys outside of sections are words that any text may have.
fn settings(recipe: &[u8]) -> BTreeMap<String, String> {
    let (mut settings, mut section) = (BTreeMap::new(), String::new());
    for line in String::from_utf8_lossy(recipe).lines() {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            section = name.to_owned();
        } else if let Some((key, _)) = line.split_once(" =").filter(|_| !section.is_empty()) {
            settings.insert(format!("{section}.{key}"), line.to_owned());
        }
    }
    settings
}

/// Numbers of the records that go into packages, edited.
fn edit_facts(context: &Context, tally: &mut Tally) {
    for (key, value) in [("error_m", "1e30"), ("triangles", "3"), ("texels_per_m", "1e9"), ("nodes", "77")] {
        let desk = context.desk_with_cave();
        tally.enter("a package before", desk.run(&["export", "c", "-t", "gltf", "-o", "before"]).done());
        let text = fs::read_to_string(desk.path("c/manifest.json")).expect("a cave folder has a manifest");
        let Some((start, rest)) = text.split_once(&format!("\"{key}\": ")) else { continue };
        let end = rest.find([',', '\n', '}']).unwrap_or(rest.len());
        desk.file("c/manifest.json", format!("{start}\"{key}\": {value}{}", &rest[end..]));
        let outcome = desk.run(&["export", "c", "-t", "gltf", "-o", "after"]);
        let same = desk.tree_of("before") == desk.tree_of("after");
        let held = match outcome.is_done() {
            true if same => Ok(()),
            true => Err(outcome.told("passed the edited number on")),
            false => outcome.refused(),
        };
        tally.enter(&format!("{key} of manifest.json set to {value}"), held);
    }
}

/// Every file of a package of every target, and every kind of archive.
fn damage_packages(context: &mut Context, tally: &mut Tally) {
    let desk = context.desk_with_cave();
    let mut packages: Vec<String> = Vec::new();
    for target in &context.packages.targets {
        tally.enter("a package to be damaged", desk.run(&["export", "c", "-t", target, "-o", target]).done());
        packages.extend(desk.tree_of(target).files().iter().map(|file| format!("{target}/{}", file.display())));
    }
    let packages = context.length.some_of(&packages, 66);
    let archive = |(bundle, target): &(String, String)| {
        let made = desk.run(&["export", "c", "-t", target, "--bundle", bundle, "-o", "out"]).done();
        tally.enter("an archive to be damaged", made);
        format!("out.{bundle}")
    };
    let archives: Vec<String> = context.packages.bundles.iter().map(archive).collect();
    let all: Vec<String> = packages.into_iter().chain(archives.iter().cycle().take(40).cloned()).collect();
    for round in context.length.rounds(all.len(), 4 * all.len()) {
        let file = &all[round % all.len()];
        let kind = KINDS[(round + round / all.len()) % KINDS.len()];
        let bytes = fs::read(desk.path(file)).expect("a file can be read");
        let damaged = (kind.1)(&bytes, &mut context.rng);
        if damaged == bytes {
            continue;
        }
        desk.file(file, &damaged);
        let package = file.split('/').next().expect("a path has a part");
        let outcome = desk.run(&["check", package]);
        let is_harmless = outcome.is_done() && archives.contains(file) && unpacks_alike(&desk, file, &bytes);
        let held = if is_harmless { Ok(()) } else { outcome.refused() };
        tally.enter(&format!("check of {package} whose {file} is {} ({})", kind.0, place(&bytes, &damaged)), held);
        desk.file(file, &bytes);
    }
}

/// Whether Python unpacks the same files from an archive as from what it was: times and modes in the heads of zip and gzip
/// are no part of what `plume check` promises. Zstandard has no such bits, and Python no reader of it.
fn unpacks_alike(desk: &Desk, archive: &str, before: &[u8]) -> bool {
    let module = match archive.rsplit('.').next() {
        Some("zip" | "mjz") => "zipfile",
        Some("tgz") => "tarfile",
        _ => return false,
    };
    desk.file("before", before);
    let unpacked = [(archive, "now"), ("before", "then")].map(|(archive, folder)| {
        let _ = fs::remove_dir_all(desk.path(folder));
        let is_done = desk.run_other("python3", &["-m", module, "-e", archive, folder]).is_done();
        is_done.then(|| desk.tree_of(folder))
    });
    unpacked[0].is_some() && unpacked[0] == unpacked[1]
}

/// Where two files differ first.
fn place(one: &[u8], other: &[u8]) -> String {
    let at = one.iter().zip(other).position(|(one, other)| one != other).unwrap_or(one.len().min(other.len()));
    format!("from byte {at} of {}", one.len())
}
