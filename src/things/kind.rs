//! The kinds of things, one row each.

use plume_graph::rng::Rng;
use plume_registry::{Named, Registry};

use super::solid::Solid;
use super::{artefact, dripstone, equipment, stone};

/// The signed distance to the surface of a body, positive inside, in metres; the body is within 0.45 m of the origin.
pub type Shape = Box<dyn Fn([f32; 3]) -> f32 + Send + Sync>;

/// A kind of thing.
#[derive(Debug)]
pub struct KindRow {
    /// Its name, which is also the semantic label.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// The rocks in which it occurs; none means all.
    pub rocks: &'static [&'static str],
    /// A setting of the rock that the things have instead of the wall's, such as all flowstone.
    pub rock_setting: Option<(&'static str, f64)>,
    /// What it looks like.
    pub shapes: Shapes,
    /// Where it occurs.
    pub place: Place,
}

/// What things look like.
#[derive(Clone, Copy, Debug)]
pub enum Shapes {
    /// Shapes of its own: how many, and what makes one.
    Own {
        /// Number of different shapes.
        count: u32,
        /// Makes a shape.
        make: fn(&mut Rng) -> Shape,
    },
    /// Solids of its own, too fine for a voxel: how many, and what makes one.
    Solid {
        /// Number of different shapes.
        count: u32,
        /// Makes a shape, within 2.1 m of the origin.
        make: fn(&mut Rng) -> Solid,
    },
    /// Those of another kind in the same rocks, in another size.
    Of(&'static str),
}

/// Where things occur.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// Loose on the floor.
    Floor(Scatter),
    /// Hanging from the ceiling.
    Ceiling(Hang),
    /// On the floor below something that drips.
    UnderDrip,
    /// Where what hangs and what stands would meet.
    Joined,
    /// Built in along the passages.
    Along(Along),
    /// Left at the foot of a wall, to be searched for.
    Lost,
}

/// What is built in along the passages, in stretches.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    /// How it is fitted to the passage.
    pub fit: Fit,
    /// Distance between two of them along the passage, at most, in metres.
    pub spacing_m: f64,
    /// What names the stretches that have it: kinds with one name and range occur together.
    pub stretch: &'static str,
    /// Which passages have it: a range of the number from 0 to 1 that varies along them by that name.
    pub range: [f64; 2],
}

/// How something is fitted to a passage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// Two at a time, from the floor to under a beam.
    Post,
    /// Across the passage under the roof.
    Beam,
    /// In rows into the roof.
    Roof,
    /// A pair along the floor, beside the way.
    Rail,
    /// Under the rails.
    Sleeper,
    /// In pieces along the right wall, 1.6 m above the floor.
    RightWall,
    /// In pieces along the left wall, 1.7 m above the floor.
    LeftWall,
    /// In pieces under the roof, on the left.
    UnderRoof,
    /// On the floor at the left wall.
    FootOfWall,
}

/// Sizes and density of loose stones.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// Range of the width in metres.
    pub width_m: [f64; 2],
    /// Exponent p of the number of stones wider than D, which is proportional to D⁻ᵖ.
    pub exponent: f64,
    /// Their share of the floor covered by stones.
    pub share: f64,
}

/// Lengths and density of what hangs.
#[derive(Clone, Copy, Debug)]
pub struct Hang {
    /// Median of the length in metres, which is log-normal.
    pub median_m: f64,
    /// Standard deviation of the natural logarithm of the length.
    pub sigma: f64,
    /// Largest length in metres.
    pub longest_m: f64,
    /// Number per square metre of ceiling where it drips.
    pub per_m2: f64,
    /// Share of those that have a counterpart on the floor.
    pub dripping: f64,
}

/// All kinds of things. Programs may [register](Registry::register) their own.
///
/// Sizes follow measured distributions where there are any: stalactites are log-normal; for breakdown no law has been
/// measured, so the exponents are a choice.
pub static KINDS: Registry<KindRow> = Registry::new(&[
    KindRow {
        name: "boulder",
        summary: "angular blocks of 0.36-1.15 m that fell from wall and ceiling",
        rocks: &[],
        rock_setting: None,
        shapes: Shapes::Own { count: 4, make: stone::block },
        place: Place::Floor(Scatter { width_m: [0.36, 1.15], exponent: 1.6, share: 0.55 }),
    },
    KindRow {
        name: "slab",
        summary: "flat pieces of beds, 0.25-0.9 m",
        rocks: &["limestone", "salt"],
        rock_setting: None,
        shapes: Shapes::Own { count: 3, make: stone::slab },
        place: Place::Floor(Scatter { width_m: [0.25, 0.9], exponent: 1.8, share: 0.15 }),
    },
    KindRow {
        name: "lining_slab",
        summary: "curved plates of lining that came off the wall of a lava tube, 0.25-0.9 m",
        rocks: &["basalt"],
        rock_setting: None,
        shapes: Shapes::Own { count: 3, make: stone::lining },
        place: Place::Floor(Scatter { width_m: [0.25, 0.9], exponent: 1.8, share: 0.2 }),
    },
    KindRow {
        name: "ropy_slab",
        summary: "broken crust of ropy lava, 0.25-0.8 m",
        rocks: &["basalt"],
        rock_setting: None,
        shapes: Shapes::Own { count: 2, make: stone::ropy },
        place: Place::Floor(Scatter { width_m: [0.25, 0.8], exponent: 1.8, share: 0.12 }),
    },
    KindRow {
        name: "cobble",
        summary: "angular stones of 0.14-0.36 m",
        rocks: &[],
        rock_setting: None,
        shapes: Shapes::Own { count: 5, make: stone::cobble },
        place: Place::Floor(Scatter { width_m: [0.14, 0.36], exponent: 2.2, share: 0.23 }),
    },
    KindRow {
        name: "pebble",
        summary: "angular stones of 5-14 cm",
        rocks: &[],
        rock_setting: None,
        shapes: Shapes::Of("cobble"),
        place: Place::Floor(Scatter { width_m: [0.05, 0.14], exponent: 2.4, share: 0.07 }),
    },
    KindRow {
        name: "stalactite",
        summary: "dripstone that hangs, with the universal shape of Short et al. (2005)",
        rocks: &["limestone"],
        rock_setting: Some(("flowstone", 0.6)),
        shapes: Shapes::Own { count: 3, make: dripstone::stalactite },
        place: Place::Ceiling(Hang { median_m: 0.16, sigma: 0.8, longest_m: 1.2, per_m2: 22.0, dripping: 0.45 }),
    },
    KindRow {
        name: "straws",
        summary: "rows of soda straws, half a centimetre wide (Curl 1972)",
        rocks: &["limestone"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 2, make: dripstone::straws },
        place: Place::Ceiling(Hang { median_m: 0.3, sigma: 0.2, longest_m: 0.5, per_m2: 8.0, dripping: 0.0 }),
    },
    KindRow {
        name: "stalagmite",
        summary: "dripstone that stands below a stalactite",
        rocks: &["limestone"],
        rock_setting: Some(("flowstone", 0.6)),
        shapes: Shapes::Own { count: 3, make: dripstone::stalagmite },
        place: Place::UnderDrip,
    },
    KindRow {
        name: "column",
        summary: "stalactite and stalagmite grown together",
        rocks: &["limestone"],
        rock_setting: Some(("flowstone", 0.6)),
        shapes: Shapes::Own { count: 2, make: dripstone::column },
        place: Place::Joined,
    },
    KindRow {
        name: "lavacicle",
        summary: "drips of remelted lining, a few centimetres long",
        rocks: &["basalt"],
        rock_setting: None,
        shapes: Shapes::Own { count: 3, make: dripstone::lavacicle },
        place: Place::Ceiling(Hang { median_m: 0.055, sigma: 0.5, longest_m: 0.25, per_m2: 30.0, dripping: 0.0 }),
    },
    KindRow {
        name: "post",
        summary: "round timber posts that carry the beams of sets, 1.2-1.8 m apart",
        rocks: &["drilled"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 2, make: equipment::post },
        place: Place::Along(TIMBER.with(Fit::Post)),
    },
    KindRow {
        name: "beam",
        summary: "squared beams of timber sets, under the roof",
        rocks: &["drilled"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::cap },
        place: Place::Along(TIMBER.with(Fit::Beam)),
    },
    KindRow {
        name: "rock_bolt",
        summary: "plates and nuts of rock bolts in the roof, 1.2 m apart",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::bolt },
        place: Place::Along(Along { fit: Fit::Roof, spacing_m: 1.2, stretch: "timber", range: [0.25, 1.0] }),
    },
    KindRow {
        name: "sleeper",
        summary: "sleepers under rails of 0.6 m gauge",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::sleeper },
        place: Place::Along(Along { fit: Fit::Sleeper, spacing_m: 0.7, stretch: "track", range: [0.0, 0.6] }),
    },
    KindRow {
        name: "rail",
        summary: "rails of 0.6 m gauge, beside the way",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::rail },
        place: Place::Along(Along { fit: Fit::Rail, spacing_m: 1.95, stretch: "track", range: [0.0, 0.6] }),
    },
    KindRow {
        name: "pipe",
        summary: "water pipes along the wall, 1.6 m above the floor",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::pipe },
        place: Place::Along(Along { fit: Fit::RightWall, spacing_m: 1.95, stretch: "pipe", range: [0.0, 0.7] }),
    },
    KindRow {
        name: "cable",
        summary: "cables that sag between hooks along the wall, 1.7 m above the floor",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::cable },
        place: Place::Along(Along { fit: Fit::LeftWall, spacing_m: 1.95, stretch: "cable", range: [0.0, 0.75] }),
    },
    KindRow {
        name: "duct",
        summary: "ventilation ducts of 0.6 m under the roof",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::duct },
        place: Place::Along(Along { fit: Fit::UnderRoof, spacing_m: 1.95, stretch: "duct", range: [0.0, 0.4] }),
    },
    KindRow {
        name: "drum",
        summary: "steel drums of 200 litres at the foot of walls",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::drum },
        place: Place::Along(Along { fit: Fit::FootOfWall, spacing_m: 9.0, stretch: "drum", range: [0.0, 0.3] }),
    },
    artefact("backpack", "a red backpack, for search tasks", artefact::backpack),
    artefact("rope", "a coil of climbing rope, for search tasks", artefact::rope),
    artefact("helmet", "a miner's helmet with a lamp, for search tasks", artefact::helmet),
    artefact("drill", "a cordless drill, for search tasks", artefact::drill),
    artefact("extinguisher", "a fire extinguisher, for search tasks", artefact::extinguisher),
    artefact("phone", "a mobile phone, for search tasks", artefact::phone),
    artefact("vent", "a square air vent, for search tasks", artefact::vent),
]);

/// An object for search tasks, in all rocks.
const fn artefact(name: &'static str, summary: &'static str, make: fn(&mut Rng) -> Solid) -> KindRow {
    let shapes = Shapes::Solid { count: 1, make };
    KindRow { name, summary, rocks: &[], rock_setting: None, shapes, place: Place::Lost }
}

/// The kinds that occur in a cave.
#[derive(Clone, Copy, Debug)]
pub struct Kinds<'a> {
    /// Name of its rock.
    pub rock: &'a str,
    /// Whether there are objects for search tasks.
    pub has_artefacts: bool,
}

impl<'a> Kinds<'a> {
    /// Their rows.
    pub fn rows(self) -> impl Iterator<Item = &'static KindRow> + use<'a> {
        KINDS
            .iter()
            .filter(move |row| row.is_in(self.rock) && (self.has_artefacts || !matches!(row.place, Place::Lost)))
    }
}

/// The rocks of mines.
const MINES: &[&str] = &["drilled", "salt"];

/// Timber sets: their spacing is common practice, their share a choice. Where there are none, the roof is bolted.
const TIMBER: Along = Along { fit: Fit::Post, spacing_m: 1.8, stretch: "timber", range: [0.0, 0.25] };

impl Along {
    const fn with(self, fit: Fit) -> Self {
        Self { fit, ..self }
    }
}

impl Place {
    /// Whether they are built in.
    pub fn is_built(&self) -> bool {
        matches!(self, Self::Along(_))
    }

    /// Whether things lie loose, so that they are placed by their centre of mass.
    pub fn is_loose(&self) -> bool {
        matches!(self, Self::Floor(_))
    }
}

impl KindRow {
    /// The kind whose shapes it has.
    pub fn model(&self) -> &str {
        match self.shapes {
            Shapes::Own { .. } | Shapes::Solid { .. } => self.name,
            Shapes::Of(other) => other,
        }
    }

    /// Whether its shapes are made of few triangles, all of which count.
    pub fn is_solid(&self) -> bool {
        matches!(self.shapes, Shapes::Solid { .. })
    }

    /// Whether it occurs in this rock.
    pub fn is_in(&self, rock: &str) -> bool {
        self.rocks.is_empty() || self.rocks.contains(&rock)
    }
}

impl Named for KindRow {
    fn name(&self) -> &'static str {
        self.name
    }
}
