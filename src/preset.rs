//! Built-in recipes: the samples.

/// A sample recipe.
pub struct Preset {
    /// Name in `plume new --preset`.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// The recipe, TOML.
    pub text: &'static str,
}

/// All presets, the default first.
pub static PRESETS: &[Preset] = &[
    Preset {
        name: "cave",
        summary: "the default: a limestone cave of 50 stations with loops",
        text: include_str!("../samples/cave.toml"),
    },
    Preset {
        name: "lava-tube",
        summary: "wide basalt passages, few branches",
        text: include_str!("../samples/lava-tube.toml"),
    },
    Preset {
        name: "mine",
        summary: "drifts and cross-cuts on two levels joined by a ramp",
        text: include_str!("../samples/mine.toml"),
    },
    Preset {
        name: "layers",
        summary: "a mine above a cave, joined by two ramps for vehicles",
        text: include_str!("../samples/layers.toml"),
    },
];
