//! The table of a campaign.

use std::fmt::Write;
use std::time::Duration;

use crate::arguments::Arguments;
use crate::attack::Attack;
use crate::tally::Tally;

/// The outcome of an attack.
pub struct Row {
    /// The attack.
    pub attack: &'static Attack,
    /// Its tries and failures.
    pub tally: Tally,
    /// How long it took.
    pub took: Duration,
}

/// The table, followed by the failures and the skipped tries.
pub fn text(rows: &[Row], arguments: &Arguments) -> String {
    let mut text = heading(arguments);
    text += "\nattack | what it tries | tried | failed | seconds\n--- | --- | ---: | ---: | ---:\n";
    for Row { attack, tally, took } in rows {
        let Attack { name, tries, .. } = attack;
        let (tried, failed, seconds) = (tally.tried, tally.failed, took.as_secs());
        let _ = writeln!(text, "{name} | {tries} | {tried} | {failed} | {seconds}");
    }
    let sum = |count: fn(&Tally) -> usize| rows.iter().map(|row| count(&row.tally)).sum::<usize>();
    let _ = writeln!(text, "all | | {} | {} |", sum(|tally| tally.tried), sum(|tally| tally.failed));
    rows.iter().for_each(|row| text += &below(row));
    text
}

fn heading(arguments: &Arguments) -> String {
    let seed = arguments.seed;
    match arguments.minutes {
        Some(minutes) => format!("campaign of {minutes} minutes, seed {seed}\n"),
        None => format!("short campaign, seed {seed}\n"),
    }
}

fn below(row: &Row) -> String {
    let Row { attack, tally, .. } = row;
    let mut text = String::new();
    let lines = tally.failures.iter().map(|failure| ("FAILED", failure.clone()));
    let more = tally.failed - tally.failures.len();
    let more = (more > 0).then(|| ("FAILED", format!("… and {more} more")));
    let apart = tally.apart.iter().map(|(kind, count)| ("apart", format!("{count} {kind}")));
    let skipped = tally.skipped.iter().map(|what| ("SKIPPED", what.clone()));
    let notes = tally.notes.iter().map(|what| ("note", what.clone()));
    for (kind, line) in lines.chain(more).chain(apart).chain(skipped).chain(notes) {
        let _ = writeln!(text, "{kind} {}: {line}", attack.name);
    }
    text
}
