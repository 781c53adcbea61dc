//! Long work that Ctrl-C can stop.
//!
//! The work runs on a separate thread, without the interpreter lock. The calling thread releases the lock too and wakes a
//! few times a second: to let Python handle signals, which it does in its main thread only, and to report progress. Handlers
//! and callbacks that raise set the stop flag of the pipeline; units of work in progress are finished first, so that no
//! half-written file is left. Threads of the pool end with the work, so the process may fork afterwards.

use std::any::Any;
use std::ffi::CString;
use std::mem;
use std::num::NonZeroUsize;
use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use plume::cave::CaveError;
use plume::pipeline::Observer;
use plume::store::Stage;
use plume_dataset::Reply;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::error;

/// How long a signal may wait: short for a human, long for a CPU.
const PAUSE: Duration = Duration::from_millis(50);

/// Runs `work`. `progress` is called from time to time as `progress(stage, done, total)` on the calling thread.
///
/// # Errors
/// Those of the work as Python exceptions; what a signal handler or `progress` raised.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> Result<T, CaveError> + Send,
) -> PyResult<T> {
    let (watch, ended) = (Watch::default(), AtomicBool::new(false));
    let (result, raised) = thread::scope(|scope| {
        let wake = Wake { caller: thread::current(), ended: &ended };
        let worker = thread::Builder::new().spawn_scoped(scope, || {
            let _wake = wake;
            work(&watch)
        })?;
        let mut raised = Ok(());
        let mut told = None;
        while !ended.load(Ordering::Acquire) {
            py.detach(|| thread::park_timeout(PAUSE));
            let attended = py.check_signals().and_then(|()| watch.warn_in(py));
            let attended = attended.and_then(|()| watch.tell(progress, &mut told));
            if attended.is_err() {
                watch.stop.store(true, Ordering::Relaxed);
                raised = raised.and(attended);
            }
        }
        let raised = raised.and_then(|()| watch.warn_in(py));
        PyResult::Ok((worker.join(), raised))
    })?;
    raised?;
    outcome(py, result)
}

/// Runs work that takes no longer than reading a file, without the interpreter lock.
///
/// # Errors
/// Those of the work as Python exceptions.
pub fn briefly<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T, CaveError> + Send) -> PyResult<T> {
    outcome(py, py.detach(|| panic::catch_unwind(AssertUnwindSafe(work))))
}

/// Runs `work` on this many threads, or on one per core.
///
/// # Errors
/// If the system refuses to start threads.
pub fn on_threads<T: Send>(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> Result<T, CaveError> + Send,
) -> Result<T, CaveError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, NonZeroUsize::get)).build();
    let refused = |error: rayon::ThreadPoolBuildError| CaveError::Failed(format!("cannot start threads: {error}"));
    pool.map_err(refused)?.install(work)
}

/// Wakes the caller when the work ends, even by a panic.
struct Wake<'a> {
    caller: thread::Thread,
    ended: &'a AtomicBool,
}

impl Drop for Wake<'_> {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        self.caller.unpark();
    }
}

/// The progress of the work, and whether it is to stop.
#[derive(Default)]
pub struct Watch {
    stop: AtomicBool,
    programs: AtomicBool,
    outside_files: AtomicBool,
    progress: Mutex<Option<Progress>>,
    warnings: Mutex<Vec<String>>,
}

#[derive(Clone, Copy, PartialEq)]
struct Progress {
    stage: &'static str,
    done: usize,
    total: usize,
}

impl Watch {
    /// Sets whether recipes may run programs.
    pub fn allow_programs(&self, allowed: bool) {
        self.programs.store(allowed, Ordering::Relaxed);
    }

    /// Sets whether files may refer to files outside their folder.
    pub fn allow_outside_files(&self, allowed: bool) {
        self.outside_files.store(allowed, Ordering::Relaxed);
    }

    fn set(&self, change: impl FnOnce(&mut Option<Progress>)) {
        change(&mut self.progress.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn step(&self) {
        self.set(|progress| {
            if let Some(progress) = progress {
                progress.done += 1;
            }
        });
    }

    /// Issues the warnings that have come since the last call.
    fn warn_in(&self, py: Python<'_>) -> PyResult<()> {
        let warnings = mem::take(&mut *self.warnings.lock().unwrap_or_else(PoisonError::into_inner));
        let category = py.get_type::<PyUserWarning>();
        for warning in warnings {
            PyErr::warn(py, &category, &CString::new(warning)?, 1)?;
        }
        Ok(())
    }

    fn tell(&self, to: Option<&Bound<'_, PyAny>>, told: &mut Option<Progress>) -> PyResult<()> {
        let now = *self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((to, now)) = to.zip(now).filter(|(_, now)| *told != Some(*now)) else {
            return Ok(());
        };
        *told = Some(now);
        to.call1((now.stage, now.done, now.total)).map(drop)
    }
}

impl Observer for Watch {
    fn begin(&self, stage: Stage, total: usize) {
        self.set(|progress| *progress = Some(Progress { stage: stage.name(), done: 0, total }));
    }

    fn advance(&self, _stage: Stage) {
        self.step();
    }

    fn end(&self, _stage: Stage) {}

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    fn warn(&self, warning: &str) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning.to_owned());
    }

    fn allows_programs(&self) -> bool {
        self.programs.load(Ordering::Relaxed)
    }

    fn allows_outside_files(&self) -> bool {
        self.outside_files.load(Ordering::Relaxed)
    }
}

impl plume_dataset::Watch for Watch {
    fn begin_caves(&self, all: usize, done: usize) {
        self.set(|progress| *progress = Some(Progress { stage: "caves", done, total: all }));
    }

    fn cave_done(&self, _: &Reply) {
        self.step();
    }

    fn end_caves(&self) {}
}

fn outcome<T>(py: Python<'_>, result: thread::Result<Result<T, CaveError>>) -> PyResult<T> {
    match result {
        Ok(result) => result.map_err(|error| error::raised(py, &error)),
        Err(panic) => Err(error::internal(py, panic_text(&*panic))),
    }
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message")
}
