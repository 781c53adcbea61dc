//! Signals that end a run: Ctrl-C, and those that a system or a supervisor sends.
//!
//! The first one sets a flag: units of work in progress are finished, a program run by a recipe is stopped, temporary files
//! are removed. The second one ends the process immediately, as it would have by default. Only the command line listens; a
//! host program that uses Plume as a library keeps its own handlers.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Set by the first signal. One per process, because signals are sent to processes.
static STOP: AtomicBool = AtomicBool::new(false);
/// The exit code that the first signal asks for.
static CODE: AtomicUsize = AtomicUsize::new(FIRST_CODE + SIGINT as usize);
static LISTEN: Once = Once::new();

/// What shells add to the signal number: 130 after Ctrl-C, 143 after SIGTERM, 129 after SIGHUP.
const FIRST_CODE: usize = 128;
#[cfg(unix)]
const ENDING: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const ENDING: [i32; 2] = [SIGINT, SIGTERM];

/// Set once the run is to stop.
pub fn stop() -> &'static AtomicBool {
    &STOP
}

/// What an interrupted run exits with.
pub fn exit_code() -> u8 {
    u8::try_from(CODE.load(Ordering::Relaxed)).unwrap_or(1)
}

/// Makes signals set the flag from now on. Signals ignored by the caller, as `nohup` does, stay ignored.
pub fn listen() {
    LISTEN.call_once(|| {
        let ignored = ignored();
        for signal in ENDING.into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0) {
            // A signal that cannot be caught ends the process as usual.
            let _ = flag::register_conditional_default(signal, &STOP)
                .and_then(|_| flag::register_usize(signal, &CODE, FIRST_CODE + signal as usize))
                .and_then(|_| flag::register(signal, &STOP));
        }
    });
}

/// Makes a write beyond the file size limit of the process fail, like one on a full disk, instead of ending the process.
pub fn survive_file_limit() {
    #[cfg(unix)]
    {
        /// Never read: the failing write reports the problem.
        static PASSED: AtomicBool = AtomicBool::new(false);
        static SURVIVE: Once = Once::new();
        SURVIVE.call_once(|| {
            let _ = flag::register(signal_hook::consts::SIGXFSZ, &PASSED);
        });
    }
}

/// The signals that are ignored, lowest bit first; none where the system does not tell.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default()
}
