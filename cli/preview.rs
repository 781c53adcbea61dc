//! `plume preview`: what a cave will look like, within seconds.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::fault::CliError;
use super::output;
use super::progress::Console;
use super::{Named, flight};
use plume::cave;
use plume::pipeline::Observer;
use plume::preview::{self, Drawn, Format, Order, Pace, Size, ViewRow};
use plume::store::StoreError;

/// Draws a cave from its graph and field alone, before there is a mesh.
#[derive(Args)]
pub struct Preview {
    #[command(flatten)]
    pub(super) named: Named,
    /// What to draw; see `plume list views` [default: the first view that fits the extension of FILE]
    #[arg(long)]
    view: Option<String>,
    /// Colour theme of maps [default: light]
    #[arg(long, value_enum)]
    theme: Option<Theme>,
    /// Width and height in pixels, for example 1280x720 [default: depends on the view]
    #[arg(long, value_name = "WxH")]
    size: Option<String>,
    /// Camera position inside the cave, in metres [default: the start pose that shows most]
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    at: Vec<f32>,
    /// Camera direction in degrees: azimuth from +x towards +y, and elevation [default: the longest line of sight]
    #[arg(long, value_name = "YAW,PITCH", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    look: Vec<f32>,
    /// Frames per second of a flight [default: 10]
    #[arg(long, value_name = "N")]
    fps: Option<u32>,
    /// Length of a flight in seconds [default: 6]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// Open the file in the default program of the system
    #[arg(long)]
    open: bool,
    /// The file to write, replacing an existing one. The extension sets the format; without one, a folder of frames is
    /// written, which must be new, empty or from an earlier flight
    /// [default: NAME-VIEW]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// The themes, as the command line names them.
#[derive(Clone, Copy, ValueEnum)]
enum Theme {
    Light,
    Dark,
}

impl Preview {
    /// Draws the view and writes it to a file.
    ///
    /// # Errors
    /// Bad input, nothing to see, I/O errors, Ctrl-C.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let start = Instant::now();
        let row = self.row()?;
        let format = self.format(row)?;
        self.refuse_unheeded(row)?;
        let input = self.named.resolve(console)?;
        let order = self.order(format, console)?;
        let output = self.output.clone().unwrap_or_else(|| {
            let dot = if format.ending().is_empty() { "" } else { "." };
            format!("{}-{}{dot}{}", input.recipe.name(), row.name, format.ending()).into()
        });
        refuse_nowhere(&output)?;
        if format.ending().is_empty() {
            flight::check(&output)?;
        }
        let drawn = cave::preview(&input, row, &order, console)?;
        let bytes = save(&output, &drawn)?;
        report(console, row, &output, bytes, start)?;
        if self.open { open(&output) } else { Ok(()) }
    }

    fn order<'a>(&self, format: Format, console: &'a Console) -> Result<Order<'a>, CliError> {
        let usual = Pace::default();
        Ok(Order {
            format,
            theme: match self.theme {
                None | Some(Theme::Light) => preview::Theme::Light,
                Some(Theme::Dark) => preview::Theme::Dark,
            },
            size: self.size.as_deref().map(str::parse::<Size>).transpose()?,
            at: numbers("--at", &self.at)?,
            look_rad: numbers("--look", &self.look)?.map(|angles: [f32; 2]| angles.map(f32::to_radians)),
            pace: Pace::new(self.fps.unwrap_or(usual.fps), self.seconds.unwrap_or(usual.seconds))?,
            stop: console.stop(),
        })
    }

    /// Refuses options that have no effect on the view.
    fn refuse_unheeded(&self, row: &ViewRow) -> Result<(), CliError> {
        let given = [
            ("theme", self.theme.is_some()),
            ("size", self.size.is_some()),
            ("at", !self.at.is_empty()),
            ("look", !self.look.is_empty()),
            ("fps", self.fps.is_some()),
            ("seconds", self.seconds.is_some()),
        ];
        let Some((option, _)) = given.into_iter().find(|(option, given)| *given && !row.heeds.contains(option)) else {
            return Ok(());
        };
        let heeding = preview::VIEWS.iter().filter(|row| row.heeds.contains(&option));
        let names: Vec<&str> = heeding.map(|row| row.name).collect();
        let message = format!("--{option} has no effect on the view {}", row.name);
        Err(CliError::Usage { message, hint: format!("use it with --view {}", names.join(", ")) })
    }

    /// The view that was named, or the first one that fits the file's extension.
    fn row(&self) -> Result<&'static ViewRow, CliError> {
        if let Some(name) = &self.view {
            return cave::view_row(name);
        }
        let ending = self.ending();
        let fits = |row: &&ViewRow| ending.as_ref().is_none_or(|ending| format_called(row, ending).is_some());
        preview::VIEWS.iter().find(fits).ok_or_else(|| {
            let mut known: Vec<&str> = Vec::new();
            for format in preview::VIEWS.iter().flat_map(|row| row.formats) {
                if !known.contains(&format.ending()) {
                    known.push(format.ending());
                }
            }
            self.unfit("no view can write", &known)
        })
    }

    fn format(&self, row: &ViewRow) -> Result<Format, CliError> {
        let Some(ending) = self.ending() else {
            return Ok(row.formats[0]);
        };
        let known: Vec<&str> = row.formats.iter().map(|format| format.ending()).collect();
        format_called(row, &ending).ok_or_else(|| self.unfit(&format!("the view {} cannot write", row.name), &known))
    }

    /// The extension of the file, lower case; `None` if no file was named.
    fn ending(&self) -> Option<String> {
        let output = self.output.as_ref()?;
        Some(output.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default())
    }

    fn unfit(&self, what: &str, known: &[&str]) -> CliError {
        let output = self.output.as_deref().unwrap_or(Path::new(""));
        let message = format!("{}: {what} files with this extension", output.display());
        let endings: Vec<String> = known.iter().filter(|one| !one.is_empty()).map(|one| format!(".{one}")).collect();
        CliError::Usage { message, hint: format!("known extensions: {}", endings.join(", ")) }
    }
}

/// The finite numbers of an option, exactly `N` of them.
fn numbers<const N: usize>(option: &str, given: &[f32]) -> Result<Option<[f32; N]>, CliError> {
    if given.is_empty() {
        return Ok(None);
    }
    let wanted: Option<[f32; N]> = given.try_into().ok().filter(|all: &[f32; N]| all.iter().all(|one| one.is_finite()));
    wanted.map(Some).ok_or_else(|| CliError::Usage {
        message: format!("{option} takes {N} numbers"),
        hint: format!("separate them with commas, for example {option} {}", ["1.5"; N].join(",")),
    })
}

fn format_called(row: &ViewRow, ending: &str) -> Option<Format> {
    row.formats.iter().copied().find(|format| format.ending() == ending)
}

/// Reports a missing folder before the work rather than after it.
fn refuse_nowhere(output: &Path) -> Result<(), CliError> {
    let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) else {
        return Ok(());
    };
    let fault = match fs::metadata(folder) {
        Ok(found) if found.is_dir() => return Ok(()),
        Ok(_) => ErrorKind::NotADirectory.into(),
        Err(source) => source,
    };
    Err(StoreError::io(folder, fault).into())
}

/// Writes what was drawn and returns its size.
fn save(path: &Path, drawn: &Drawn) -> Result<usize, CliError> {
    match drawn {
        Drawn::File(bytes) => {
            output::replace(path, bytes)?;
            Ok(bytes.len())
        }
        Drawn::Frames(frames) => {
            flight::save(path, frames)?;
            Ok(frames.iter().map(Vec::len).sum())
        }
    }
}

fn report(console: &Console, row: &ViewRow, output: &Path, bytes: usize, start: Instant) -> Result<(), CliError> {
    let wall_s = start.elapsed().as_secs_f64();
    if console.is_json() {
        let path = output.to_string_lossy();
        return console
            .result(&format!("{:#}\n", json!({"view": row.name, "path": path, "bytes": bytes, "wall_s": wall_s})));
    }
    console.note(&format!("  {:9} {}  {} kB  {wall_s:.1} s", row.name, output.display(), bytes.div_ceil(1000)));
    Ok(())
}

fn open(output: &Path) -> Result<(), CliError> {
    open::that_detached(output).map_err(|error| CliError::Usage {
        message: format!("{}: was written, but cannot be opened: {error}", output.display()),
        hint: "open it yourself".into(),
    })
}
