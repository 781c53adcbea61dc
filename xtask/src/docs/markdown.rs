//! As much of Markdown as checking and moving links takes: prose, links, headings.

/// The lines outside fenced code, with their numbers from 1.
pub fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    let numbered = text.lines().enumerate().map(|(index, line)| (index + 1, line));
    numbered.filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// Where the links and pictures of a line lead, code aside.
pub fn links(line: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut is_code = false;
    for (index, character) in line.char_indices() {
        is_code ^= character == '`';
        if !is_code && line[index..].starts_with("](") {
            found.extend(line[index + 2..].split_once(')').map(|(target, _)| target));
        }
    }
    found
}

/// The names by which links reach the headings of a page, as GitHub and mdBook derive them.
pub fn anchors(text: &str) -> Vec<String> {
    let headings = prose(text).filter_map(|(_, line)| {
        let title = line.trim_start_matches('#');
        (title.len() < line.len() && title.starts_with(' ')).then_some(title)
    });
    headings.map(anchor).collect()
}

fn anchor(title: &str) -> String {
    let kept = title.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Whether a link leads out of the repository.
pub fn is_foreign(target: &str) -> bool {
    target.contains("://") || target.starts_with("mailto:")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_has_no_links() {
        let text = "[a](b.md)\n```toml\n[c](d.md)\n```\n`[e](f.md)` and [`g`](h.md#i)";
        let found: Vec<_> =
            prose(text).flat_map(|(line, text)| links(text).into_iter().map(move |l| (line, l))).collect();
        assert_eq!(found, [(1, "b.md"), (5, "h.md#i")]);
    }

    #[test]
    fn a_picture_in_a_link_is_two_links() {
        assert_eq!(links("| [![plan](a.png)](a.toml) |"), ["a.png", "a.toml"]);
    }

    #[test]
    fn anchors_are_those_of_github() {
        assert_eq!(
            anchors("# ROS 2\n## How fast?\n### `[graph]` and rocks\n#no heading"),
            ["ros-2", "how-fast", "graph-and-rocks"]
        );
    }
}
