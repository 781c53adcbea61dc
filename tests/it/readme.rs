//! The README: its lists match the tables, and links lead somewhere.

use std::fs;
use std::path::Path;

use plume::generators::{GENERATORS, GeneratorRow};
use plume::material::MATERIALS;
use plume::things::{KINDS, KindRow};
use plume_exporters::{TARGETS, TargetRow};

/// Rewrites the lists instead of comparing them.
const RENEW: &str = "UPDATE_README=1 cargo test --test it readme";

#[test]
fn its_lists_are_those_of_the_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let text = fs::read_to_string(&path).expect("the README can be read");
    let lists = [
        ("targets", targets()),
        ("pieces", pieces()),
        ("rocks", rocks()),
        ("things", things()),
        ("generators", generators(&text)),
    ];
    let renewed = lists.iter().fold(text.clone(), |text, (name, list)| with_list(&text, name, list));
    if std::env::var_os("UPDATE_README").is_some() {
        return fs::write(&path, renewed).expect("the README can be written");
    }
    let stale = text.lines().zip(renewed.lines()).find(|(old, new)| old != new);
    assert!(text == renewed, "the README is out of date, renew it by `{RENEW}`: {stale:#?}");
}

#[test]
fn links_lead_to_files() {
    const PAGES: [&str; 5] =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "samples/README.md", "docs/decisions/README.md"];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for page in PAGES.map(|page| root.join(page)) {
        let text = fs::read_to_string(&page).expect("the page can be read");
        let folder = page.parent().expect("a page is in a folder");
        let links = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
        let files = links.filter(|link| !link.is_empty() && !link.contains("://"));
        let lost: Vec<&str> = files.filter(|file| !folder.join(file).exists()).collect();
        assert!(lost.is_empty(), "{} links to {lost:?}, which is not there", page.display());
    }
}

/// The text with the list between `<!-- NAME -->` and `<!-- end -->` replaced.
fn with_list(text: &str, name: &str, list: &str) -> String {
    let marker = format!("<!-- {name} -->");
    let (before, rest) = text.split_once(&marker).unwrap_or_else(|| panic!("the README has no {marker}"));
    let (_, after) = rest.split_once("<!-- end -->").unwrap_or_else(|| panic!("{marker} has no <!-- end -->"));
    format!("{before}{marker}{list}<!-- end -->{after}")
}

fn table(head: [&str; 3], rows: impl Iterator<Item = [String; 3]>) -> String {
    let lines = rows.map(|cells| format!("| {} |\n", cells.join(" | "))).collect::<String>();
    format!("\n\n| {} |\n|---|---|---|\n{lines}\n", head.join(" | "))
}

fn targets() -> String {
    let row = |row: &TargetRow| [format!("`{}`", row.usage()), row.contents.to_owned(), row.tested_by.to_owned()];
    table(["target", "what is written", "opened in the tests by"], TARGETS.iter().map(row))
}

fn pieces() -> String {
    let names = TARGETS.iter().filter(|row| row.has_pieces).map(|row| format!("`{}`", row.name));
    names.collect::<Vec<_>>().join(", ")
}

fn rocks() -> String {
    let rows = MATERIALS.iter().map(|row| format!("| `{}` | {} |\n", row.name, row.summary));
    format!("\n\n| rock | shape and colour |\n|---|---|\n{}\n", rows.collect::<String>())
}

fn things() -> String {
    let rock = |row: &KindRow| match row.rocks {
        [] => "all".to_owned(),
        rocks => rocks.iter().map(|rock| format!("`{rock}`")).collect::<Vec<_>>().join(", "),
    };
    let row = |row: &KindRow| [format!("`{}`", row.name), row.summary.to_owned(), rock(row)];
    table(["thing", "what it is", "in the rocks"], KINDS.iter().map(row))
}

fn generators(readme: &str) -> String {
    let row = |row: &GeneratorRow| [format!("`{}`", row.name), row.source.to_owned(), sample(row, readme)];
    table(["generator", "based on", "sample and plan"], GENERATORS.iter().map(row))
}

/// A link to the sample, as its picture unless the README shows that already.
fn sample(row: &GeneratorRow, readme: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    assert!(!row.sample.is_empty(), "the row of `{}` in generators/lib.rs lacks `.based_on(SOURCE, SAMPLE)`", row.name);
    let recipe = format!("{}.toml", row.sample);
    let picture = ["png", "jpg"].map(|extension| format!("{}.{extension}", row.sample));
    let picture = picture.into_iter().find(|file| root.join(file).is_file());
    assert!(
        root.join(&recipe).is_file() && picture.is_some(),
        "`{recipe}` or its picture is not there, which the row of `{}` in generators/lib.rs names; `cargo xtask gallery` draws pictures",
        row.name
    );
    let picture = picture.unwrap_or_default();
    let name = Path::new(row.sample).file_name().and_then(|name| name.to_str()).unwrap_or(row.name);
    match readme.contains(&format!("| ![]({picture}) |")) {
        true => format!("[`{name}`]({recipe})"),
        false => format!("[![]({picture})]({recipe})"),
    }
}
