//! Names of surveyed stations, beside them.
//!
//! As many as fit without covering each other: first those of junctions and dead ends, then the others in their order. What all
//! names begin with, such as the name of the cave, is left out.

use super::frame::{Area, Frame};
use super::sheet::{Panel, Sheet};
use crate::preview::svg::{Anchor, PaperPoint, Svg};
use crate::preview::theme::Palette;
use plume_graph::{Graph, StationId};

/// Height of letters, in units of the paper.
const SIZE: f64 = 11.0;
/// Gap between a station and its name, in units of the paper.
const GAP: f64 = 8.0;
/// Side of a square of paper that is free or taken, in units of the paper.
const SQUARE: f64 = 4.0;
/// Longest name that is drawn, in letters.
const MOST_LETTERS: usize = 40;

/// The names of a cave, the most important first.
pub struct Names<'a> {
    names: Vec<(StationId, &'a str)>,
}

impl<'a> Names<'a> {
    /// Of all stations that have one.
    pub fn of(graph: &'a Graph) -> Self {
        let named = || graph.stations().filter_map(|station| Some((station, graph[station].name.as_deref()?)));
        let skipped = shared(named().map(|(_, name)| name));
        let degrees = graph.degrees();
        let mut names: Vec<(StationId, &str)> = named().map(|(station, name)| (station, &name[skipped..])).collect();
        names.retain(|(_, name)| (1..=MOST_LETTERS).contains(&name.chars().count()));
        names.sort_by_key(|(station, _)| degrees[station.index()] == 2);
        Self { names }
    }

    /// Draws those of a panel that find room.
    pub fn draw(
        &self,
        svg: &mut Svg,
        palette: &Palette,
        sheet: &Sheet,
        panel: &Panel,
        frame: &Frame,
        paper: &mut Paper,
    ) {
        let unit = frame.line_px;
        let is_here = |station: StationId| panel.level.is_none_or(|level| sheet[station].level == level);
        for &(station, name) in self.names.iter().filter(|(station, _)| is_here(*station)) {
            let at = frame.paper_point(sheet[station].at);
            let size = [svg.text_width(name, SIZE * unit), SIZE * unit];
            let corners = [
                [at[0] + GAP * unit, at[1] - size[1] / 2.0],
                [at[0] - GAP * unit - size[0], at[1] - size[1] / 2.0],
                [at[0] - size[0] / 2.0, at[1] - GAP * unit - size[1]],
                [at[0] - size[0] / 2.0, at[1] + GAP * unit],
            ];
            let Some(corner) = corners.into_iter().find(|&corner| paper.take(corner, size)) else { continue };
            let margin = 1.5 * unit;
            svg.rectangle(corner.map(|x| x - margin), size.map(|x| x + 2.0 * margin), palette.paper);
            // Letters stand on a line an eighth above the lower edge, so that descenders are inside.
            svg.text([corner[0], corner[1] + 0.875 * size[1]], Anchor::Left, size[1], palette.ink, name);
        }
    }
}

/// Bytes of the surveys that all names have in front, `cave.` of `cave.1` and `cave.deep.2`.
fn shared<'a>(mut names: impl Iterator<Item = &'a str>) -> usize {
    let Some(first) = names.next() else { return 0 };
    let mut shared = first.rfind('.').map_or(0, |dot| dot + 1);
    for name in names {
        while !name.starts_with(&first[..shared]) {
            shared = first[..shared - 1].rfind('.').map_or(0, |dot| dot + 1);
        }
    }
    shared
}

/// Which squares of the paper are taken by names.
pub struct Paper {
    square_px: f64,
    /// The area of maps, in pixels.
    min: PaperPoint,
    columns: usize,
    rows: usize,
    taken: Vec<bool>,
}

impl Paper {
    /// Empty paper.
    pub fn of(area: &Area) -> Self {
        let square_px = SQUARE * area.unit;
        let [columns, rows] = [area.width(), area.height()].map(|length_px| (length_px / square_px).ceil() as usize);
        Self { square_px, min: area.min, columns, rows, taken: vec![false; columns * rows] }
    }

    /// Takes a rectangle, if it is inside the area and free.
    fn take(&mut self, corner: PaperPoint, size: [f64; 2]) -> bool {
        let first = [0, 1].map(|axis| ((corner[axis] - self.min[axis]) / self.square_px).floor());
        let last = [0, 1].map(|axis| ((corner[axis] + size[axis] - self.min[axis]) / self.square_px).floor());
        let is_inside =
            first.iter().all(|&at| at >= 0.0) && last[0] < self.columns as f64 && last[1] < self.rows as f64;
        if !is_inside {
            return false;
        }
        let [first, last] = [first, last].map(|place| place.map(|at| at as usize));
        let columns = self.columns;
        let squares =
            move || (first[1]..=last[1]).flat_map(move |row| (first[0]..=last[0]).map(move |x| row * columns + x));
        if squares().any(|square| self.taken[square]) {
            return false;
        }
        squares().for_each(|square| self.taken[square] = true);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_all_names_begin_with_is_left_out() {
        assert_eq!(shared(["cave.deep.1", "cave.deep.2"].into_iter()), "cave.deep.".len());
        assert_eq!(shared(["cave.deep.1", "cave.2", "cave.deeper.1"].into_iter()), "cave.".len());
        assert_eq!(shared(["a.1", "b.1"].into_iter()), 0);
        assert_eq!(shared(["1", "2"].into_iter()), 0);
        assert_eq!(shared(std::iter::empty()), 0);
    }

    #[test]
    fn names_do_not_cover_each_other_and_stay_on_the_paper() {
        let mut paper = Paper { square_px: 4.0, min: [10.0, 10.0], columns: 25, rows: 10, taken: vec![false; 250] };
        assert!(paper.take([10.0, 10.0], [30.0, 11.0]));
        assert!(!paper.take([30.0, 15.0], [30.0, 11.0]));
        assert!(paper.take([45.0, 10.0], [30.0, 11.0]));
        assert!(!paper.take([5.0, 30.0], [30.0, 11.0]));
        assert!(!paper.take([90.0, 30.0], [30.0, 11.0]));
    }
}
