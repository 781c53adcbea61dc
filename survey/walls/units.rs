//! Settings for the lines that follow: `#UNITS`.

use super::values::{angle_deg, is_missing, length_m, number};
use crate::limits::{MAX_DEPTH, MAX_LENGTH_M};
use crate::measure::{Instruments, METRES_PER_FOOT, Quantity};
use plume_graph::MAX_NAME_BYTES;
use plume_graph::echo::shown;

/// How vectors are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Vectors {
    /// By tape, compass and clinometer.
    #[default]
    Tape,
    /// By differences of coordinates.
    Rectangular,
}

/// The unit of an angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum AngleUnit {
    #[default]
    Degrees,
    Grads,
    /// The slope of a gradient.
    Percent,
}

impl AngleUnit {
    /// A number in this unit, in degrees.
    pub(super) fn degrees(self, number: f64) -> f64 {
        match self {
            Self::Degrees => number,
            Self::Grads => number * 0.9,
            Self::Percent => libm::atan(number / 100.0).to_degrees(),
        }
    }

    /// The unit of this name or its beginning.
    fn named(name: &str, is_vertical: bool) -> Result<Self, String> {
        match name.to_ascii_lowercase().as_str() {
            "degrees" | "deg" | "d" => Ok(Self::Degrees),
            "grads" | "grad" | "g" => Ok(Self::Grads),
            "percent" | "p" if is_vertical => Ok(Self::Percent),
            _ => Err(format!("{} is not a supported unit of angles", shown(name))),
        }
    }
}

/// How backsights are to be taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Backsights {
    /// Whether they are already reversed to match foresights.
    is_corrected: bool,
    /// Whether they count only where there is no foresight.
    only_alone: bool,
}

impl Backsights {
    /// `N` or `C`, then optionally a tolerance and `X`.
    fn read(text: &str) -> Result<Self, String> {
        let mut parts = text.split(',');
        let is_corrected = match parts.next().unwrap_or_default().to_ascii_lowercase().as_str() {
            "normal" | "n" => false,
            "corrected" | "c" => true,
            _ => return Err(format!("{} is neither `Normal` nor `Corrected`", shown(text))),
        };
        Ok(Self { is_corrected, only_alone: parts.nth(1).is_some_and(|mark| mark.eq_ignore_ascii_case("x")) })
    }
}

/// How foresights and backsights of a kind of angle are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sights {
    unit: AngleUnit,
    back_unit: AngleUnit,
    back: Backsights,
}

impl Sights {
    /// The foresight and the backsight in degrees, as far as they are given and count. `reversed` makes a backsight of one that has
    /// been reversed to match foresights.
    pub(super) fn read(
        self,
        fore: Option<&str>,
        back: Option<&str>,
        reversed: impl Fn(f64) -> f64,
    ) -> Result<[Option<f64>; 2], String> {
        let fore_deg = fore.map(|word| angle_deg(word, self.unit)).transpose()?;
        let back_deg = back.map(|word| angle_deg(word, self.back_unit)).transpose()?;
        let counted = back_deg.filter(|_| !self.back.only_alone || fore_deg.is_none());
        Ok([fore_deg, counted.map(|deg| if self.back.is_corrected { reversed(deg) } else { deg })])
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Case {
    #[default]
    Kept,
    Upper,
    Lower,
}

/// What `#UNITS` and `#PREFIX` set.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    pub(super) vectors: Vectors,
    /// The columns of vectors by tape: `D`, `A` and `V`.
    pub(super) columns: Vec<char>,
    /// The columns of rectangular vectors: `E`, `N` and `U`.
    coordinates: Vec<char>,
    /// Metres per unit of tapes and coordinates.
    pub(super) distance_m: f64,
    /// Metres per unit of distances to walls.
    size_m: f64,
    pub(super) azimuths: Sights,
    pub(super) verticals: Sights,
    declination_deg: f64,
    grid_deg: f64,
    /// Corrections in metres and degrees.
    pub(super) instruments: Instruments,
    case: Case,
    /// Of the third, second and first level.
    pub(super) prefixes: [String; 3],
    /// Whether distances to walls are those at the end of a vector.
    pub(super) walls_at_end: bool,
    /// The order of distances to walls: `L`, `R`, `U` and `D`.
    walls: Vec<char>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            vectors: Vectors::Tape,
            columns: vec!['D', 'A', 'V'],
            coordinates: vec!['E', 'N', 'U'],
            distance_m: 1.0,
            size_m: 1.0,
            azimuths: Sights::default(),
            verticals: Sights::default(),
            declination_deg: 0.0,
            grid_deg: 0.0,
            instruments: Instruments::of_walls(),
            case: Case::Kept,
            prefixes: Default::default(),
            walls_at_end: false,
            walls: vec!['L', 'R', 'U', 'D'],
        }
    }
}

/// Options that do not matter here: how tapes are held without heights, weights, tolerances of flags, notes.
const PASSED_OVER: &[&str] = &["tape", "uv", "uvh", "uvv", "flag", "note"];

impl Settings {
    /// The options of a `#UNITS` directive; `saved` are the settings that `SAVE` put aside.
    pub(super) fn read(&mut self, text: &str, saved: &mut Vec<Self>) -> Result<(), String> {
        for option in text.split_ascii_whitespace() {
            let (name, value) = option.split_once('=').unwrap_or((option, ""));
            match (name.to_ascii_lowercase().as_str(), value) {
                ("save", "") if saved.len() < MAX_DEPTH => saved.push(self.clone()),
                ("save", "") => return Err(format!("settings are saved more than {MAX_DEPTH} deep")),
                ("restore", "") => *self = saved.pop().ok_or("no settings have been saved")?,
                ("reset", "") => *self = Self { prefixes: self.prefixes.clone(), ..Self::default() },
                (name, value) => self.set(name, value)?,
            }
        }
        let north_deg = self.declination_deg - self.grid_deg;
        self.instruments.set_declination_rad(north_deg.to_radians());
        Ok(())
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match (name, value) {
            ("meters" | "metres" | "m", "") => (self.distance_m, self.size_m) = (1.0, 1.0),
            ("feet" | "f", "") => (self.distance_m, self.size_m) = (METRES_PER_FOOT, METRES_PER_FOOT),
            ("ct", "") => self.vectors = Vectors::Tape,
            ("rect", "") => self.vectors = Vectors::Rectangular,
            ("d", value) => self.distance_m = unit_of_length(value)?,
            ("s", value) => self.size_m = unit_of_length(value)?,
            ("a", value) => self.azimuths.unit = AngleUnit::named(value, false)?,
            ("ab", value) => self.azimuths.back_unit = AngleUnit::named(value, false)?,
            ("v", value) => self.verticals.unit = AngleUnit::named(value, true)?,
            ("vb", value) => self.verticals.back_unit = AngleUnit::named(value, true)?,
            ("order" | "o", value) => self.set_order(value)?,
            ("decl", value) => self.declination_deg = angle_deg(value, AngleUnit::Degrees)?,
            ("grid", value) => self.grid_deg = angle_deg(value, AngleUnit::Degrees)?,
            ("incd", value) => self.instruments.correct(Quantity::Length, length_m(value, self.distance_m)?),
            ("inca", value) => self.instruments.correct(Quantity::Bearing, angle_deg(value, self.azimuths.unit)?),
            ("incab", value) => {
                self.instruments.correct(Quantity::BackBearing, angle_deg(value, self.azimuths.back_unit)?)
            }
            ("incv", value) => self.instruments.correct(Quantity::Gradient, angle_deg(value, self.verticals.unit)?),
            ("incvb", value) => {
                self.instruments.correct(Quantity::BackGradient, angle_deg(value, self.verticals.back_unit)?)
            }
            ("typeab", value) => self.azimuths.back = Backsights::read(value)?,
            ("typevb", value) => self.verticals.back = Backsights::read(value)?,
            ("case", value) => self.set_case(value)?,
            ("prefix" | "prefix1", value) => self.set_prefix(1, value)?,
            ("prefix2", value) => self.set_prefix(2, value)?,
            ("prefix3", value) => self.set_prefix(3, value)?,
            ("lrud", value) => self.set_walls(value)?,
            ("inch" | "incs" | "rect", value) if number(value) == Some(0.0) => {}
            (passed, _) if PASSED_OVER.contains(&passed) => {}
            _ => return Err(format!("{} is not a supported unit or option", shown(name))),
        }
        Ok(())
    }

    /// An order of columns: of vectors by tape or of rectangular ones.
    fn set_order(&mut self, order: &str) -> Result<(), String> {
        let [letters, sorted] = letters(order);
        match sorted[..] {
            ['A', 'D', 'V'] | ['A', 'D'] => self.columns = letters,
            ['E', 'N', 'U'] | ['E', 'N'] => self.coordinates = letters,
            _ => return Err(format!("{} is not an order of columns", shown(order))),
        }
        Ok(())
    }

    fn set_case(&mut self, case: &str) -> Result<(), String> {
        self.case = match case.to_ascii_lowercase().as_str() {
            "upper" | "u" => Case::Upper,
            "lower" | "l" => Case::Lower,
            "mixed" | "m" => Case::Kept,
            _ => return Err(format!("{} is not Upper, Lower or Mixed", shown(case))),
        };
        Ok(())
    }

    /// Sets the prefix of a level, 1 being the lowest.
    pub(super) fn set_prefix(&mut self, level: usize, prefix: &str) -> Result<(), String> {
        if prefix.contains([':', ',', '#']) || prefix.split_ascii_whitespace().count() > 1 {
            return Err(format!("{} is not a prefix", shown(prefix)));
        }
        // Otherwise one long line could lengthen a million names.
        if prefix.len() > MAX_NAME_BYTES {
            return Err(format!("a prefix has more than {MAX_NAME_BYTES} letters"));
        }
        self.prefixes[3 - level] = prefix.to_owned();
        Ok(())
    }

    /// `F`, `T`, `FB` or `TB`, then optionally a colon and the order.
    fn set_walls(&mut self, text: &str) -> Result<(), String> {
        let (place, order) = text.split_once(':').unwrap_or((text, "LRUD"));
        self.walls_at_end = match place.to_ascii_lowercase().as_str() {
            "f" | "fb" => false,
            "t" | "tb" => true,
            _ => return Err(format!("{} is not F, T, FB or TB", shown(place))),
        };
        let [letters, sorted] = letters(order);
        if sorted != ['D', 'L', 'R', 'U'] {
            return Err(format!("{} is not an order of left, right, up and down", shown(order)));
        }
        self.walls = letters;
        Ok(())
    }

    /// Distances to the walls left, right, up and down in metres, as written between their brackets.
    pub(super) fn walls_m(&self, text: &str) -> Result<[Option<f64>; 4], String> {
        let words: Vec<&str> = text.split([',', ' ', '\t']).filter(|word| !word.is_empty()).collect();
        if words.len() < 4 {
            return Err("distances to walls are left, right, up and down".to_owned());
        }
        let mut walls_m = [None; 4];
        for (side, word) in self.walls.iter().zip(words) {
            if is_missing(word) {
                continue;
            }
            let distance_m = length_m(word, self.size_m)?;
            let at = ['L', 'R', 'U', 'D'].iter().position(|known| known == side).unwrap_or_default();
            walls_m[at] = (0.0..=MAX_LENGTH_M).contains(&distance_m).then_some(distance_m);
        }
        Ok(walls_m)
    }

    /// Whether rectangular vectors would have to be turned.
    pub(super) fn turns_vectors(&self) -> bool {
        self.grid_deg != 0.0
    }

    /// The axis of each column of coordinates: 0 is east, 1 north, 2 up.
    pub(super) fn rectangular_axes(&self) -> Vec<usize> {
        let axis = |letter: &char| match letter {
            'E' => 0,
            'N' => 1,
            _ => 2,
        };
        self.coordinates.iter().map(axis).collect()
    }

    /// A name in the case of names.
    pub(super) fn spelled(&self, name: &str) -> String {
        match self.case {
            Case::Kept => name.to_owned(),
            Case::Upper => name.to_uppercase(),
            Case::Lower => name.to_lowercase(),
        }
    }
}

/// The letters of an order of columns, as they stand and sorted.
fn letters(order: &str) -> [Vec<char>; 2] {
    let letters: Vec<char> = order.to_ascii_uppercase().chars().collect();
    let mut sorted = letters.clone();
    sorted.sort_unstable();
    [letters, sorted]
}

fn unit_of_length(name: &str) -> Result<f64, String> {
    match name.to_ascii_lowercase().as_str() {
        "meters" | "metres" | "m" => Ok(1.0),
        "feet" | "f" => Ok(METRES_PER_FOOT),
        _ => Err(format!("{} is neither meters nor feet", shown(name))),
    }
}
