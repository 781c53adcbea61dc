//! Makes one cave of a dataset in a folder of its own.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plume::cave::{self, Cave, CaveError, Order, named_robot};
use plume::pipeline::Observer;
use plume::store::{CaveFolder, StoreError, sha256};
use plume_disk::Staging;
use plume_exporters::place::{Existing, Place};
use plume_exporters::stage::Library;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::measures::{Measures, graph_sha256};
use crate::plan::{Item, Plan};
use crate::spec::Part;

/// What is known about a cave, in its folder.
pub const RECORD: &str = "item.json";
/// Its recipe.
pub const RECIPE: &str = "recipe.toml";
/// Its certificate, if the specification names a robot.
pub const CERTIFICATE: &str = "certificate.json";
/// Its cave folder, if that is kept.
pub const CAVE: &str = "cave";

/// Name of the folder of all caves.
const ITEMS: &str = "items";
/// Name of the folder in which caves are made.
pub(crate) const WORK: &str = "work";

/// What is known about a finished cave of a dataset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its number.
    pub item: usize,
    /// The part of the dataset that it is in.
    pub part: Part,
    /// The seed of its recipe.
    pub seed: u64,
    /// What was drawn for it.
    pub drawn: Map<String, Value>,
    /// SHA-256 of its complete recipe.
    pub recipe_sha256: String,
    /// SHA-256 of its stations and passages.
    pub graph_sha256: String,
    /// Its numbers.
    pub measures: Measures,
    /// Its files but this one, by path.
    pub files: Vec<FileSum>,
}

/// A file of a cave.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileSum {
    /// Its path in the folder of the cave, with `/`.
    pub path: String,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256.
    pub sha256: String,
}

/// The path of a cave in its dataset, with `/`.
pub fn path(number: usize) -> String {
    format!("{ITEMS}/{number:06}")
}

/// Where the caves of a dataset are made: beside all items, as whoever makes a staging folder looks through the folder around it.
pub fn work_folder(root: &Path) -> PathBuf {
    root.join(WORK)
}

/// Makes a cave; it appears whole or not at all. Does nothing if it is there already.
///
/// # Errors
/// An impossible cave, the disk, a missing USD library, the observer's stop.
pub fn make(
    plan: &Plan,
    number: usize,
    root: &Path,
    library: Option<&Arc<dyn Library>>,
    observer: &dyn Observer,
) -> Result<(), CaveError> {
    let place = root.join(path(number));
    if place.join(RECORD).is_file() {
        return Ok(());
    }
    let item = plan.item(number);
    let staging = Staging::new(&work_folder(root)).map_err(|error| StoreError::io(root, error))?;
    let work = staging.path().join("item");
    fs::create_dir(&work).map_err(|error| StoreError::io(&work, error))?;
    let record = fill(plan, &item, &work, library, observer)?;
    write(&work.join(RECORD), &(pretty(&record) + "\n"))?;
    Ok(adopt(root, number, &work)?)
}

/// Moves a finished cave, which may have been made elsewhere, into its place in the dataset. Both are on one file system.
///
/// # Errors
/// If the disk fails.
pub fn adopt(root: &Path, number: usize, folder: &Path) -> Result<(), StoreError> {
    let place = root.join(path(number));
    fs::create_dir_all(root.join(ITEMS)).map_err(|error| StoreError::io(root, error))?;
    match plume_disk::publish(folder, &place) {
        // Another process has made the same.
        Err(error) if [ErrorKind::AlreadyExists, ErrorKind::DirectoryNotEmpty].contains(&error.kind()) => Ok(()),
        published => published.map_err(|error| StoreError::io(&place, error)),
    }
}

/// Writes everything but the record.
fn fill(
    plan: &Plan,
    item: &Item,
    work: &Path,
    library: Option<&Arc<dyn Library>>,
    observer: &dyn Observer,
) -> Result<Record, CaveError> {
    let spec = plan.spec();
    let input = plan.input(item)?;
    write(&work.join(RECIPE), &input.recipe.to_toml())?;
    let recipe_sha256 = sha256(input.recipe.to_json().to_string().as_bytes());
    let folder = CaveFolder::open_or_new(&work.join(CAVE))?;
    let folder = if spec.keeps_caves() { folder } else { folder.ephemeral() };
    let cave = Cave::make(input, folder, false, observer, &mut |_, _| ())?;
    let place = |folder: String| Place { path: work.join(folder), bundle: None, existing: Existing::Keep };
    let orders =
        plan.targets(library)?.into_iter().map(|wanted| Order { place: place(wanted.choice.folder()), wanted });
    let orders: Vec<Order> = orders.collect();
    if orders.iter().any(|order| order.wanted.target.wants_pieces()) {
        cave.make_pieces(observer, &mut |_, _| ())?;
    }
    let chunks = cave.chunks(observer.stop());
    let scene = cave.scene(&chunks);
    cave::export(&scene, &orders)?;
    let robot = spec.robot.as_deref().map(named_robot).transpose()?;
    let certified = robot.as_ref().map(|robot| cave.certify(&scene, robot)).transpose()?;
    if let Some(certified) = &certified {
        write(&work.join(CERTIFICATE), &(pretty(&certified.json()) + "\n"))?;
    }
    let graph_sha256 = graph_sha256(cave.graph());
    let measures = Measures::of(&cave, certified.as_ref().map(|certified| &certified.certificate));
    if !spec.keeps_caves() {
        let folder = work.join(CAVE);
        fs::remove_dir_all(&folder).map_err(|error| StoreError::io(&folder, error))?;
    }
    Ok(Record {
        item: item.number,
        part: item.part,
        seed: item.seed,
        drawn: item.drawn.iter().cloned().collect(),
        recipe_sha256,
        graph_sha256,
        measures,
        files: sums(work)?,
    })
}

/// Sums of all files in a folder, by path.
fn sums(root: &Path) -> Result<Vec<FileSum>, StoreError> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        let named = |error| StoreError::io(&folder, error);
        for entry in fs::read_dir(&folder).map_err(named)? {
            let path = entry.map_err(named)?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let bytes = fs::read(&path).map_err(|error| StoreError::io(&path, error))?;
            let below = path.strip_prefix(root).expect("it was found below").components();
            let names: Vec<_> = below.map(|part| part.as_os_str().to_string_lossy()).collect();
            found.push(FileSum { path: names.join("/"), bytes: bytes.len() as u64, sha256: sha256(&bytes) });
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(found)
}

fn pretty(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("it is plain data")
}

fn write(path: &Path, text: &str) -> Result<(), StoreError> {
    fs::write(path, text).map_err(|error| StoreError::io(path, error))
}
