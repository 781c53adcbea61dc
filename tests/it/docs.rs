//! The README and the documentation: generated lists match the tables that they come from.

use std::fs;
use std::path::{Path, PathBuf};

use plume::generators::{GENERATORS, GeneratorRow};
use plume::material::MATERIALS;
use plume::recipe::{SCHEMA_ADDRESS, Setting, editor_schema, settings_of};
use plume::things::{KINDS, KindRow};
use plume_exporters::{TARGETS, TargetRow};

/// Rewrites the lists instead of comparing them.
const RENEW: &str = "UPDATE_DOCS=1 cargo test --test it docs";
/// Whoever reads the README has a minute; the rest is in `docs`.
const README_WORDS: usize = 1000;

#[test]
fn lists_are_those_of_the_tables() {
    has_lists("docs/formats.md", |_| vec![("targets", targets()), ("pieces", pieces()), ("options", options())]);
    has_lists("docs/gallery.md", |page| vec![("rocks", rocks()), ("generators", generators(page))]);
    has_lists("docs/things.md", |_| vec![("things", things())]);
}

/// Recipes name it by its address, at the tag of their version.
#[test]
fn the_schema_is_that_of_recipes() {
    assert!(SCHEMA_ADDRESS.ends_with(&format!("/v{}/docs/recipe.schema.json", env!("CARGO_PKG_VERSION"))));
    let (path, schema) = (of_project("docs/recipe.schema.json"), format!("{:#}\n", editor_schema()));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        return fs::write(&path, schema).expect("the schema can be written");
    }
    assert!(read(&path) == schema, "docs/recipe.schema.json is out of date, renew it by `{RENEW}`");
}

#[test]
fn the_readme_is_short() {
    let words = read(&of_project("README.md")).split_whitespace().count();
    assert!(words <= README_WORDS, "the README has {words} words, of at most {README_WORDS}: move some to docs");
}

#[test]
fn the_citation_names_this_version() {
    let (citation, version) = (read(&of_project("CITATION.cff")), env!("CARGO_PKG_VERSION"));
    assert!(
        citation.lines().any(|line| line == format!("version: {version}")),
        "CITATION.cff has another version than {version}"
    );
    let page = read(&of_project("docs/citation.md"));
    assert!(page.contains(&format!("{{{version}}}")), "docs/citation.md has another version than {version}");
}

/// Holds the lists of a page to what they should be, or rewrites them if the environment says so.
fn has_lists(page: &str, lists: impl Fn(&str) -> Vec<(&'static str, String)>) {
    let path = of_project(page);
    let text = read(&path);
    let renewed = lists(&text).iter().fold(text.clone(), |text, (name, list)| with_list(page, &text, name, list));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        return fs::write(&path, renewed).expect("the page can be written");
    }
    let stale = text.lines().zip(renewed.lines()).find(|(old, new)| old != new);
    assert!(text == renewed, "{page} is out of date, renew it by `{RENEW}`: {stale:#?}");
}

fn of_project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text with the list between `<!-- NAME -->` and `<!-- end -->` replaced.
fn with_list(page: &str, text: &str, name: &str, list: &str) -> String {
    let marker = format!("<!-- {name} -->");
    let (before, rest) = text.split_once(&marker).unwrap_or_else(|| panic!("{page} has no {marker}"));
    let (_, after) =
        rest.split_once("<!-- end -->").unwrap_or_else(|| panic!("{marker} of {page} has no <!-- end -->"));
    format!("{before}{marker}{list}<!-- end -->{after}")
}

fn table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let lines = rows.map(|cells| format!("| {} |\n", cells.join(" | "))).collect::<String>();
    format!("\n\n| {} |\n|{}\n{lines}\n", head.join(" | "), "---|".repeat(N))
}

fn targets() -> String {
    let row = |row: &TargetRow| [format!("`{}`", row.usage()), row.contents.to_owned(), row.tested_by.to_owned()];
    table(["target", "what is written", "opened in the tests by"], TARGETS.iter().map(row))
}

fn pieces() -> String {
    let names = TARGETS.iter().filter(|row| row.has_pieces).map(|row| format!("`{}`", row.name));
    names.collect::<Vec<_>>().join(", ")
}

fn options() -> String {
    table(["option", "what it does", "range", "default"], TARGETS.iter().flat_map(options_of))
}

fn options_of(row: &TargetRow) -> Vec<[String; 4]> {
    let settings = settings_of(&(row.settings)().to_value());
    let cells = |setting: Setting| {
        let default = format!("`{}`", setting.default_text());
        [format!("`{}.{}`", row.name, setting.key), setting.meaning, setting.range, default]
    };
    settings.into_iter().map(cells).map(|cells| cells.map(|cell| cell.replace('|', "\\|"))).collect()
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

fn generators(page: &str) -> String {
    let row = |row: &GeneratorRow| [format!("`{}`", row.name), row.source.to_owned(), sample(row, page)];
    table(["generator", "based on", "sample and plan"], GENERATORS.iter().map(row))
}

/// A link to the sample, as its picture unless the page, which is in `docs`, shows that already.
fn sample(row: &GeneratorRow, page: &str) -> String {
    assert!(!row.sample.is_empty(), "the row of `{}` in generators/lib.rs lacks `.based_on(SOURCE, SAMPLE)`", row.name);
    let recipe = format!("{}.toml", row.sample);
    let picture = ["png", "jpg"].map(|extension| format!("{}.{extension}", row.sample));
    let picture = picture.into_iter().find(|file| of_project(file).is_file());
    assert!(
        of_project(&recipe).is_file() && picture.is_some(),
        "`{recipe}` or its picture is not there, which the row of `{}` in generators/lib.rs names; `cargo xtask gallery` draws pictures",
        row.name
    );
    let picture = picture.unwrap_or_default();
    let name = Path::new(row.sample).file_name().and_then(|name| name.to_str()).unwrap_or(row.name);
    match page.contains(&format!("](../{picture}) |")) {
        true => format!("[`{name}`](../{recipe})"),
        false => format!("[![](../{picture})](../{recipe})"),
    }
}
