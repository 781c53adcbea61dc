//! `plume list`: what there is to choose from.

use clap::{Args, ValueEnum};
use plume_exporters::TARGETS;
use serde_json::{Value, json};

use super::fault::CliError;
use super::progress::Console;
use plume::generators::GENERATORS;
use plume::material::MATERIALS;
use plume::preset::PRESETS;
use plume::preview::VIEWS;
use plume_survey::{FORMATS, FormatRow};

/// Lists targets, generators, formats, materials, presets and views.
#[derive(Args)]
pub struct List {
    /// Which table [default: all]
    table: Option<Table>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Table {
    Targets,
    Generators,
    Formats,
    Materials,
    Presets,
    Views,
}

type Rows = Vec<(String, String)>;

impl List {
    /// Prints the tables on stdout.
    ///
    /// # Errors
    /// None; commands can fail.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let tables: Vec<(Table, Rows)> = vec![
            (Table::Targets, TARGETS.iter().map(|row| (row.usage(), row.summary.to_owned())).collect()),
            (Table::Generators, GENERATORS.iter().map(|row| (row.name.to_owned(), row.summary.to_owned())).collect()),
            (Table::Formats, FORMATS.iter().map(|row| (row.name.to_owned(), format_summary(row))).collect()),
            (Table::Materials, MATERIALS.iter().map(|row| (row.name.to_owned(), row.summary.to_owned())).collect()),
            (Table::Presets, PRESETS.iter().map(|row| (row.name.to_owned(), row.summary.to_owned())).collect()),
            (Table::Views, VIEWS.iter().map(|row| (row.name.to_owned(), row.summary.to_owned())).collect()),
        ];
        let asked = tables.into_iter().filter(|(table, _)| self.table.is_none_or(|asked| asked == *table));
        if console.is_json() {
            let json: Value = asked.map(|(table, rows)| (title(table), rows_json(&rows))).collect();
            return console.result(&format!("{json:#}\n"));
        }
        let text: Vec<String> = asked.map(|(table, rows)| rows_text(&title(table), &rows)).collect();
        console.result(&text.join("\n"))
    }
}

/// What it is, whether it is read and written, and by which names.
fn format_summary(row: &FormatRow) -> String {
    let ways = match (row.read, row.write) {
        (Some(_), Some(_)) => "read and written",
        (Some(_), None) => "read",
        _ => "written",
    };
    format!("{} ({ways}: {})", row.summary, row.endings.join(" "))
}

fn title(table: Table) -> String {
    table.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

fn rows_json(rows: &Rows) -> Value {
    rows.iter().map(|(name, summary)| json!({"name": name, "summary": summary})).collect()
}

fn rows_text(title: &str, rows: &Rows) -> String {
    let lines = rows.iter().map(|(name, summary)| format!("  {name:18} {summary}\n"));
    format!("{title}\n{}", lines.collect::<String>())
}
