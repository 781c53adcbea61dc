//! What a dataset is made from.

use plume::cave;
use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::curve::Task;
use crate::draw::Vary;

/// The specification of a dataset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Spec {
    /// Name of the dataset, and of its caves: lower-case letters, digits, - and _.
    #[schemars(regex(pattern = "^[a-z][a-z0-9_-]*$"), length(max = 60))]
    pub name: String,
    /// First and last seed. There is a cave for each, and for each combination of the values that are drawn by `grid`.
    pub seeds: [u64; 2],
    /// What the caves are made from: a preset (see `plume list presets`); or a recipe, graph or survey, relative to this file.
    pub recipe: String,
    /// Keys of the recipe that are the same in every cave, such as "mesh.voxel_m=0.2".
    pub set: Vec<String>,
    /// What the robots are to do, which decides what the key `difficulty` makes harder: `drive`, `fly` or `slam`.
    pub task: Task,
    /// Targets of each cave; see `plume list targets`. Without one, the cave folders are the dataset.
    pub targets: Vec<String>,
    /// Options of targets, such as "mujoco.sleep=false".
    pub options: Vec<String>,
    /// A robot that every cave is certified for; see `plume list robots`.
    pub robot: Option<String>,
    /// Whether to keep the cave folders beside the packages.
    pub keep_caves: bool,
    /// Number of caves on the contact sheet; 0 makes none.
    #[schemars(range(max = 48))]
    pub sheet: usize,
    /// Shares of the seeds.
    pub split: Shares,
    /// What varies from cave to cave.
    pub vary: Vec<Vary>,
}

impl Default for Spec {
    fn default() -> Self {
        Self {
            name: "caves".to_owned(),
            seeds: [1, 10],
            recipe: "cave".to_owned(),
            set: Vec::new(),
            task: Task::default(),
            targets: Vec::new(),
            options: Vec::new(),
            robot: None,
            keep_caves: false,
            sheet: 24,
            split: Shares::default(),
            vary: Vec::new(),
        }
    }
}

impl Spec {
    /// Whether the cave folders are part of the dataset.
    pub fn keeps_caves(&self) -> bool {
        self.keep_caves || self.targets.is_empty()
    }

    /// The folders of the packages of a cave; targets that are not known have none.
    pub fn packages(&self) -> impl Iterator<Item = String> {
        self.targets.iter().filter_map(|name| Some(cave::target(name).ok()?.folder()))
    }
}

/// Shares of the seeds for training, validation and tests; only their ratio counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Shares {
    /// For training.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub train: f64,
    /// For choosing between what was trained.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub validation: f64,
    /// For the last word.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub test: f64,
}

impl Default for Shares {
    fn default() -> Self {
        Self { train: 0.8, validation: 0.1, test: 0.1 }
    }
}

/// A part of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// For training.
    Train,
    /// For choosing between what was trained.
    Validation,
    /// For the last word.
    Test,
}

impl Part {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Train, Self::Validation, Self::Test];

    /// As in the index.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
            Self::Test => "test",
        }
    }
}

impl Shares {
    /// The part of each of `count` seeds from `first`: as many of each part as its share asks for, to the nearest whole number,
    /// drawn by lot. All caves of a seed are in one part.
    pub fn parts(&self, first: u64, count: usize) -> Vec<Part> {
        let all = self.train + self.validation + self.test;
        let end = |share: f64| (count as f64 * share / all + 0.5) as usize;
        let ends = [end(self.train), end(self.train + self.validation)];
        let mut lots: Vec<(f64, usize)> =
            (0..count).map(|place| (Rng::new(stream(first + place as u64, "split", 0)).unit(), place)).collect();
        lots.sort_by(|a, b| a.partial_cmp(b).expect("lots are numbers"));
        let mut parts = vec![Part::Test; count];
        for (rank, (_, place)) in lots.into_iter().enumerate() {
            if rank < ends[1] {
                parts[place] = if rank < ends[0] { Part::Train } else { Part::Validation };
            }
        }
        parts
    }

    pub(crate) fn is_possible(&self) -> bool {
        self.train + self.validation + self.test > 0.0
    }
}
