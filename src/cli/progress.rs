//! Progress bars and notes on stderr, results on stdout.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::Common;
use super::fault::CliError;
use crate::pipeline::Observer;
use crate::store::Stage;

/// Set by Ctrl-C. One per process, because a process has one Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Where everything is printed.
pub struct Console {
    quiet: bool,
    json: bool,
    allow_run: bool,
    bar: Mutex<Option<(ProgressBar, Instant)>>,
}

impl Console {
    /// A console; the first one also starts to listen for Ctrl-C.
    pub fn new(common: &Common) -> Self {
        // A host program may have its own handler; then it decides.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
        Self { quiet: common.quiet, json: common.json, allow_run: common.allow_run, bar: Mutex::new(None) }
    }

    /// Whether results are asked for as JSON.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Prints what was asked for. A reader that hangs up early is no fault.
    #[expect(clippy::unnecessary_wraps, reason = "the last step of commands that can fail")]
    pub fn result(&self, text: &str) -> Result<(), CliError> {
        let _ = std::io::stdout().write_all(text.as_bytes());
        Ok(())
    }

    /// Prints a line about the work.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }

    /// Prints a fault and its hint.
    pub fn fault(&self, error: &CliError) {
        self.clear();
        let hint = error.hint();
        let mut stderr = std::io::stderr();
        let _ = writeln!(stderr, "error: {error}");
        if !hint.is_empty() {
            let _ = writeln!(stderr, " hint: {hint}");
        }
    }

    fn clear(&self) {
        if let Some((bar, _)) = self.bar.lock().ok().and_then(|mut bar| bar.take()) {
            bar.finish_and_clear();
        }
    }
}

impl Observer for Console {
    fn begin(&self, stage: Stage, total: usize) {
        let bar = if self.quiet || !std::io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(total as u64)
        };
        let style = ProgressStyle::with_template("  {prefix:9} {bar:32} {pos}/{len} {eta}");
        bar.set_style(style.expect("the template is a constant"));
        bar.set_prefix(stage.name());
        bar.enable_steady_tick(Duration::from_millis(200));
        if let Ok(mut slot) = self.bar.lock() {
            *slot = Some((bar, Instant::now()));
        }
    }

    fn advance(&self, _stage: Stage) {
        if let Some((bar, _)) = self.bar.lock().ok().as_deref().and_then(Option::as_ref) {
            bar.inc(1);
        }
    }

    fn end(&self, _stage: Stage) {
        self.clear();
    }

    fn stop(&self) -> &AtomicBool {
        &STOP
    }

    fn allows_programs(&self) -> bool {
        self.allow_run
    }
}
