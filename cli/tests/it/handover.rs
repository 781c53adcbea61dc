//! USD targets of the plain binary: it hands over to a Python with the same version of Plume, or says where it looked.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::command;
use command::Desk;
use insta::assert_snapshot;

const EXPORT: [&str; 5] = ["export", "--target", "gltf,isaac", "--output", "out"];

/// A program in the place of a Python.
fn interpreter(desk: &Desk, text: &str) -> String {
    desk.file("python.sh", &format!("#!/bin/sh\n{text}\n"));
    let path = desk.path("python");
    install(&desk.path("python.sh"), &path);
    path.to_str().unwrap().to_owned()
}

/// Copies a program. Another process does so: a file that this one has open for writing may pass to a child that another test
/// starts at that moment, and until the child runs its own program, ours is busy.
fn install(from: &Path, to: &Path) {
    assert!(Command::new("install").args(["-m", "755"]).args([from, to]).status().unwrap().success());
}

/// Exit code and stderr, without the place of the desk and the version.
fn told(desk: &Desk, output: &Output) -> String {
    let stderr = String::from_utf8_lossy(&output.stderr);
    let text = stderr.replace(desk.path("").to_str().unwrap(), "DESK/").replace(plume::VERSION, "VERSION");
    format!("exit {}\n{text}", output.status.code().unwrap())
}

#[test]
fn an_unsuitable_python_is_reported() {
    for (name, answer) in
        [("no_plume", "echo \"! No module named 'plume'\""), ("other_version", "echo 0.0.1"), ("broken", "exit 3")]
    {
        let desk = Desk::new();
        let python = interpreter(&desk, answer);
        let output = desk.command(&EXPORT).env("PLUME_PYTHON", python).output().unwrap();
        assert_snapshot!(name, told(&desk, &output));
        assert!(!desk.path("out").exists());
    }
}

#[test]
fn publishing_needs_fsspec() {
    let desk = Desk::new();
    let python = interpreter(&desk, "echo \"! No module named '$3'\"");
    let output = desk.command(&["publish", "small", "copy"]).env("PLUME_PYTHON", python).output().unwrap();
    assert_snapshot!("no_fsspec", told(&desk, &output));
}

#[test]
fn every_searched_place_is_reported() {
    let desk = Desk::new();
    // Away from the workspace, which may have a `.venv` that fits.
    let program = desk.path("plume");
    install(env!("CARGO_BIN_EXE_plume").as_ref(), &program);
    fs::create_dir(desk.path(".venv")).unwrap();
    let mut command = Command::new(program);
    command.args(EXPORT).current_dir(desk.path("")).env_remove("PLUME_PYTHON").env("PATH", "");
    let output =
        command.env("VIRTUAL_ENV", desk.path("active")).env("CONDA_PREFIX", desk.path("conda")).output().unwrap();
    assert_snapshot!("nowhere", told(&desk, &output));
}

#[test]
fn a_suitable_python_gets_the_complete_command_line() {
    let desk = Desk::new();
    let text = format!("[ \"$1\" = -c ] && exec echo {}\nprintf '%s|' \"$@\"\nexit 130", plume::VERSION);
    let python = interpreter(&desk, &text);
    let output = desk.command(&EXPORT).env("PLUME_PYTHON", python).output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "-m|plume|export|--target|gltf,isaac|--output|out|");
    assert_eq!(output.status.code(), Some(130));
}

#[test]
fn other_targets_need_no_python() {
    let desk = Desk::new();
    let arguments: Vec<&str> = ["export", "--target", "gltf"].iter().chain(&command::SMALL).copied().collect();
    let output = desk.command(&arguments).env("PLUME_PYTHON", "nowhere").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
