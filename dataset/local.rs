//! Makes the caves of a plan in worker processes on this machine.
//!
//! A worker is the same program. It reads the numbers of caves from its standard input, one per line, and replies to each with
//! a line of JSON. It ends when its input does, so none outlives the run that started it. A worker that dies is replaced, and its
//! request repeated, but not for ever.

use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

use plume::cave::CaveError;

use crate::engine::{Engine, Reply};
use crate::plan::Plan;

/// How often a cave is requested if workers die of it.
const ATTEMPTS: u32 = 3;
/// What a worker says first, once it has read the specification.
const READY: &str = "ready";
/// How often the stop flag is read.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Worker processes as the engine of a dataset.
#[derive(Clone, Debug)]
pub struct Processes {
    /// How each is started.
    pub worker: Worker,
    /// How many there are at most.
    pub count: usize,
}

impl Engine for Processes {
    fn make(
        &self,
        _plan: &Plan,
        numbers: &[usize],
        root: &Path,
        stop: &AtomicBool,
        on_reply: &(dyn Fn(Reply) + Sync),
    ) -> Result<(), CaveError> {
        dispatch(numbers, self.count.min(numbers.len()), || self.worker.command(root), stop, on_reply)
    }
}

/// How a worker is started.
#[derive(Clone, Debug)]
pub struct Worker {
    /// The `plume` command: a program and its first arguments.
    pub program: Vec<OsString>,
    /// The specification.
    pub spec: PathBuf,
    /// Whether recipes may run programs.
    pub allows_programs: bool,
    /// Whether surveys may include files from outside their own folder.
    pub allows_outside_files: bool,
}

impl Worker {
    /// Its command line; `root` is the folder of the dataset.
    ///
    /// # Panics
    /// If there is no program.
    pub fn command(&self, root: &Path) -> Command {
        let mut command = Command::new(&self.program[0]);
        command.args(&self.program[1..]).arg("dataset").arg(&self.spec).arg("--output").arg(root);
        command.args(["--worker", "--quiet", "--threads", "1"]);
        command.args(self.allows_programs.then_some("--allow-run"));
        command.args(self.allows_outside_files.then_some("--allow-outside"));
        command
    }
}

/// Serves requests until the input ends, as a worker does. Sets `stop` then, as nobody waits for what is being made.
///
/// # Errors
/// If a reply cannot be written.
pub fn serve(
    requests: impl BufRead + Send,
    mut replies: impl Write,
    stop: &AtomicBool,
    mut make: impl FnMut(usize) -> Result<f64, CaveError>,
) -> io::Result<()> {
    writeln!(replies, "{READY}")?;
    replies.flush()?;
    let (requested, numbers) = mpsc::channel();
    thread::scope(|scope| {
        scope.spawn(move || {
            for line in requests.lines().map_while(Result::ok) {
                if let Ok(number) = line.trim().parse() {
                    let _ = requested.send(number);
                }
            }
            stop.store(true, Ordering::Relaxed);
        });
        for item in numbers {
            let line = serde_json::to_string(&Reply::of(item, make(item))).expect("it is plain data");
            writeln!(replies, "{line}")?;
            replies.flush()?;
        }
        Ok(())
    })
}

/// Requests caves from workers, and passes on their replies in whatever order they come.
///
/// # Errors
/// If a worker cannot be started; the first reply that is final; [`CaveError::Interrupted`] once `stop` is set.
pub fn dispatch(
    numbers: &[usize],
    workers: usize,
    worker: impl Fn() -> Command + Sync,
    stop: &AtomicBool,
    on_reply: &(dyn Fn(Reply) + Sync),
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
                    let mut connection = Connection { child, pipes: None, worker };
                    while let Some(number) = next() {
                        match connection.request(number, &is_stopped) {
                            Ok(reply) => reply.into_iter().for_each(on_reply),
                            Err(error) => end(error),
                        }
                    }
                    connection.close();
                })
            })
            .collect();
        // Workers that are making a cave are not waited for once there is a reason to stop.
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                if is_stopped() {
                    running.iter().for_each(kill);
                }
                thread::sleep(POLL_INTERVAL);
            }
        });
        for handle in handles {
            if handle.join().is_err() {
                end(CaveError::Failed("a thread of a worker has panicked".into()));
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

/// The connection to a worker.
struct Connection<'a, W> {
    child: &'a Mutex<Option<Child>>,
    pipes: Option<(ChildStdin, BufReader<ChildStdout>)>,
    worker: &'a W,
}

impl<W: Fn() -> Command> Connection<'_, W> {
    /// The reply of a worker; `None` if work was stopped.
    fn request(&mut self, number: usize, is_stopped: &dyn Fn() -> bool) -> Result<Option<Reply>, CaveError> {
        let (mut has_started, mut end) = (false, String::new());
        for _ in 0..ATTEMPTS {
            if is_stopped() {
                return Ok(None);
            }
            has_started |= self.start()?;
            match self.exchange(number) {
                Some(Reply { is_final: true, fault, .. }) => {
                    return Err(CaveError::Failed(fault.unwrap_or_default()));
                }
                Some(reply) => return Ok(Some(reply)),
                None => end = self.close(),
            }
        }
        if !has_started {
            return Err(CaveError::Failed(format!("no worker starts: {ATTEMPTS} ended at once, the last with {end}")));
        }
        let fault = format!("{ATTEMPTS} workers died of it, the last with {end}; perhaps of too little memory");
        Ok(Some(Reply { item: number, cpu_s: 0.0, fault: Some(fault), is_final: false }))
    }

    /// Starts a worker unless there is one; whether it is ready.
    fn start(&mut self) -> Result<bool, CaveError> {
        if self.pipes.is_some() {
            return Ok(true);
        }
        let mut command = (self.worker)();
        let failed = |error| CaveError::Failed(format!("cannot start a worker: {error}"));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
        let requests = child.stdin.take().expect("it is piped");
        let mut replies = BufReader::new(child.stdout.take().expect("it is piped"));
        *self.child.lock().unwrap_or_else(PoisonError::into_inner) = Some(child);
        let mut greeting = String::new();
        let is_ready = replies.read_line(&mut greeting).is_ok() && greeting.trim_end() == READY;
        self.pipes = Some((requests, replies));
        Ok(is_ready)
    }

    /// The reply of the worker; `None` if it dies.
    fn exchange(&mut self, number: usize) -> Option<Reply> {
        let (requests, replies) = self.pipes.as_mut()?;
        writeln!(requests, "{number}").and_then(|()| requests.flush()).ok()?;
        let mut line = String::new();
        replies.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok().filter(|reply: &Reply| reply.item == number)
    }

    /// Ends the worker by ending its input; how it ended.
    fn close(&mut self) -> String {
        self.pipes = None;
        let child = self.child.lock().unwrap_or_else(PoisonError::into_inner).take();
        let status = child.and_then(|mut child| child.wait().ok());
        status.map(|status| status.to_string()).unwrap_or_default()
    }
}
