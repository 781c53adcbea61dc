//! Options of targets: how they are listed, and what hints say where one was meant.

use crate::command::{Desk, files};
use insta::assert_snapshot;
use serde_json::json;

#[test]
fn options_of_targets_are_listed() {
    let desk = Desk::new();
    let listed = |more: &[&str]| String::from_utf8(desk.run(&[&["list", "options"], more].concat()).stdout).unwrap();
    let gazebo = listed(&["gazebo"]);
    assert!(gazebo.contains("  gazebo.ambient ") && gazebo.contains("[0.0 to 1.0; default 0.1]"), "{gazebo}");
    assert!(!gazebo.contains("mujoco."), "{gazebo}");
    let all: serde_json::Value = serde_json::from_str(&listed(&["--json"])).unwrap();
    let lights = all["options"].as_array().unwrap().iter().find(|row| row["name"] == "gazebo.lights").unwrap();
    assert_eq!((&lights["target"], &lights["default"]), (&json!("gazebo"), &json!(true)));
    assert_snapshot!("options_of_no_target", desk.fault(&["list", "options", "gazeboo"]));
    assert_snapshot!("options_of_another_table", desk.fault(&["list", "robots", "gazebo"]));
}

#[test]
fn hints_lead_to_what_was_meant() {
    let desk = Desk::new();
    assert_snapshot!("no_preset_nearby", desk.fault(&["new", "--preset", "ice"]));
    assert_snapshot!("key_without_section", desk.fault(&["new", "--set", "nodes=5"]));
    let export = |target: &str, option: &str| desk.fault(&["export", "--target", target, "--option", option]);
    assert_snapshot!("option_without_target", export("gazebo", "ros2=true"));
    assert_snapshot!("option_of_others", export("obj", "ros2=true"));
    assert_snapshot!("option_of_no_export", export("obj, glb", "gazebo.ros2=true"));
    let fault = desk.fault(&["export"]);
    assert!(fault.starts_with("exit 2\n") && fault.contains("known targets: gazebo, isaac"), "{fault}");
}

#[test]
fn images_that_a_target_does_not_take_are_refused_before_the_work() {
    let desk = Desk::new();
    let webp = ["--set", "texture.format=webp"];
    assert_snapshot!("images_unfit", desk.fault(&[&["export", "--target", "glb,gazebo"], &webp[..]].concat()));
    let with = ["export", "--target", "glb", "--with", "gazebo"];
    assert!(desk.fault(&[&with, &webp[..]].concat()).contains("target `gazebo` does not take"));
    assert_eq!(files(&desk.path("")).len(), 0);
}
