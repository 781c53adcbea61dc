//! The kinds of things, one row each.

use plume_graph::rng::Rng;
use plume_registry::{Named, Registry};

use super::{dripstone, stone};

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
        shapes: Shapes::Own { count: 6, make: stone::block },
        place: Place::Floor(Scatter { width_m: [0.36, 1.15], exponent: 1.6, share: 0.55 }),
    },
    KindRow {
        name: "slab",
        summary: "flat pieces of beds or lining, 0.25-0.9 m",
        rocks: &["limestone", "basalt", "salt"],
        rock_setting: None,
        shapes: Shapes::Own { count: 3, make: stone::slab },
        place: Place::Floor(Scatter { width_m: [0.25, 0.9], exponent: 1.8, share: 0.15 }),
    },
    KindRow {
        name: "cobble",
        summary: "angular stones of 0.14-0.36 m",
        rocks: &[],
        rock_setting: None,
        shapes: Shapes::Own { count: 6, make: stone::cobble },
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
        shapes: Shapes::Own { count: 4, make: dripstone::stalactite },
        place: Place::Ceiling(Hang { median_m: 0.16, sigma: 0.8, longest_m: 1.2, per_m2: 22.0, dripping: 0.45 }),
    },
    KindRow {
        name: "stalagmite",
        summary: "dripstone that stands below a stalactite",
        rocks: &["limestone"],
        rock_setting: Some(("flowstone", 0.6)),
        shapes: Shapes::Own { count: 4, make: dripstone::stalagmite },
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
]);

impl Place {
    /// Whether things lie loose, so that they are placed by their centre of mass.
    pub fn is_loose(&self) -> bool {
        matches!(self, Self::Floor(_))
    }
}

impl KindRow {
    /// The kind whose shapes it has.
    pub fn model(&self) -> &str {
        match self.shapes {
            Shapes::Own { .. } => self.name,
            Shapes::Of(other) => other,
        }
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
