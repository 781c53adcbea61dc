//! Graphs by external programs: run only on request, errors reported, never blocking.
#![cfg(unix)]

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::command;
use command::{Desk, files};

/// A recipe whose program is this shell script.
fn desk(script: &str) -> Desk {
    let desk = Desk::new();
    fs::create_dir(desk.path("recipes")).unwrap();
    desk.file("recipes/make.sh", script);
    desk.file(
        "recipes/cave.toml",
        "seed = 5\n[graph]\ngenerator = \"external\"\ncommand = [\"sh\", \"make.sh\"]\ntime_limit_s = 5.0\n\
         size_limit_mb = 0.01\nsettings = { stations = 3, \"a.b\" = [1.5, \"x\"] }\n",
    );
    desk
}

/// Writes a row of three stations, and its input to `told.json`.
const ROW: &str = r#"cat > told.json; echo '{"nodes": [
{"id": 0, "edges": [1], "coordinates": {"x": 0, "y": 0, "z": 0}},
{"id": 1, "edges": [2], "coordinates": {"x": 5, "y": 0, "z": 0}},
{"id": 2, "edges": [], "coordinates": {"x": 9, "y": 3, "z": 0}}]}'"#;

#[test]
fn a_program_gets_seed_and_settings_and_returns_the_graph() {
    let desk = desk(ROW);
    let made = desk.run(&["graph", "recipes/cave.toml", "-o", "cave", "--allow-run"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let told: serde_json::Value = serde_json::from_slice(&fs::read(desk.path("recipes/told.json")).unwrap()).unwrap();
    assert_eq!(told["seed"], 5);
    assert_eq!(told["settings"], serde_json::json!({"stations": 3, "a.b": [1.5, "x"]}));
    let graph = fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    assert_eq!(graph.matches("\"coordinates\"").count(), 3);
    assert!(desk.run(&["preview", "recipes/cave.toml", "-o", "plan.svg", "--allow-run"]).status.success());
    // The folder works without the program, and its recipe reads back.
    fs::remove_dir_all(desk.path("recipes")).unwrap();
    assert!(desk.run(&["graph", "cave"]).status.success());
}

#[test]
fn the_example_digs_its_mine() {
    let desk = Desk::new();
    let recipe = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/external/decline.toml");
    let made = desk.run(&["graph", recipe, "-o", "cave", "--allow-run"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let graph = fs::read_to_string(desk.path("cave/graph.json")).unwrap();
    assert!(graph.matches("\"coordinates\"").count() > 100);
}

#[test]
fn no_program_runs_unasked() {
    let desk = desk(ROW);
    insta::assert_snapshot!(desk.fault(&["graph", "recipes/cave.toml", "-o", "cave"]));
    assert!(!desk.path("recipes/told.json").exists());
    assert!(!desk.path("cave").exists());
}

#[test]
fn programs_that_fail_hang_flood_or_lie_are_reported() {
    let cases = [
        ("fails", "echo the rock is too hard >&2; exit 7"),
        ("hangs", "sleep 60"),
        ("floods", "yes"),
        ("says nothing", "true"),
        (
            "lies",
            r#"echo '{"nodes": [{"id": 0, "edges": [4], "coordinates": {"x": 0, "y": 0}}, {"id": 1, "coordinates": {"x": 1, "y": 0}}]}'"#,
        ),
        ("is no text", r"printf '\377\376'"),
    ];
    let told: String = cases
        .map(|(name, script)| {
            let desk = desk(script);
            let fast = if name == "hangs" { "graph.time_limit_s=0.3" } else { "graph.time_limit_s=20" };
            let fault = desk.fault(&["graph", "recipes/cave.toml", "-o", "cave", "--allow-run", "--set", fast]);
            assert!(!desk.path("cave").exists(), "{name} left a folder");
            format!("{name}: {fault}\n")
        })
        .concat();
    insta::assert_snapshot!(told);
}

/// Whether it came true within half a minute.
fn comes_true(mut what: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(30) {
        if what() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

#[cfg(target_os = "linux")]
#[test]
fn signals_that_end_a_run_end_its_program_and_leave_nothing() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        // The program reports its process id, and that of a child in a separate session.
        let desk = desk("(setsid sh -c 'echo $$ > other; sleep 600' &)\necho $$ > one; sleep 600");
        let make = ["graph", "recipes/cave.toml", "-o", "cave", "--allow-run", "--set", "graph.time_limit_s=500"];
        let mut run = desk.command(&make).stderr(Stdio::piped()).spawn().unwrap();
        let pids = ["recipes/one", "recipes/other"].map(|name| desk.path(name));
        let pid = |path| fs::read_to_string(path).ok().filter(|pid| pid.ends_with('\n'));
        assert!(comes_true(|| pids.iter().all(|path| pid(path).is_some())), "SIG{signal}: it did not start");
        let sent = std::process::Command::new("kill").args(["-s", signal, &run.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert!(comes_true(|| run.try_wait().unwrap().is_some()), "SIG{signal} had no effect");
        assert_eq!(run.wait().unwrap().code(), Some(code), "SIG{signal}");
        for path in &pids {
            let process = format!("/proc/{}/cmdline", pid(path).unwrap().trim());
            assert!(
                comes_true(|| fs::read(&process).map_or(true, |line| line.is_empty())),
                "SIG{signal}: {path:?} lives"
            );
        }
        assert_eq!(files(&desk.path("")).len(), 4, "SIG{signal}: {:?}", files(&desk.path("")));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn signals_ignored_by_the_caller_stay_ignored() {
    let desk = desk(&format!("kill -HUP $PPID; {ROW}"));
    let script =
        format!("trap '' HUP; exec {} graph recipes/cave.toml -o cave --allow-run", env!("CARGO_BIN_EXE_plume"));
    let made = std::process::Command::new("sh").args(["-c", &script]).current_dir(desk.path("")).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

/// It would keep standard output open for a minute, and the command waiting.
#[test]
fn a_child_left_with_standard_output_does_no_harm() {
    let desk = desk(&format!("setsid sleep 60 &\n{ROW}"));
    let start = Instant::now();
    let made = desk.run(&["graph", "recipes/cave.toml", "-o", "cave", "--allow-run"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(start.elapsed() < Duration::from_secs(30));
}

#[test]
fn a_program_sees_only_secrets_named_in_its_recipe() {
    let desk = desk(&format!("env > seen; {ROW}"));
    let seen = |more: &[&str]| {
        let make = ["graph", "recipes/cave.toml", "-o", "cave", "--allow-run", "--force"];
        let mut make = desk.command(&[&make, more].concat());
        let made = make.env("API_KEY", "secret").env("LICENSE_SERVER", "there").output().unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let seen = fs::read_to_string(desk.path("recipes/seen")).unwrap();
        ["PATH=", "API_KEY=", "LICENSE_SERVER="].map(|name| seen.lines().any(|line| line.starts_with(name)))
    };
    assert_eq!(seen(&[]), [true, false, false]);
    assert_eq!(seen(&["--set", "graph.environment=[\"LICENSE_SERVER\"]"]), [true, false, true]);
}
