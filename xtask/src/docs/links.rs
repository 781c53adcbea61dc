//! Links that lead nowhere.

use std::fs;
use std::path::Path;

use super::markdown::{anchors, is_foreign, links, prose};
use crate::tools::{Result, root};

/// Each link of a page that leads nowhere, with page and line.
pub fn faults(page: &Path) -> Result<Vec<String>> {
    let name = page.strip_prefix(root()).unwrap_or(page).display().to_string();
    let text = fs::read_to_string(page).map_err(|error| format!("{name}: {error}"))?;
    let links = prose(&text).flat_map(|(line, text)| links(text).into_iter().map(move |link| (line, link)));
    let lost = links.filter(|(_, link)| !leads_somewhere(page, link));
    Ok(lost.map(|(line, link)| format!("{name}:{line}: {link}")).collect())
}

fn leads_somewhere(page: &Path, link: &str) -> bool {
    if is_foreign(link) {
        return true;
    }
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
    let target = match file {
        "" => page.to_owned(),
        file => page.parent().unwrap_or(Path::new("")).join(file),
    };
    match anchor {
        None => target.exists(),
        Some(anchor) => fs::read_to_string(target).is_ok_and(|text| anchors(&text).iter().any(|known| known == anchor)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_file_and_a_lost_heading_are_told_with_their_line() {
        let page = root().join("README.md");
        for (link, is_there) in [
            ("docs/limits.md", true),
            ("docs/limits.md#meshes", true),
            ("docs/limits.md#no-such-heading", false),
            ("docs/no-such-page.md", false),
            ("#links", true),
            ("#no-such-heading", false),
            ("samples/cave.jpg", true),
            ("https://example.org/no-such-page", true),
        ] {
            assert_eq!(leads_somewhere(&page, link), is_there, "{link}");
        }
        let folder = std::env::temp_dir().join(format!("plume-links-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("there is room");
        let page = folder.join("page.md");
        fs::write(&page, "# Page\n\n[lost](lost.md) and [found](#page)\n").expect("there is room");
        let found = faults(&page);
        fs::remove_dir_all(&folder).expect("it is ours");
        assert_eq!(found, Ok(vec![format!("{}:3: lost.md", page.display())]));
    }
}
