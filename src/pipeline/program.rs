//! Runs a program that may hang, flood its output, lie or leave child processes behind.
//!
//! Its input and output are unnamed files rather than pipes, so that Plume never waits for a process that holds them open.
//! It runs in its own process group, which is killed with it. On Linux so is every process it has started, in whatever
//! session, recognised by the [`Mark`] in its environment; one started with a different environment is missed.

use std::ffi::OsString;
use std::fs::File;
use std::hash::{BuildHasher, RandomState};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use plume_graph::{RunError, Task};

/// How often a running program is polled.
const GLANCE: Duration = Duration::from_millis(10);
/// How much of its standard error is shown, and how much it may write.
const SHOWN_BYTES: u64 = 2000;
const MOST_WORDS_BYTES: u64 = 64 << 20;

/// What a program sees of our environment. Anything else may be a secret, and would make the graph depend on the user.
const PASSED_ON: &[&str] = &["PATH", "HOME", "USER", "LANG", "TZ", "TMPDIR"];
/// And all variables with this prefix.
const PASSED_ON_PREFIX: &str = "LC_";
/// What programs on Windows need to start.
#[cfg(windows)]
const PASSED_ON_HERE: &[&str] = &[
    "SystemRoot",
    "SystemDrive",
    "windir",
    "ComSpec",
    "PATHEXT",
    "TEMP",
    "TMP",
    "USERPROFILE",
    "APPDATA",
    "LOCALAPPDATA",
];
#[cfg(not(windows))]
const PASSED_ON_HERE: &[&str] = &[];

/// Runs the program and returns its standard output.
///
/// # Errors
/// If it does not start, fails, takes too long, writes too much, or `stop` is set.
pub fn run(task: &Task, stop: &AtomicBool) -> Result<Vec<u8>, RunError> {
    let mark = Mark::new();
    let mut streams = Streams::new(&task.input).map_err(|error| {
        fault(
            format!("its input and output cannot be set up: {error}"),
            "free some space in the folder for temporary files",
        )
    })?;
    let mut child = started(task, &streams, &mark)?;
    let end = wait(&mut child, task, stop, &streams);
    end_all(&mut child, &mark);
    let words = streams.last_words();
    let status = end.map_err(|fault| with_words(fault, &words))?;
    if !status.success() {
        return Err(with_words(fault(format!("failed ({status})"), "fix the program or its settings"), &words));
    }
    streams.refuse_flood(task).map_err(|fault| with_words(fault, &words))?;
    streams.told().map_err(|error| fault(format!("its output cannot be read: {error}"), ""))
}

/// Its input and output, in unnamed files.
struct Streams {
    input: File,
    output: File,
    words: File,
}

impl Streams {
    fn new(input: &[u8]) -> io::Result<Self> {
        let mut streams =
            Self { input: tempfile::tempfile()?, output: tempfile::tempfile()?, words: tempfile::tempfile()? };
        streams.input.write_all(input)?;
        streams.input.rewind()?;
        Ok(streams)
    }

    /// Fails if the output exceeds its limit. Polled, so slightly more than the limit may be on the disk.
    fn refuse_flood(&self, task: &Task) -> Result<(), RunError> {
        if length(&self.output) > task.most_bytes as u64 {
            let message = format!("wrote more than {} bytes", task.most_bytes);
            return Err(fault(message, "raise `size_limit_mb`, or fix the program"));
        }
        if length(&self.words) > MOST_WORDS_BYTES {
            let message = format!("wrote more than {} MiB to standard error", MOST_WORDS_BYTES >> 20);
            return Err(fault(message, "make the program print less"));
        }
        Ok(())
    }

    fn told(&mut self) -> io::Result<Vec<u8>> {
        let mut told = Vec::new();
        self.output.rewind()?;
        self.output.read_to_end(&mut told)?;
        Ok(told)
    }

    /// The end of its standard error; empty if that cannot be read.
    fn last_words(&mut self) -> Vec<u8> {
        let mut words = Vec::new();
        let start = length(&self.words).saturating_sub(SHOWN_BYTES);
        let read = self.words.seek(SeekFrom::Start(start));
        let _ = read.and_then(|_| (&self.words).take(SHOWN_BYTES).read_to_end(&mut words));
        words
    }
}

/// Size of a file; 0 if it cannot be determined.
fn length(file: &File) -> u64 {
    file.metadata().map_or(0, |about| about.len())
}

fn started(task: &Task, streams: &Streams, mark: &Mark) -> Result<Child, RunError> {
    let refused = |error: io::Error| match error.kind() {
        ErrorKind::NotFound => fault(
            "there is no such program, or no such folder to run it in".to_owned(),
            "give its path relative to the recipe (./name), or a name on the search path",
        ),
        ErrorKind::PermissionDenied => fault("may not be run".to_owned(), "make the file executable"),
        _ => fault(error.to_string(), ""),
    };
    let mut command = Command::new(&task.program);
    command.args(&task.arguments).current_dir(&task.folder);
    command.env_clear().envs(passed_on(&task.environment)).env(Mark::VARIABLE, &mark.0);
    let files = [&streams.input, &streams.output, &streams.words].map(File::try_clone);
    let [input, output, words] = files;
    command.stdin(input.map_err(refused)?).stdout(output.map_err(refused)?).stderr(words.map_err(refused)?);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command.spawn().map_err(refused)
}

/// The environment variables that a program sees: the usual ones, and those named in its recipe.
fn passed_on(named: &[String]) -> impl Iterator<Item = (OsString, OsString)> {
    std::env::vars_os().filter(|(name, _)| {
        let Some(name) = name.to_str() else { return false };
        let is = |other: &str| if cfg!(windows) { name.eq_ignore_ascii_case(other) } else { name == other };
        PASSED_ON.iter().chain(PASSED_ON_HERE).any(|other| is(other))
            || name.starts_with(PASSED_ON_PREFIX)
            || named.iter().any(|other| is(other))
    })
}

/// Waits for the end of the program.
fn wait(child: &mut Child, task: &Task, stop: &AtomicBool, streams: &Streams) -> Result<ExitStatus, RunError> {
    let started = Instant::now();
    loop {
        if stop.load(Ordering::Relaxed) {
            return Err(fault("was interrupted".to_owned(), ""));
        }
        if started.elapsed() > task.limit {
            let message = format!("took longer than {} s", task.limit.as_secs_f64());
            return Err(fault(message, "raise `time_limit_s`, or fix the program"));
        }
        streams.refuse_flood(task)?;
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status),
            Ok(None) => thread::sleep(GLANCE),
            Err(error) => return Err(fault(error.to_string(), "")),
        }
    }
}

/// Kills the program and all processes that it left behind.
fn end_all(child: &mut Child, mark: &Mark) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    let _ = child.wait();
    mark.end_all_who_carry_it();
}

/// An environment variable by which a program and its descendants are recognised.
struct Mark(String);

impl Mark {
    const VARIABLE: &str = "PLUME_RUN";

    fn new() -> Self {
        // From the random keys of hash maps; it has to be unique, not secret.
        let [one, other] = [(); 2].map(|()| RandomState::new().hash_one(std::process::id()));
        Self(format!("{one:016x}{other:016x}"))
    }

    /// Repeated, because a process may start another in the meantime.
    #[cfg(target_os = "linux")]
    fn end_all_who_carry_it(&self) {
        const ROUNDS: usize = 100;
        for _ in 0..ROUNDS {
            if !self.end_some() {
                return;
            }
            thread::sleep(GLANCE);
        }
    }

    #[cfg(not(target_os = "linux"))]
    fn end_all_who_carry_it(&self) {}

    /// Kills the processes that exist now. Whether there were any.
    #[cfg(target_os = "linux")]
    fn end_some(&self) -> bool {
        use rustix::process::{Pid, PidfdFlags, Signal, pidfd_open, pidfd_send_signal};
        let variable = format!("{}={}", Self::VARIABLE, self.0);
        let mut found = false;
        for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
            let pid = entry.file_name().to_str().and_then(|name| name.parse().ok()).and_then(Pid::from_raw);
            // Held open so that the id cannot be reused by another process.
            let Some(process) = pid.and_then(|pid| pidfd_open(pid, PidfdFlags::empty()).ok()) else { continue };
            let Ok(environment) = std::fs::read(entry.path().join("environ")) else { continue };
            if environment.split(|&byte| byte == 0).any(|one| one == variable.as_bytes()) {
                found |= pidfd_send_signal(&process, Signal::KILL).is_ok();
            }
        }
        found
    }
}

fn fault(message: String, hint: &str) -> RunError {
    RunError { message, hint: hint.to_owned() }
}

/// The fault with the last output of the program.
fn with_words(fault: RunError, words: &[u8]) -> RunError {
    let words = String::from_utf8_lossy(words);
    let words: String = words.trim().chars().filter(|c| !c.is_control() || *c == '\n').collect();
    if words.is_empty() {
        return fault;
    }
    let lines: String = words.lines().map(|line| format!("\n   | {line}")).collect();
    RunError { message: format!("{}; its last output:{lines}", fault.message), ..fault }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, limit_s: f64) -> Task {
        Task {
            program: "sh".into(),
            arguments: vec!["-c".into(), script.into()],
            folder: ".".into(),
            input: b"seven\n".to_vec(),
            environment: Vec::new(),
            limit: Duration::from_secs_f64(limit_s),
            most_bytes: 1000,
        }
    }

    fn outcome(script: &str, limit_s: f64) -> String {
        match run(&shell(script, limit_s), &AtomicBool::new(false)) {
            Ok(told) => String::from_utf8_lossy(&told).into_owned(),
            Err(error) => format!("error: {error}"),
        }
    }

    #[test]
    fn a_program_reads_and_writes() {
        assert_eq!(outcome("read word; echo got $word", 20.0), "got seven\n");
        assert_eq!(outcome("echo deaf", 20.0), "deaf\n");
    }

    #[test]
    fn the_last_output_of_a_failing_program_is_shown() {
        let told = outcome("echo no rock >&2; exit 3", 20.0);
        assert!(told.contains("exit status: 3") && told.contains("| no rock"), "{told}");
    }

    #[test]
    fn a_program_that_hangs_is_stopped_with_its_children() {
        assert!(outcome("sleep 1000 & sleep 1000", 0.2).contains("took longer than 0.2 s"));
    }

    #[test]
    fn a_program_that_floods_is_stopped() {
        assert!(outcome("yes", 20.0).contains("wrote more than 1000 bytes"));
        assert_eq!(outcome("yes >&2 & echo fine; kill $!", 20.0), "fine\n");
    }

    #[test]
    fn a_child_left_behind_does_not_block() {
        assert_eq!(outcome("sleep 1000 & echo done", 20.0), "done\n");
    }

    /// The number of processes that sleep for this many seconds; no other process does.
    #[cfg(target_os = "linux")]
    fn sleepers(seconds: &str) -> usize {
        let entries = std::fs::read_dir("/proc").expect("there are processes").flatten();
        let lines = entries.filter_map(|entry| std::fs::read(entry.path().join("cmdline")).ok());
        lines.filter(|line| *line == format!("sleep\0{seconds}\0").as_bytes()).count()
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_grandchild_in_its_own_session_does_not_block_and_is_killed() {
        let script = "setsid sleep 98765 & (setsid sh -c 'sleep 98765' &) ; sleep 0.1; echo done";
        let start = Instant::now();
        assert_eq!(outcome(script, 20.0), "done\n");
        assert!(start.elapsed() < Duration::from_secs(10));
        assert_eq!(sleepers("98765"), 0);
    }

    #[test]
    fn a_program_sees_what_it_needs_and_what_is_named() {
        let told = outcome("env", 20.0);
        let names = told.lines().filter_map(|line| Some(line.split_once('=')?.0));
        let known = ["PWD", "SHLVL", "_", "OLDPWD", Mark::VARIABLE];
        for name in names {
            assert!(known.contains(&name) || PASSED_ON.contains(&name) || name.starts_with("LC_"), "{name} in\n{told}");
        }
        assert!(told.contains("PATH="), "{told}");
    }

    #[test]
    fn a_program_that_floods_standard_error_is_stopped() {
        assert!(outcome("yes >&2", 20.0).contains("wrote more than 64 MiB to standard error"));
    }

    #[test]
    fn ctrl_c_stops_it() {
        let error = run(&shell("sleep 1000", 20.0), &AtomicBool::new(true)).expect_err("it was stopped");
        assert_eq!(error.message, "was interrupted");
    }

    #[test]
    fn a_missing_program_is_reported() {
        let task = Task { program: "./no-such-program".into(), ..shell("", 20.0) };
        let error = run(&task, &AtomicBool::new(false)).expect_err("there is none");
        assert!(error.message.contains("no such program"), "{error}");
    }
}
