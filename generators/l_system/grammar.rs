//! A stochastic bracketed grammar, parsed from the strings of a recipe.

use crate::GenerateError;
use plume_graph::rng::Rng;

/// The letter that digs a passage.
pub(super) const FORWARD: char = 'F';
const COMMANDS: &str = "+-^&![]";

/// The symbols that replace a letter.
#[derive(Clone, Debug)]
pub(super) struct Production {
    pub(super) symbols: Vec<char>,
    /// For each `[`, the index of its `]`.
    pub(super) closing: Vec<usize>,
}

struct Rule {
    letter: char,
    weight: f64,
    production: usize,
}

/// An axiom, which is production 0, and rules.
pub(super) struct Grammar {
    pub(super) productions: Vec<Production>,
    rules: Vec<Rule>,
}

impl Grammar {
    /// # Errors
    /// If a string is not a rule, a symbol is unknown, brackets do not match, or nothing is ever dug.
    pub(super) fn read(axiom: &str, rules: &[String]) -> Result<Self, GenerateError> {
        let mut grammar = Self { productions: vec![production(axiom, axiom, "the axiom")?], rules: Vec::new() };
        for (index, text) in rules.iter().enumerate() {
            grammar.add(text, &format!("rule {} `{text}`", index + 1))?;
        }
        if grammar.digs() {
            return Ok(grammar);
        }
        Err(GenerateError::new(
            "the grammar never digs a passage",
            "add an F to the axiom or to a rule that it leads to",
        ))
    }

    fn add(&mut self, text: &str, place: &str) -> Result<(), GenerateError> {
        let fault = |what: &str| {
            Err(GenerateError::new(
                format!("{place} {what}"),
                "a rule is written as `A = F[+A]-A`, or with a weight as `A 0.5 = FA`",
            ))
        };
        let Some((head, body)) = text.split_once('=') else { return fault("has no `=`") };
        let mut letters = head.trim().chars();
        let Some(letter) = letters.next().filter(char::is_ascii_alphabetic) else {
            return fault("does not begin with a letter");
        };
        let weight = match letters.as_str().trim() {
            "" => 1.0,
            number => number.parse().unwrap_or(f64::NAN),
        };
        if !(weight > 0.0 && weight <= 1e6) {
            return fault("has a weight that is not a number between 0 and a million");
        }
        self.rules.push(Rule { letter, weight, production: self.productions.len() });
        self.productions.push(production(body, text, place)?);
        Ok(())
    }

    /// Whether the axiom leads to a letter that digs.
    fn digs(&self) -> bool {
        let mut seen = vec![false; self.productions.len()];
        let mut open = vec![0];
        while let Some(next) = open.pop() {
            if std::mem::replace(&mut seen[next], true) {
                continue;
            }
            let symbols = &self.productions[next].symbols;
            if symbols.contains(&FORWARD) {
                return true;
            }
            let leads = self.rules.iter().filter(|rule| symbols.contains(&rule.letter));
            open.extend(leads.map(|rule| rule.production));
        }
        false
    }

    /// The production of a letter, drawn by weight; `None` if it has no rule.
    pub(super) fn draw(&self, letter: char, rng: &mut Rng) -> Option<usize> {
        let fitting = || self.rules.iter().filter(|rule| rule.letter == letter);
        let last = fitting().next_back()?.production;
        let mut drawn = rng.unit() * fitting().map(|rule| rule.weight).sum::<f64>();
        let chosen = fitting().find(|rule| {
            drawn -= rule.weight;
            drawn < 0.0
        });
        Some(chosen.map_or(last, |rule| rule.production))
    }
}

/// Parses the symbols of `body`, which is the end of `text`.
fn production(body: &str, text: &str, place: &str) -> Result<Production, GenerateError> {
    let offset = text.chars().count() - body.chars().count();
    let (mut symbols, mut closing, mut open) = (Vec::new(), Vec::new(), Vec::new());
    for (index, symbol) in body.chars().enumerate().filter(|(_, symbol)| !symbol.is_whitespace()) {
        let at = offset + index + 1;
        if !symbol.is_ascii_alphabetic() && !COMMANDS.contains(symbol) {
            return Err(GenerateError::new(
                format!("{place} has {symbol:?} at character {at}"),
                "symbols are letters, + and - to turn, ^ and & to pitch up and down, ! to narrow, [ and ] around a branch",
            ));
        }
        if symbol == '[' {
            open.push((symbols.len(), at));
        }
        closing.push(usize::MAX);
        if symbol == ']' {
            let Some((opened, _)) = open.pop() else {
                return Err(GenerateError::new(
                    format!("{place} has `]` at character {at} without a `[`"),
                    "brackets must match within the axiom and within each rule",
                ));
            };
            closing[opened] = symbols.len();
        }
        symbols.push(symbol);
    }
    match open.pop() {
        None => Ok(Production { symbols, closing }),
        Some((_, at)) => Err(GenerateError::new(
            format!("{place} has `[` at character {at} that is never closed"),
            "brackets must match within the axiom and within each rule",
        )),
    }
}
