//! Parallel checks: most readers keep only one core busy.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use crate::tools::Result;

/// A check of a package. Returns a summary, or what is wrong.
pub(super) struct Check {
    who: &'static str,
    ask: Box<dyn FnOnce() -> Result<String> + Send>,
}

impl Check {
    pub(super) fn new(who: &'static str, ask: impl FnOnce() -> Result<String> + Send + 'static) -> Self {
        Self { who, ask: Box::new(ask) }
    }
}

/// Puts all checks by a reader but its first behind those by others: where the first run of a program compiles what the later ones
/// load, two that start together would both compile it.
pub(super) fn first_ahead(who: &str, checks: Vec<Check>) -> Vec<Check> {
    let first = checks.iter().position(|check| check.who == who);
    let is_later = |(place, check): &(usize, Check)| check.who == who && Some(*place) != first;
    let (later, sooner): (Vec<_>, Vec<_>) = checks.into_iter().enumerate().partition(is_later);
    sooner.into_iter().chain(later).map(|(_, check)| check).collect()
}

/// Prints a line per check and counts what must fail the run.
#[derive(Default)]
pub(super) struct Tally {
    failures: AtomicUsize,
}

impl Tally {
    /// Runs all checks, as many in parallel as there are cores.
    pub(super) fn run(&self, checks: Vec<Check>) {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let queue = Mutex::new(VecDeque::from(checks));
        let work = || {
            while let Some(check) = { queue.lock().expect("no worker panics").pop_front() } {
                self.ask(check);
            }
        };
        std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    }

    fn ask(&self, check: Check) {
        let (who, started) = (check.who, Instant::now());
        let answer = (check.ask)();
        let seconds = started.elapsed().as_secs();
        match answer {
            Ok(summary) => println!("ok      {who:<10} {seconds:>3} s  {}", summary.lines().last().unwrap_or_default()),
            Err(reason) => {
                self.failures.fetch_add(1, Ordering::Relaxed);
                println!("FAILED  {who:<10} {seconds:>3} s  {reason}");
            }
        }
    }

    /// A reader that is not available fails the run if the environment variable `CI` is set.
    pub(super) fn skip(&self, who: &str, missing: &str) {
        self.failures.fetch_add(usize::from(std::env::var_os("CI").is_some()), Ordering::Relaxed);
        println!("SKIPPED {who:<10} {missing}");
    }

    pub(super) fn failures(&self) -> usize {
        self.failures.load(Ordering::Relaxed)
    }

    pub(super) fn result(&self) -> Result<()> {
        match self.failures() {
            0 => Ok(()),
            count => Err(format!("{count} of the checks above failed")),
        }
    }
}
