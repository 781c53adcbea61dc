//! What a kind of things is: what it looks like, how large it is and where it occurs.

use plume_graph::rng::Rng;
use plume_registry::Named;

use super::catalogue::KINDS;
use super::settings::FileSettings;
use super::solid::Solid;

/// The signed distance to the surface of a body, positive inside, in metres; the body is within 0.45 m of the origin.
pub type Shape = Box<dyn Fn([f32; 3]) -> f32 + Send + Sync>;

/// A kind of thing.
#[derive(Clone, Copy, Debug)]
pub struct KindRow<'a> {
    /// Its name, which is also the semantic label.
    pub name: &'a str,
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
    /// That of a model file.
    File,
}

/// Where things occur.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// Loose on the floor.
    Floor(Scatter),
    /// Loose on the floor, and only drawn.
    Strewn(Scatter),
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
    /// As many as this, left at the foot of a wall.
    Left(u32),
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
    /// From one beam to the next, on top of them.
    OnBeams,
    /// In rows into the roof.
    Roof,
    /// In squares against the roof, each held by a bolt.
    AgainstRoof,
    /// A pair along the floor, beside the way.
    Rail,
    /// Under the rails.
    Sleeper,
    /// In pieces along the right wall, 1.6 m above the floor.
    RightWall,
    /// Where that ends, into the wall.
    IntoRightWall,
    /// In pieces along the left wall, 1.7 m above the floor.
    LeftWall,
    /// Where that ends, into the wall.
    IntoLeftWall,
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
    /// Where their x axes point.
    pub heading: Heading,
}

/// Where the x axis of something that hangs points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heading {
    /// Anywhere.
    Any,
    /// Along the joint from which it hangs.
    Joint,
    /// Down the slope of the ceiling.
    Slope,
}

/// The kinds that occur in a cave.
#[derive(Clone, Copy, Debug)]
pub struct Kinds<'a> {
    /// Name of its rock.
    pub rock: &'a str,
    /// Whether there are objects for search tasks.
    pub has_artefacts: bool,
    /// The model files of its recipe, each a kind of its own.
    pub files: &'a [FileSettings],
}

impl<'a> Kinds<'a> {
    /// The names of those that are objects for search tasks.
    pub fn sought(self) -> impl Iterator<Item = &'a str> {
        self.rows().filter(|row| matches!(row.place, Place::Lost)).map(|row| row.name)
    }

    /// Their rows.
    pub fn rows(self) -> impl Iterator<Item = KindRow<'a>> {
        let built_in = KINDS.iter().filter_map(move |row| -> Option<KindRow<'a>> {
            let is_left_out = !self.has_artefacts && matches!(row.place, Place::Lost);
            (row.is_in(self.rock) && !is_left_out).then_some(*row)
        });
        built_in.chain(self.files.iter().map(KindRow::of_file))
    }
}

impl Along {
    /// In the same stretches, fitted like this.
    pub(super) const fn with(self, fit: Fit) -> Self {
        Self { fit, ..self }
    }
}

impl Place {
    /// How they are built in, if they are.
    pub fn along(&self) -> Option<Along> {
        match self {
            Self::Along(along) => Some(*along),
            _ => None,
        }
    }

    /// Whether they are built in.
    pub fn is_built(&self) -> bool {
        self.along().is_some()
    }

    /// Whether things lie loose, so that they are placed by their centre of mass.
    pub fn is_loose(&self) -> bool {
        matches!(self, Self::Floor(_))
    }
}

impl<'a> KindRow<'a> {
    /// The kind of a model file, which occurs in all rocks.
    fn of_file(file: &'a FileSettings) -> Self {
        let (shapes, place) = (Shapes::File, Place::Left(file.count));
        Self { name: &file.name, summary: "a model file of the recipe", rocks: &[], rock_setting: None, shapes, place }
    }

    /// The kind whose shapes it has.
    pub fn model(&self) -> &'a str {
        match self.shapes {
            Shapes::Own { .. } | Shapes::Solid { .. } | Shapes::File => self.name,
            Shapes::Of(other) => other,
        }
    }

    /// Whether its shapes are made of few triangles, all of which count.
    pub fn is_solid(&self) -> bool {
        matches!(self.shapes, Shapes::Solid { .. } | Shapes::File)
    }

    /// Whether it occurs in this rock.
    pub fn is_in(&self, rock: &str) -> bool {
        self.rocks.is_empty() || self.rocks.contains(&rock)
    }
}

impl Named for KindRow<'static> {
    fn name(&self) -> &'static str {
        self.name
    }
}
