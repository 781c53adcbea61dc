//! A plan in which passages have the colours of a judgement: where a robot gets, and what stops it.

use super::frame::{Area, Frame};
use super::furniture::Furniture;
use super::sheet::{Panel, Sheet};
use crate::preview::image::Image;
use crate::preview::svg::{Anchor, PaperPoint, Svg};
use crate::preview::theme::Palette;
use crate::preview::{Size, Subject, Theme};
use plume_graph::{Graph, StationId};

/// Good, doubtful and bad: three colours of Okabe and Ito (2008), told apart also by colour-blind people.
const COLORS: [&str; 3] = ["#009e73", "#e69f00", "#d55e00"];

/// What was found of the passages of a graph.
pub struct Judgement {
    /// What was judged, for the title.
    pub what: String,
    /// For each passage of the graph, 0 if it is good, 1 if it is doubtful, 2 if it is bad.
    pub passages: Vec<usize>,
    /// What these three are called.
    pub names: [&'static str; 3],
    /// A way, in metres.
    pub route: Vec<[f64; 3]>,
    /// Numbered places, in metres.
    pub places: Vec<[f64; 3]>,
}

/// The plan as a PNG.
pub fn judged(subject: &Subject, judgement: &Judgement, size: Size) -> Vec<u8> {
    let sheet = Sheet { note: judgement.what.clone(), ..Sheet::plan(subject) };
    let palette = Theme::Light.palette();
    let svg = Svg::new(size, &format!("{} of {}", judgement.what, subject.name), palette.paper);
    let mut furniture = Furniture { svg, palette, area: Area::of(size) };
    furniture.title(subject, &sheet);
    let frames = Frame::of(&furniture.area, &sheet);
    for (panel, frame) in sheet.panels.iter().zip(&frames) {
        let view = View { graph: subject.graph, sheet: &sheet, panel, frame, palette };
        view.draw_passages(&mut furniture.svg, judgement);
        view.draw_route(&mut furniture.svg, &judgement.route);
        view.draw_places(&mut furniture.svg, &judgement.places);
        let at = [frame.corner[0], frame.corner[1] - 8.0 * frame.line_px];
        furniture.svg.text(at, Anchor::Left, 14.0 * frame.line_px, palette.faint, &panel.label);
    }
    key(&mut furniture, judgement);
    furniture.scale_bar(&sheet, frames[0].px_per_m);
    furniture.north();
    Image::of_svg(&furniture.svg.finish(), size).png()
}

/// A storey on paper.
struct View<'a> {
    graph: &'a Graph,
    sheet: &'a Sheet,
    panel: &'a Panel,
    frame: &'a Frame,
    palette: &'a Palette,
}

impl View<'_> {
    /// The bad passages over the good ones.
    fn draw_passages(&self, svg: &mut Svg, judgement: &Judgement) {
        let shape = |edge: &[StationId; 2]| self.frame.shape(edge.map(|end| &self.sheet[end]));
        let all: Vec<Vec<PaperPoint>> = self.sheet.everything.edges.iter().map(shape).collect();
        svg.fill(&all, self.palette.ghost);
        let here: Vec<Vec<PaperPoint>> = self.panel.edges.iter().map(shape).collect();
        svg.outline(&here, self.palette.wall, 2.0 * self.frame.line_px);
        for (class, color) in COLORS.into_iter().enumerate() {
            let is_of_class = |edge: &&[StationId; 2]| {
                let place = self.graph.edges.binary_search(edge);
                place.is_ok_and(|place| judgement.passages[place] == class)
            };
            let shapes: Vec<Vec<PaperPoint>> = self.panel.edges.iter().filter(is_of_class).map(shape).collect();
            if !shapes.is_empty() {
                svg.fill(&shapes, color);
            }
        }
    }

    fn draw_route(&self, svg: &mut Svg, route: &[[f64; 3]]) {
        let runs = route.chunk_by(|one, next| self.is_here(*one) == self.is_here(*next));
        let here = runs.filter(|run| self.is_here(run[0]) && run.len() > 1);
        let lines: Vec<Vec<PaperPoint>> =
            here.map(|run| run.iter().map(|[x, y, _]| self.frame.paper_point([*x, *y])).collect()).collect();
        svg.strokes(&lines, self.palette.paper, 4.0 * self.frame.line_px);
        svg.strokes(&lines, self.palette.ink, 2.0 * self.frame.line_px);
    }

    fn draw_places(&self, svg: &mut Svg, places: &[[f64; 3]]) {
        let unit = self.frame.line_px;
        for (number, place) in places.iter().enumerate().filter(|(_, place)| self.is_here(**place)) {
            let [x, y] = self.frame.paper_point([place[0], place[1]]);
            let cross = |half: f64| {
                vec![vec![[x - half, y - half], [x + half, y + half]], vec![[x - half, y + half], [x + half, y - half]]]
            };
            svg.strokes(&cross(6.0 * unit), self.palette.paper, 5.0 * unit);
            svg.strokes(&cross(5.0 * unit), self.palette.ink, 2.5 * unit);
            svg.text(
                [x + 8.0 * unit, y - 6.0 * unit],
                Anchor::Left,
                14.0 * unit,
                self.palette.ink,
                &(number + 1).to_string(),
            );
        }
    }

    /// Whether a point is in this storey: that of the nearest station.
    fn is_here(&self, point: [f64; 3]) -> bool {
        let Some(level) = self.panel.level else { return true };
        let away = |station: &StationId| (self.graph[*station].position.coords - nalgebra::Vector3::from(point)).norm();
        let nearest = self.graph.stations().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.is_some_and(|station| self.graph[station].level == level)
    }
}

/// What the colours mean.
fn key(furniture: &mut Furniture, judgement: &Judgement) {
    let unit = furniture.area.unit;
    let [x, mut y] = [furniture.area.paper[0] - 136.0 * unit, 150.0 * unit];
    for (class, (color, name)) in COLORS.iter().zip(judgement.names).enumerate() {
        let count = judgement.passages.iter().filter(|of| **of == class).count();
        furniture.svg.rectangle([x, y], [18.0 * unit, 18.0 * unit], color);
        let text = format!("{name} {count}");
        furniture.svg.text([x + 26.0 * unit, y + 14.0 * unit], Anchor::Left, 14.0 * unit, furniture.palette.ink, &text);
        y += 28.0 * unit;
    }
}
