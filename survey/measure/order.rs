//! The order of columns.

use super::Quantity;

/// How shots are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Style {
    /// Tape, compass and clino.
    Normal,
    /// Tape, compass and depth gauge.
    Diving,
    /// Horizontal tape, compass and depth gauge.
    Cylpolar,
    /// Differences of coordinates.
    Cartesian,
    /// Only that there is a connection.
    NoSurvey,
    /// Distances to the walls, station by station.
    Passage,
    /// Ignored data.
    Ignore,
}

impl Style {
    /// The style of this name, in any case.
    pub(in super::super) fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "normal" | "topofil" => Self::Normal,
            "diving" => Self::Diving,
            "cylpolar" => Self::Cylpolar,
            "cartesian" => Self::Cartesian,
            "nosurvey" => Self::NoSurvey,
            "passage" | "dimensions" => Self::Passage,
            "ignore" => Self::Ignore,
            _ => return None,
        })
    }
}

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Reading {
    From,
    To,
    Station,
    Direction,
    FromDepth,
    ToDepth,
    DepthChange,
    FromCount,
    ToCount,
    Of(Quantity),
    Newline,
    Ignore,
    IgnoreAll,
}

impl Reading {
    pub(in super::super) fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "from" => Self::From,
            "to" => Self::To,
            "station" => Self::Station,
            "direction" => Self::Direction,
            "fromdepth" => Self::FromDepth,
            "todepth" => Self::ToDepth,
            "depthchange" => Self::DepthChange,
            "fromcount" => Self::FromCount,
            "tocount" => Self::ToCount,
            "newline" => Self::Newline,
            "ignore" => Self::Ignore,
            "ignoreall" => Self::IgnoreAll,
            other => Self::Of(Quantity::named(other)?),
        })
    }

    /// Whether it belongs to a station, and so appears once between two legs.
    pub(super) fn is_shared(self) -> bool {
        matches!(self, Self::Station | Self::Of(Quantity::Depth | Quantity::Count))
    }
}

/// The columns of one style.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Order {
    pub(in super::super) style: Style,
    /// The columns of a line or, for interleaved data, of a station's line and of a leg's line.
    pub(super) lines: Vec<Vec<Reading>>,
    pub(super) by_station: bool,
}

impl Default for Order {
    fn default() -> Self {
        let columns = [
            Reading::From,
            Reading::To,
            Reading::Of(Quantity::Length),
            Reading::Of(Quantity::Bearing),
            Reading::Of(Quantity::Gradient),
        ];
        Self { style: Style::Normal, lines: vec![columns.to_vec()], by_station: false }
    }
}

impl Order {
    /// # Errors
    /// If these columns do not determine a leg.
    pub(in super::super) fn new(style: Style, columns: &[Reading]) -> Result<Self, String> {
        let has = |reading: Reading| columns.contains(&reading);
        let by_station = has(Reading::Station);
        let lines: Vec<Vec<Reading>> =
            columns.split(|&reading| reading == Reading::Newline).map(<[_]>::to_vec).collect();
        for (at, &reading) in columns.iter().enumerate() {
            if reading != Reading::Ignore && columns[..at].contains(&reading) {
                return Err("a column appears twice".to_owned());
            }
            let last = columns.get(at + 1).is_none_or(|&next| next == Reading::Newline);
            if reading == Reading::IgnoreAll && !last {
                return Err("no column can follow `ignoreall`".to_owned());
            }
        }
        if style == Style::Ignore {
            return Ok(Self { style, lines, by_station: false });
        }
        if by_station == (has(Reading::From) || has(Reading::To)) || has(Reading::From) != has(Reading::To) {
            return Err("the columns contain neither `from` and `to` nor `station`".to_owned());
        }
        let shape = match (style, by_station, lines.len()) {
            (Style::Passage, true, 1) | (_, false, 1) | (Style::NoSurvey, true, 1) => {
                lines[0].len() > 1 || style == Style::NoSurvey
            }
            (Style::Passage | Style::NoSurvey, ..) => false,
            (_, true, 2) => lines[0].contains(&Reading::Station) && lines[1].iter().all(|reading| !reading.is_shared()),
            _ => false,
        };
        if !shape || (style == Style::Passage && !by_station) {
            return Err("the columns do not fit the style".to_owned());
        }
        let order = Self { style, lines, by_station };
        order.check_measures(&has)?;
        Ok(order)
    }

    /// Whether the readings of a leg are on a line of their own, between those of its stations.
    pub(in super::super) fn is_interleaved(&self) -> bool {
        self.lines.len() == 2
    }

    fn check_measures(&self, has: &dyn Fn(Reading) -> bool) -> Result<(), String> {
        let of = |quantity| has(Reading::Of(quantity));
        let length = of(Quantity::Length)
            || of(Quantity::BackLength)
            || of(Quantity::Count)
            || (has(Reading::FromCount) && has(Reading::ToCount));
        let bearing = of(Quantity::Bearing) || of(Quantity::BackBearing);
        let depth =
            of(Quantity::Depth) || has(Reading::DepthChange) || (has(Reading::FromDepth) && has(Reading::ToDepth));
        let enough = match self.style {
            Style::Normal => length && bearing,
            Style::Diving | Style::Cylpolar => length && bearing && depth,
            Style::Cartesian => of(Quantity::East) && of(Quantity::North) && of(Quantity::Altitude),
            Style::NoSurvey | Style::Passage | Style::Ignore => true,
        };
        if enough { Ok(()) } else { Err("columns that the style needs are missing".to_owned()) }
    }
}
