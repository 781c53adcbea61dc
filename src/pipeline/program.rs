//! Runs a program that may hang, flood or lie.
//!
//! Its standard input, output and error are served by a thread each, so that none of them can block another. It runs in a
//! process group of its own, and where the system has such groups its children are stopped with it.

use std::io::{ErrorKind, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::graph::{RunError, Task};

/// How often a running program is looked at.
const GLANCE: Duration = Duration::from_millis(10);
/// How long the last output of an ended program may take to arrive.
const LAST_WORDS: Duration = Duration::from_secs(1);
/// How much of its standard error is shown.
const SHOWN_BYTES: usize = 2000;

/// Runs the program to its end and gives its standard output.
///
/// # Errors
/// When it does not start, fails, takes too long, writes too much, or `stop` is set.
pub fn run(task: &Task, stop: &AtomicBool) -> Result<Vec<u8>, RunError> {
    let mut child = started(task)?;
    serve_input(&mut child, task.input.clone());
    let output = collected(child.stdout.take(), task.most_bytes.saturating_add(1));
    let words = collected(child.stderr.take(), usize::MAX);
    let end = wait(&mut child, task, stop, &output);
    stop_group(&mut child);
    let words = words.recv_timeout(LAST_WORDS).unwrap_or_default();
    let (status, told) = end.map_err(|fault| with_words(fault, &words))?;
    if !status.success() {
        return Err(with_words(fault(format!("failed ({status})"), "mend the program, or its settings"), &words));
    }
    Ok(told)
}

fn started(task: &Task) -> Result<Child, RunError> {
    let mut command = Command::new(&task.program);
    command.args(&task.arguments).current_dir(&task.folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command.spawn().map_err(|error| match error.kind() {
        ErrorKind::NotFound => fault(
            "there is no such program, or no such folder to run it in".to_owned(),
            "give its path relative to the recipe (./name), or a name on the search path",
        ),
        ErrorKind::PermissionDenied => fault("may not be run".to_owned(), "make the file executable"),
        _ => fault(error.to_string(), ""),
    })
}

/// Writes the input; a program that does not read it is not at fault.
fn serve_input(child: &mut Child, input: Vec<u8>) {
    if let Some(mut pipe) = child.stdin.take() {
        thread::spawn(move || {
            let _ = pipe.write_all(&input);
        });
    }
}

/// What a pipe brings until it ends, at most `most` bytes; the rest of a longer one stays unread, or is dropped.
fn collected(pipe: Option<impl Read + Send + 'static>, most: usize) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let Some(mut pipe) = pipe else { return };
        if most < usize::MAX {
            let _ = pipe.take(most as u64).read_to_end(&mut bytes);
        } else {
            keep_last(&mut pipe, &mut bytes);
        }
        let _ = sender.send(bytes);
    });
    receiver
}

/// Reads to the end and keeps the last words.
fn keep_last(pipe: &mut impl Read, kept: &mut Vec<u8>) {
    let mut block = [0; 4096];
    while let Ok(read @ 1..) = pipe.read(&mut block) {
        kept.extend_from_slice(&block[..read]);
        let surplus = kept.len().saturating_sub(SHOWN_BYTES);
        kept.drain(..surplus);
    }
}

/// Waits for the end of the program and of its output.
fn wait(
    child: &mut Child,
    task: &Task,
    stop: &AtomicBool,
    output: &Receiver<Vec<u8>>,
) -> Result<(ExitStatus, Vec<u8>), RunError> {
    let started = Instant::now();
    let mut told = None;
    loop {
        if stop.load(Ordering::Relaxed) {
            return Err(fault("was interrupted".to_owned(), ""));
        }
        if started.elapsed() > task.limit {
            let message = format!("took longer than {} s", task.limit.as_secs_f64());
            return Err(fault(message, "raise `time_limit_s`, or mend the program"));
        }
        match output.recv_timeout(GLANCE) {
            Ok(bytes) => told = Some(bytes),
            Err(RecvTimeoutError::Disconnected) if told.is_some() => thread::sleep(GLANCE),
            Err(_) => {}
        }
        if told.as_ref().is_some_and(|bytes| bytes.len() > task.most_bytes) {
            let message = format!("wrote more than {} bytes", task.most_bytes);
            return Err(fault(message, "raise `size_limit_mb`, or mend the program"));
        }
        if let Ok(Some(status)) = child.try_wait() {
            // A child that it left behind may hold the pipe open.
            stop_group(child);
            let told = told.or_else(|| output.recv_timeout(LAST_WORDS).ok()).unwrap_or_default();
            return Ok((status, told));
        }
    }
}

/// Ends the program and the children that it left behind.
fn stop_group(child: &mut Child) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    let _ = child.wait();
}

fn fault(message: String, hint: &str) -> RunError {
    RunError { message, hint: hint.to_owned() }
}

/// The fault with what the program said last.
fn with_words(fault: RunError, words: &[u8]) -> RunError {
    let words = String::from_utf8_lossy(words);
    let words: String = words.trim().chars().filter(|c| !c.is_control() || *c == '\n').collect();
    if words.is_empty() {
        return fault;
    }
    let lines: String = words.lines().map(|line| format!("\n   | {line}")).collect();
    RunError { message: format!("{}; its last words:{lines}", fault.message), ..fault }
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
    fn a_program_that_fails_has_the_last_word() {
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
    fn a_child_left_behind_holds_nobody_up() {
        assert_eq!(outcome("sleep 1000 & echo done", 20.0), "done\n");
    }

    #[test]
    fn ctrl_c_stops_it() {
        let error = run(&shell("sleep 1000", 20.0), &AtomicBool::new(true)).expect_err("it was stopped");
        assert_eq!(error.message, "was interrupted");
    }

    #[test]
    fn a_program_that_is_none_is_told() {
        let task = Task { program: "./no-such-program".into(), ..shell("", 20.0) };
        let error = run(&task, &AtomicBool::new(false)).expect_err("there is none");
        assert!(error.message.contains("no such program"), "{error}");
    }
}
