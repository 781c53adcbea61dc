use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Stones, dripstone and the equipment of mines: things of their own in every package, with collision shapes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct ThingSettings {
    /// Share of the floor that stones cover. 0 leaves out all things, dripstone and equipment too.
    #[schemars(range(min = 0.0, max = 0.4))]
    pub cover: f64,
    /// Amount of dripstone; 1 is natural, 0 none.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub dripstone: f64,
    /// Amount of gravel, stones of 2-5 cm that are drawn and not collided with; 1 is natural, 0 none.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub gravel: f64,
    /// Amount of timber, bolts, rails, pipes and other equipment in mines; 1 is that of a working mine, 0 none.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub sets: f64,
    /// Number of objects for search tasks, such as backpacks and helmets, spread along the passages where there is room.
    #[schemars(range(max = 10000))]
    pub artefacts: u32,
    /// Width of the way along the passages in which nothing is higher than `step_m`, in metres. 0 leaves no way free.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub corridor_m: f64,
    /// Height of the highest step on that way, in metres: 0.025 is what wheels take, 0.1 leaves steps for robots on legs.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub step_m: f64,
    /// Headroom over that way under what hangs from the ceiling, in metres.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub headroom_m: f64,
    /// How much harder than set the floor is to drive on, for curricula: 0 as set; towards 1, stones cover more of it (40 %), more
    /// of them are large, and the way that is kept free narrows to nothing, with its headroom.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub difficulty: f64,
    /// Width in metres under which loose stones are bodies that move when pushed, in MuJoCo, Gazebo, USD and Unity; 0 leaves all in
    /// place.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub movable_m: f64,
    /// Model files of your own, each a kind of its own that is left at the foot of walls like the objects for search tasks, with
    /// its colours, and with its convex hull as the collision shape. Each has a `name`, a `path` and a `count`.
    #[schemars(length(max = 16))]
    pub files: Vec<FileSettings>,
}

/// A model file that is a kind of thing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub struct FileSettings {
    /// Name of the kind and its semantic label: lower-case letters, digits and _; none of `plume list things`.
    #[schemars(length(max = 40), extend("format" = "file-name", "pattern" = "^[a-z][a-z0-9_]*$"))]
    pub name: String,
    /// The file, relative to the recipe: GLB, or OBJ with its MTL and images beside it. Its surface is closed and has at most
    /// 10,000 triangles, and y is up. It stands on its lowest point.
    #[schemars(extend("format" = "path", "minLength" = 1))]
    pub path: PathBuf,
    /// Number in the cave, spread evenly along the passages; where there is no room, there is none.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 10000))]
    pub count: u32,
    /// Factor on all lengths of the file, which are in metres; then the longest side is at most 2 m, and the shortest at least
    /// 5 mm.
    #[serde(default = "unscaled")]
    #[schemars(range(min = 0.000001, max = 1000000.0))]
    pub scale: f64,
}

fn one() -> u32 {
    1
}

fn unscaled() -> f64 {
    1.0
}

impl FileSettings {
    /// The folder of a cave folder that keeps its files.
    pub fn kept_folder(&self) -> String {
        format!("{KEPT}/{}", self.name)
    }

    /// Where a cave folder keeps the file.
    pub fn kept_path(&self) -> String {
        let file = self.path.file_name().unwrap_or_default();
        format!("{}/{}", self.kept_folder(), file.to_string_lossy())
    }
}

/// The folder of a cave folder for the files of models.
pub const KEPT: &str = "models";

/// Largest share of the floor that stones cover.
const MOST_COVER: f64 = 0.4;

impl ThingSettings {
    /// With the difficulty in the cover, the corridor and its headroom. No cover remains no cover.
    pub(super) fn hardened(&self) -> Self {
        let easy = 1.0 - self.difficulty;
        let cover = if self.cover > 0.0 { self.cover * easy + MOST_COVER * self.difficulty } else { 0.0 };
        let (corridor_m, headroom_m) = (self.corridor_m * easy, self.headroom_m * easy);
        Self { cover, corridor_m, headroom_m, ..self.clone() }
    }
}

impl Default for ThingSettings {
    fn default() -> Self {
        Self {
            cover: 0.06,
            dripstone: 1.0,
            gravel: 1.0,
            sets: 1.0,
            artefacts: 0,
            corridor_m: 1.5,
            step_m: 0.025,
            headroom_m: 2.0,
            difficulty: 0.0,
            movable_m: 0.0,
            files: Vec::new(),
        }
    }
}
