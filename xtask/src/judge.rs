//! `cargo xtask judge [PACKAGE_DIR...]`: opens packages with readers that are not ours.
//!
//! Without a folder, a small made-up scene is judged, then spoiled in ways that the judges must notice (a judge that
//! cannot say no is worth nothing), and then every sample cave is judged for every target, and a small one of convex pieces
//! for every target that offers them. A judge whose program cannot be had is skipped loudly, and fails the run where the
//! environment variable `CI` is set.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::plume::Plume;
use crate::samples::SAMPLES;
use crate::tools::{self, Result, ensure_debian, ensure_npm, root};
use crate::venv::Environment;

mod assimp;
mod blender;
mod formats;
mod graph;
pub mod mujoco;
mod page;
mod spoil;
mod unity;
pub mod urdf;
pub mod usd;

/// The task.
pub fn run(arguments: &[String]) -> Result<()> {
    let mut tally = Tally::default();
    if arguments.is_empty() {
        let sample = export_sample()?;
        let judges = ready(&JUDGES.iter().collect::<Vec<_>>(), &mut tally);
        for package in SAMPLE_PACKAGES {
            judge(&judges, &sample.join(package), &mut tally);
        }
        judge(&judges, &sample, &mut tally);
        judge(&judges, &formats::shelve(&sample)?, &mut tally);
        spoil::run(&judges, &sample, &mut tally)?;
        if judges.iter().any(|judge| judge.name == "physx") {
            tally.enter("physx", usd::spoil());
        }
        judge_caves(&judges, &mut tally)?;
        tally.enter("husky", urdf::spoil());
        tally.enter("unity", unity::spoil());
        judge_graphs(&mut tally)?;
        return tally.result();
    }
    let packages: Vec<PathBuf> = arguments.iter().map(PathBuf::from).collect();
    if let Some(stranger) = packages.iter().find(|package| Kind::of(package).is_none()) {
        return Err(format!("no judge knows such a package: {}", stranger.display()));
    }
    let wanted = |judge: &&Judge| packages.iter().any(|package| Kind::of(package) == Some(judge.of));
    let judges = ready(&JUDGES.iter().filter(wanted).collect::<Vec<_>>(), &mut tally);
    packages.iter().for_each(|package| judge(&judges, package, &mut tally));
    tally.result()
}

/// One judge on one package.
pub fn only(name: &str, package: &Path) -> Result<()> {
    let judge = JUDGES.iter().find(|judge| judge.name == name).ok_or("there is no such judge")?;
    (judge.prepare)()?;
    println!("{}", verdict(judge, package)?);
    Ok(())
}

/// A reader that is not ours.
struct Judge {
    name: &'static str,
    of: Kind,
    /// Gets the program, or says what is missing.
    prepare: fn() -> Result<()>,
    /// What to run on a package; it ends with praise on stdout, or fails.
    command: fn(&Path) -> Result<Command>,
}

const JUDGES: [Judge; 24] = [
    Judge { name: "pybullet", of: Kind::Gazebo, prepare: make_venv, command: drop_pybullet },
    Judge { name: "gazebo", of: Kind::Gazebo, prepare: build_gazebo, command: open_gazebo },
    Judge { name: "validator", of: Kind::Gltf, prepare: install_node, command: validate_gltf },
    Judge { name: "three", of: Kind::Gltf, prepare: install_browser, command: shoot_package },
    Judge { name: "three-fbx", of: Kind::Fbx, prepare: install_browser, command: shoot_package },
    Judge { name: "page", of: Kind::Page, prepare: page::make, command: page::open },
    Judge { name: "check_urdf", of: Kind::Urdf, prepare: urdf::install_parser, command: urdf::parse },
    Judge { name: "pinocchio", of: Kind::Urdf, prepare: urdf::make, command: urdf::open_in_pinocchio },
    Judge { name: "yourdfpy", of: Kind::Urdf, prepare: urdf::make, command: urdf::open_in_yourdfpy },
    Judge { name: "unity", of: Kind::Unity, prepare: unity::make, command: unity::check },
    Judge { name: "usd", of: Kind::Usd, prepare: usd::make, command: usd::validate },
    Judge { name: "usd-old", of: Kind::Usd, prepare: usd::make_old, command: usd::compare },
    Judge { name: "newton", of: Kind::Usd, prepare: usd::make_newton, command: usd::drop_balls },
    Judge { name: "compile", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::compile },
    Judge { name: "balls", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::drop_balls },
    Judge { name: "rays", of: Kind::Mujoco, prepare: mujoco::make, command: mujoco::shoot_rays },
    Judge { name: "trimesh", of: Kind::Shelf, prepare: formats::make, command: formats::open },
    Judge { name: "blender", of: Kind::Shelf, prepare: blender::make, command: blender::open },
    Judge { name: "libassimp", of: Kind::Shelf, prepare: formats::make_assimp, command: formats::open_in_assimp },
    Judge { name: "orient", of: Kind::Marker, prepare: formats::make, command: formats::orient },
    Judge { name: "blender", of: Kind::Marker, prepare: blender::make, command: blender::open },
    Judge { name: "libassimp", of: Kind::Marker, prepare: formats::make_assimp, command: formats::open_in_assimp },
    Judge { name: "assimp", of: Kind::Assimp, prepare: assimp::make, command: assimp::compare },
    Judge { name: "physx", of: Kind::Usd, prepare: usd::make_physx, command: usd::touch },
];

/// What a package is for, told by what lies in it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Gazebo,
    Gltf,
    Unity,
    Fbx,
    Urdf,
    Usd,
    Mujoco,
    /// All packages of one cave, beside each other.
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
            _ if package.join("worlds").is_dir() => Some(Self::Gazebo),
            _ if package.join("scene.json").is_file() => Some(Self::Gltf),
            _ if package.join("Runtime").is_dir() => Some(Self::Unity),
            _ if holds(package, &["fbx"]) => Some(Self::Fbx),
            _ if urdf::file_of(package).is_some() => Some(Self::Urdf),
            _ if holds(package, &["usda", "usdz"]) => Some(Self::Usd),
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

/// Prints a line per verdict and counts what must fail the run.
#[derive(Default)]
struct Tally {
    complaints: usize,
}

impl Tally {
    fn praise(&self, who: &str, text: &str) {
        println!("ok      {who:<10} {}", text.lines().last().unwrap_or_default());
    }

    fn complain(&mut self, who: &str, text: &str) {
        self.complaints += 1;
        println!("FAILED  {who:<10} {text}");
    }

    fn enter(&mut self, who: &str, verdict: Result<String>) {
        match verdict {
            Ok(praise) => self.praise(who, &praise),
            Err(complaint) => self.complain(who, &complaint),
        }
    }

    fn skip(&mut self, who: &str, missing: &str) {
        self.complaints += usize::from(std::env::var_os("CI").is_some());
        println!("SKIPPED {who:<10} {missing}");
    }

    fn result(&self) -> Result<()> {
        match self.complaints {
            0 => Ok(()),
            count => Err(format!("{count} of the judgements above must not be")),
        }
    }
}

/// The judges whose programs are there; the others are skipped.
fn ready(judges: &[&'static Judge], tally: &mut Tally) -> Vec<&'static Judge> {
    let mut ready = Vec::new();
    for judge in judges {
        if judge.name == "physx" && !usd::has_agreed() {
            println!("LEFT    {:<10} its licence has not been accepted: see the end of ARCHITECTURE.md", judge.name);
            continue;
        }
        match (judge.prepare)() {
            Ok(()) => ready.push(*judge),
            Err(missing) => tally.skip(judge.name, &missing),
        }
    }
    ready
}

fn judge(judges: &[&'static Judge], package: &Path, tally: &mut Tally) {
    for judge in judges.iter().filter(|judge| Kind::of(package) == Some(judge.of)) {
        tally.enter(judge.name, verdict(judge, package));
    }
}

fn verdict(judge: &Judge, package: &Path) -> Result<String> {
    tools::run(&mut (judge.command)(package)?)
}

fn export_sample() -> Result<PathBuf> {
    let sample = target_folder().join("sample");
    tools::run(
        Command::new(env!("CARGO"))
            .args(["run", "-q", "-p", "plume-exporters", "--example", "sample_package", "--"])
            .arg(&sample)
            .args(formats::python())
            .current_dir(root()),
    )?;
    Ok(sample)
}

/// Packages of the sample that are judged as they are.
const SAMPLE_PACKAGES: [&str; 20] = [
    "fbx",
    "fbx_chunks",
    "fbx_pieces",
    "fbx_y",
    "gazebo",
    "gazebo_pieces",
    "glb",
    "glb_chunks",
    "glb_lods",
    "glb_meshopt",
    "glb_pieces",
    "glb_webp",
    "gltf",
    "gltf_meshopt",
    "gltf_pieces",
    "gltf_webp",
    "unity",
    "unity_pieces",
    "urdf",
    "urdf_pieces",
];

/// Makes the samples one by one and asks of each; a cave that is good gives its gigabytes back.
fn judge_caves(judges: &[&'static Judge], tally: &mut Tally) -> Result<()> {
    let plume = Plume::package()?;
    for name in SAMPLES {
        let before = tally.complaints;
        let folder = target_folder().join(name);
        judge_packages(judges, &export_cave(&plume, name)?, tally);
        if tally.complaints == before {
            std::fs::remove_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        }
    }
    let others = [export_pieces(&plume)?, assimp::export(&plume)?, vec![page::write(&plume)?]];
    judge_packages(judges, &others.concat(), tally);
    Ok(())
}

fn judge_packages(judges: &[&'static Judge], packages: &[PathBuf], tally: &mut Tally) {
    for package in packages {
        if package.join("manifest.json").is_file() {
            tally.enter("check", check(package));
        }
        judge(judges, package, tally);
        if Kind::of(package) == Some(Kind::Mujoco) {
            tally.enter("drive", mujoco::drive(package));
        }
        if Kind::of(package) == Some(Kind::Page) && judges.iter().any(|judge| judge.name == "page") {
            tally.enter("page", page::spoil(package));
        }
    }
}

fn judge_graphs(tally: &mut Tally) -> Result<()> {
    let plume = Plume::build()?;
    for judge in &graph::JUDGES {
        match judge.prepare() {
            Ok(environment) => tally.enter(judge.name, judge.ask(&environment, &plume)),
            Err(missing) => tally.skip(judge.name, &missing),
        }
    }
    Ok(())
}

/// A sample, for every target; beside the package for MuJoCo lies the cave, for the way through it.
fn export_cave(plume: &Plume, name: &str) -> Result<Vec<PathBuf>> {
    let (recipe, output) = (format!("samples/{name}.toml"), format!("target/judges/{name}"));
    let (opened, cave) = ("gazebo,glb,gltf,fbx,isaac,unity,urdf,usd,usdz,mujoco", format!("{output}/mujoco.cave"));
    let targets = format!("{opened},obj,ply,stl");
    plume.output(&["export", &recipe, "--target", &targets, "--output", &output, "--keep", &cave, "--force"])?;
    let mut packages: Vec<PathBuf> = opened.split(',').map(|target| root().join(&output).join(target)).collect();
    packages.push(root().join(&output));
    Ok(packages)
}

/// A cave of few convex pieces, because the validators of USD take long over each.
fn export_pieces(plume: &Plume) -> Result<Vec<PathBuf>> {
    let (targets, output) = (["gazebo", "glb", "gltf", "fbx", "isaac", "unity", "usd", "usdz"], "target/judges/pieces");
    let options = targets.map(|target| format!("{target}.collision=pieces"));
    let names = targets.join(",");
    let mut export = vec!["export", "samples/cave.toml", "--target", &names, "--output", output, "--force"];
    export.extend(["--set", "graph.nodes=4", "--set", "mesh.voxel_m=0.5", "--set", "texture.size_px=256"]);
    export.extend(options.iter().flat_map(|option| ["--option", option]));
    plume.output(&export)?;
    Ok(targets.map(|target| root().join(output).join(target)).into())
}

/// Not a reader of others: whether ours says of a package that these take that it is whole.
fn check(package: &Path) -> Result<String> {
    tools::run(Command::new(Environment::of_project()?.program("plume")).arg("check").arg(package))
}

fn make_venv() -> Result<()> {
    Environment::of_project()?.with(REQUIREMENTS).map(drop)
}

fn drop_pybullet(package: &Path) -> Result<Command> {
    let mut command = Command::new(Environment::of_project()?.with(REQUIREMENTS)?.python());
    command.arg(root().join("tests/judges/drop_pybullet.py")).arg(package);
    Ok(command)
}

fn build_gazebo() -> Result<()> {
    ensure_debian(&GAZEBO_PACKAGES)?;
    let (source, build) = (root().join("tests/judges/gazebo"), target_folder().join("gazebo"));
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(source).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Release");
    if tools::run(&mut configure).is_err() && build.exists() {
        // A checkout that was moved or copied takes a cache along that names its old place.
        std::fs::remove_dir_all(&build).map_err(|error| error.to_string())?;
        tools::run(&mut configure)?;
    }
    tools::run(Command::new("cmake").arg("--build").arg(build)).map(drop)
}

fn open_gazebo(package: &Path) -> Result<Command> {
    let mut command = Command::new(target_folder().join("gazebo/judge"));
    command.arg(package);
    Ok(command)
}

fn install_node() -> Result<()> {
    ensure_npm(&node_folder())
}

fn validate_gltf(package: &Path) -> Result<Command> {
    let mut command = Command::new("node");
    command.arg(node_folder().join("validate.mjs")).args(gltf_files(package));
    Ok(command)
}

fn install_browser() -> Result<()> {
    ensure_debian(&["chromium"])?;
    install_node()
}

/// The picture lies beside the package: `<package>.png`.
fn shoot_package(package: &Path) -> Result<Command> {
    Ok(shot(package, &package.with_extension("png"), 0))
}

fn shot(package: &Path, picture: &Path, spawn: usize) -> Command {
    let mut command = Command::new("node");
    command.arg(node_folder().join("shot.mjs")).arg(package).arg("--out").arg(picture);
    command.arg("--spawn").arg(spawn.to_string());
    command
}

/// Takes a picture of a package of glTF or FBX from one of its spawn poses.
pub fn shoot(package: &Path, picture: &Path, spawn: usize) -> Result<String> {
    install_browser()?;
    tools::run(&mut shot(package, picture, spawn))
}

fn gltf_files(package: &Path) -> Vec<PathBuf> {
    let folders = [package.to_owned(), package.join("chunks")];
    let is_gltf = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "glb" || ending == "gltf");
    let mut files: Vec<PathBuf> = folders.iter().flat_map(|folder| files_of(folder).filter(is_gltf)).collect();
    files.sort();
    files
}

fn node_folder() -> PathBuf {
    root().join("tests/judges/gltf")
}

fn target_folder() -> PathBuf {
    root().join("target/judges")
}

const REQUIREMENTS: &str = "tests/judges/requirements.txt";

/// Gazebo itself is not in Debian; the libraries it is made of are.
const GAZEBO_PACKAGES: [&str; 8] = [
    "cmake",
    "g++",
    "make",
    "libsdformat-dev",
    "libignition-physics-dev",
    "libignition-physics5-dartsim-plugin5",
    "libignition-plugin-dev",
    "libignition-fuel-tools-dev",
];
