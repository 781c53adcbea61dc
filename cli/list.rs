//! `plume list`: the available choices.

use clap::{Args, ValueEnum};
use plume_exporters::ImageFormat;
use plume_exporters::bundle::Bundle;
use plume_exporters::{TARGETS, TargetRow};
use serde_json::{Value, json};

use super::fault::CliError;
use super::progress::Console;
use plume::cave;
use plume::generators::GENERATORS;
use plume::material::MATERIALS;
use plume::preset::PRESETS;
use plume::preview::VIEWS;
use plume::recipe::{Setting, settings_of};
use plume::robot::{ROBOTS, RobotRow};
use plume::things::KINDS;
use plume_graph::echo;
use plume_survey::{FORMATS, FormatRow};

/// Lists targets and their options, generators, formats, materials, things, presets, views and robots.
#[derive(Args)]
pub struct List {
    /// Which table [default: all but the options]
    table: Option<Table>,
    /// The target whose options to list [default: all targets]
    target: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Table {
    Targets,
    Options,
    Generators,
    Formats,
    Materials,
    Things,
    Presets,
    Views,
    Robots,
}

/// A row of any table.
struct Row {
    name: String,
    summary: String,
    /// The same as a JSON object, with further facts for programs.
    facts: Value,
}

impl Row {
    fn new(name: &str, summary: &str) -> Self {
        Self { name: name.to_owned(), summary: summary.to_owned(), facts: json!({}) }
    }
}

impl List {
    /// Prints the tables on stdout.
    ///
    /// # Errors
    /// If there is no such target, or the table is not that of options.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let targets = self.targets()?;
        let tables: Vec<(Table, Vec<Row>)> = vec![
            (Table::Targets, TARGETS.iter().map(target).collect()),
            (Table::Options, targets.into_iter().flat_map(options).collect()),
            (Table::Generators, GENERATORS.iter().map(|row| Row::new(row.name, row.summary)).collect()),
            (Table::Formats, FORMATS.iter().map(|row| Row::new(row.name, &format_summary(row))).collect()),
            (Table::Materials, MATERIALS.iter().map(|row| Row::new(row.name, row.summary)).collect()),
            (Table::Things, KINDS.iter().map(|row| Row::new(row.name, row.summary)).collect()),
            (Table::Presets, PRESETS.iter().map(|row| Row::new(row.name, row.summary)).collect()),
            (Table::Views, VIEWS.iter().map(|row| Row::new(row.name, row.summary)).collect()),
            (Table::Robots, ROBOTS.iter().map(robot).collect()),
        ];
        let is_asked = |table: Table| self.table.map_or(table != Table::Options, |asked| asked == table);
        let asked = tables.into_iter().filter(|(table, _)| is_asked(*table));
        if console.is_json() {
            let json: Value = asked.map(|(table, rows)| (title(table), rows_json(&rows))).collect();
            return console.result(&format!("{json:#}\n"));
        }
        let text: Vec<String> = asked.map(|(table, rows)| rows_text(&title(table), &rows)).collect();
        console.result(&text.join("\n"))
    }

    /// The targets whose options are listed.
    fn targets(&self) -> Result<Vec<&'static TargetRow>, CliError> {
        let Some(name) = &self.target else { return Ok(TARGETS.iter().collect()) };
        if self.table != Some(Table::Options) {
            return Err(CliError::Usage {
                message: "only options are listed by target".into(),
                hint: format!("`plume list options {}` lists the options of a target", echo::plain(name)),
            });
        }
        Ok(vec![cave::target(name)?.row])
    }
}

/// The options of a target, as they are passed to `plume export`.
fn options(row: &'static TargetRow) -> Vec<Row> {
    let settings = settings_of(&(row.settings)().to_value());
    settings.into_iter().map(|setting| option(row, &setting)).collect()
}

fn option(row: &TargetRow, setting: &Setting) -> Row {
    let name = format!("{}.{}", row.name, setting.key);
    let summary = format!("{} [{}; default {}]", setting.meaning, setting.range, setting.default_text());
    let facts = json!({
        "target": row.name,
        "key": setting.key,
        "meaning": setting.meaning,
        "range": setting.range,
        "default": setting.default,
    });
    Row { facts, ..Row::new(&name, &summary) }
}

/// A target with the facts by which tests and other programs choose targets.
fn target(row: &TargetRow) -> Row {
    let images = row.images.iter().map(|format: &ImageFormat| format.extension()).collect::<Vec<_>>();
    let facts = json!({
        "target": row.name,
        "opened_by": row.opened_by,
        "needs_format": row.needs_format(),
        "needs_usd": row.needs_usd(),
        "has_pieces": row.has_pieces,
        "is_single_file": row.is_single_file,
        "images": images,
        "bundles": row.all_bundles().map(Bundle::name).collect::<Vec<_>>(),
        "checks": row.checks,
    });
    Row { facts, ..Row::new(&row.usage(), row.summary) }
}

/// A robot with what it measures.
fn robot(row: &RobotRow) -> Row {
    let facts = serde_json::to_value(&row.settings).unwrap_or_default();
    Row { facts: json!({ "settings": facts }), ..Row::new(row.name, row.summary) }
}

/// What the format is, whether it can be read or written, and its extensions.
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

fn rows_json(rows: &[Row]) -> Value {
    let object = |row: &Row| {
        let mut object = json!({"name": row.name, "summary": row.summary});
        let facts = row.facts.as_object().into_iter().flatten();
        facts.for_each(|(key, fact)| object[key] = fact.clone());
        object
    };
    rows.iter().map(object).collect()
}

fn rows_text(title: &str, rows: &[Row]) -> String {
    let width = rows.iter().map(|row| row.name.len()).fold(18, usize::max);
    let lines = rows.iter().map(|Row { name, summary, .. }| format!("  {name:width$} {summary}\n"));
    format!("{title}\n{}", lines.collect::<String>())
}
