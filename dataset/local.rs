//! Makes the caves of a plan in processes of this machine.
//!
//! A worker is the same program, which is asked for caves by their numbers, one per line on its standard input, and answers each with
//! a line of JSON. It ends when its input does, so none outlives whoever asks. A worker that dies is replaced, and what it was asked
//! for is asked for again, but not for ever.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

use plume::cave::CaveError;
use plume::pipeline::PipelineError;
use plume::store::StoreError;
use plume_exporters::ExportError;
use serde::{Deserialize, Serialize};

/// How often a cave is asked for if workers die of it.
const ATTEMPTS: u32 = 3;
/// What a worker says first, once it has read the specification.
const READY: &str = "ready";
/// How often it is looked whether to stop.
const PATIENCE: Duration = Duration::from_millis(50);

/// How a worker is started.
#[derive(Clone, Debug)]
pub struct Worker {
    /// The `plume` command: a program and its first arguments.
    pub program: Vec<OsString>,
    /// The specification.
    pub spec: PathBuf,
    /// The folder of the dataset.
    pub root: PathBuf,
    /// Whether recipes may run programs.
    pub allows_programs: bool,
    /// Whether surveys may include files from outside their own folder.
    pub allows_outside_files: bool,
}

impl Worker {
    /// Its command line.
    ///
    /// # Panics
    /// If there is no program.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.program[0]);
        command.args(&self.program[1..]).arg("dataset").arg(&self.spec).arg("--output").arg(&self.root);
        command.args(["--worker", "--quiet", "--threads", "1"]);
        command.args(self.allows_programs.then_some("--allow-run"));
        command.args(self.allows_outside_files.then_some("--allow-outside"));
        command
    }
}

/// What a worker says of a cave.
#[derive(Debug, Serialize, Deserialize)]
pub struct Answer {
    /// Its number.
    pub item: usize,
    /// What it took.
    pub cpu_s: f64,
    /// Why it could not be made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// Whether no other can be made either, as the disk is full.
    #[serde(default)]
    pub is_final: bool,
}

/// Answers until the input ends: the life of a worker. Sets `stop` then, as nobody waits for what is being made.
///
/// # Errors
/// If an answer cannot be written.
pub fn serve(
    questions: impl BufRead + Send,
    mut answers: impl Write,
    stop: &AtomicBool,
    mut make: impl FnMut(usize) -> Result<f64, CaveError>,
) -> io::Result<()> {
    writeln!(answers, "{READY}")?;
    answers.flush()?;
    let (asked, numbers) = mpsc::channel();
    thread::scope(|scope| {
        scope.spawn(move || {
            for line in questions.lines().map_while(Result::ok) {
                if let Ok(number) = line.trim().parse() {
                    let _ = asked.send(number);
                }
            }
            stop.store(true, Ordering::Relaxed);
        });
        for item in numbers {
            let answer = match make(item) {
                Ok(cpu_s) => Answer { item, cpu_s, fault: None, is_final: false },
                Err(error) => Answer { item, cpu_s: 0.0, fault: Some(error.to_string()), is_final: is_final(&error) },
            };
            let line = serde_json::to_string(&answer).expect("it is plain data");
            writeln!(answers, "{line}")?;
            answers.flush()?;
        }
        Ok(())
    })
}

/// Whether an error is not that of a cave, so that all others would meet it too.
fn is_final(error: &CaveError) -> bool {
    let source = match error {
        CaveError::Interrupted | CaveError::Pipeline(PipelineError::Interrupted) => return true,
        CaveError::Export(ExportError::MissingPart { .. }) => return true,
        CaveError::Pipeline(PipelineError::Store(StoreError::Io { source, .. })) => source,
        CaveError::Export(ExportError::Io(source) | ExportError::Load { source, .. }) => source,
        _ => return false,
    };
    let of_the_disk = [
        ErrorKind::StorageFull,
        ErrorKind::QuotaExceeded,
        ErrorKind::FileTooLarge,
        ErrorKind::ReadOnlyFilesystem,
        ErrorKind::PermissionDenied,
    ];
    of_the_disk.contains(&source.kind())
}

/// Asks workers for caves, and hands on what they say in whatever order it comes.
///
/// # Errors
/// If a worker cannot be started; the first answer that is final; [`CaveError::Interrupted`] once `stop` is set.
pub fn ask(
    numbers: &[usize],
    workers: usize,
    worker: impl Fn() -> Command + Sync,
    stop: &AtomicBool,
    hear: &(dyn Fn(Answer) + Sync),
) -> Result<(), CaveError> {
    let left = Mutex::new(numbers.iter());
    let fault = Mutex::new(None);
    let is_over = AtomicBool::new(false);
    let end = |error: CaveError| {
        fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
        is_over.store(true, Ordering::Relaxed);
    };
    let is_stopped = || is_over.load(Ordering::Relaxed) || stop.load(Ordering::Relaxed);
    let next = || left.lock().unwrap_or_else(PoisonError::into_inner).next().filter(|_| !is_stopped()).copied();
    let running: Vec<Mutex<Option<Child>>> = (0..workers).map(|_| Mutex::new(None)).collect();
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        let handles: Vec<_> = running
            .iter()
            .map(|child| {
                let (next, end, worker) = (&next, &end, &worker);
                scope.spawn(move || {
                    let mut line = Line { child, pipes: None, worker };
                    while let Some(number) = next() {
                        match line.ask(number, &is_stopped) {
                            Ok(answer) => answer.into_iter().for_each(hear),
                            Err(error) => end(error),
                        }
                    }
                    line.close();
                })
            })
            .collect();
        // A worker that is asked for a cave is not waited for once there is a reason to stop.
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                if is_stopped() {
                    running.iter().for_each(kill);
                }
                thread::sleep(PATIENCE);
            }
        });
        for handle in handles {
            if handle.join().is_err() {
                end(CaveError::Failed("a thread that asks workers has panicked".into()));
            }
        }
        done.store(true, Ordering::Relaxed);
    });
    if stop.load(Ordering::Relaxed) {
        return Err(CaveError::Interrupted);
    }
    fault.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

fn kill(child: &Mutex<Option<Child>>) {
    if let Some(child) = child.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
        let _ = child.kill();
    }
}

/// The line to a worker.
struct Line<'a, W> {
    child: &'a Mutex<Option<Child>>,
    pipes: Option<(ChildStdin, BufReader<ChildStdout>)>,
    worker: &'a W,
}

impl<W: Fn() -> Command> Line<'_, W> {
    /// What a worker says of a cave; `None` if it was stopped.
    fn ask(&mut self, number: usize, is_stopped: &dyn Fn() -> bool) -> Result<Option<Answer>, CaveError> {
        let (mut has_started, mut end) = (false, String::new());
        for _ in 0..ATTEMPTS {
            if is_stopped() {
                return Ok(None);
            }
            has_started |= self.start()?;
            match self.try_to_ask(number) {
                Some(Answer { is_final: true, fault, .. }) => {
                    return Err(CaveError::Failed(fault.unwrap_or_default()));
                }
                Some(answer) => return Ok(Some(answer)),
                None => end = self.close(),
            }
        }
        if !has_started {
            return Err(CaveError::Failed(format!("no worker starts: {ATTEMPTS} ended at once, the last with {end}")));
        }
        let fault = format!("{ATTEMPTS} workers died of it, the last with {end}; perhaps of too little memory");
        Ok(Some(Answer { item: number, cpu_s: 0.0, fault: Some(fault), is_final: false }))
    }

    /// Starts a worker unless there is one; whether it is ready.
    fn start(&mut self) -> Result<bool, CaveError> {
        if self.pipes.is_some() {
            return Ok(true);
        }
        let mut command = (self.worker)();
        let failed = |error| CaveError::Failed(format!("cannot start a worker: {error}"));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let questions = child.stdin.take().expect("it is piped");
        let mut answers = BufReader::new(child.stdout.take().expect("it is piped"));
        *self.child.lock().unwrap_or_else(PoisonError::into_inner) = Some(child);
        let mut greeting = String::new();
        let is_ready = answers.read_line(&mut greeting).is_ok() && greeting.trim_end() == READY;
        self.pipes = Some((questions, answers));
        Ok(is_ready)
    }

    /// What the worker says of a cave; `None` if it dies.
    fn try_to_ask(&mut self, number: usize) -> Option<Answer> {
        let (questions, answers) = self.pipes.as_mut()?;
        writeln!(questions, "{number}").and_then(|()| questions.flush()).ok()?;
        let mut line = String::new();
        answers.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok().filter(|answer: &Answer| answer.item == number)
    }

    /// Ends the worker by ending its input; how it ended.
    fn close(&mut self) -> String {
        self.pipes = None;
        let child = self.child.lock().unwrap_or_else(PoisonError::into_inner).take();
        let status = child.and_then(|mut child| child.wait().ok());
        status.map(|status| status.to_string()).unwrap_or_default()
    }
}
