//! Marks for origins, dead ends and loops.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::frame::Frame;
use super::sheet::{Panel, Sheet};
use crate::preview::svg::{PaperPoint, Svg};
use crate::preview::theme::Palette;
use plume_graph::sets::Sets;
use plume_graph::{Graph, StationId};

/// Minimum distance of marks, in units of the paper.
const APART: f64 = 9.0;

/// Number of corners of a circle.
const CORNERS: usize = 20;

/// Meaning of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A station that a part of the cave grew from.
    Origin,
    /// A station with one passage.
    DeadEnd,
    /// A passage that closes a loop.
    Loop,
}

/// The marks of a cave.
pub struct Marks {
    /// Each with its two stations, which are the same for a mark at one station.
    marks: Vec<(Mark, [StationId; 2])>,
}

impl Marks {
    /// Origins first, then loops, then dead ends.
    pub fn of(graph: &Graph) -> Self {
        let degrees = graph.degrees();
        let stations = graph.stations();
        let is_origin = |station: &StationId| graph[*station].parent.is_none();
        let origins = stations.clone().filter(is_origin).map(|station| (Mark::Origin, [station; 2]));
        let loops = closing(graph).into_iter().map(|edge| (Mark::Loop, edge));
        let is_end = |station: &StationId| degrees[station.index()] == 1 && !is_origin(station);
        let ends = stations.filter(is_end).map(|station| (Mark::DeadEnd, [station; 2]));
        Self { marks: origins.chain(loops).chain(ends).collect() }
    }

    /// Number of marks of a kind.
    pub fn count(&self, kind: Mark) -> usize {
        self.marks.iter().filter(|(mark, _)| *mark == kind).count()
    }

    /// Draws those of a panel; of two that are too close, the earlier one.
    pub fn draw(&self, svg: &mut Svg, palette: &Palette, sheet: &Sheet, panel: &Panel, frame: &Frame) {
        let mut places = Places { apart_px: APART * frame.line_px, taken: BTreeMap::new() };
        let is_here = |end: &StationId| panel.level.is_none_or(|level| sheet[*end].level == level);
        for (mark, ends) in &self.marks {
            if !ends.iter().any(is_here) {
                continue;
            }
            let [a, b] = ends.map(|end| frame.paper_point(sheet[end].at));
            let paper_point = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
            if places.take(paper_point) {
                draw(svg, palette, *mark, paper_point, frame.line_px);
            }
        }
    }
}

/// Occupied positions, by squares of the minimum distance.
struct Places {
    apart_px: f64,
    taken: BTreeMap<[i64; 2], Vec<PaperPoint>>,
}

impl Places {
    /// Occupies a position, if no other is too close.
    fn take(&mut self, paper_point: PaperPoint) -> bool {
        let [column, row] = paper_point.map(|pixel| (pixel / self.apart_px).floor() as i64);
        let squares = (column - 1..=column + 1).flat_map(|x| (row - 1..=row + 1).map(move |y| [x, y]));
        let mut others = squares.filter_map(|square| self.taken.get(&square)).flatten();
        let is_free =
            others.all(|other| libm::hypot(other[0] - paper_point[0], other[1] - paper_point[1]) >= self.apart_px);
        if is_free {
            self.taken.entry([column, row]).or_default().push(paper_point);
        }
        is_free
    }
}

/// Draws a mark; `unit` is the width of a thin line.
pub fn draw(svg: &mut Svg, palette: &Palette, mark: Mark, at: PaperPoint, unit: f64) {
    let round = |radius: f64| {
        let corner = |i: usize| {
            let angle = TAU * i as f64 / CORNERS as f64;
            [at[0] + radius * unit * libm::cos(angle), at[1] + radius * unit * libm::sin(angle)]
        };
        (0..CORNERS).map(corner).collect::<Vec<PaperPoint>>()
    };
    match mark {
        Mark::Origin => {
            svg.fill(&[round(6.5)], palette.paper);
            svg.outline(&[round(6.5)], palette.ink, 2.0 * unit);
            svg.fill(&[round(2.8)], palette.ink);
        }
        Mark::Loop => {
            svg.fill(&[round(3.6)], palette.paper);
            svg.outline(&[round(3.6)], palette.ink, 1.5 * unit);
        }
        Mark::DeadEnd => {
            let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let square = square.map(|[x, y]| [at[0] + 2.6 * unit * x, at[1] + 2.6 * unit * y]).to_vec();
            svg.outline(std::slice::from_ref(&square), palette.paper, 2.5 * unit);
            svg.fill(&[square], palette.ink);
        }
    }
}

/// Passages that close a loop when they are added in their order: as many as there are loops.
fn closing(graph: &Graph) -> Vec<[StationId; 2]> {
    let mut joined = Sets::new(graph.nodes.len());
    let closes = |&&[a, b]: &&[StationId; 2]| !joined.unite(a.index(), b.index());
    graph.edges.iter().filter(closes).copied().collect()
}
