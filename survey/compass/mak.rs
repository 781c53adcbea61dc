//! `.mak` projects: the files of a project, the stations they share, and fixed stations.
//!
//! ```text
//! #DEEP1.DAT,A1[F,10.1,20.2,30.3];    / a file with a station at known coordinates in feet
//! #DEEP2.DAT,A7,A9;                   / a file that shares two stations with those before it
//! ```
//! A file with such links may reuse other names of earlier files for different stations, which Compass keeps apart and
//! Survex does not. Datum and zone name the coordinate system; nothing is projected. Folders and settings are skipped.

use nalgebra::Point3;

use super::Reader;
use crate::ReadError;
use crate::files::{self, FilePosition};
use crate::limits::MAX_COORDINATE_M;
use crate::measure::METRES_PER_FOOT;
use plume_graph::echo::shown;

const HINT: &str =
    "a survey file is written as #FILE.DAT,STATION,STATION[M,east,north,up]; with a semicolon at the end";

/// A survey file of a project.
struct Book {
    file: String,
    /// Stations that it shares with earlier files, if not all.
    links: Vec<String>,
    /// Stations with known coordinates, in metres.
    fixes: Vec<(String, Point3<f64>)>,
}

impl Reader<'_> {
    /// Reads all files of a project.
    pub(super) fn read_project(&mut self, bytes: &[u8]) -> Result<(), ReadError> {
        let text = files::text(bytes);
        self.set_system(&text);
        let entries = entries(&text);
        if entries.is_empty() {
            return Err(self.files.fault_of_file("names no survey file", HINT));
        }
        for (line, entry) in entries {
            let file_position = self.files.file_position(line);
            let book = entry
                .ok_or_else(|| "has a file entry without a semicolon at the end".to_owned())
                .and_then(|entry| book(&entry));
            let begun = book.and_then(|book| self.begin(file_position, &book).map(|()| book));
            let book = begun.map_err(|message| self.files.fault(file_position, message, HINT))?;
            let bytes = self.files.open(file_position, &book.file, ".dat")?;
            self.read_book(&bytes)?;
            self.files.close();
        }
        Ok(())
    }

    /// Takes the datum (`&WGS 1984;`) and the UTM zone (`$13;`, negative in the south) as the coordinate system.
    fn set_system(&mut self, text: &str) {
        let lines = || text.lines().map(|line| line.split('/').next().unwrap_or_default().trim());
        let value = |mark: char| lines().find_map(|line| line.strip_prefix(mark)?.strip_suffix(';')).map(str::trim);
        let (Some(datum), Some(zone)) = (value('&'), value('$')) else { return };
        if zone.parse().is_ok_and(|zone: i32| (1..=60).contains(&zone.abs())) {
            self.centreline.set_datum(datum, zone);
        }
    }

    /// Sets up the station names of a file, and fixes stations.
    fn begin(&mut self, file_position: FilePosition, book: &Book) -> Result<(), String> {
        if !book.links.is_empty() {
            let before = std::mem::replace(&mut self.book, self.centreline.names.add()?);
            for name in book.links.iter().chain(book.fixes.iter().map(|(name, _)| name)) {
                let known = self.centreline.names.below(before, name)?;
                let here = self.station(name)?;
                self.centreline.equate(known, here);
            }
        }
        for (name, position) in &book.fixes {
            let station = self.station(name)?;
            self.centreline.fix(station, *position, None, file_position)?;
        }
        Ok(())
    }
}

/// The text between each `#` and its semicolon, without blanks and comments, and the line where it starts; `None` if the
/// semicolon is missing. Comments extend from a slash to the next one or to the end of the line.
fn entries(text: &str) -> Vec<(usize, Option<String>)> {
    let mut entries = Vec::new();
    let (mut line, mut in_comment) = (1, false);
    let mut entry: Option<(usize, String)> = None;
    for letter in text.chars() {
        line += usize::from(letter == '\n');
        in_comment = match letter {
            '\n' => false,
            '/' => !in_comment,
            _ => in_comment,
        };
        if in_comment || letter == '/' || letter.is_ascii_whitespace() {
            continue;
        }
        match (letter, entry.as_mut()) {
            ('#', None) => entry = Some((line, String::new())),
            (';', Some(_)) => entries.extend(entry.take().map(|(line, text)| (line, Some(text)))),
            (_, Some((_, text))) => text.push(letter),
            _ => {}
        }
    }
    entries.extend(entry.map(|(line, _)| (line, None)));
    entries
}

fn book(entry: &str) -> Result<Book, String> {
    let (file, mut rest) = entry.split_once(',').unwrap_or((entry, ""));
    if file.is_empty() {
        return Err("has an entry without a file name".to_owned());
    }
    let mut book = Book { file: file.to_owned(), links: Vec::new(), fixes: Vec::new() };
    while !rest.is_empty() {
        let end = rest.find([',', '[']).unwrap_or(rest.len());
        let (name, after) = rest.split_at(end);
        rest = after.strip_prefix(',').unwrap_or(after);
        if let Some(fix) = after.strip_prefix('[') {
            let (place, after) = fix
                .split_once(']')
                .ok_or_else(|| format!("has no closing bracket after the coordinates of {}", shown(name)))?;
            let position = position(place)
                .ok_or_else(|| format!("fixes {} at invalid coordinates {}", shown(name), shown(place)))?;
            book.fixes.push((name.to_owned(), position));
            rest = after.strip_prefix(',').unwrap_or(after);
        } else if !name.is_empty() {
            book.links.push(name.to_owned());
        }
    }
    Ok(book)
}

/// A unit and three numbers.
fn position(text: &str) -> Option<Point3<f64>> {
    let mut parts = text.split(',');
    let metres = match parts.next()? {
        "F" | "f" => METRES_PER_FOOT,
        "M" | "m" => 1.0,
        _ => return None,
    };
    let mut number = || parts.next()?.parse().ok().filter(|number: &f64| number.abs() <= MAX_COORDINATE_M);
    Some(Point3::new(number()?, number()?, number()?) * metres)
}
