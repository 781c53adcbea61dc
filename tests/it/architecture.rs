//! The arrows between modules of the library, read off the syntax tree. Those between crates are the compiler's.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use plume::survey::FORMATS;
use syn::visit::{self, Visit};
use syn::{ItemMod, ItemUse, UseTree};

/// Folders whose modules these are: the root crate, which re-exports those of the rock.
const FOLDERS: [&str; 2] = ["src", "rock"];

/// Modules, and the modules that each may name. A module may always name itself.
const ARROWS: &[(&str, &[&str])] = &[
    ("noise", &[]),
    ("srgb", &[]),
    ("picture", &["srgb"]),
    ("model", &["picture"]),
    ("material", &["noise", "picture"]),
    ("field", &["material", "noise"]),
    ("mesh", &["field"]),
    ("texture", &["field", "mesh", "noise", "srgb"]),
    ("things", &["field", "material", "mesh", "model", "noise"]),
    ("placement", &["field"]),
    ("preview", &["field", "material", "mesh", "placement", "things"]),
    ("recipe", &["field", "material", "mesh", "model", "preset", "texture", "things"]),
    ("preset", &[]),
    ("store", &["field", "mesh", "texture", "things"]),
    ("assemble", &["field", "mesh", "recipe", "store", "texture", "things", "placement"]),
    ("pipeline", &["field", "material", "mesh", "model", "picture", "preview", "recipe", "store", "texture", "things"]),
    ("trajectory", &[]),
    ("cave", &["assemble", "field", "mesh", "pipeline", "preset", "preview", "recipe", "store", "texture"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        // Tests in a folder of their own are no module.
        .filter(|path| !path.ends_with("tests"))
        .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    files
}

/// The path of the module that a source below one of [`FOLDERS`] holds.
fn module_path(file: &Path) -> Vec<String> {
    let below = file.iter().skip(1).collect::<PathBuf>().with_extension("");
    let path = below.iter().map(|part| part.to_string_lossy().into_owned());
    path.filter(|part| part != "lib").collect()
}

/// The top-level modules that a source names, however the path is written, tests included.
struct Named {
    module: Vec<String>,
    roots: BTreeSet<String>,
}

impl Named {
    fn by(module: Vec<String>, text: &str) -> BTreeSet<String> {
        let mut named = Self { module, roots: BTreeSet::new() };
        named.visit_file(&syn::parse_file(text).unwrap());
        named.roots
    }

    /// Follows `crate`, `self` and `super` to the root.
    fn follow(&mut self, path: &[String]) {
        let (mut place, mut rest) = match path {
            [first, rest @ ..] if first == "crate" => (Vec::new(), rest),
            [first, ..] if first == "self" || first == "super" => (self.module.clone(), path),
            _ => return,
        };
        while let [first, others @ ..] = rest {
            match first.as_str() {
                "self" => {}
                "super" => drop(place.pop()),
                name => place.push(name.to_owned()),
            }
            rest = others;
        }
        self.roots.extend(place.into_iter().next());
    }

    fn follow_use(&mut self, tree: &UseTree, path: &mut Vec<String>) {
        match tree {
            UseTree::Path(step) => {
                path.push(step.ident.to_string());
                self.follow_use(&step.tree, path);
                path.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.follow_use(tree, path)),
            UseTree::Name(last) => self.follow(&[&path[..], &[last.ident.to_string()]].concat()),
            UseTree::Rename(last) => self.follow(&[&path[..], &[last.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.follow(path),
        }
    }
}

impl Visit<'_> for Named {
    fn visit_item_use(&mut self, item: &ItemUse) {
        self.follow_use(&item.tree, &mut Vec::new());
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.follow(&names);
        visit::visit_path(self, path);
    }

    /// Tokens inside a macro are not parsed.
    fn visit_macro(&mut self, call: &syn::Macro) {
        let tokens = call.tokens.to_string();
        for rest in tokens.split("crate :: ").skip(1) {
            let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next();
            self.roots.extend(name.map(str::to_owned));
        }
    }

    fn visit_item_mod(&mut self, module: &ItemMod) {
        self.module.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.module.pop();
    }
}

#[test]
fn every_way_to_name_a_module_is_seen() {
    let texts = [
        "use crate::cave::Cave;",
        "use crate::{cave as _, noise};",
        "use super::super::{cave as _};",
        "fn f() -> super::super::cave::Cave { todo() }",
        "fn f() { crate::cave::run() }",
        "mod inner { use super::super::super::cave; }",
        "impl crate::cave::Order for u8 {}",
        "fn f() { assert!(crate::cave::run()) }",
    ];
    for text in texts {
        assert!(Named::by(vec!["noise".to_owned(), "lanes".to_owned()], text).contains("cave"), "{text}");
    }
    let own = Named::by(vec!["noise".to_owned(), "lanes".to_owned()], "use super::cell; use self::cave; use cave::x;");
    assert_eq!(own, BTreeSet::from(["noise".to_owned()]));
}

#[test]
fn dependencies_point_one_way() {
    for file in FOLDERS.into_iter().flat_map(|folder| sources(Path::new(folder))) {
        let path = module_path(&file);
        let Some(module) = path.first().cloned() else { continue };
        let (_, allowed) = ARROWS.iter().find(|(name, _)| *name == module).expect(&module);
        for name in Named::by(path, &fs::read_to_string(&file).unwrap()) {
            let is_module = ARROWS.iter().any(|(known, _)| *known == name);
            let is_lawful = !is_module || name == module || allowed.contains(&&*name);
            assert!(is_lawful, "{}: {module} must not name {name}", file.display());
        }
    }
}

#[test]
fn only_assemble_and_those_above_it_know_exporters() {
    for file in sources(Path::new("src")) {
        // How images are encoded is a setting of textures, too.
        let text = fs::read_to_string(&file).unwrap().replace("use plume_exporters::ImageFormat;", "");
        let names_exporters = text.contains("plume_exporters");
        // The root crate re-exports them for users of the library.
        let may = matches!(module_path(&file).first().map_or("", String::as_str), "" | "assemble" | "cave");
        assert!(!names_exporters || may, "{}", file.display());
    }
}

#[test]
fn only_the_command_line_prints() {
    let crates = ["src", "graph", "survey", "generators", "disk", "exporters", "record", "rock"];
    for file in crates.into_iter().flat_map(|folder| sources(Path::new(folder))) {
        let is_library = !file.iter().any(|part| part == "tests" || part == "examples");
        let text = fs::read_to_string(&file).unwrap();
        let prints = ["println!", "eprintln!", "print!(", "io::stdout", "io::stderr"];
        assert!(!is_library || !prints.iter().any(|word| text.contains(word)), "{}", file.display());
    }
}

#[test]
fn every_file_of_a_table_has_its_row() {
    let tables = [
        ("generators", "Generator", "generators/lib.rs"),
        ("rock/material", "Rock", "rock/material.rs"),
        ("exporters/targets", "Target", "exporters/lib.rs"),
    ];
    for (folder, contract, table) in tables {
        let rows = fs::read_to_string(table).unwrap();
        let is_library = |file: &PathBuf| !file.iter().any(|part| part == "tests" || part == "examples");
        let mut count = 0;
        for file in sources(Path::new(folder)).into_iter().filter(is_library) {
            let module = file.file_stem().unwrap().to_string_lossy().into_owned();
            for name in implementors(&file, contract) {
                count += 1;
                let forms = [format!("::<{name}>("), format!("{module}::ROW,")];
                assert!(
                    forms.iter().any(|row| rows.contains(row)),
                    "{name} has no row in {table}: add {}",
                    forms.join(" or ")
                );
            }
        }
        assert!(count > 1, "{folder}: nothing implements {contract}");
    }
}

/// The types that a source implements this trait for, outside of its tests.
fn implementors(file: &Path, contract: &str) -> Vec<String> {
    let items = syn::parse_file(&fs::read_to_string(file).unwrap()).unwrap().items;
    let implemented = |item: syn::Item| {
        let syn::Item::Impl(block) = item else { return None };
        let is_it = block.trait_.as_ref().is_some_and(|(_, path, _)| path.segments.last().unwrap().ident == contract);
        let syn::Type::Path(name) = *block.self_ty else { return None };
        is_it.then(|| name.path.segments.last().unwrap().ident.to_string())
    };
    items.into_iter().filter_map(implemented).collect()
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
