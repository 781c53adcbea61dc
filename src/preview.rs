//! Previews within seconds: a cave drawn from its graph and its field, before there is a mesh.
//!
//! [`VIEWS`] lists the views. Each returns bytes and neither prints nor touches the disk. The same cave and [`Order`] give the
//! same bytes for any number of threads; maps and HTML on every machine.
//!
//! Maps are drawn as SVG; a PNG of a map is that SVG rasterised, for which straight lines and quadratic curves need no float
//! functions of the platform. Not promised: that a preview looks like the cave in a simulator.

mod flight;
mod furnishing;
mod image;
mod inside;
mod map;
mod page;
mod svg;
mod theme;

use std::fmt;
use std::str::FromStr;
use std::sync::atomic::AtomicBool;

use crate::field::{CaveField, PassageSettings};
use plume_graph::Graph;

pub use self::flight::Pace;
pub use self::furnishing::Furnishing;
pub use self::map::judged::{Judgement, judged};
pub use self::theme::Theme;

/// A cave to be shown.
pub struct Subject<'a> {
    /// Its name.
    pub name: &'a str,
    /// The graph of its passages.
    pub graph: &'a Graph,
    /// Width and height of the passages.
    pub passage: &'a PassageSettings,
    /// The signed distance field.
    pub field: &'a CaveField,
    /// Distance between its lamps in metres; `None` without lamps.
    pub lamp_spacing_m: Option<f64>,
    /// Its things; `None` to leave them out.
    pub furnishing: Option<Furnishing<'a>>,
}

/// What to draw, and how.
pub struct Order<'a> {
    /// The file format.
    pub format: Format,
    /// The theme of maps.
    pub theme: Theme,
    /// The size; `None` for the default of the view.
    pub size: Option<Size>,
    /// Camera position, metres; `None` for the start pose that shows most.
    pub at: Option<[f32; 3]>,
    /// Yaw and pitch in radians, from +x towards +y and up; `None` for the longest line of sight, about level.
    pub look_rad: Option<[f32; 2]>,
    /// Frame rate and length of a flight.
    pub pace: Pace,
    /// Set to stop.
    pub stop: &'a AtomicBool,
}

/// Width and height of an image in pixels, each from 16 to 8192.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// From left to right.
    pub width: u32,
    /// From top to bottom.
    pub height: u32,
}

impl Size {
    const LEAST: u32 = 16;
    const MOST: u32 = 8192;

    /// A size within the limits.
    ///
    /// # Errors
    /// When it is not.
    pub fn new(width: u32, height: u32) -> Result<Self, PreviewError> {
        let fits = |side: u32| (Self::LEAST..=Self::MOST).contains(&side);
        if fits(width) && fits(height) { Ok(Self { width, height }) } else { Err(PreviewError::Size) }
    }
}

impl FromStr for Size {
    type Err = PreviewError;

    fn from_str(text: &str) -> Result<Self, PreviewError> {
        let (width, height) = text.split_once('x').ok_or(PreviewError::Size)?;
        let side = |text: &str| text.parse().map_err(|_| PreviewError::Size);
        Self::new(side(width)?, side(height)?)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// File formats of views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Vector graphics.
    Svg,
    /// Pixels; animated if the view moves.
    Png,
    /// Animated pixels in 256 colours.
    Gif,
    /// A folder of numbered PNGs.
    Frames,
    /// A page for a browser.
    Html,
}

/// What was drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// The bytes of a file.
    File(Vec<u8>),
    /// The bytes of a PNG for each frame.
    Frames(Vec<Vec<u8>>),
}

impl Format {
    /// The file extension; empty for a folder.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Gif => "gif",
            Self::Frames => "",
            Self::Html => "html",
        }
    }
}

/// A row of [`VIEWS`].
pub struct ViewRow {
    /// Name on the command line.
    pub name: &'static str,
    /// One line for `plume list`.
    pub summary: &'static str,
    /// Supported formats, the default first.
    pub formats: &'static [Format],
    /// Default size.
    pub size: Size,
    /// The options it uses in addition to the format.
    pub heeds: &'static [&'static str],
    /// Whether it shows [`Subject::furnishing`].
    pub shows_things: bool,
    draw: fn(&Subject, &Order, Size) -> Result<Drawn, PreviewError>,
}

impl ViewRow {
    /// Draws this view. The order's format must be supported.
    ///
    /// # Errors
    /// If there is nothing to see, or the order was stopped.
    pub fn draw(&self, subject: &Subject, order: &Order) -> Result<Drawn, PreviewError> {
        if subject.graph.nodes.is_empty() {
            return Err(PreviewError::NoPassages);
        }
        (self.draw)(subject, order, order.size.unwrap_or(self.size))
    }
}

/// Default size of maps.
pub const MAP: Size = Size { width: 1280, height: 900 };

/// All views, the default first.
pub static VIEWS: &[ViewRow] = &[
    ViewRow {
        name: "plan",
        summary: "map seen from above, storeys side by side",
        formats: &[Format::Png, Format::Svg],
        size: MAP,
        heeds: &["size", "theme"],
        shows_things: true,
        draw: map::plan,
    },
    ViewRow {
        name: "profile",
        summary: "map seen from the side, along the longest axis of the cave",
        formats: &[Format::Png, Format::Svg],
        size: Size { height: 640, ..MAP },
        heeds: &["size", "theme"],
        shows_things: false,
        draw: map::profile,
    },
    ViewRow {
        name: "inside",
        summary: "what a robot's camera will see, with the rock and the lamps of the cave",
        formats: &[Format::Png],
        size: Size { width: 960, height: 540 },
        heeds: &["size", "at", "look"],
        shows_things: true,
        draw: inside::inside,
    },
    ViewRow {
        name: "flight",
        summary: "flight from the entrance along the longest passages",
        formats: &[Format::Gif, Format::Png, Format::Frames],
        size: Size { width: 400, height: 225 },
        heeds: &["size", "fps", "seconds"],
        shows_things: false,
        draw: flight::flight,
    },
    ViewRow {
        name: "page",
        summary: "page for a browser, in which the cave can be rotated and cut open",
        formats: &[Format::Html],
        size: MAP,
        heeds: &[],
        shows_things: true,
        draw: page::page,
    },
];

/// The view called `name`.
pub fn view(name: &str) -> Option<&'static ViewRow> {
    VIEWS.iter().find(|row| row.name == name)
}

/// Why a view cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PreviewError {
    /// The graph has no stations.
    #[error("the graph has no stations, so there is nothing to show")]
    NoPassages,
    /// The size is out of range.
    #[error("a size is WIDTHxHEIGHT, each from {} to {} pixels", Size::LEAST, Size::MOST)]
    Size,
    /// The frame rate or the length is out of range.
    #[error("a flight has 1 to 50 frames per second, and takes up to 600 seconds")]
    Pace,
    /// The frames would need too much memory.
    #[error("a flight has at most a thousand million pixels in all frames together")]
    Long,
    /// There is no air inside the cave.
    #[error("there is no air at any station, so there is nothing to see from inside")]
    NoAir,
    /// The camera is in rock.
    #[error("there is rock at {}, {}, {}", .0[0], .0[1], .0[2])]
    InRock([f32; 3]),
    /// It was stopped.
    #[error("interrupted")]
    Stopped,
}

impl PreviewError {
    /// What to do; may be empty.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::NoPassages => "give the graph at least one station",
            Self::Size => "for example --size 1280x720",
            Self::Pace => "for example --fps 10 --seconds 6",
            Self::Long => "make it smaller or shorter, for example --size 1280x720 --fps 10 --seconds 60",
            Self::NoAir => "widen the passages, see `passage` in the recipe",
            Self::InRock(_) => "give a point in a passage, or omit --at",
            Self::Stopped => "",
        }
    }
}
