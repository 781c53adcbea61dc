//! Running `plume` so that neither a hang nor a flood of words harms the campaign.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{Read, Seek};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process, kill_process_group};

/// Default time limit of a run.
const LIMIT: Duration = Duration::from_secs(120);
/// How often a run is looked at.
const GLANCE: Duration = Duration::from_millis(2);
/// Maximum output read of a run.
const MOST_BYTES: u64 = 1 << 22;
/// No message to a person is longer.
const MOST_WORDS: usize = 16 << 10;
/// Exit code of a Rust program that panics.
const PANIC: i32 = 101;

/// A run to be started.
pub struct Call {
    words: Vec<OsString>,
    /// Number of words before the program itself.
    prefix: usize,
    folder: PathBuf,
    limit: Duration,
    stdout: Option<File>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// By itself.
    Code(i32),
    /// Stopped by this signal.
    Signal(i32),
    /// Killed by the campaign because it took too long.
    Late,
}

/// The result of a run.
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// What it printed.
    pub stdout: String,
    /// Its output.
    pub stderr: String,
    /// How long it took.
    pub took: Duration,
    line: String,
}

impl Call {
    /// `program` with `arguments` in `folder`.
    pub fn new<S: AsRef<OsStr>>(program: &Path, arguments: &[S], folder: &Path) -> Self {
        let words = std::iter::once(program.as_os_str()).chain(arguments.iter().map(AsRef::as_ref));
        let words = words.map(OsStr::to_owned).collect();
        Self { words, prefix: 0, folder: folder.to_owned(), limit: LIMIT, stdout: None }
    }

    /// Started by another program, such as `strace`.
    pub fn under<S: AsRef<OsStr>>(mut self, prefix: &[S]) -> Self {
        self.prefix += prefix.len();
        let prefix = prefix.iter().map(|word| word.as_ref().to_owned());
        self.words = prefix.chain(self.words).collect();
        self
    }

    /// Sets the time limit.
    pub fn within(mut self, limit: Duration) -> Self {
        self.limit = limit;
        self
    }

    /// Redirects its output to this file.
    pub fn to(mut self, stdout: File) -> Self {
        self.stdout = Some(stdout);
        self
    }

    /// Runs it to its end.
    pub fn run(self) -> Outcome {
        self.start().wait()
    }

    /// Starts it. Its output goes to files: a grandchild that keeps a pipe open could otherwise block the campaign.
    pub fn start(self) -> Running {
        let [out, err] = [(); 2].map(|()| tempfile::tempfile().expect("a temporary file can be made"));
        let mut command = Command::new(&self.words[0]);
        command.args(&self.words[1..]).current_dir(&self.folder).stdin(Stdio::null()).process_group(0);
        // Makes leftover temporary files visible in the folder of the try.
        command.env("TMPDIR", self.folder.join("tmp")).env("RUST_BACKTRACE", "0").env_remove("PLUME_PYTHON");
        command.stdout(self.stdout.unwrap_or_else(|| out.try_clone().expect("a file can be opened twice")));
        command.stderr(err.try_clone().expect("a file can be opened twice"));
        let line = quoted(&self.words, self.prefix);
        let child = command.spawn().unwrap_or_else(|error| panic!("cannot run `{line}`: {error}"));
        Running { child, out, err, started: Instant::now(), limit: self.limit, line }
    }
}

/// A run that has been started.
pub struct Running {
    child: Child,
    out: File,
    err: File,
    started: Instant,
    limit: Duration,
    line: String,
}

impl Running {
    /// Asks it, but not its children, to stop.
    pub fn send(&self, signal: Signal) {
        let _ = kill_process(Pid::from_child(&self.child), signal);
    }

    /// Kills it and its children, like a power failure.
    pub fn kill(mut self) -> Outcome {
        self.stop();
        self.wait()
    }

    /// Sets the time limit, counted from now.
    pub fn within(mut self, limit: Duration) -> Self {
        self.limit = self.started.elapsed() + limit;
        self
    }

    /// The processes that it has started, as far as they run.
    pub fn children(&self) -> Vec<Pid> {
        let pid = self.child.id();
        let listed = fs::read_to_string(format!("/proc/{pid}/task/{pid}/children")).unwrap_or_default();
        listed.split_whitespace().filter_map(|child| Pid::from_raw(child.parse().ok()?)).collect()
    }

    /// Waits until it ends or its time limit is up; processes that it has left running go on.
    pub fn wait_alone(mut self) -> Outcome {
        let end = self.end();
        self.outcome(end)
    }

    /// Waits until it ends or its time limit is up.
    pub fn wait(mut self) -> Outcome {
        let end = self.end();
        // Processes that it has left running are killed with it.
        self.stop();
        self.outcome(end)
    }

    fn outcome(self, end: End) -> Outcome {
        let took = self.started.elapsed();
        let [stdout, stderr] = [self.out, self.err].map(text);
        Outcome { end, stdout, stderr, took, line: self.line }
    }

    fn end(&mut self) -> End {
        loop {
            if let Some(status) = self.child.try_wait().expect("a child can be waited for") {
                return end(status);
            }
            if self.started.elapsed() > self.limit {
                self.stop();
                let _ = self.child.wait();
                return End::Late;
            }
            sleep(GLANCE);
        }
    }

    fn stop(&mut self) {
        let _ = kill_process_group(Pid::from_child(&self.child), Signal::KILL);
    }
}

impl Outcome {
    /// Whether it succeeded.
    pub fn is_done(&self) -> bool {
        self.end == End::Code(0)
    }

    /// Fails unless it succeeded.
    pub fn done(&self) -> Result<(), String> {
        if self.is_done() { Ok(()) } else { Err(self.told("should have worked")) }
    }

    /// Fails unless it succeeded or refused with a short message: no panic, no signal, no hang, no flood of output.
    pub fn decent(&self) -> Result<(), String> {
        match self.end {
            End::Code(0) if self.stderr.len() <= MOST_WORDS => Ok(()),
            End::Code(PANIC) => Err(self.told("panicked")),
            End::Code(1 | 2 | 69 | 130) if self.stderr.trim().is_empty() => Err(self.told("gave no reason")),
            End::Code(1 | 2 | 69 | 130) if self.stderr.len() <= MOST_WORDS => Ok(()),
            End::Code(_) if self.stderr.len() > MOST_WORDS => {
                Err(self.told(&format!("said {} bytes", self.stderr.len())))
            }
            End::Late => Err(self.told("took too long")),
            _ => Err(self.told("ended badly")),
        }
    }

    /// Fails unless it refused cleanly, with exit code 1 or 2.
    pub fn refused(&self) -> Result<(), String> {
        self.decent()?;
        if matches!(self.end, End::Code(1 | 2)) { Ok(()) } else { Err(self.told("should have been refused")) }
    }

    /// The command line, how it ended and the start of its output, for reproduction.
    pub fn told(&self, verdict: &str) -> String {
        // The output of a successful run is a summary, which is not needed here.
        let said = if self.is_done() { "" } else { self.stderr.trim() };
        let said: String = said.replace('\n', " / ").chars().take(300).collect();
        let end = match self.end {
            End::Code(code) => format!("exit {code}"),
            End::Signal(signal) => format!("signal {signal}"),
            End::Late => format!("stopped after {:.0} s", self.took.as_secs_f64()),
        };
        let line = format!("`{}` {verdict}: {end}: {said}", self.line);
        line.trim_end_matches([':', ' ']).to_owned()
    }
}

fn end(status: ExitStatus) -> End {
    match (status.code(), status.signal()) {
        (Some(code), _) => End::Code(code),
        (None, signal) => End::Signal(signal.unwrap_or_default()),
    }
}

fn text(mut file: File) -> String {
    let mut bytes = Vec::new();
    let _ = file.rewind().and_then(|()| file.take(MOST_BYTES).read_to_end(&mut bytes));
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The command as a shell line, with the bare name of the program.
fn quoted(words: &[OsString], prefix: usize) -> String {
    let quote = |(at, word): (usize, &OsString)| {
        let word = if at == prefix { Path::new(word).file_name().unwrap_or(word) } else { word };
        let word: String = word.to_string_lossy().chars().take(200).collect();
        let is_plain = word.chars().all(|c| c.is_ascii_alphanumeric() || "-_=./,:+".contains(c));
        if is_plain && !word.is_empty() { word } else { format!("'{word}'") }
    };
    words.iter().enumerate().map(quote).collect::<Vec<_>>().join(" ")
}
