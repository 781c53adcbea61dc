//! The arrows of ARCHITECTURE.md, read off the `use` lines.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

use plume::graph::format::FORMATS;

/// Modules of `src`, and the modules that each may name. A module may always name itself.
const ARROWS: &[(&str, &[&str])] = &[
    ("seed", &[]),
    ("echo", &[]),
    ("noise", &["seed"]),
    ("graph", &["echo", "seed"]),
    ("material", &["noise", "seed"]),
    ("field", &["graph", "material", "noise", "seed"]),
    ("mesh", &["field"]),
    ("texture", &["field", "mesh"]),
    ("truth", &["field", "graph"]),
    ("preview", &["field", "graph", "material", "mesh", "truth"]),
    ("recipe", &["echo", "field", "graph", "material", "mesh", "texture"]),
    ("preset", &[]),
    ("store", &["echo", "field", "mesh", "texture"]),
    ("assemble", &["field", "graph", "mesh", "recipe", "store", "texture", "truth"]),
    ("pipeline", &["field", "graph", "mesh", "preview", "recipe", "store"]),
    ("cave", &["assemble", "echo", "graph", "pipeline", "preset", "preview", "recipe", "store"]),
    ("cli", &["cave", "echo", "graph", "material", "mesh", "pipeline", "preset", "preview", "recipe", "store"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    files
}

/// The first path segment of a source below `src`, without `.rs`.
fn module(file: &Path) -> String {
    let below = file.strip_prefix("src").unwrap();
    below.iter().next().unwrap().to_string_lossy().trim_end_matches(".rs").to_owned()
}

/// Modules of this crate that a source names outside its comments.
fn named(text: &str) -> Vec<&str> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let uses = code.flat_map(|line| line.split("crate::").skip(1));
    uses.map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap()).collect()
}

#[test]
fn arrows_point_one_way() {
    for file in sources(Path::new("src")) {
        let (module, text) = (module(&file), fs::read_to_string(&file).unwrap());
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == module) else {
            assert!(["lib", "main"].contains(&module.as_str()), "{module} has no row in ARROWS");
            continue;
        };
        for name in named(&text) {
            let is_module = ARROWS.iter().any(|(known, _)| *known == name);
            let lawful = !is_module || name == module || allowed.contains(&name);
            assert!(lawful, "{}: {module} must not name {name}", file.display());
        }
    }
}

#[test]
fn only_assemble_and_those_above_it_know_exporters() {
    for file in sources(Path::new("src")) {
        let names_exporters = fs::read_to_string(&file).unwrap().contains("plume_exporters");
        assert!(
            !names_exporters || ["assemble", "cave", "cli"].contains(&module(&file).as_str()),
            "{}",
            file.display()
        );
    }
}

#[test]
fn only_the_command_line_prints() {
    for file in sources(Path::new("src")).into_iter().filter(|file| module(file) != "cli") {
        let text = fs::read_to_string(&file).unwrap();
        let prints = ["println!", "eprintln!", "print!(", "io::stdout", "io::stderr"];
        assert!(!prints.iter().any(|word| text.contains(word)), "{}", file.display());
    }
}

#[test]
fn every_file_of_a_table_has_its_row() {
    let rows = |table: &str| fs::read_to_string(table).unwrap();
    for (folder, table) in [("src/graph", "src/graph/generator/mod.rs"), ("src/material", "src/material/mod.rs")] {
        for file in sources(Path::new(folder)) {
            let text = fs::read_to_string(&file).unwrap();
            for line in
                text.lines().filter(|l| l.starts_with("impl Generator for") || l.starts_with("impl Material for"))
            {
                let implementor = line.split_whitespace().nth(3).unwrap();
                assert!(rows(table).contains(implementor), "{}: {implementor} has no row", file.display());
            }
        }
    }
}

#[test]
fn every_reader_has_its_fuzzer_and_its_seeds() {
    for row in FORMATS.iter().filter(|row| row.read.is_some()) {
        let target = fs::read_to_string(format!("fuzz/fuzz_targets/{}.rs", row.name)).expect(row.name);
        assert!(target.contains(&format!("read(\"{}\", bytes)", row.name)), "{}", row.name);
        let seeds = Path::new("tests/data/formats").join(row.name);
        assert!(seeds.is_dir(), "{} has no small files", row.name);
    }
}
