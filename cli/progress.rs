//! Progress bars and notes on stderr, results on stdout.

use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::access::Access;
use super::fault::CliError;
use super::{Common, signals};
use plume::pipeline::{Disk, Observer};
use plume::recipe::Fault;
use plume::store::Stage;
use plume_graph::echo::sentence;
use plume_record::Watch;

/// All printing goes through this.
pub struct Console {
    quiet: bool,
    json: bool,
    access: Access,
    bar: Mutex<Option<(ProgressBar, Instant)>>,
}

impl Console {
    /// A console.
    pub fn new(common: &Common, access: Access) -> Self {
        Self { quiet: common.quiet, json: common.json, access, bar: Mutex::new(None) }
    }

    /// Whether results are to be printed as JSON.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// The disk, with the access that the user allows.
    pub fn disk(&self) -> Disk {
        Disk { allows_outside_files: self.access.outside_files }
    }

    /// Prints a result.
    ///
    /// # Errors
    /// As [`told`].
    pub fn result(&self, text: &str) -> Result<(), CliError> {
        told(io::stdout().write_all(text.as_bytes()))
    }

    /// Prints a progress note.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// Prints an error and its hint.
    pub fn fault(&self, error: &CliError) {
        self.clear();
        match self.json {
            true => print_fault(&fault_json(error)),
            false => fault(error),
        }
    }

    /// Removes the progress bar.
    pub fn clear(&self) {
        if let Some((bar, _)) = self.bar.lock().ok().and_then(|mut bar| bar.take()) {
            bar.finish_and_clear();
        }
    }
}

/// Flushes standard output. A reader that closes the pipe early is not an error.
///
/// # Errors
/// If not everything could be written.
pub fn told(written: io::Result<()>) -> Result<(), CliError> {
    match written.and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(CliError::Failed(format!("standard output: {error}; the output is incomplete")))
        }
        _ => Ok(()),
    }
}

/// Prints an error and its hint.
pub fn fault(error: &CliError) {
    let hint = error.hint();
    let mut stderr = io::stderr();
    let _ = writeln!(stderr, "error: {error}");
    if !hint.is_empty() {
        let _ = writeln!(stderr, " hint: {hint}");
    }
}

/// Prints a fault as JSON on a line of its own, after any notes.
pub fn print_fault(fault: &Value) {
    let _ = writeln!(io::stderr(), "{fault}");
}

/// An error for programs: what is wrong, and what to do about it. Of a recipe with several faults, the first, and all in a list.
fn fault_json(error: &CliError) -> Value {
    let CliError::Recipe(faults) = error else {
        return json!({"error": error.to_string(), "hint": error.hint()});
    };
    let one = |fault: &Fault| json!({"error": format!("{}: {}", fault.origin, fault.message), "hint": fault.hint});
    let listed: Vec<Value> = faults.told.iter().map(one).collect();
    let mut all = listed.first().cloned().unwrap_or_default();
    all["faults"] = listed.into();
    all["more"] = faults.more.into();
    all
}

impl Console {
    fn start_bar(&self, prefix: &'static str, total: usize) {
        self.start_bar_at(prefix, total, 0);
    }

    /// Starts a progress bar of which some is done.
    pub fn start_bar_at(&self, prefix: &'static str, total: usize, done: usize) {
        let bar = if self.quiet || !io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(total as u64)
        };
        let style = ProgressStyle::with_template("  {prefix:9} {bar:32} {pos}/{len} {per_sec} {eta}");
        bar.set_style(style.expect("the template is a constant"));
        bar.set_prefix(prefix);
        bar.set_position(done as u64);
        // What was done before says nothing about the rate.
        bar.reset_eta();
        // A steady tick takes a thread, which a hidden bar does not need.
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        if let Ok(mut slot) = self.bar.lock() {
            *slot = Some((bar, Instant::now()));
        }
    }

    /// Advances the progress bar.
    pub fn advance_bar(&self) {
        if let Some((bar, _)) = self.bar.lock().ok().as_deref().and_then(Option::as_ref) {
            bar.inc(1);
        }
    }
}

impl Observer for Console {
    fn begin(&self, stage: Stage, total: usize) {
        self.start_bar(stage.name(), total);
    }

    fn advance(&self, _stage: Stage) {
        self.advance_bar();
    }

    fn end(&self, _stage: Stage) {
        self.clear();
    }

    fn stop(&self) -> &AtomicBool {
        signals::stop()
    }

    fn warn(&self, warning: &str) {
        self.note(&format!("  warning   {}", sentence(warning)));
    }

    fn allows_programs(&self) -> bool {
        self.access.programs
    }

    fn allows_outside_files(&self) -> bool {
        self.access.outside_files
    }
}

impl Watch for Console {
    fn begin(&self, total: usize) {
        self.start_bar("record", total);
    }

    fn advance(&self) {
        self.advance_bar();
    }

    fn stop(&self) -> &AtomicBool {
        signals::stop()
    }
}
