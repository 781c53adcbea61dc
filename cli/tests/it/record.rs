//! `plume record`: a recording appears whole, and what cannot be is refused before it begins.

use std::fs;

use crate::command::Desk;

const RIG: &str = "[[cameras]]\nname = \"cam0\"\nrate_hz = 2.0\nsize_px = [32, 24]\nfov_deg = 70.0\n\n[imu]\n";
const STILL: &str = "0 0 0 0.5 0 0 0 1\n1 0 0 0.5 0 0 0 1\n";

#[test]
fn a_recording_appears_whole_or_not_at_all() {
    let desk = Desk::new();
    desk.make(&["generate", "-o", "cave", "--quiet"]);
    desk.file("rig.toml", RIG);
    desk.file("path.tum", STILL);
    let record = ["record", "cave", "--path", "path.tum", "--rig", "rig.toml", "-o", "run", "--quiet"];
    assert!(desk.run(&record).status.success());
    let about: serde_json::Value = serde_json::from_slice(&fs::read(desk.path("run/recording.json")).unwrap()).unwrap();
    assert_eq!((&about["counts"]["cam0"], &about["counts"]["imu"]), (&3.into(), &201.into()));
    assert!(desk.path("run/rgb/0.500000.png").exists());
    assert!(desk.fault(&record).contains("not empty"), "what is there stays");
    desk.file("far.tum", "0 0 0 0.5 0 0 0 1\n100000 0 0 0.5 0 0 0 1\n");
    let fault = desk.fault(&["record", "cave", "--path", "far.tum", "--rig", "rig.toml", "-o", "other"]);
    assert!(
        fault.starts_with("exit 2") && fault.contains("takes more than") && !desk.path("other").exists(),
        "{fault}"
    );
}

#[test]
fn faults_tell_what_to_do() {
    let desk = Desk::new();
    desk.file("path.tum", STILL);
    desk.file("bad.tum", "0 0 0 0.5 0 0 0 1\n1 0 0\n");
    desk.file("bad.toml", "[imu]\nrate_hz = -1.0\n");
    let record = |path: &'static str, more: &[&'static str]| {
        desk.fault(&[&["record", "cave", "--path", path, "-o", "run"][..], more].concat())
    };
    let faults = [
        record("path.tum", &[]),
        record("bad.tum", &[]),
        record("none.tum", &[]),
        record("path.tum", &["--rig", "bad.toml"]),
        record("path.tum", &["--layout", "kittens"]),
        desk.fault(&["record", "--print-rig", "none"]),
    ];
    insta::assert_snapshot!(faults.join("\n"));
}

#[test]
fn a_rig_that_is_printed_is_one() {
    let desk = Desk::new();
    let printed = String::from_utf8(desk.run(&["record", "--print-rig"]).stdout).unwrap();
    assert!(plume_record::rig::Rig::parse(&printed, "rig.toml".as_ref()).is_ok());
    let other = String::from_utf8(desk.run(&["record", "--print-rig", "stereo"]).stdout).unwrap();
    assert_ne!(printed, other);
}
