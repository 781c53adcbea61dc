//! A command that writes, and the invariant of stopping it at any time: outputs appear whole or not at all, and running the
//! same command again ends as if nothing had happened.

use std::time::Duration;

use crate::attack::Context;
use crate::cave::SMALL;
use crate::desk::Desk;
use crate::packages::Packages;
use crate::program::Outcome;
use crate::tree::Tree;

/// A command on a desk with the cave folder `c`.
#[derive(Clone)]
pub struct Scenario {
    /// Its arguments.
    pub words: Vec<String>,
    /// A command that runs before it, undisturbed.
    first: Option<Vec<String>>,
    /// Outputs that appear whole or not at all.
    outputs: Vec<String>,
}

/// The result of an undisturbed run.
pub struct Reference {
    before: Tree,
    after: Tree,
    /// How long that takes.
    pub took: Duration,
}

impl Scenario {
    /// A command that computes, with one thread so that its system calls come in the same order every time.
    fn new(line: &str, outputs: &[&str]) -> Self {
        Self::convert(&format!("{line} --threads 1"), outputs)
    }

    /// A command that starts no threads; progress output would add writes.
    fn convert(line: &str, outputs: &[&str]) -> Self {
        let outputs = outputs.iter().map(|output| (*output).to_owned()).collect();
        Self { words: words(&format!("{line} --quiet")), first: None, outputs }
    }

    fn after(self, line: &str) -> Self {
        Self { first: Some(words(line)), ..self }
    }

    /// With the settings of the small cave.
    fn small(mut self) -> Self {
        self.words.extend(SMALL.map(str::to_owned));
        self
    }

    /// A desk on which the command can start.
    pub fn desk(&self, context: &Context) -> Result<Desk, String> {
        let desk = context.desk_with_cave();
        if let Some(first) = &self.first {
            desk.run(&strs(first)).done()?;
        }
        Ok(desk)
    }

    /// Runs it undisturbed.
    pub fn reference(&self, context: &Context) -> Result<Reference, String> {
        let desk = self.desk(context)?;
        let before = desk.tree();
        let outcome = desk.run(&strs(&self.words));
        outcome.done()?;
        Ok(Reference { before, after: desk.tree(), took: outcome.took })
    }

    /// Fails unless each output is as it was before or as it is in the end.
    fn is_whole(&self, desk: &Desk, reference: &Reference) -> Result<(), String> {
        let now = desk.tree();
        let torn = |output: &&String| {
            let [before, after, now] = [&reference.before, &reference.after, &now].map(|tree| tree.at(output));
            now != before && now != after
        };
        match self.outputs.iter().find(torn) {
            Some(output) if now.at(output).is_empty() => Err(format!("{output} is gone, the old and the new")),
            Some(output) => Err(format!("{output} is neither as before nor finished")),
            None => Ok(()),
        }
    }

    /// Fails unless outputs are whole and a second run ends with exactly the files of an undisturbed one. A run that has
    /// already finished is not repeated, since its output is in the way.
    pub fn withstands(&self, desk: &Desk, outcome: &Outcome, reference: &Reference) -> Result<(), String> {
        self.is_whole(desk, reference)?;
        let again = if outcome.is_done() { Ok(()) } else { desk.run(&strs(&self.words)).done() };
        again.map_err(|fault| format!("the next run: {fault}"))?;
        reference.after.expect(&desk.tree()).map_err(|change| format!("in the end {change}"))
    }

    /// The command line.
    pub fn line(&self) -> String {
        let first = self.first.as_ref().map(|first| format!("plume {} && ", first.join(" "))).unwrap_or_default();
        format!("{first}plume {}", self.words.join(" "))
    }
}

/// Commands that write each kind of thing.
pub fn all(packages: &Packages) -> Vec<Scenario> {
    let new = Scenario::new;
    let force = |line: &str, output: &str| new(&format!("{line} --force"), &[output]);
    let bundles = packages.bundles.iter().map(|(bundle, target)| {
        new(&format!("export c -t {target} --bundle {bundle} -o out"), &[&format!("out.{bundle}")])
    });
    let others = [
        new("export c -t gazebo -o out", &["out"]),
        force("export c -t obj -o out", "out").after("export c -t stl -o out"),
        new("export c -t obj,stl -o out", &["out/obj", "out/stl"]),
        force("export c -t obj --bundle zip -o out", "out.zip").after("export c -t stl --bundle zip -o out"),
        new("generate -o new", &[]).small(),
        new("export -t stl -o out", &["out"]).small(),
        new("generate c --seed 9 --force", &[]),
        new("pieces c", &[]),
        new("preview c -o plan.png", &["plan.png"]),
        Scenario::convert("graph export c -o g.json", &["g.json"]),
    ];
    bundles.chain(others).collect()
}

/// A package of every target, and other commands long enough to be interrupted midway.
pub fn long(packages: &Packages) -> Vec<Scenario> {
    let target = |name: &String| Scenario::new(&format!("export c -t {name} -o out"), &["out"]);
    let several = Scenario::new("export c -t gazebo,obj,glb -o out", &["out/gazebo", "out/obj", "out/glb"]);
    packages.targets.iter().map(target).chain([several]).chain(all(packages)).collect()
}

/// A line as arguments.
fn words(line: &str) -> Vec<String> {
    line.split(' ').map(str::to_owned).collect()
}

/// Arguments in the form that [`Desk::run`] takes.
pub fn strs(words: &[String]) -> Vec<&str> {
    words.iter().map(String::as_str).collect()
}
