use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Stones and dripstone: things of their own in every package, with collision shapes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct ThingSettings {
    /// Share of the floor that stones cover. 0 leaves out all things, dripstone too.
    #[schemars(range(min = 0.0, max = 0.4))]
    pub cover: f64,
    /// Amount of dripstone; 1 is natural, 0 none.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub dripstone: f64,
    /// Width of the way along the passages in which nothing is higher than a wheel can take (2.5 cm), in metres. 0 leaves no way
    /// free.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub corridor_m: f64,
    /// Headroom over that way under what hangs from the ceiling, in metres.
    #[schemars(range(min = 0.0, max = 5.0))]
    pub headroom_m: f64,
    /// Width in metres under which loose stones are bodies that move when pushed, so far only in MuJoCo; 0 leaves all in place.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub movable_m: f64,
}

impl Default for ThingSettings {
    fn default() -> Self {
        Self { cover: 0.06, dripstone: 1.0, corridor_m: 1.5, headroom_m: 2.0, movable_m: 0.0 }
    }
}
