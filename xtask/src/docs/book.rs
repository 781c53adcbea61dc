//! The sources of the book: the pages of `docs`, moved so that all they show is below one folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::markdown::{is_foreign, links, prose};
use crate::strips;
use crate::tools::{Result, root};

/// Where links lead that leave the book: files of the repository that are neither pages nor pictures.
const REPOSITORY: &str = "https://github.com/plume-caves/plume/blob/main";
/// The line of `recipe.md` that the recipe reference takes the place of.
const REFERENCE: &str = "<!-- reference -->";
/// The line of `SUMMARY.md` below which every decision is listed.
const DECISIONS: &str = "(decisions/README.md)";

/// Writes the pages and the pictures they show to a new folder.
pub fn stage(pages: &[PathBuf], folder: &Path, reference: &str) -> Result<()> {
    let _ = fs::remove_dir_all(folder);
    let docs = root().join("docs");
    let mut pictures = BTreeSet::new();
    for path in pages {
        let page = Page::read(&docs, path)?;
        pictures.extend(page.links().filter_map(|link| page.picture(link)));
        write(&folder.join(in_book(&page.name)), &page.text_in_book(&docs, pages, reference)?)?;
    }
    for picture in pictures.into_iter().chain(strips::all()) {
        copy(&root().join(&picture), &folder.join(picture.strip_prefix("docs").unwrap_or(&picture)))?;
    }
    copy(&docs.join("book.toml"), &folder.join("book.toml"))
}

struct Page {
    /// Its path below `docs`.
    name: PathBuf,
    text: String,
}

impl Page {
    fn read(docs: &Path, path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self { name: path.strip_prefix(docs).unwrap_or(path).to_owned(), text })
    }

    fn links(&self) -> impl Iterator<Item = &str> {
        prose(&self.text).flat_map(|(_, line)| links(line)).filter(|link| !is_foreign(link) && !link.starts_with('#'))
    }

    /// The file that a link leads to, relative to the repository.
    fn target(&self, link: &str) -> PathBuf {
        let file = link.split('#').next().unwrap_or_default();
        normal(&Path::new("docs").join(&self.name).with_file_name(file))
    }

    /// The same if it is a picture.
    fn picture(&self, link: &str) -> Option<PathBuf> {
        let target = self.target(link);
        let is_picture = target.extension().is_some_and(|end| ["png", "jpg", "svg"].iter().any(|known| end == *known));
        is_picture.then_some(target)
    }

    fn text_in_book(&self, docs: &Path, pages: &[PathBuf], reference: &str) -> Result<String> {
        let unique: BTreeSet<&str> = self.links().collect();
        let moved = unique.into_iter().fold(self.text.clone(), |text, link| {
            text.replace(&format!("]({link})"), &format!("]({})", self.link_in_book(link)))
        });
        let moved = moved.replace(REFERENCE, reference);
        match self.name == Path::new("SUMMARY.md") {
            true => with_decisions(docs, pages, &moved),
            false => Ok(moved),
        }
    }

    /// Pages and their pictures stay where they are, other pictures come nearer by the folder `docs`, and all else is in the
    /// repository only.
    fn link_in_book(&self, link: &str) -> String {
        let target = self.target(link);
        if let Some(picture) = self.picture(link) {
            let nearer = link.strip_prefix("../").filter(|_| !picture.starts_with("docs"));
            return nearer.unwrap_or(link).to_owned();
        }
        if target.starts_with("docs") && target.extension().is_some_and(|end| end == "md") {
            return link.replace("README.md", "index.md");
        }
        let anchor = link.split_once('#').map(|(_, anchor)| format!("#{anchor}")).unwrap_or_default();
        format!("{REPOSITORY}/{}{anchor}", target.display())
    }
}

/// mdBook has no page for the address of a folder unless it is called `index`.
fn in_book(name: &Path) -> PathBuf {
    match name.ends_with("README.md") {
        true => name.with_file_name("index.md"),
        false => name.to_owned(),
    }
}

/// The summary with a line for every decision, which mdBook needs to show it.
fn with_decisions(docs: &Path, pages: &[PathBuf], summary: &str) -> Result<String> {
    let folder = docs.join("decisions");
    let decisions = pages.iter().filter(|page| page.starts_with(&folder) && !page.ends_with("README.md"));
    let lines = decisions.map(|path| {
        let page = Page::read(docs, path)?;
        let title = page.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' ']);
        Ok(format!("  - [{title}]({})\n", page.name.display()))
    });
    let lines = lines.collect::<Result<String>>()?;
    let marker = DECISIONS.replace("README.md", "index.md");
    let Some((before, after)) = summary.split_once(&format!("{marker}\n")) else {
        return Err(format!("docs/SUMMARY.md has no line that ends with `{DECISIONS}`"));
    };
    Ok(format!("{before}{marker}\n{lines}{after}"))
}

/// The path without `..`.
fn normal(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut normal, part| {
        match part {
            Component::ParentDir => drop(normal.pop()),
            part => normal.push(part),
        }
        normal
    })
}

fn write(path: &Path, text: &str) -> Result<()> {
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    folder.and_then(|()| fs::write(path, text)).map_err(|error| format!("{}: {error}", path.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let folder = to.parent().map_or(Ok(()), fs::create_dir_all);
    folder.and_then(|()| fs::copy(from, to).map(drop)).map_err(|error| format!("{}: {error}", from.display()))
}
