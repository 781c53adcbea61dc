//! Exact error messages of the command line, and that nothing of the user is lost.

use std::fs;

use crate::command;
use command::{Desk, SMALL, files};
use insta::assert_snapshot;
use serde_json::json;

#[test]
fn a_faulty_recipe_is_reported_line_by_line() {
    let desk = Desk::new();
    let recipe = "name = \"My Cave\"\nsed = 3\n\n[graph]\nnodes = 1\ngeneratr = \"mine\"\n\n[mesh]\nvoxel_m = 9.0\n\
                  chunk_m = [16, 16]\n\n[look]\nhumidity = nan\n";
    desk.file("cave.toml", recipe);
    assert_snapshot!("recipe_not_finite", desk.fault(&["generate", "cave.toml"]));
    desk.file("cave.toml", &recipe.replace("nan", "\"wet\""));
    assert_snapshot!("recipe_faults", desk.fault(&["generate", "cave.toml"]));
    desk.file("cave.toml", "[graph\nnodes = 3\n");
    assert_snapshot!("recipe_syntax", desk.fault(&["generate", "cave.toml"]));
    desk.file("cave.toml", "rock = 3\n");
    assert_snapshot!("recipe_not_a_section", desk.fault(&["generate", "cave.toml"]));
}

#[test]
fn unknown_names_are_reported() {
    let desk = Desk::new();
    assert_snapshot!("no_such_target", desk.fault(&["export", "--target", "gazeboo"]));
    assert_snapshot!("no_such_bundle", desk.fault(&["export", "--target", "mujoco", "--bundle", "mjb"]));
    assert_snapshot!("bundle_of_none", desk.fault(&["export", "--target", "gltf", "--bundle", "tgz"]));
    assert_snapshot!("bundle_of_others", desk.fault(&["export", "--target", "mujoco,gltf", "--bundle", "mjz"]));
    assert_snapshot!(
        "no_such_collision",
        desk.fault(&["export", "--target", "mujoco", "--option", "mujoco.collision=flax"])
    );
    assert_snapshot!("no_such_preset", desk.fault(&["new", "--preset", "mines"]));
    assert_snapshot!("override_without_value", desk.fault(&["new", "--set", "seed"]));
    assert_snapshot!("override_out_of_range", desk.fault(&["new", "--set", "graph.nodes=10000000"]));
    assert_snapshot!("no_such_recipe", desk.fault(&["generate", "nowhere.toml"]));
    assert_snapshot!("no_such_graph", desk.fault(&["generate", "nowhere.json"]));
}

#[test]
fn faulty_previews_are_reported() {
    let desk = Desk::new();
    desk.file("file", "a file");
    for (name, arguments) in [
        ("preview_no_such_view", &["--view", "plam"][..]),
        ("preview_wrong_ending", &["--view", "plan", "--output", "cave.gif"]),
        ("preview_of_no_view", &["--output", "cave.bmp"]),
        ("preview_size", &["--size", "10x10"]),
        ("preview_pace", &["--view", "flight", "--fps", "90"]),
        ("preview_in_rock", &["--view", "inside", "--at", "0,0,-500"]),
        ("preview_look", &["--view", "inside", "--look", "90"]),
        ("preview_unwritable", &["--output", "file/plan.png"]),
        ("preview_unheeded", &["--view", "plan", "--look", "90,0"]),
        ("preview_of_nothing", &["nowhere.toml"]),
    ] {
        let arguments: Vec<&str> = ["preview"].iter().chain(arguments).copied().collect();
        assert_snapshot!(name, desk.fault(&arguments));
    }
    assert_eq!(files(&desk.path("")).len(), 1);
}

#[test]
fn a_preview_is_named_by_its_view() {
    let desk = Desk::new();
    assert!(desk.run(&["preview", "--size", "320x240"]).status.success());
    assert!(desk.run(&["preview", "--size", "320x240", "--output", "cave.svg"]).status.success());
    let flight = ["preview", "--view", "flight", "--size", "32x24", "--fps", "2", "--output", "frames"];
    // Nothing of the longer one is left.
    for seconds in ["2", "1"] {
        assert!(desk.run(&[&flight[..], &["--seconds", seconds]].concat()).status.success());
    }
    let names: Vec<String> = desk.hashes("").into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["cave-plan.png", "cave.svg", "frames/00000.png", "frames/00001.png", "frames/flight.json"]);
}

#[test]
fn a_missing_assimp_is_reported() {
    let desk = Desk::new();
    let mut command = desk.command(&["export", "--target", "assimp:collada"]);
    let output = command.env("PLUME_ASSIMP", "nowhere/libassimp.so").output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_snapshot!("no_assimp", format!("exit {}\n{stderr}", output.status.code().unwrap()));
    assert_eq!(files(&desk.path("")).len(), 0);
}

#[test]
fn frames_not_ours_are_left_alone() {
    let desk = Desk::new();
    let flight =
        ["preview", "--view", "flight", "--size", "32x24", "--fps", "2", "--seconds", "1", "--output", "frames"];
    fs::create_dir(desk.path("frames")).unwrap();
    desk.file("frames/00001.png", "my holiday");
    assert_snapshot!("flight_over_others", desk.fault(&flight));
    fs::remove_file(desk.path("frames/00001.png")).unwrap();
    assert!(desk.run(&flight).status.success());
    // One more of the user's, one that the user has changed, and a list that leads elsewhere.
    desk.file("frames/00002.png", "my holiday");
    assert_snapshot!("flight_beside_others", desk.fault(&flight));
    fs::rename(desk.path("frames/00002.png"), desk.path("frames/holiday.png")).unwrap();
    assert!(desk.run(&flight).status.success());
    desk.file("frames/00001.png", "drawn over");
    assert_snapshot!("flight_changed", desk.fault(&flight));
    desk.file("frames/flight.json", r#"{"frames": {"../../00001.png": []}}"#);
    assert_snapshot!("flight_of_no_list", desk.fault(&flight));
    let left = ["frames/00001.png", "frames/holiday.png"].map(|name| fs::read_to_string(desk.path(name)).unwrap());
    assert_eq!(left, ["drawn over", "my holiday"]);
}

#[cfg(unix)]
#[test]
fn no_planted_link_is_followed() {
    let desk = Desk::new();
    desk.file("diary.txt", "dear diary");
    for name in ["plan.png.partial", "plan.png"] {
        std::os::unix::fs::symlink(desk.path("diary.txt"), desk.path(name)).unwrap();
    }
    assert!(desk.run(&["preview", "--size", "320x240", "--output", "plan.png"]).status.success());
    assert_eq!(fs::read_to_string(desk.path("diary.txt")).unwrap(), "dear diary");
    assert!(!desk.path("plan.png").is_symlink());
}

/// The output of a command within ten seconds and a memory limit in bytes.
fn fault_at_once(desk: &Desk, arguments: &[&str]) -> String {
    let start = std::time::Instant::now();
    let mut run = desk.command(arguments);
    let mut run = run.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::null()).spawn().unwrap();
    while run.try_wait().unwrap().is_none() {
        if start.elapsed().as_secs() >= 10 {
            run.kill().unwrap();
            return format!("{arguments:?} is still at work");
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let said = run.wait_with_output().unwrap();
    format!("exit {:?}\n{}", said.status.code(), String::from_utf8(said.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_without_blocking() {
    let desk = Desk::new();
    fs::create_dir(desk.path("cave")).unwrap();
    for name in ["pipe.toml", "pipe.svx", "pipe.json", "pipe_nodes.dat", "pipe", "cave/cave.toml"] {
        assert!(std::process::Command::new("mkfifo").arg(desk.path(name)).status().unwrap().success());
    }
    desk.file("cave/graph.json", "{}");
    desk.file("pipe_links.dat", "1 2\n");
    desk.file("includes.svx", "*include pipe\n");
    std::os::unix::fs::symlink("/dev/zero", desk.path("zero.svx")).unwrap();
    let commands = [
        "generate pipe.toml",
        "generate /dev/zero",
        "generate zero.svx",
        "graph import pipe.svx -o graph.json",
        "graph import includes.svx -o graph.json",
        "graph import pipe_links.dat -o graph.json",
        "graph export pipe.json -o graph.csv",
        "measure pipe.json",
        "status cave",
        "check pipe",
        "check /dev/zero",
    ];
    let said = commands.map(|command| {
        let arguments: Vec<&str> = command.split(' ').collect();
        format!("{command}: {}", fault_at_once(&desk, &arguments))
    });
    assert_snapshot!("pipes_and_devices", said.join("\n"));
    desk.make(&["export", "--target", "gltf", "--output", "package"]);
    fs::rename(desk.path("pipe"), desk.path("package/pipe")).unwrap();
    assert_snapshot!("pipe_in_package", said_of(&desk, "package"));
}

#[test]
fn recipes_made_to_take_long_are_refused_quickly() {
    let desk = Desk::new();
    let lines = |count: usize, line: fn(usize) -> String| (0..count).map(line).collect::<String>();
    let recipes = [
        ("comments", "#".repeat(1 << 20) + "\n"),
        ("keys", lines(90_000, |n| format!("k{n}=1\n"))),
        ("sections", lines(90_000, |n| format!("[s{n}]\n"))),
        ("sections in sections", lines(70_000, |n| format!("a{n}.b.c.d=1\n"))),
        ("lists", "[[a]]\n".repeat(170_000)),
        ("numbers", format!("x=[{}]\n", "nan,".repeat(250_000))),
        ("items", format!("[graph]\nnodes=[{}]\n", "1,".repeat(400_000))),
        ("a long section", format!("[{}]\n{}", "a".repeat(400_000), lines(60_000, |n| format!("k{n}=1\n")))),
        ("depth", format!("{}=1\n", "a.".repeat(60) + "a")),
        ("a long name", format!("name = \"{}\"\n", "n".repeat(1_000_000))),
        ("a long kind", format!("[rock]\nkind = \"{}\"\n", "k".repeat(1_000_000))),
        ("some keys", lines(5_000, |n| format!("k{n}=1\n"))),
    ];
    let said = recipes.map(|(name, recipe)| {
        desk.file("cave.toml", &recipe);
        format!("{name}: {}", fault_at_once(&desk, &["graph", "cave.toml"]))
    });
    assert_snapshot!("recipes_that_take_long", said.join("\n"));
}

#[test]
fn quoted_text_is_short_and_harmless_to_a_terminal() {
    let desk = Desk::new();
    let long = format!("\u{1b}[2J{}", "x".repeat(90_000));
    let pair = format!("name={long}");
    let key = format!("{long}=1");
    desk.file("graph.json", &json!({"nodes": [{"id": long, "coordinates": {"x": long, "y": 0}}]}).to_string());
    desk.file("recipe.json", &json!({"nodes": [], "recipe": {long.as_str(): long}}).to_string());
    desk.file("cave.svx", &format!("*{long}\n").replacen('x', " ", 40_000));
    desk.file("cave.graphml", &format!("<graphml><{long}></y></graphml>"));
    desk.file("cave.csv", &format!("{long},y1,z1,x2,y2,z2\n"));
    let command = format!("graph.command=[\"{}\"]", "x".repeat(90_000));
    let program = ["graph", "--allow-run", "--set", "graph.generator=external", "--set", &command];
    let said: Vec<String> = [
        &["new", "--preset", &long][..],
        &["new", "--set", &long],
        &["new", "--set", &pair],
        &["new", "--set", &key],
        &["new", &long],
        &[&long],
        &["list", &long],
        &["export", "--target", &long],
        &["export", "--target", "mujoco", "--bundle", &long],
        &["export", "--target", "gltf", "--option", &key],
        &["preview", "--view", &long],
        &["preview", "--size", &long],
        &["graph", "import", "graph.json", "-o", "x.json", "--format", &long],
        &["graph", "import", "graph.json", "-o", "x.json"],
        &["graph", "import", "cave.svx", "-o", "x.json"],
        &["graph", "import", "cave.graphml", "-o", "x.json"],
        &["graph", "import", "cave.csv", "-o", "x.json"],
        &["graph", "recipe.json"],
        &program,
    ]
    .iter()
    .map(|arguments| desk.fault(arguments))
    .collect();
    for said in &said {
        assert!(said.starts_with("exit 2") && said.len() < 2000 && !said.contains('\u{1b}'), "{said:.3000}");
    }
    assert_snapshot!("long_echoes", said.join("\n"));
}

#[test]
fn impossible_file_names_are_reported() {
    let desk = Desk::new();
    for name in ["con", "nul", "com1"] {
        let fault = desk.fault(&["graph", "--set", &format!("name={name}")]);
        assert!(fault.starts_with("exit 2") && fault.contains("Windows"), "{fault}");
    }
    assert_snapshot!("name_of_a_device", desk.fault(&["new", "--set", "name=aux"]));
    desk.file("cave.csv", "x1,y1,z1,x2,y2,z2\n0,0,0,9,0,0\n");
    let long = "long".repeat(80);
    let told = [
        "graph -o",
        "preview --size 320x240 -o",
        "graph import cave.csv -o",
        "preview --view flight --fps 1 --seconds 1 -o",
    ]
    .map(|command| {
        let ending = if command.contains("import") {
            ".json"
        } else if command.contains("320") {
            ".png"
        } else {
            ""
        };
        let name = format!("{long}{ending}");
        let arguments: Vec<&str> = command.split(' ').chain([name.as_str()]).collect();
        desk.fault(&arguments)
    });
    assert_snapshot!("names_too_long", told.join("\n"));
}

#[test]
fn folders_of_others_are_left_alone() {
    let desk = Desk::new();
    fs::create_dir(desk.path("mine")).unwrap();
    desk.file("mine/diary.txt", "dear diary");
    assert_snapshot!("folder_of_others", desk.fault(&["generate", "--output", "mine"]));
    assert_snapshot!("package_exists", desk.fault(&["export", "--target", "gazebo", "--output", "mine"]));
    assert_eq!(fs::read_to_string(desk.path("mine/diary.txt")).unwrap(), "dear diary");
    assert_eq!(files(&desk.path("")).len(), 1);
    desk.file("file", "a file");
    assert_snapshot!("folder_is_a_file", desk.fault(&["graph", "--output", "file"]));
}

#[test]
fn another_cave_is_not_overwritten() {
    let desk = Desk::new();
    desk.make(&["graph", "--output", "cave"]);
    let before = desk.hashes("cave");
    assert_snapshot!("another_cave", desk.fault(&["graph", "--output", "cave", "--seed", "8"]));
    assert_eq!(before, desk.hashes("cave"));
    desk.make(&["graph", "--output", "cave", "--seed", "8", "--force"]);
    assert_ne!(before, desk.hashes("cave"));
}

#[test]
fn results_go_to_stdout_and_notes_to_stderr() {
    let desk = Desk::new();
    let plain = desk.run(&["graph", "--output", "plain"]);
    assert!(plain.stdout.is_empty() && !plain.stderr.is_empty());
    let quiet = desk.run(&["graph", "--output", "quiet", "--quiet"]);
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let json = desk.run(&["graph", "--output", "json", "--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!(summary["graph"]["nodes"], 50);
}

#[test]
fn errors_are_json_for_programs() {
    let desk = Desk::new();
    let told = |arguments: &[&str]| -> (i32, serde_json::Value) {
        let output = desk.run(&[arguments, &["--json"]].concat());
        assert!(output.stdout.is_empty(), "{arguments:?}");
        (output.status.code().unwrap(), serde_json::from_slice(&output.stderr).unwrap())
    };
    let (code, preset) = told(&["new", "--preset", "mines"]);
    assert_eq!((code, &preset["error"]), (2, &json!("there is no preset \"mines\"")));
    assert_eq!(preset["hint"], "did you mean `mine`? known: cave, lava-tube, mine, layers");
    desk.file("cave.toml", "sed = 3\n\n[graph]\nnodes = 1\n");
    let (code, recipe) = told(&["generate", "cave.toml"]);
    assert_eq!((code, &recipe["error"]), (2, &json!("cave.toml:1: sed is not a key")));
    let faults = recipe["faults"].as_array().unwrap();
    assert_eq!((faults.len(), &recipe["more"]), (2, &json!(0)));
    assert_eq!(faults[1]["error"], "cave.toml:4: graph.nodes must be at least 2, found 1");
    let (code, usage) = told(&["generate", "--sed", "3"]);
    assert_eq!((code, &usage["error"]), (2, &json!("unexpected argument '--sed' found")));
    assert!(usage["hint"].as_str().unwrap().contains("Usage: plume generate"), "{usage}");
}

#[test]
fn numbers_for_programs_have_no_more_digits_than_they_mean() {
    let desk = Desk::new();
    let all: Vec<&str> = ["mesh", "--output", "cave", "--json"].iter().chain(&SMALL).copied().collect();
    let told: serde_json::Value = serde_json::from_slice(&desk.run(&all).stdout).unwrap();
    assert!(["triangles", "collision_triangles"].iter().all(|key| told["mesh"][key].is_u64()), "{told}");
    for number in [&told["graph"]["length_m"], &told["mesh"]["area_m2"]] {
        let digits = number.to_string().split_once('.').map_or(0, |(_, digits)| digits.len());
        assert!(digits <= 3, "{number}");
    }
}

#[test]
fn shells_and_man_are_served() {
    let desk = Desk::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = String::from_utf8(desk.run(&["completions", shell]).stdout).unwrap();
        assert!(script.contains("preset"), "{shell}");
    }
    let pages = [&["manual"][..], &["manual", "export"]].map(|page| String::from_utf8(desk.run(page).stdout).unwrap());
    assert!(pages.iter().all(|page| page.contains(".TH ")) && pages[1].contains("option"), "{}", pages[1]);
    assert!(desk.fault(&["manual", "exprot"]).contains("did you mean `export`?"));
}

#[test]
fn colour_heeds_no_color() {
    let desk = Desk::new();
    let help = |variables: &[&str]| {
        let mut command = desk.command(&["--help"]);
        command.env_remove("NO_COLOR").envs(variables.iter().map(|name| (name, "1")));
        String::from_utf8(command.output().unwrap().stdout).unwrap()
    };
    assert!(help(&["CLICOLOR_FORCE"]).contains('\u{1b}'));
    assert!(!help(&["CLICOLOR_FORCE", "NO_COLOR"]).contains('\u{1b}'));
}

/// The result goes to the device that is always full.
#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_printed_is_an_error() {
    let desk = Desk::new();
    desk.make(&["export", "--target", "gltf", "--output", "package", "--keep", "cave"]);
    let fault = "standard output: No space left on device (os error 28); the output is incomplete";
    for command in [
        "new",
        "schema",
        "list",
        "list --json",
        "completions bash",
        "manual",
        "check package",
        "status cave",
        "measure cave",
        "graph import cave/graph.json -o graph.json --json",
        "preview cave --size 320x240 --json",
        "--help",
        "new --help",
        "--version",
    ] {
        let mut printing = desk.command(&command.split(' ').collect::<Vec<_>>());
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let said = printing.arg("--quiet").stdout(full).output().unwrap();
        let expected = match command.contains("--json") {
            true => format!("{{\"error\":\"{fault}\",\"hint\":\"\"}}\n"),
            false => format!("error: {fault}\n"),
        };
        assert_eq!((said.status.code(), String::from_utf8(said.stderr).unwrap()), (Some(1), expected), "{command}");
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_closes_the_pipe_early_is_not_an_error() {
    let desk = Desk::new();
    for command in [&["schema"][..], &["export", "--help"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let said = desk.command(command).stdout(writer).output().unwrap();
        assert!(said.status.success() && said.stderr.is_empty(), "{command:?}");
    }
}

/// A file may grow no larger than 4 KiB.
#[cfg(unix)]
#[test]
fn a_file_size_limit_is_reported_and_leaves_nothing() {
    let desk = Desk::new();
    let script = format!("ulimit -f 4; exec {} preview --output plan.svg --quiet", env!("CARGO_BIN_EXE_plume"));
    let said = std::process::Command::new("sh").args(["-c", &script]).current_dir(desk.path("")).output().unwrap();
    assert_snapshot!("file_limit", format!("{:?}\n{}", said.status.code(), String::from_utf8(said.stderr).unwrap()));
    assert_eq!(files(&desk.path("")).len(), 0);
}

#[test]
fn faulty_overrides_are_reported_as_typed() {
    let desk = Desk::new();
    for (name, pair) in [
        ("override_nowhere", "a.b.c.d=1"),
        ("override_below_a_value", "graph.nodes.x=1"),
        ("override_not_finite", "graph.sigma_deg=nan"),
        ("override_too_large", "mesh.divisions=[99999999999, 1, 1]"),
    ] {
        assert_snapshot!(name, desk.fault(&["new", "--set", pair]));
    }
    assert_snapshot!("seed_negative", desk.fault(&["graph", "--seed", "-1"]));
    desk.file("flat.toml", "graph = 3\n");
    assert_snapshot!("override_hides_nothing", desk.fault(&["graph", "flat.toml", "--set", "graph.nodes=9"]));
    for threads in ["0", "100000"] {
        assert_eq!(desk.run(&["list", "--threads", threads]).status.code(), Some(2));
    }
}

#[test]
fn bytes_that_are_not_text_are_bad_input() {
    let desk = Desk::new();
    fs::write(desk.path("graph.json"), b"{\"nodes\": \"\xff\"}").unwrap();
    assert_snapshot!("graph_no_text", desk.fault(&["graph", "graph.json"]));
    desk.file("marked.json", "\u{feff}{\"nodes\": []}");
    assert_snapshot!("graph_byte_order_mark", desk.fault(&["graph", "marked.json"]));
}

#[test]
fn bad_input_leaves_nothing_behind() {
    let desk = Desk::new();
    for faulty in [
        &["graph", "--output", "cave", "--set", "graph.bounds_x_m=1"][..],
        &["export", "--target", "gltf", "--output", "package", "--set", "mesh.chunk_m=[1, 1, 1]"],
    ] {
        assert_eq!(desk.run(faulty).status.code(), Some(2));
    }
    assert_eq!(fs::read_dir(desk.path("")).unwrap().count(), 0);
}

#[test]
fn a_cave_of_absurd_size_is_refused_early() {
    let desk = Desk::new();
    let at = |x: i32| json!({"x": x, "y": x, "z": x});
    let graph = |x: i32| {
        let node =
            |id: i32, edges: &[i32], x: i32| json!({"id": id, "edges": edges, "radius": 2, "coordinates": at(x)});
        json!({"nodes": [node(0, &[], -x), node(1, &[0], x)]}).to_string()
    };
    desk.file("vast.json", &graph(4000));
    assert_snapshot!("cave_too_vast", desk.fault(&["mesh", "vast.json", "--output", "vast"]));
    desk.file("far.json", &graph(900_000));
    assert_snapshot!("cave_too_far", desk.fault(&["mesh", "far.json", "--output", "far"]));
}

#[test]
fn only_packages_are_replaced() {
    let desk = Desk::new();
    desk.make(&["graph", "--output", "cave"]);
    fs::create_dir(desk.path("extension")).unwrap();
    desk.file("extension/manifest.json", "{\"name\": \"of a browser\"}");
    for (name, folder) in [("package_over_cave", "cave"), ("package_over_others", "extension")] {
        let fault = desk.fault(&["export", "--target", "gltf", "--output", folder, "--force"]);
        assert_snapshot!(name, fault);
        assert!(desk.path(folder).join("manifest.json").exists());
    }
    assert_snapshot!("cave_over_others", desk.fault(&["graph", "--output", "extension", "--force"]));
}

/// Any package.
const SOME: [&str; 5] = ["export", "--target", "gazebo", "--output", "cave"];

#[test]
fn several_targets_are_written_in_one_run() {
    let desk = Desk::new();
    desk.make(&["export", "--target", "gazebo,gltf,urdf", "--output", "one", "--threads", "1", "--keep", "cave"]);
    desk.make(&["export", "cave", "--target", "gazebo,gltf,urdf", "--output", "all", "--threads", "3"]);
    assert_eq!(desk.hashes("one"), desk.hashes("all"));
    desk.make(&["export", "cave", "--target", "gazebo,gltf", "--output", "packed", "--bundle", "tar.zst"]);
    let names: Vec<_> = desk.hashes("packed").into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["gazebo.tar.zst", "gltf.tar.zst"]);
    for package in ["one/gazebo", "all/urdf", "packed/gltf.tar.zst"] {
        let said = desk.run(&["check", package, "--json"]);
        let report: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
        assert!(said.status.success() && report["whole"] == true, "{report}");
    }
    let order = String::from_utf8(desk.run(&["export", "cave", "--target", "urdf,gazebo"]).stderr).unwrap();
    assert!(order.find("  urdf").unwrap() < order.find("  gazebo").unwrap(), "{order}");
}

#[test]
fn an_existing_bundle_is_left_alone() {
    let desk = Desk::new();
    desk.file("cave.zip", "a letter");
    let bundled: Vec<&str> = SOME.into_iter().chain(["--bundle", "zip"]).collect();
    assert_snapshot!("bundle_exists", desk.fault(&bundled));
    let forced: Vec<&str> = bundled.iter().copied().chain(["--force"]).collect();
    assert_snapshot!("bundle_over_others", desk.fault(&forced));
    assert_eq!(fs::read_to_string(desk.path("cave.zip")).unwrap(), "a letter");
    fs::remove_file(desk.path("cave.zip")).unwrap();
    desk.make(&bundled);
    desk.make(&forced);
    assert!(desk.run(&["check", "cave.zip"]).status.success());
}

/// Exit code, stdout and stderr of a check.
fn said_of(desk: &Desk, package: &str) -> String {
    let output = desk.run(&["check", package]);
    let [out, fault] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    format!("exit {}\n{out}{fault}", output.status.code().unwrap())
}

#[test]
fn a_package_is_checked() {
    let desk = Desk::new();
    desk.make(&SOME);
    assert!(said_of(&desk, "cave").starts_with("exit 0\ncave: intact: gazebo by plume "));
    let license = fs::read_to_string(desk.path("cave/LICENSE.md")).unwrap();
    desk.file("cave/LICENSE.md", &license.replace("yours", "OURS!"));
    desk.file("cave/virus\u{1b}[2J.exe", "MZ");
    fs::remove_file(desk.path("cave/models/cave/model.config")).unwrap();
    assert_snapshot!("package_tampered", said_of(&desk, "cave"));
    assert_snapshot!("package_of_nothing", said_of(&desk, "nowhere"));
    desk.file("letter.txt", "dear diary");
    assert_snapshot!("package_is_a_letter", said_of(&desk, "letter.txt"));
    fs::create_dir(desk.path("empty")).unwrap();
    assert_snapshot!("package_is_empty", said_of(&desk, "empty"));
}

#[test]
fn a_package_of_another_version_is_reported() {
    let desk = Desk::new();
    desk.make(&SOME);
    let manifest = desk.path("cave/manifest.json");
    let newer = fs::read_to_string(&manifest).unwrap().replacen("\"format\": 3", "\"format\": 4", 1);
    fs::write(&manifest, newer.replace(env!("CARGO_PKG_VERSION"), "9.1.0")).unwrap();
    assert_snapshot!("package_of_newer_version", said_of(&desk, "cave"));
    let newer: serde_json::Value = serde_json::from_slice(&fs::read(&manifest).unwrap()).unwrap();
    fs::write(&manifest, newer["files"].to_string()).unwrap();
    assert_snapshot!("package_of_older_version", said_of(&desk, "cave"));
    // Both are ours, and may be replaced.
    let forced: Vec<&str> = SOME.into_iter().chain(["--force"]).collect();
    desk.make(&forced);
    assert!(said_of(&desk, "cave").starts_with("exit 0"));
}

#[test]
fn two_outputs_with_one_path_are_refused_before_the_work() {
    let desk = Desk::new();
    assert_snapshot!("target_twice", desk.fault(&["export", "--target", "gltf,gltf", "--output", "out"]));
    assert_snapshot!(
        "kept_in_package",
        desk.fault(&["export", "--target", "gltf", "--output", "out", "--keep", "out"])
    );
    assert!(!desk.path("out").exists());
}

#[test]
fn a_package_can_be_made_in_the_current_folder() {
    let desk = Desk::new();
    fs::create_dir(desk.path("here")).unwrap();
    let arguments: Vec<&str> = ["export", "--target", "gltf", "--output", "."].iter().chain(&SMALL).copied().collect();
    let output = desk.command(&arguments).current_dir(desk.path("here")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(desk.path("here/manifest.json").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn folders_may_have_names_that_are_not_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let name = OsStr::from_bytes(b"cave\xff");
    for format in ["--quiet", "--json"] {
        let output = desk.command(&["graph", "--force", format, "--output"]).arg(name).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
