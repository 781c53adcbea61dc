//! `plume graph`: makes, imports and exports graphs.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use plume_disk::Existing;
use serde_json::{Value, json};

use super::access::{Access, Outside};
use super::fault::CliError;
use super::generate::Generate;
use super::progress::Console;
use super::signals;
use plume::pipeline::{Observer, PipelineError};
use plume::store::{self, CaveFolder, Stage, StoreError};
use plume_graph::Graph;
use plume_survey::{FORMATS, FormatRow, Import, Parts, ReadError, Tally, Written};

/// Makes or updates the graph of a cave folder, or exchanges graphs with other programs.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct GraphCommand {
    #[command(subcommand)]
    exchange: Option<Exchange>,
    #[command(flatten)]
    generate: Generate,
}

#[derive(Subcommand)]
enum Exchange {
    /// Convert a graph or cave survey to graph JSON
    Import(Bring),
    /// Convert the graph of a file or cave folder to another format
    Export(Hand),
}

impl GraphCommand {
    /// What it may use.
    pub fn access(&self) -> Access {
        match &self.exchange {
            None => self.generate.source.named.making.into(),
            Some(Exchange::Import(Bring { outside, .. }) | Exchange::Export(Hand { outside, .. })) => (*outside).into(),
        }
    }

    /// Runs the command.
    ///
    /// # Errors
    /// Bad input, I/O errors, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        match &self.exchange {
            None => self.generate.run(Stage::Graph, console),
            Some(Exchange::Import(bring)) => bring.run(console),
            Some(Exchange::Export(hand)) => hand.run(console),
        }
    }
}

/// Where to write, and how.
#[derive(Args)]
struct Output {
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Format, if the file name does not imply it; see `plume list formats`
    #[arg(long, value_name = "NAME")]
    format: Option<String>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct Bring {
    /// The graph or survey
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// What to do with disconnected parts of the graph
    #[arg(long, value_name = "refuse|join|keep|longest", default_value = "refuse", value_parser = parts)]
    parts: Parts,
    /// Factor by which all lengths are multiplied
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = factor)]
    scale: f64,
    #[command(flatten)]
    to: Output,
    #[command(flatten)]
    outside: Outside,
}

impl Bring {
    fn run(&self, console: &Console) -> Result<(), CliError> {
        let disk = console.disk();
        let import = match &self.to.format {
            Some(name) => plume_survey::read_as(row(name)?, &self.file, self.parts, &disk),
            None => plume_survey::read(&self.file, self.parts, &disk),
        };
        let import = import.and_then(|import| import.scaled(self.scale, &self.file)).map_err(faulty)?;
        let json = &FORMATS[0];
        if self.to.named_format().is_some_and(|row| row.name != json.name) {
            let message = format!("{}: an import always writes graph JSON", self.to.output.display());
            let hint = "use a name ending in .json; `plume graph export` writes the other formats".to_owned();
            return Err(CliError::Usage { message, hint });
        }
        self.to.write(json, &import, console)
    }
}

#[derive(Args)]
struct Hand {
    /// A graph, a survey or a cave folder
    #[arg(value_name = "GRAPH|CAVE_DIR")]
    input: PathBuf,
    #[command(flatten)]
    to: Output,
    #[command(flatten)]
    outside: Outside,
}

impl Hand {
    fn run(&self, console: &Console) -> Result<(), CliError> {
        let row = match &self.to.format {
            Some(name) => row(name)?,
            None => self.to.named_format().ok_or_else(|| self.unknown())?,
        };
        let path = match self.input.is_dir() {
            true if !CaveFolder::is_at(&self.input) => {
                let message = format!("{}: does not contain a cave", self.input.display());
                let hint = "name a graph, or a folder made by `plume graph -o`".to_owned();
                return Err(CliError::Usage { message, hint });
            }
            true => self.input.join(store::GRAPH),
            false => self.input.clone(),
        };
        let import = plume_survey::read(&path, Parts::Keep, &console.disk()).map_err(faulty)?;
        self.to.write(row, &import, console)
    }

    fn unknown(&self) -> CliError {
        let known = FORMATS.iter().filter(|row| row.write.is_some()).flat_map(|row| row.endings);
        CliError::Usage {
            message: format!("{}: no graph format that can be written has this extension", self.to.output.display()),
            hint: format!("known extensions: {}; or give --format", known.copied().collect::<Vec<_>>().join(", ")),
        }
    }
}

impl Output {
    /// The format that is written to files with such a name.
    fn named_format(&self) -> Option<&'static FormatRow> {
        plume_survey::format_of(&self.output, |row| row.write.is_some())
    }

    /// Writes what was read in the format of a row, and reports it.
    fn write(&self, row: &FormatRow, import: &Import, console: &Console) -> Result<(), CliError> {
        let Some(write) = row.write else {
            let message = format!("{} can be read but not written", row.name);
            return Err(CliError::Usage { message, hint: "see `plume list formats`".to_owned() });
        };
        let files = match &import.recipe {
            // The one format that holds a recipe.
            Some(recipe) if row.name == FORMATS[0].name => {
                let text = plume_survey::json::write(&import.graph, plume::VERSION, recipe);
                vec![Written { suffix: "", bytes: text.into_bytes() }]
            }
            _ => write(&import.graph),
        };
        signals::listen();
        let paths: Vec<PathBuf> = files.iter().map(|file| self.path(row, file.suffix)).collect();
        // What a killed run has finished is kept, as are the packages of an interrupted export.
        let open: Vec<_> = paths.iter().zip(&files).filter(|(path, file)| !holds(path, &file.bytes)).collect();
        if let Some((path, _)) = open.iter().find(|(path, _)| path.exists() && !self.force) {
            let message = format!("{}: already exists", path.display());
            return Err(CliError::Usage {
                message,
                hint: "choose another name, or replace it with --force".to_owned(),
            });
        }
        let existing = if self.force { Existing::Replace } else { Existing::Keep };
        for (path, file) in open {
            plume_disk::write_file(path, existing, &file.bytes).map_err(|error| StoreError::io(path, error))?;
        }
        plume_disk::sweep_beside(&self.output);
        tell(import, &paths, console)
    }

    /// For one file, the path asked for; for several, that path with an extension for each.
    fn path(&self, row: &FormatRow, suffix: &str) -> PathBuf {
        if suffix.is_empty() {
            return self.output.clone();
        }
        let name = self.output.file_name().unwrap_or_default().to_string_lossy();
        let lower = name.to_ascii_lowercase();
        let ending = row.endings.iter().find(|ending| lower.ends_with(*ending));
        let stem = match ending {
            Some(ending) => &name[..name.len() - ending.len()],
            None => name.rsplit_once('.').map_or(&*name, |(stem, _)| stem),
        };
        let extension = row.endings[0].rsplit('.').next().unwrap_or_default();
        self.output.with_file_name(format!("{stem}{suffix}.{extension}"))
    }
}

fn row(name: &str) -> Result<&'static FormatRow, CliError> {
    plume_survey::format(name).ok_or_else(|| CliError::unknown("format", name, FORMATS.iter().map(|row| row.name)))
}

fn faulty(error: ReadError) -> CliError {
    CliError::Pipeline(PipelineError::GraphFile(error))
}

/// Parses what recipes call `parts`.
pub fn parts(name: &str) -> Result<Parts, String> {
    serde_json::from_value(Value::from(name)).map_err(|_| "must be refuse, join, keep or longest".to_owned())
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor| (0.001..=1000.0).contains(factor));
    factor.ok_or_else(|| "must be a number from 0.001 to 1000".to_owned())
}

/// Whether the file at `path` has exactly this content.
fn holds(path: &Path, bytes: &[u8]) -> bool {
    plume_disk::regular::read(path, bytes.len() as u64).is_ok_and(|found| found == bytes)
}

fn tell(import: &Import, paths: &[PathBuf], console: &Console) -> Result<(), CliError> {
    let Import { graph, tally, warnings, .. } = import;
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    if console.is_json() {
        let counts = counts(tally).into_iter().map(|(name, count, _)| (name.to_owned(), Value::from(count)));
        let origin = ("origin_m".to_owned(), json!(<[f64; 3]>::from(tally.origin_m)));
        let doubtful = ("doubtful".to_owned(), Value::from(tally.doubtful));
        let tally = Value::Object(counts.chain([doubtful, origin]).collect());
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let told = json!({"graph": numbers(graph), "tally": tally, "warnings": warnings, "files": paths});
        return console.result(&format!("{told:#}\n"));
    }
    let (nodes, loops) = (grouped(graph.nodes.len()), grouped(graph.loops()));
    console.note(&format!("  graph     {nodes} nodes  {loops} loops  {:.0} m", graph.length_m()));
    let counts = counts(tally).into_iter().filter(|(_, count, _)| *count > 0);
    let counts: Vec<String> = counts.map(|(_, count, what)| format!("{what}: {}", grouped(count))).collect();
    if !counts.is_empty() {
        console.note(&format!("  changed   {}", counts.join(", ")));
    }
    let [x, y, z] = tally.origin_m.into();
    if [x, y, z] != [0.0; 3] {
        console.note(&format!("  origin    at {x:.3}, {y:.3}, {z:.3} m of the file"));
    }
    import.doubts().for_each(|doubt| console.warn(&doubt));
    console.note(&format!("  written   {}", paths.join(", ")));
    Ok(())
}

fn numbers(graph: &Graph) -> Value {
    let (nodes, passages) = (graph.nodes.len(), graph.edges.len());
    json!({"nodes": nodes, "passages": passages, "loops": graph.loops(), "length_m": graph.length_m()})
}

/// Each count of a tally, its name in JSON and in words.
fn counts(tally: &Tally) -> [(&'static str, usize, &'static str); 9] {
    [
        ("splays", tally.splays, "splays dropped"),
        ("duplicates", tally.duplicates, "duplicate legs dropped"),
        ("surface", tally.surface, "surface legs dropped"),
        ("interpolated", tally.interpolated, "sections interpolated"),
        ("welded", tally.welded, "zero-length legs welded"),
        ("joined", tally.joined, "passages added between parts"),
        ("left_out", tally.left_out, "stations left out"),
        ("afloat", tally.afloat, "pieces of unknown position laid beside the others"),
        ("unplaced", tally.unplaced, "stations without a position left out"),
    ]
}

/// A count with thousands separators.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let start = digits.len() % 3;
    let groups = digits.as_bytes()[start..].chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let first = (start > 0).then(|| digits[..start].to_owned());
    first.into_iter().chain(groups).collect::<Vec<_>>().join(",")
}
