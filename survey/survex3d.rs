//! Survex `.3d` files, version 8: the output of `cavern` for a processed survey.
//!
//! Read according to the published description of the format (survex.com/docs/3dformat.htm, 2016). A header of four lines
//! is followed by items with a one-byte code each: moves and lines in centimetres, names of stations, cross-sections. Names
//! are stored as differences from the previous one. Loops are closed already. Stations with the same coordinates are one,
//! as defined by the format; names tell where a cross-section was measured, and a station has the first of its names.
//!
//! Not supported are other versions (`survexport --3d` converts older ones to version 8) and extended elevations, which are
//! not caves; dates and misclosures are skipped.

mod bytes;
mod label;

use std::collections::HashMap;

use nalgebra::Point3;

use self::bytes::Bytes;
use self::label::Label;
use super::files;
use super::survey::{Leg, Survey, SurveyStation, Walls};
use super::{Import, Parts, ReadError, Source};

const FILE_ID: &[u8] = b"Survex 3D Image File";
/// Flag of the file: an extended elevation.
const EXTENDED: u8 = 0x80;
/// Flags of a line's code.
const LINE_SURFACE: u8 = 0x01;
const LINE_DUPLICATE: u8 = 0x02;
const LINE_SPLAY: u8 = 0x04;
const LINE_SAME_LABEL: u8 = 0x20;
/// Flag of a label's code: an entrance.
const LABEL_ENTRANCE: u8 = 0x04;

/// Reader of a row of [`FORMATS`](super::FORMATS).
pub(super) fn import(source: &Source, parts: Parts) -> Result<Import, ReadError> {
    let mut bytes = Bytes::new(source.path, source.bytes);
    let system = header(&mut bytes)?;
    let mut reader = Reader { bytes, ..Reader::new(source) };
    reader.survey.system = system;
    while reader.item()? {}
    reader.end_passage();
    reader.survey.into_import(source, parts)
}

/// Checks the four lines before the items, and returns the coordinate system, which may follow the title after a zero byte.
fn header(bytes: &mut Bytes) -> Result<Option<Box<str>>, ReadError> {
    if bytes.line().ok() != Some(FILE_ID) {
        return Err(bytes.fault_at(0, "is not a Survex 3D file", "process the survey with `cavern`"));
    }
    let at = bytes.at();
    let version = bytes.line()?;
    if version != b"v8" {
        let version = String::from_utf8_lossy(&version[..version.len().min(8)]).into_owned();
        let message = format!("has version `{}` of the format, not v8", version.escape_debug());
        let hint = "process the survey with a current `cavern`, or convert the file: `survexport --3d OLD.3d NEW.3d`";
        return Err(bytes.fault_at(at, message, hint));
    }
    let system = bytes.line()?.split(|&byte| byte == 0).nth(1);
    let _time = bytes.line()?;
    let at = bytes.at();
    if bytes.u8()? & EXTENDED != 0 {
        let hint = "name the .3d file that it was made from";
        return Err(bytes.fault_at(at, "is an extended elevation, which is flat", hint));
    }
    Ok(system.and_then(|system| plume_graph::name(&files::text(system))))
}

/// Coordinates in centimetres, which identify a station.
type Place = [i32; 3];

/// The survey as read so far.
struct Reader<'a> {
    bytes: Bytes<'a>,
    survey: Survey,
    /// Randomly hashed, like the next map, so that no file can provoke collisions.
    of_place: HashMap<Place, usize>,
    /// The station of each name, by the name's hash.
    of_label: HashMap<u64, usize>,
    label: Label,
    /// Where the next line starts.
    here: Option<Place>,
    /// Whether the style is normal: setting it again ends the file.
    is_style_normal: bool,
    /// Index of the first cross-section of the current passage.
    passage: usize,
}

impl<'a> Reader<'a> {
    fn new(source: &Source<'a>) -> Self {
        Self {
            bytes: Bytes::new(source.path, source.bytes),
            survey: Survey::default(),
            of_place: HashMap::default(),
            of_label: HashMap::default(),
            label: Label::default(),
            here: None,
            is_style_normal: false,
            passage: 0,
        }
    }

    /// Reads an item; `false` after the last.
    fn item(&mut self) -> Result<bool, ReadError> {
        let at = self.bytes.at();
        match self.bytes.u8()? {
            0x00 if self.is_style_normal => return Ok(false),
            code @ 0x00..=0x04 => self.is_style_normal = code == 0x00,
            0x0f => self.here = Some(self.place()?),
            0x10 => {}
            0x11 => self.bytes.skip(2)?,
            0x12 => self.bytes.skip(3)?,
            0x13 => self.bytes.skip(4)?,
            0x1f => self.bytes.skip(20)?,
            code @ 0x30..=0x33 => self.cross_section(at, code)?,
            code @ 0x40..=0x7f => self.line(at, code)?,
            code @ 0x80..=0xff => self.station(code)?,
            code => {
                let message = format!("has an item of the unknown kind {code:#04x}");
                return Err(self.bytes.fault_at(at, message, "process the survey again with `cavern`"));
            }
        }
        Ok(true)
    }

    fn place(&mut self) -> Result<Place, ReadError> {
        Ok([self.bytes.i32()?, self.bytes.i32()?, self.bytes.i32()?])
    }

    /// The station at a place.
    fn at(&mut self, place: Place) -> usize {
        let stations = &mut self.survey.stations;
        *self.of_place.entry(place).or_insert_with(|| {
            let position = Point3::from(place.map(|x_cm| f64::from(x_cm) / 100.0));
            stations.push(SurveyStation::at(position));
            stations.len() - 1
        })
    }

    fn line(&mut self, at: usize, code: u8) -> Result<(), ReadError> {
        if code & LINE_SAME_LABEL == 0 {
            self.label.read(&mut self.bytes)?;
        }
        let to = self.place()?;
        let Some(from) = self.here.replace(to) else {
            return Err(self.bytes.fault_at(at, "has a leg without a start", "process the survey with `cavern`"));
        };
        let kind = match code {
            code if code & LINE_SPLAY != 0 => Leg::Splay,
            code if code & LINE_SURFACE != 0 => Leg::Surface,
            code if code & LINE_DUPLICATE != 0 => Leg::Duplicate,
            _ => Leg::Passage,
        };
        let ends = [self.at(from), self.at(to)];
        self.survey.legs.push((ends, kind));
        Ok(())
    }

    fn station(&mut self, code: u8) -> Result<(), ReadError> {
        self.label.read(&mut self.bytes)?;
        let place = self.place()?;
        let station = self.at(place);
        self.survey.stations[station].entrance |= code & LABEL_ENTRANCE != 0;
        if self.survey.stations[station].name.is_none() {
            self.survey.stations[station].name = self.label.name();
        }
        self.of_label.insert(self.label.hash(), station);
        Ok(())
    }

    fn cross_section(&mut self, at: usize, code: u8) -> Result<(), ReadError> {
        self.label.read(&mut self.bytes)?;
        let is_wide = code & 0x02 != 0;
        let mut sides = [None; 4];
        for side in &mut sides {
            let length_cm = if is_wide { self.bytes.i32()? } else { i32::from(self.bytes.i16()?) };
            *side = (length_cm >= 0).then(|| f64::from(length_cm) / 100.0);
        }
        let Some(&station) = self.of_label.get(&self.label.hash()) else {
            let message = "has a cross-section at a station that was not named before";
            return Err(self.bytes.fault_at(at, message, "process the survey again with `cavern`"));
        };
        let [left_m, right_m, up_m, down_m] = sides;
        self.survey.walls.push(Walls { station, looking: [station; 2], left_m, right_m, up_m, down_m });
        if code & 0x01 != 0 {
            self.end_passage();
        }
        Ok(())
    }

    /// Sets the direction of each cross-section of a passage: from the previous to the next.
    fn end_passage(&mut self) {
        let passage = &mut self.survey.walls[self.passage..];
        for index in 1..passage.len() {
            let (before, here) = (passage[index - 1].station, passage[index].station);
            passage[index - 1].looking[1] = here;
            passage[index].looking[0] = before;
        }
        self.passage = self.survey.walls.len();
    }
}
