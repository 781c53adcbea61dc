//! The laws of workers: one reply for each cave, deaths are survived, and nothing is waited for once work is stopped.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use plume::cave::CaveError;
use plume_dataset::Reply;
use plume_dataset::local::dispatch;

/// Caves, each with why it could not be made.
type Replies = Vec<(usize, Option<String>)>;

/// The replies of workers that run this script to requests for ten caves.
fn outcome_of(script: &str, stop: &AtomicBool) -> (Replies, Result<(), CaveError>) {
    let replies = Mutex::new(Vec::new());
    let worker = || {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    };
    let on_reply = |reply: Reply| replies.lock().unwrap().push((reply.item, reply.fault));
    let numbers: Vec<usize> = (0..10).collect();
    let result = dispatch(&numbers, 3, worker, stop, &on_reply);
    let mut replies = replies.into_inner().unwrap();
    replies.sort();
    (replies, result)
}

fn replies_of(script: &str) -> (Replies, Result<(), CaveError>) {
    outcome_of(script, &AtomicBool::new(false))
}

const HONEST: &str = r#"while read n; do echo "{\"item\": $n, \"cpu_s\": 0}"; done"#;

#[test]
fn each_cave_gets_one_reply() {
    let (replies, result) = replies_of(&format!("echo ready; {HONEST}"));
    assert!(result.is_ok());
    assert!(replies.into_iter().eq((0..10).map(|number| (number, None))));
}

#[test]
fn a_worker_that_dies_is_replaced() {
    // Every second one dies of its first cave.
    let folder = tempfile::tempdir().unwrap();
    let flag = folder.path().join("flag").display().to_string();
    let script =
        format!("echo ready; if rm {flag} 2>/dev/null; then {HONEST}; else touch {flag}; read n; kill -9 $$; fi");
    let (replies, result) = replies_of(&script);
    assert!(result.is_ok());
    assert_eq!(replies.len(), 10);
    assert!(replies.iter().any(|(_, fault)| fault.is_none()), "{replies:?}");
}

#[test]
fn a_cave_of_which_workers_die_is_left_out() {
    let script = format!("echo ready; while read n; do if [ $n = 4 ]; then kill -9 $$; fi; echo $n | ({HONEST}); done");
    let (replies, result) = replies_of(&script);
    assert!(result.is_ok());
    let fault = "3 workers died of it, the last with signal: 9 (SIGKILL); perhaps of too little memory";
    assert!(replies.into_iter().eq((0..10).map(|number| (number, (number == 4).then(|| fault.to_owned())))));
}

#[test]
fn workers_that_do_not_start_end_the_work() {
    let (replies, result) = replies_of("exit 3");
    assert!(replies.is_empty());
    assert_eq!(result.unwrap_err().to_string(), "no worker starts: 3 ended at once, the last with exit status: 3");
}

#[test]
fn a_full_disk_ends_the_work() {
    let script = r#"echo ready; while read n; do echo "{\"item\": $n, \"cpu_s\": 0, \"fault\": \"the disk is full\", \"is_final\": true}"; done"#;
    let (replies, result) = replies_of(script);
    assert!(replies.is_empty());
    assert_eq!(result.unwrap_err().to_string(), "the disk is full");
}

#[test]
fn nothing_is_waited_for_once_work_is_stopped() {
    let stop = AtomicBool::new(false);
    let (replies, result) = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(200));
            stop.store(true, Ordering::Relaxed);
        });
        // Longer than any test may take.
        outcome_of("echo ready; exec sleep 100000", &stop)
    });
    assert!(replies.is_empty() && matches!(result, Err(CaveError::Interrupted)));
}
