//! Words and numbers, with the special characters that `*set` can change.

use crate::measure::{Cell, Quantity, Reading};
use plume_graph::echo::shown;

const BLANK: u16 = 1;
const COMMENT: u16 = 2;
const DECIMAL: u16 = 4;
const KEYWORD: u16 = 8;
const MINUS: u16 = 16;
const NAMES: u16 = 32;
const OMIT: u16 = 64;
const PLUS: u16 = 128;
const ROOT: u16 = 256;
const SEPARATOR: u16 = 512;

/// Their names in `*set`.
const ITEMS: &[(&str, u16)] = &[
    ("blank", BLANK),
    ("comment", COMMENT),
    ("decimal", DECIMAL),
    ("keyword", KEYWORD),
    ("minus", MINUS),
    ("names", NAMES),
    ("omit", OMIT),
    ("plus", PLUS),
    ("root", ROOT),
    ("separator", SEPARATOR),
];

/// The role of each ASCII character.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Marks([u16; 128]);

impl Default for Marks {
    fn default() -> Self {
        let mut marks = Self([0; 128]);
        let usual = [
            ("\t ,", BLANK),
            (";", COMMENT),
            (".", DECIMAL | SEPARATOR),
            ("*", KEYWORD),
            ("-", MINUS | NAMES | OMIT),
            ("_", NAMES),
            ("+", PLUS),
            ("\\", ROOT),
        ];
        for (characters, what) in usual {
            characters.bytes().for_each(|byte| marks.0[usize::from(byte)] = what);
        }
        marks
    }
}

impl Marks {
    fn is(&self, character: char, what: u16) -> bool {
        self.0.get(character as usize).is_some_and(|marks| marks & what != 0)
    }

    /// Sets the characters of an item, as in `*set`: literally, or by code as in `x2C`.
    pub(super) fn set(&mut self, item: &str, characters: &str) -> Result<(), String> {
        let Some(&(_, what)) = ITEMS.iter().find(|(known, _)| known.eq_ignore_ascii_case(item)) else {
            return Err(format!("{} cannot be set", shown(item)));
        };
        let mut codes = Vec::new();
        let mut rest = characters.chars();
        while let Some(character) = rest.next() {
            let code = character.eq_ignore_ascii_case(&'x');
            let hex = rest.as_str().get(..2).and_then(|digits| u32::from_str_radix(digits, 16).ok()).filter(|_| code);
            let character = hex.and_then(char::from_u32).unwrap_or(character);
            if hex.is_some() {
                rest = rest.as_str()[2..].chars();
            }
            if !character.is_ascii() || character.is_ascii_alphanumeric() {
                return Err(format!("`{}` cannot be a special character", character.escape_default()));
            }
            codes.push(character as usize);
        }
        self.0.iter_mut().for_each(|marks| *marks &= !what);
        codes.into_iter().for_each(|code| self.0[code] |= what);
        Ok(())
    }

    /// The content of a line: a command without its keyword character, or data.
    pub(super) fn command<'a>(&self, line: &'a str) -> Option<&'a str> {
        let line = line.trim_start_matches(|c| self.is(c, BLANK));
        line.strip_prefix(|c| self.is(c, KEYWORD))
    }

    /// Whether a line is only a comment, which, unlike an empty line, does not end a traverse.
    pub(super) fn is_comment(&self, line: &str) -> bool {
        line.trim_start_matches(|c| self.is(c, BLANK)).starts_with(|c| self.is(c, COMMENT))
    }

    /// The words of a data line, without its comment.
    pub(super) fn words<'a>(&self, line: &'a str) -> Vec<&'a str> {
        let line = line.find(|c| self.is(c, COMMENT)).map_or(line, |end| &line[..end]);
        line.split(|c| self.is(c, BLANK)).filter(|word| !word.is_empty()).collect()
    }

    /// The words of a command, where quotes protect blanks and comment characters.
    pub(super) fn quoted<'a>(&self, line: &'a str) -> Result<Vec<&'a str>, String> {
        let mut words = Vec::new();
        let mut rest = line.trim_start_matches(|c| self.is(c, BLANK));
        while !rest.is_empty() && !rest.starts_with(|c| self.is(c, COMMENT)) {
            let end;
            if let Some(text) = rest.strip_prefix('"') {
                end = text.find('"').ok_or("a quotation mark is not closed")?;
                words.push(&text[..end]);
                rest = &text[end + 1..];
            } else {
                end = rest.find(|c| self.is(c, BLANK) || self.is(c, COMMENT)).unwrap_or(rest.len());
                words.push(&rest[..end]);
                rest = &rest[end..];
            }
            rest = rest.trim_start_matches(|c| self.is(c, BLANK));
        }
        Ok(words)
    }

    /// The parts of a name.
    pub(super) fn parts<'a>(&self, name: &'a str) -> Result<Vec<&'a str>, String> {
        let fits = |c: char| c.is_ascii_alphanumeric() || !c.is_ascii() || self.is(c, NAMES | SEPARATOR);
        if let Some(invalid) = name.chars().find(|&c| !fits(c)) {
            return Err(format!("`{}` cannot be part of a name", invalid.escape_default()));
        }
        let parts: Vec<&str> = name.split(|c| self.is(c, SEPARATOR)).collect();
        if parts.iter().any(|part| part.is_empty()) {
            return Err(format!("{} is not a name", shown(name)));
        }
        Ok(parts)
    }

    /// The rest of a name that starts at the root.
    pub(super) fn behind_root<'a>(&self, name: &'a str) -> Option<&'a str> {
        name.strip_prefix(|c| self.is(c, ROOT))
    }

    /// The number of separators, if a word consists of nothing else: an anonymous station.
    pub(super) fn dots(&self, word: &str) -> Option<usize> {
        word.chars().all(|c| self.is(c, SEPARATOR)).then(|| word.chars().count())
    }

    pub(super) fn number(&self, word: &str) -> Option<f64> {
        let minus = word.starts_with(|c| self.is(c, MINUS));
        let digits = word.strip_prefix(|c| self.is(c, MINUS) || self.is(c, PLUS)).unwrap_or(word);
        let mut plain = String::with_capacity(digits.len());
        for character in digits.chars() {
            match character {
                '0'..='9' => plain.push(character),
                _ if self.is(character, DECIMAL) && !plain.contains('.') => plain.push('.'),
                _ => return None,
            }
        }
        let number: f64 = plain.parse().ok()?;
        Some(if minus { -number } else { number })
    }

    /// The content of a column.
    pub(super) fn cell(&self, reading: Reading, word: &str) -> Result<Cell, String> {
        if word.chars().count() == 1 && word.starts_with(|c| self.is(c, OMIT)) {
            return Ok(Cell::Omitted);
        }
        if let Some(number) = self.number(word) {
            return Ok(Cell::Number(number));
        }
        let plumb = match word.to_ascii_lowercase().as_str() {
            "up" | "u" | "+v" => Some(Cell::Up),
            "down" | "d" | "-v" => Some(Cell::Down),
            "level" | "h" => Some(Cell::Level),
            _ => None,
        };
        match (reading, plumb) {
            (Reading::Of(Quantity::Gradient | Quantity::BackGradient), Some(plumb)) => Ok(plumb),
            (Reading::Of(Quantity::Bearing | Quantity::BackBearing), _) => {
                self.quadrant(word).map(Cell::Number).ok_or_else(|| format!("{} is not a bearing", shown(word)))
            }
            _ => Err(format!("{} is not a number", shown(word))),
        }
    }

    /// A bearing such as `S34E`, in degrees.
    fn quadrant(&self, word: &str) -> Option<f64> {
        let word = word.to_ascii_uppercase();
        let cardinal = [("N", 0.0), ("E", 90.0), ("S", 180.0), ("W", 270.0)];
        if let Some(&(_, bearing)) = cardinal.iter().find(|(name, _)| *name == word) {
            return Some(bearing);
        }
        let inner = word.strip_prefix(['N', 'S'])?.strip_suffix(['E', 'W'])?;
        let angle = self.number(inner).filter(|angle| (0.0..=90.0).contains(angle))?;
        let eastwards = if word.starts_with('N') { angle } else { 180.0 - angle };
        Some(if word.ends_with('E') { eastwards } else { 360.0 - eastwards })
    }
}
