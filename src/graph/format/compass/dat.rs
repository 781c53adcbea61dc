//! The survey books themselves: a header and a line per shot, surveys parted by form feeds.
//!
//! Lengths are in feet and angles in degrees whatever the survey's `FORMAT` says; that tells how the notebook had
//! them, and whether there are backsights and at which end of a shot the walls were measured.

use std::path::Path;

use nalgebra::Vector3;

use super::super::ReadError;
use super::super::limits::MAX_LINE;
use super::super::survey::Leg;
use super::METRES_PER_FOOT;

/// Angles up to here are the mark of a missing one, -999.
const MISSING_DEG: f64 = -900.0;
/// From this inclination on a shot needs no bearing, in degrees.
const PLUMB_DEG: f64 = 89.9;
const SHOT_HINT: &str =
    "a shot is FROM TO LENGTH BEARING INC LEFT UP DOWN RIGHT, with AZM2 INC2 where FORMAT has backsights";

/// A shot as a vector.
pub(super) struct Shot<'a> {
    pub(super) from: &'a [u8],
    pub(super) to: &'a [u8],
    /// East, north, up, in metres.
    pub(super) vector: Vector3<f64>,
    /// Left, right, up, down.
    pub(super) walls_m: [Option<f64>; 4],
    /// Whether the walls are those at its far end.
    pub(super) walls_at_end: bool,
    pub(super) leg: Leg,
    /// Whether closing loops should leave it as it is.
    pub(super) is_rigid: bool,
}

/// All shots of a book that exist, with the lines they stand in.
pub(super) fn shots<'a>(path: &Path, bytes: &'a [u8]) -> Result<Vec<(usize, Shot<'a>)>, ReadError> {
    let mut shots = Vec::new();
    let mut header = Header::default();
    let mut in_shots = false;
    let mut was_in_shots = false;
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let fault = |message: String, hint: &str| ReadError::line(path, index + 1, message, hint);
        if line.len() > MAX_LINE {
            return Err(fault(format!("has more than {MAX_LINE} bytes"), "is this a Compass file?"));
        }
        if line.contains(&b'\x0c') || line.trim_ascii().starts_with(b"\x1a") {
            (header, in_shots) = (Header::default(), false);
            continue;
        }
        let mut words = Words { line };
        if in_shots {
            if !line.trim_ascii().is_empty() {
                shots.extend(
                    shot(&mut words, &header)
                        .map_err(|message| fault(message, SHOT_HINT))?
                        .map(|shot| (index + 1, shot)),
                );
            }
            continue;
        }
        match words.next() {
            Some(b"DECLINATION:") => {
                let read = Header::read(&mut words);
                header =
                    read.map_err(|message| fault(message, "DECLINATION:, CORRECTIONS: and CORRECTIONS2: are numbers"))?;
            }
            Some(b"FROM") if words.next() == Some(b"TO") => (in_shots, was_in_shots) = (true, true),
            _ => {}
        }
    }
    if !was_in_shots {
        let hint = "each survey has a line of headings that starts with FROM and TO";
        return Err(ReadError::whole(path, "has no table of shots", hint));
    }
    Ok(shots)
}

/// What a survey says of all its shots.
#[derive(Default)]
struct Header {
    declination_deg: f64,
    /// What to add to bearing, inclination and length.
    azimuth_deg: f64,
    inclination_deg: f64,
    length_ft: f64,
    /// What to add to those looking back.
    back_azimuth_deg: f64,
    back_inclination_deg: f64,
    has_backsights: bool,
    walls_at_end: bool,
}

impl Header {
    /// Reads on behind `DECLINATION:`.
    fn read(words: &mut Words) -> Result<Self, String> {
        let mut header = Self { declination_deg: words.number("declination")?, ..Self::default() };
        while let Some(word) = words.next() {
            match word {
                b"FORMAT:" => header.set_format(words.next().unwrap_or_default()),
                b"CORRECTIONS:" => {
                    header.azimuth_deg = words.number("correction")?;
                    header.inclination_deg = words.number("correction")?;
                    header.length_ft = words.number("correction")?;
                }
                b"CORRECTIONS2:" => {
                    header.back_azimuth_deg = words.number("correction")?;
                    header.back_inclination_deg = words.number("correction")?;
                }
                _ => {}
            }
        }
        Ok(header)
    }

    /// Formats of 11 letters say nothing of backsights, those of 12 nothing of the end; 15 have two more before both.
    fn set_format(&mut self, format: &[u8]) {
        let backsights = if format.len() >= 15 { 13 } else { 11 };
        self.has_backsights = format.get(backsights) == Some(&b'B');
        self.walls_at_end = format.get(backsights + 1) == Some(&b'T');
    }
}

/// A shot, unless its flags say that there is none.
fn shot<'a>(words: &mut Words<'a>, header: &Header) -> Result<Option<Shot<'a>>, String> {
    let (Some(from), Some(to)) = (words.next(), words.next()) else {
        return Err("is no shot: it names no two stations".to_owned());
    };
    let length_ft = words.number("length")? + header.length_ft;
    let fore = [words.number("bearing")?, words.number("inclination")?];
    let mut walls_m = [None; 4];
    // The columns are left, up, down, right.
    for side in [0, 2, 3, 1] {
        let feet = words.number("distance to a wall")?;
        walls_m[side] = (feet >= 0.0).then_some(feet * METRES_PER_FOOT);
    }
    let back = if header.has_backsights {
        [words.number("bearing back")?, words.number("inclination back")?]
    } else {
        [MISSING_DEG; 2]
    };
    let flags = words.flags();
    if flags.contains(&b'X') {
        return Ok(None);
    }
    if length_ft < 0.0 {
        return Err(format!("is {length_ft} feet long"));
    }
    let leg = match flags {
        flags if flags.contains(&b'S') => Leg::Splay,
        flags if flags.contains(&b'P') => Leg::Surface,
        flags if flags.contains(&b'L') => Leg::Duplicate,
        _ => Leg::Passage,
    };
    let vector = direction(fore, back, header)? * (length_ft * METRES_PER_FOOT);
    let is_rigid = flags.contains(&b'C');
    Ok(Some(Shot { from, to, vector, walls_m, walls_at_end: header.walls_at_end, leg, is_rigid }))
}

/// The mean direction of looking there and back, each bearing and inclination.
fn direction(fore: [f64; 2], back: [f64; 2], header: &Header) -> Result<Vector3<f64>, String> {
    let known = |angle_deg: f64| (angle_deg > MISSING_DEG).then_some(angle_deg);
    let up = known(fore[1]).map(|angle| angle + header.inclination_deg);
    let up_back = known(back[1]).map(|angle| -angle - header.back_inclination_deg);
    let up_deg = up.zip(up_back).map(|(one, other)| 0.5 * (one + other)).or(up).or(up_back);
    let up_deg = up_deg.ok_or("has no inclination")?;
    if up_deg.abs() >= PLUMB_DEG {
        return Ok(Vector3::new(0.0, 0.0, up_deg.signum()));
    }
    let ahead = known(fore[0]).map(|angle| angle + header.azimuth_deg);
    let ahead_back = known(back[0]).map(|angle| angle + header.back_azimuth_deg + 180.0);
    let between = |(one, other): (f64, f64)| one + 0.5 * ((other - one + 180.0).rem_euclid(360.0) - 180.0);
    let ahead_deg = ahead.zip(ahead_back).map(between).or(ahead).or(ahead_back);
    let ahead = (ahead_deg.ok_or("has no bearing")? + header.declination_deg).to_radians();
    let up = up_deg.to_radians();
    Ok(Vector3::new(libm::cos(up) * libm::sin(ahead), libm::cos(up) * libm::cos(ahead), libm::sin(up)))
}

/// What is left of a line.
struct Words<'a> {
    line: &'a [u8],
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.line.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.line = rest;
        (!word.is_empty()).then_some(word)
    }

    fn number(&mut self, what: &str) -> Result<f64, String> {
        let word = String::from_utf8_lossy(self.next().ok_or_else(|| format!("has no {what}"))?);
        let number = word.parse().ok().filter(|number: &f64| number.abs() < 1e9);
        number.ok_or_else(|| {
            let shown: String = word.chars().take(20).collect();
            format!("has a {what} of {shown:?}, which is no number")
        })
    }

    /// What stands between `#|` and `#`, if that is next.
    fn flags(&self) -> &'a [u8] {
        let Some(flags) = self.line.trim_ascii_start().strip_prefix(b"#|") else { return &[] };
        let end = flags.iter().position(|&byte| byte == b'#').unwrap_or(flags.len());
        &flags[..end]
    }
}
