//! Words and numbers of Therion.

use crate::measure::{Cell, Quantity, Reading};
use plume_graph::echo::shown;

/// The words of a line without its comment; text in quotes or brackets is one word.
pub(super) fn words(line: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut rest = line.trim_start();
    while !rest.is_empty() && !rest.starts_with('#') {
        if let Some(text) = rest.strip_prefix('"') {
            let mut word = String::new();
            rest = text;
            loop {
                let end = rest.find('"').ok_or("a quotation mark is not closed")?;
                word += &rest[..end];
                rest = &rest[end + 1..];
                // A doubled quotation mark stands for itself.
                let Some(more) = rest.strip_prefix('"') else { break };
                word.push('"');
                rest = more;
            }
            words.push(word);
        } else if let Some(text) = rest.strip_prefix('[') {
            let end = text.find(']').ok_or("a bracket is not closed")?;
            words.push(text[..end].trim().to_owned());
            rest = &text[end + 1..];
        } else {
            let end = rest.find(|c: char| c.is_whitespace() || c == '#').unwrap_or(rest.len());
            words.push(rest[..end].to_owned());
            rest = &rest[end..];
        }
        rest = rest.trim_start();
    }
    Ok(words)
}

/// A number, or an angle as `degrees:minutes:seconds`.
pub(super) fn number(word: &str) -> Option<f64> {
    let (sign, digits) = match word.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    let mut sum = 0.0;
    let mut share = 1.0;
    for (place, part) in digits.split(':').enumerate() {
        let plain = part.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
        let part: f64 = part.parse().ok().filter(|_| plain && place < 3)?;
        sum += part / share;
        share *= 60.0;
    }
    Some(sign * sum)
}

/// The content of a column.
pub(super) fn cell(reading: Reading, word: &str) -> Result<Cell, String> {
    if matches!(word, "-" | ".") {
        return Ok(Cell::Omitted);
    }
    if let Some(number) = number(word) {
        return Ok(Cell::Number(number));
    }
    let wall = matches!(reading, Reading::Of(Quantity::Left | Quantity::Right | Quantity::Up | Quantity::Down));
    let pair: Vec<&str> = word.split_whitespace().collect();
    if let ([start, end], true) = (pair.as_slice(), wall)
        && let (Some(start), Some(end)) = (number(start), number(end))
    {
        return Ok(Cell::Pair(start, end));
    }
    let gradient = matches!(reading, Reading::Of(Quantity::Gradient | Quantity::BackGradient));
    match word.to_ascii_lowercase().as_str() {
        "up" | "u" | "+v" if gradient => Ok(Cell::Up),
        "down" | "d" | "-v" if gradient => Ok(Cell::Down),
        "level" | "h" if gradient => Ok(Cell::Level),
        _ => Err(format!("{} is not a number", shown(word))),
    }
}
