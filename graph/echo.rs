//! Quotes untrusted text in messages: short, and harmless to a terminal.
//!
//! A name may be as long as a file, and may contain characters that clear the screen or reverse the text.

/// Maximum length of a name or a value in a message.
const SHOWN: usize = 80;
/// Maximum length of a sentence that contains such text, as messages of parsers do.
const SENTENCE: usize = 400;

/// A text in quotes.
pub fn shown(text: &str) -> String {
    let (start, rest) = clipped(text.trim(), SHOWN);
    format!("{start:?}{rest}")
}

/// A text without quotes, such as a key or a value.
pub fn plain(text: &str) -> String {
    let (start, rest) = clipped(text, SHOWN);
    format!("{}{rest}", printable(start))
}

/// A path, or a sentence that may quote names.
pub fn sentence(text: &str) -> String {
    let (start, rest) = clipped(text, SENTENCE);
    format!("{}{rest}", printable(start))
}

/// The beginning of a text, with an ellipsis for the rest.
fn clipped(text: &str, most: usize) -> (&str, &'static str) {
    match text.char_indices().nth(most) {
        Some((end, _)) => (&text[..end], "…"),
        None => (text, ""),
    }
}

/// Whether a character controls a terminal or the direction of text.
pub(crate) fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text with control characters escaped.
fn printable(text: &str) -> String {
    text.chars().map(|c| if steers(c) { c.escape_default().to_string() } else { c.to_string() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_texts_stay_and_long_ones_are_clipped() {
        assert_eq!((shown(" mine "), plain("a.b"), sentence("a/b")), ("\"mine\"".into(), "a.b".into(), "a/b".into()));
        let long = "ö".repeat(1_000_000);
        assert_eq!(shown(&long), format!("\"{}\"…", "ö".repeat(80)));
        assert_eq!(plain(&long), format!("{}…", "ö".repeat(80)));
        assert_eq!(sentence(&long).chars().count(), 401);
    }

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(shown("a\u{1b}[2Jb\"\n\u{202e}"), r#""a\u{1b}[2Jb\"\n\u{202e}""#);
        assert_eq!(plain("a\u{1b}[2J\u{202e}"), r"a\u{1b}[2J\u{202e}");
    }
}
