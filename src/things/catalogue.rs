//! The kinds of things, one row each.

use plume_graph::rng::Rng;
use plume_registry::Registry;

use super::kind::{Along, Fit, Hang, Heading, KindRow, Place, Scatter, Shapes};
use super::solid::Solid;
use super::{artefact, dripstone, equipment, stone};

/// All kinds of things. Programs may [register](Registry::register) their own.
///
/// Sizes follow measured distributions where there are any: stalactites are log-normal; for breakdown no law has been
/// measured, so the exponents are a choice.
pub static KINDS: Registry<KindRow<'static>> = Registry::new(&[
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
        name: "gravel",
        summary: "angular stones of 2-5 cm, which are drawn and not collided with",
        rocks: &[],
        rock_setting: None,
        shapes: Shapes::Of("cobble"),
        place: Place::Strewn(Scatter { width_m: [0.02, 0.05], exponent: 2.5, share: 0.002 }),
    },
    KindRow {
        name: "stalactite",
        summary: "dripstone that hangs, with the universal shape of Short et al. (2005)",
        rocks: &["limestone"],
        rock_setting: Some(("flowstone", 0.6)),
        shapes: Shapes::Own { count: 3, make: dripstone::stalactite },
        place: Place::Ceiling(Hang {
            median_m: 0.16,
            sigma: 0.8,
            longest_m: 1.2,
            per_m2: 22.0,
            dripping: 0.45,
            heading: Heading::Any,
        }),
    },
    KindRow {
        name: "straws",
        summary: "rows of soda straws, half a centimetre wide (Curl 1972)",
        rocks: &["limestone"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 2, make: dripstone::straws },
        place: Place::Ceiling(Hang {
            median_m: 0.3,
            sigma: 0.2,
            longest_m: 0.5,
            per_m2: 8.0,
            dripping: 0.0,
            heading: Heading::Joint,
        }),
    },
    KindRow {
        name: "drapery",
        summary: "folded sheets of flowstone that hang down a sloping ceiling, banded like bacon",
        rocks: &["limestone"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 3, make: dripstone::drapery },
        place: Place::Ceiling(Hang {
            median_m: 0.3,
            sigma: 0.4,
            longest_m: 0.6,
            per_m2: 3.0,
            dripping: 0.0,
            heading: Heading::Slope,
        }),
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
        place: Place::Ceiling(Hang {
            median_m: 0.055,
            sigma: 0.5,
            longest_m: 0.25,
            per_m2: 30.0,
            dripping: 0.0,
            heading: Heading::Any,
        }),
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
        name: "lagging",
        summary: "boards from beam to beam that hold back what falls from the roof",
        rocks: &["drilled"],
        rock_setting: None,
        shapes: Shapes::Solid { count: 4, make: equipment::board },
        place: Place::Along(TIMBER.with(Fit::OnBeams)),
    },
    KindRow {
        name: "rock_bolt",
        summary: "plates and nuts of rock bolts in the roof, 1.2 m apart",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::bolt },
        place: Place::Along(BOLTS),
    },
    KindRow {
        name: "roof_mesh",
        summary: "squares of welded wire under bolts, with wires 75 mm apart",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::roof_mesh },
        place: Place::Along(Along { fit: Fit::AgainstRoof, range: [0.4, 0.8], ..BOLTS }),
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
        place: Place::Along(PIPES),
    },
    KindRow {
        name: "pipe_elbow",
        summary: "elbows by which water pipes turn into the wall where they end",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::pipe_elbow },
        place: Place::Along(PIPES.with(Fit::IntoRightWall)),
    },
    KindRow {
        name: "cable",
        summary: "cables that sag between hooks along the wall, 1.7 m above the floor",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::cable },
        place: Place::Along(CABLES),
    },
    KindRow {
        name: "cable_end",
        summary: "where cables go into the wall",
        rocks: MINES,
        rock_setting: None,
        shapes: Shapes::Solid { count: 1, make: equipment::cable_end },
        place: Place::Along(CABLES.with(Fit::IntoLeftWall)),
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
const fn artefact(name: &'static str, summary: &'static str, make: fn(&mut Rng) -> Solid) -> KindRow<'static> {
    let shapes = Shapes::Solid { count: 1, make };
    KindRow { name, summary, rocks: &[], rock_setting: None, shapes, place: Place::Lost }
}

/// The rocks of mines.
const MINES: &[&str] = &["drilled", "salt"];

/// Timber sets: their spacing is common practice, their share a choice. Where there are none, the roof is bolted.
const TIMBER: Along = Along { fit: Fit::Post, spacing_m: 1.8, stretch: "timber", range: [0.0, 0.25] };

/// Rock bolts.
const BOLTS: Along = Along { fit: Fit::Roof, spacing_m: 1.2, stretch: "timber", range: [0.25, 1.0] };

/// Water pipes.
const PIPES: Along = Along { fit: Fit::RightWall, spacing_m: 1.95, stretch: "pipe", range: [0.0, 0.7] };

/// Cables.
const CABLES: Along = Along { fit: Fit::LeftWall, spacing_m: 1.95, stretch: "cable", range: [0.0, 0.75] };
