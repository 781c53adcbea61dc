//! `cargo xtask interop [--all | PACKAGE_DIR...]`: opens packages with readers that are not ours.
//!
//! Without a folder, the checks open a small synthetic scene, then copies with injected faults that the readers must notice
//! (a reader that accepts everything proves nothing), then sample caves for every target, and small caves where size does
//! not matter. The default cave is always among the samples, the others by turns; `--all` takes every sample. A reader
//! whose program is not available is skipped with a message, and fails the run if the variable `CI` is set.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use crate::plume::{Plume, Profile};
use crate::samples::{self, SAMPLES, Sample};
use crate::targets::Target;
use crate::tools::{self, Result, ensure_debian, root};
use crate::venv::Environment;
use queue::{Check, Tally};

mod assimp;
mod blender;
pub mod certify;
mod faults;
mod formats;
mod gazebo;
mod gltf;
mod graph;
mod gym;
pub mod mujoco;
mod page;
mod queue;
pub mod record;
mod ros2;
pub mod truth;
mod unity;
pub mod urdf;
pub mod usd;

pub use blender::{contrast, picture};
pub use formats::side_by_side;

/// The task.
pub fn run(arguments: &[String]) -> Result<()> {
    match arguments {
        [] => check_samples(&samples::by_turns()?),
        [all] if all == "--all" => check_samples(&SAMPLES.map(Sample::fine)),
        packages => check_packages(&packages.iter().map(PathBuf::from).collect::<Vec<_>>()),
    }
}

/// Installs the programs of all readers, and the Python package for them. What cannot be installed is reported by the checks
/// that need it.
pub fn prepare() {
    let _ = (ensure_debian(&debian()), Plume::python());
    READERS.iter().filter(|reader| reader.may_be_used()).for_each(|reader| drop((reader.prepare)()));
    graph::CHECKS.iter().for_each(|check| drop(check.prepare()));
    let _ = gym::make();
}

/// Installs them in one call, because each call refreshes the package index first.
fn debian() -> Vec<&'static str> {
    let graph = graph::CHECKS.iter().flat_map(|check| check.debian);
    let lists = [&gazebo::DEBIAN[..], &gltf::DEBIAN, &urdf::DEBIAN, &blender::DEBIAN, &assimp::DEBIAN, &truth::DEBIAN];
    lists.into_iter().flatten().chain(graph).copied().collect()
}

/// One reader on one package.
pub fn only(name: &str, package: &Path) -> Result<()> {
    let reader = READERS.iter().find(|reader| reader.name == name).ok_or("there is no such reader")?;
    (reader.prepare)()?;
    println!("{}", reader.open(package)?);
    Ok(())
}

fn check_packages(packages: &[PathBuf]) -> Result<()> {
    if let Some(unknown) = packages.iter().find(|package| Kind::of(package).is_none()) {
        return Err(format!("no reader knows such a package: {}", unknown.display()));
    }
    let tally = Tally::default();
    let readers = ready(|reader| packages.iter().any(|package| Kind::of(package) == Some(reader.of)), &tally);
    tally.run(packages.iter().flat_map(|package| checks_of(&readers, package)).collect());
    tally.result()
}

fn check_samples(samples: &[Sample]) -> Result<()> {
    let (tally, plume) = (Tally::default(), Plume::package(Profile::Dev)?);
    let targets = Target::all(&plume)?;
    println!("samples: {}", samples.iter().map(|sample| sample.name).collect::<Vec<_>>().join(", "));
    let readers = ready(|_| true, &tally);
    let scene = write_scene()?;
    // The longest checks start first, so that none of them runs alone at the end.
    let mut checks = checks_of_graphs(&tally)?;
    match gym::make() {
        Ok(()) => checks.push(Check::new("gym", gym::train)),
        Err(missing) => tally.skip("gym", &missing),
    }
    let mut opened = Opened::default();
    checks.extend(checks_of_small_things(&readers, &plume, &targets, &scene, &mut opened)?);
    for sample in samples {
        let folder = target_folder().join(sample.name);
        let packages = without_twins(export_cave(&plume, &targets, sample)?);
        opened.add(&readers, &packages);
        checks.extend(packages.iter().flat_map(|package| checks_of_export(&readers, package)));
        let before = tally.failures();
        tally.run(queue::first_ahead("newton", std::mem::take(&mut checks)));
        // Frees the gigabytes of a cave that has passed.
        if tally.failures() == before {
            std::fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
    }
    tally.run(vec![Check::new("table", move || opened.are_those_of(&targets, &readers))]);
    tally.result()
}

/// Checks that need no large cave: the synthetic scene, its injected faults, and small caves.
fn checks_of_small_things(
    readers: &[&'static Reader],
    plume: &Plume,
    targets: &[Target],
    scene: &Path,
    opened: &mut Opened,
) -> Result<Vec<Check>> {
    let on_scene = |who, ask: fn(&Path) -> Result<String>| {
        let scene = scene.to_owned();
        Check::new(who, move || ask(&scene))
    };
    let mut checks = vec![
        Check::new("husky", urdf::check_faults),
        on_scene("unity", unity::check_faults),
        on_scene("ros2", ros2::check_faults),
    ];
    if readers.iter().any(|reader| reader.name == "physx") {
        checks.push(Check::new("physx", usd::check_faults));
    }
    let pages = vec![page::write(plume)?];
    let small = [export_pieces(plume, targets)?, export_movable(plume)?, assimp::export(plume)?, pages].concat();
    checks.extend(small.iter().flat_map(|package| checks_of_export(readers, package)));
    let mut packages: Vec<PathBuf> = files_of(scene).filter(|package| opens_alone(package)).collect();
    packages.sort();
    packages.extend([scene.to_owned(), formats::shelve(scene, targets)?]);
    checks.extend(packages.iter().flat_map(|package| checks_of(readers, package)));
    opened.add(readers, &[small, packages].concat());
    checks.extend(faults::checks(readers, scene));
    Ok(checks)
}

fn checks_of_graphs(tally: &Tally) -> Result<Vec<Check>> {
    let plume = Arc::new(Plume::build(Profile::Dev)?);
    let mut checks = Vec::new();
    for check in &graph::CHECKS {
        match check.prepare() {
            Ok(environment) => {
                let plume = plume.clone();
                checks.push(Check::new(check.name, move || check.ask(&environment, &plume)));
            }
            Err(missing) => tally.skip(check.name, &missing),
        }
    }
    Ok(checks)
}

/// A foreign program that opens our packages.
struct Reader {
    name: &'static str,
    of: Kind,
    /// Installs the program, or reports what is missing.
    prepare: fn() -> Result<()>,
    /// The command to run on a package. It prints a summary or fails.
    command: fn(&Path) -> Result<Command>,
}

impl Reader {
    fn may_be_used(&self) -> bool {
        self.name != "physx" || usd::has_agreed()
    }

    fn open(&self, package: &Path) -> Result<String> {
        tools::run(&mut (self.command)(package)?)
    }
}

static READERS: [Reader; 33] = [
    Reader { name: "pybullet", of: Kind::Gazebo, prepare: gazebo::make_bullet, command: gazebo::drop_balls },
    Reader { name: "rest", of: Kind::Gazebo, prepare: gazebo::make_bullet, command: gazebo::let_go_of_stones },
    Reader { name: "gazebo", of: Kind::Gazebo, prepare: gazebo::make, command: gazebo::open },
    Reader { name: "gazebo", of: Kind::Ros2, prepare: gazebo::make, command: gazebo::open },
    Reader { name: "ros2", of: Kind::Ros2, prepare: ros2::make, command: ros2::check },
    Reader { name: "validator", of: Kind::Gltf, prepare: gltf::make, command: gltf::validate },
    Reader { name: "three", of: Kind::Gltf, prepare: gltf::make_browser, command: gltf::draw },
    Reader { name: "validator", of: Kind::Tiles, prepare: gltf::make, command: gltf::validate },
    Reader { name: "tiles", of: Kind::Tiles, prepare: gltf::make_browser, command: gltf::stream },
    Reader { name: "cesium", of: Kind::Tiles, prepare: gltf::make_browser, command: gltf::stream_in_cesium },
    Reader { name: "three-fbx", of: Kind::Fbx, prepare: gltf::make_browser, command: gltf::draw },
    Reader { name: "page", of: Kind::Page, prepare: gltf::make_browser, command: page::open },
    Reader { name: "check_urdf", of: Kind::Urdf, prepare: urdf::install_parser, command: urdf::parse },
    Reader { name: "pinocchio", of: Kind::Urdf, prepare: urdf::make, command: urdf::open_in_pinocchio },
    Reader { name: "yourdfpy", of: Kind::Urdf, prepare: urdf::make, command: urdf::open_in_yourdfpy },
    Reader { name: "unity", of: Kind::Unity, prepare: unity::make, command: unity::check },
    Reader { name: "usd", of: Kind::Usd, prepare: usd::make, command: usd::validate },
    Reader { name: "usd-old", of: Kind::Usd, prepare: usd::make_old, command: usd::compare },
    Reader { name: "newton", of: Kind::Usd, prepare: usd::make_newton, command: usd::drop_balls },
    Reader { name: "compile", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::compile },
    Reader { name: "balls", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::drop_balls },
    Reader { name: "rays", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::shoot_rays },
    Reader { name: "things", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::count_things },
    Reader { name: "sleep", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::sleep },
    Reader { name: "trimesh", of: Kind::Shelf, prepare: formats::make, command: formats::open },
    Reader { name: "blender", of: Kind::Shelf, prepare: blender::make, command: blender::open },
    Reader { name: "libassimp", of: Kind::Shelf, prepare: formats::make_assimp, command: formats::open_in_assimp },
    Reader { name: "orient", of: Kind::Marker, prepare: formats::make, command: formats::orient },
    Reader { name: "blender", of: Kind::Marker, prepare: blender::make, command: blender::open },
    Reader { name: "libassimp", of: Kind::Marker, prepare: formats::make_assimp, command: formats::open_in_assimp },
    Reader { name: "assimp", of: Kind::Assimp, prepare: assimp::make, command: assimp::compare },
    Reader { name: "truth", of: Kind::Truth, prepare: truth::make, command: truth::check },
    Reader { name: "physx", of: Kind::Usd, prepare: usd::make_physx, command: usd::touch },
];

/// The target of a package, recognised by its files.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Gazebo,
    /// A Gazebo package with launch files: those without are opened by all other readers of Gazebo.
    Ros2,
    Gltf,
    Tiles,
    Unity,
    Fbx,
    Urdf,
    Usd,
    Mujoco,
    Truth,
    /// All packages of one cave, next to each other.
    Shelf,
    /// The samples of the exporters.
    Marker,
    Assimp,
    /// A page for a browser.
    Page,
}

impl Kind {
    fn of(package: &Path) -> Option<Self> {
        match package {
            _ if formats::is_marked(package) => Some(Self::Marker),
            _ if formats::is_shelf(package) => Some(Self::Shelf),
            _ if ros2::is_launched(package) => Some(Self::Ros2),
            _ if package.join("worlds").is_dir() => Some(Self::Gazebo),
            // Packages for Unreal have a `scene.json` too.
            _ if package.join("import_cave.py").is_file() => None,
            _ if package.join("scene.json").is_file() => Some(Self::Gltf),
            _ if package.join("tileset.json").is_file() => Some(Self::Tiles),
            _ if package.join("Runtime").is_dir() => Some(Self::Unity),
            _ if holds(package, &["fbx"]) => Some(Self::Fbx),
            _ if urdf::file_of(package).is_some() => Some(Self::Urdf),
            _ if holds(package, &["usda", "usdz"]) => Some(Self::Usd),
            _ if package.join("floor.npz").is_file() => Some(Self::Truth),
            _ if package.join("rover.xml").is_file() => Some(Self::Mujoco),
            _ if assimp::is_package(package) => Some(Self::Assimp),
            _ if page::is_page(package) => Some(Self::Page),
            _ => None,
        }
    }
}

fn holds(folder: &Path, endings: &[&str]) -> bool {
    files_of(folder).any(|path| path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)))
}

fn files_of(folder: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()))
}

/// The requested readers whose programs are available; the others are skipped.
fn ready(is_wanted: impl Fn(&Reader) -> bool, tally: &Tally) -> Vec<&'static Reader> {
    let mut ready = Vec::new();
    for reader in READERS.iter().filter(|reader| is_wanted(reader)) {
        if !reader.may_be_used() {
            println!(
                "LEFT    {:<10} its licence has not been accepted: see docs/decisions/0031-omniverse-licence.md",
                reader.name
            );
            continue;
        }
        match (reader.prepare)() {
            Ok(()) => ready.push(reader),
            Err(missing) => tally.skip(reader.name, &missing),
        }
    }
    ready
}

fn checks_of(readers: &[&'static Reader], package: &Path) -> Vec<Check> {
    let kind = Kind::of(package);
    let fitting = readers.iter().filter(|reader| kind == Some(reader.of));
    let check = |reader: &&'static Reader| {
        let (reader, package) = (*reader, package.to_owned());
        Check::new(reader.name, move || reader.open(&package))
    };
    fitting.map(check).collect()
}

/// Which readers have opened packages of which targets.
#[derive(Default)]
struct Opened(BTreeSet<(String, &'static str)>);

impl Opened {
    fn add(&mut self, readers: &[&'static Reader], packages: &[PathBuf]) {
        for package in packages {
            let kind = Kind::of(package);
            let targets = match kind {
                Some(Kind::Shelf) => files_of(package).filter_map(|path| target_of(&path)).collect(),
                Some(Kind::Marker) => files_of(&package.join("marker")).filter_map(|path| target_of(&path)).collect(),
                _ => Vec::from_iter(target_of(package)),
            };
            for reader in readers.iter().filter(|reader| kind == Some(reader.of)) {
                self.0.extend(targets.iter().map(|target| (target.clone(), reader.name)));
            }
        }
    }

    /// Fails unless every check that a target's row names has opened a package of that target, if its reader is available.
    fn are_those_of(&self, targets: &[Target], readers: &[&'static Reader]) -> Result<String> {
        let named = targets.iter().flat_map(|target| target.checks().map(move |check| (target.name(), check)));
        for (target, check) in named.clone() {
            if !READERS.iter().any(|reader| reader.name == check) {
                return Err(format!("the row of `{target}` names {check}, which is no interop check"));
            }
            let is_here = readers.iter().any(|reader| reader.name == check);
            if is_here && !self.0.iter().any(|(opened, by)| opened == target && *by == check) {
                return Err(format!("the row of `{target}` names {check}, which has opened no package of it"));
            }
        }
        Ok(format!("{} checks that rows of targets name have opened their packages", named.count()))
    }
}

/// The target of a package, by the name of its folder: `glb` for `glb_webp`, `assimp` for `assimp-collada`.
fn target_of(package: &Path) -> Option<String> {
    let name = package.file_name()?.to_str()?;
    name.split(['_', '-', '.']).next().map(str::to_owned)
}

/// Adds the checks that apply to packages of caves but not to the synthetic scene.
fn checks_of_export(readers: &[&'static Reader], package: &Path) -> Vec<Check> {
    let mut checks = checks_of(readers, package);
    let mut also = |who, ask: fn(&Path) -> Result<String>| {
        let package = package.to_owned();
        checks.push(Check::new(who, move || ask(&package)));
    };
    if package.join("manifest.json").is_file() {
        also("check", is_whole);
    }
    match Kind::of(package) {
        // The route follows from the cave.
        Some(Kind::Mujoco) if mujoco::cave_of(package).is_dir() => {
            also("drive", mujoco::drive);
            also("certify", certify::check);
        }
        Some(Kind::Page) if readers.iter().any(|reader| reader.name == "page") => also("page", page::check_faults),
        _ => {}
    }
    checks
}

/// Writes the synthetic scene for every target, and the marker.
pub fn write_scene() -> Result<PathBuf> {
    let scene = target_folder().join("sample");
    let writer = Profile::Dev.example("sample_package")?;
    tools::run(Command::new(writer).arg(&scene).args(formats::python()))?;
    Ok(scene)
}

/// Whether a package of the synthetic scene is opened on its own. The tests of the Python package cover USD, and the MuJoCo
/// scene has nothing that moves.
fn opens_alone(package: &Path) -> bool {
    matches!(Kind::of(package), Some(Kind::Gazebo | Kind::Ros2 | Kind::Gltf | Kind::Unity | Kind::Fbx | Kind::Urdf))
}

/// Exports a sample for every target. The cave folder stays next to the MuJoCo package, which needs its route.
fn export_cave(plume: &Plume, targets: &[Target], sample: &Sample) -> Result<Vec<PathBuf>> {
    let name = sample.name;
    let (recipe, output) = (format!("samples/{name}.toml"), format!("target/interop/{name}"));
    let cave = format!("{output}/mujoco.cave");
    let names: Vec<&str> = targets.iter().filter(|target| target.is_complete()).map(Target::name).collect();
    let list = names.join(",");
    let export = ["export", &recipe, "--target", &list, "--output", &output, "--keep", &cave, "--force"];
    plume.output(&[&export[..], sample.settings].concat())?;
    let mut packages: Vec<PathBuf> = names.iter().map(|target| root().join(&output).join(target)).collect();
    packages.push(root().join(&output));
    Ok(packages)
}

/// Keeps only one of the USD packages of a large cave: all hold the same stage, and its validators take minutes on a large one.
/// Of small caves all are validated, and Blender opens all of every cave.
fn without_twins(packages: Vec<PathBuf>) -> Vec<PathBuf> {
    let (mut stages, mut others): (Vec<_>, Vec<_>) =
        packages.into_iter().partition(|package| matches!(Kind::of(package), Some(Kind::Usd)));
    stages.truncate(1);
    others.splice(0..0, stages);
    others
}

/// A cave with few convex pieces, because the USD validators are slow on each.
fn export_pieces(plume: &Plume, targets: &[Target]) -> Result<Vec<PathBuf>> {
    let output = "target/interop/pieces";
    let targets: Vec<&str> = targets.iter().filter(|target| target.has_pieces()).map(Target::name).collect();
    let options: Vec<String> = targets.iter().map(|target| format!("{target}.collision=pieces")).collect();
    let names = targets.join(",");
    let mut export = vec!["export", "samples/cave.toml", "--target", &names, "--output", output, "--force"];
    export.extend(["--set", "graph.nodes=4", "--set", "mesh.voxel_m=0.5", "--set", "texture.size_px=256"]);
    export.extend(options.iter().flat_map(|option| ["--option", option]));
    plume.output(&export)?;
    Ok(targets.iter().map(|target| root().join(output).join(target)).collect())
}

/// A small cave with stones that move.
fn export_movable(plume: &Plume) -> Result<Vec<PathBuf>> {
    let output = "target/interop/movable";
    let mut export = vec!["export", "samples/cave.toml", "--target", "gazebo,usd", "--output", output, "--force"];
    export.extend(["--set", "graph.nodes=6", "--set", "things.movable_m=0.2", "--set", "texture.size_px=256"]);
    plume.output(&export)?;
    Ok(["gazebo", "usd"].map(|target| root().join(output).join(target)).into())
}

/// Not a foreign reader: whether `plume check` accepts the package that the others open.
fn is_whole(package: &Path) -> Result<String> {
    tools::run(Command::new(Environment::of_project()?.program("plume")).arg("check").arg(package))
}

fn target_folder() -> PathBuf {
    root().join("target/interop")
}

const REQUIREMENTS: &str = "tests/interop/requirements.txt";
