//! The laws of workers: each cave is heard of once, deaths are survived, and nothing is waited for once work is stopped.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use plume::cave::CaveError;
use plume_dataset::local::{Answer, ask};

/// Caves, each with why it could not be made.
type Heard = Vec<(usize, Option<String>)>;

/// Asks workers that run this script for ten caves.
fn asked(script: &str, stop: &AtomicBool) -> (Heard, Result<(), CaveError>) {
    let heard = Mutex::new(Vec::new());
    let worker = || {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    };
    let hear = |answer: Answer| heard.lock().unwrap().push((answer.item, answer.fault));
    let numbers: Vec<usize> = (0..10).collect();
    let result = ask(&numbers, 3, worker, stop, &hear);
    let mut heard = heard.into_inner().unwrap();
    heard.sort();
    (heard, result)
}

fn answers(script: &str) -> (Heard, Result<(), CaveError>) {
    asked(script, &AtomicBool::new(false))
}

const HONEST: &str = r#"while read n; do echo "{\"item\": $n, \"cpu_s\": 0}"; done"#;

#[test]
fn each_cave_is_heard_of_once() {
    let (heard, result) = answers(&format!("echo ready; {HONEST}"));
    assert!(result.is_ok());
    assert!(heard.into_iter().eq((0..10).map(|number| (number, None))));
}

#[test]
fn a_worker_that_dies_is_replaced() {
    // Every second one dies of its first cave.
    let folder = tempfile::tempdir().unwrap();
    let flag = folder.path().join("flag").display().to_string();
    let script =
        format!("echo ready; if rm {flag} 2>/dev/null; then {HONEST}; else touch {flag}; read n; kill -9 $$; fi");
    let (heard, result) = answers(&script);
    assert!(result.is_ok());
    assert_eq!(heard.len(), 10);
    assert!(heard.iter().any(|(_, fault)| fault.is_none()), "{heard:?}");
}

#[test]
fn a_cave_of_which_workers_die_is_left_out() {
    let script = format!("echo ready; while read n; do if [ $n = 4 ]; then kill -9 $$; fi; echo $n | ({HONEST}); done");
    let (heard, result) = answers(&script);
    assert!(result.is_ok());
    let fault = "3 workers died of it, the last with signal: 9 (SIGKILL); perhaps of too little memory";
    assert!(heard.into_iter().eq((0..10).map(|number| (number, (number == 4).then(|| fault.to_owned())))));
}

#[test]
fn workers_that_do_not_start_end_the_work() {
    let (heard, result) = answers("exit 3");
    assert!(heard.is_empty());
    assert_eq!(result.unwrap_err().to_string(), "no worker starts: 3 ended at once, the last with exit status: 3");
}

#[test]
fn a_full_disk_ends_the_work() {
    let script = r#"echo ready; while read n; do echo "{\"item\": $n, \"cpu_s\": 0, \"fault\": \"the disk is full\", \"is_final\": true}"; done"#;
    let (heard, result) = answers(script);
    assert!(heard.is_empty());
    assert_eq!(result.unwrap_err().to_string(), "the disk is full");
}

#[test]
fn nothing_is_waited_for_once_work_is_stopped() {
    let stop = AtomicBool::new(false);
    let (heard, result) = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(200));
            stop.store(true, Ordering::Relaxed);
        });
        // Longer than any test may take.
        asked("echo ready; exec sleep 100000", &stop)
    });
    assert!(heard.is_empty() && matches!(result, Err(CaveError::Interrupted)));
}
