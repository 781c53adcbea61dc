//! `cargo xtask docs`: checks the links of all pages and builds the documentation as a book, in `target/docs/book`.
//!
//! The pages in `docs` are written to be read on GitHub too. They are copied before the book is built, since they show pictures
//! from other folders, and since the recipe reference is made from the schema of the `plume` of this tree.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::plume::{Plume, Profile};
use crate::tools::{self, Result, ensure_cargo, root, show};

mod book;
mod links;
mod markdown;
mod reference;

/// Pages outside `docs` whose links are checked as well.
const OTHERS: [&str; 7] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "SECURITY.md",
    "samples/README.md",
    "tests/interop/README.md",
];

/// The version of mdBook, which makes the book.
const MDBOOK: &str = "0.5.4";

/// Checks the links; builds the book unless told to `check` only.
pub fn run(arguments: &[String]) -> Result<()> {
    check()?;
    match arguments {
        [] => build(),
        [word] if word == "check" => Ok(()),
        _ => Err("unknown arguments; run `cargo xtask docs` or `cargo xtask docs check`".to_owned()),
    }
}

/// Checks that every relative link of every page leads to a file and, if it names one, to a heading.
pub fn check() -> Result<()> {
    let pages: Vec<PathBuf> = OTHERS.iter().map(|page| root().join(page)).chain(pages()?).collect();
    let faults = pages.iter().map(|page| links::faults(page)).collect::<Result<Vec<_>>>()?.concat();
    if !faults.is_empty() {
        return Err(format!("links that lead nowhere:\n  {}", faults.join("\n  ")));
    }
    println!("the links of {} pages lead somewhere", pages.len());
    Ok(())
}

fn build() -> Result<()> {
    let reference = reference::tables(&schema()?)?;
    let mdbook = ensure_cargo("mdbook", MDBOOK)?;
    let (source, output) = (root().join("target/docs/src"), root().join("target/docs/book"));
    book::stage(&pages()?, &source, &reference)?;
    show(Command::new(mdbook).arg("build").arg(&source).arg("--dest-dir").arg(&output))?;
    println!("{}", output.join("index.html").display());
    Ok(())
}

/// The JSON Schema of recipes, by the program that `PLUME_BINARY` names or else by the one of this tree.
fn schema() -> Result<String> {
    match std::env::var_os("PLUME_BINARY") {
        Some(program) => tools::run(Command::new(program).arg("schema")),
        None => Plume::build(Profile::Dev)?.output(&["schema"]),
    }
}

/// The pages in `docs` and its folders, in order.
fn pages() -> Result<Vec<PathBuf>> {
    let mut pages = Vec::new();
    collect(&root().join("docs"), &mut pages).map_err(|error| format!("docs: {error}"))?;
    pages.sort();
    Ok(pages)
}

fn collect(folder: &Path, pages: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, pages)?;
        } else if path.extension().is_some_and(|end| end == "md") {
            pages.push(path);
        }
    }
    Ok(())
}
