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
    /// Amount of timber, bolts, rails, pipes and other equipment in mines; 1 is that of a working mine, 0 none.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub sets: f64,
    /// Number of objects for search tasks, such as backpacks and helmets, spread along the passages where there is room.
    #[schemars(range(max = 10000))]
    pub artefacts: u32,
    /// Width of the way along the passages in which nothing is higher than a wheel can take (2.5 cm), in metres. 0 leaves no way
    /// free.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub corridor_m: f64,
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
}

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
            sets: 1.0,
            artefacts: 0,
            corridor_m: 1.5,
            headroom_m: 2.0,
            difficulty: 0.0,
            movable_m: 0.0,
        }
    }
}
