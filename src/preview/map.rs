//! Plan and profile: passages at their true width, coloured by elevation.
//!
//! The plan has north (+y) up, and a panel for each storey, all to one scale. The profile is projected onto the vertical plane
//! along the longest horizontal axis of the cave (the first principal axis of its stations), and states the vertical
//! exaggeration if the cave is too flat to be legible otherwise.
//!
//! Widths are those of the smooth passages at their stations; a passage too narrow for the paper is drawn a pixel wide. Detail
//! below a pixel is merged, so that a map of a million stations is no larger than one of ten thousand. The plan has the names of
//! surveyed stations, as many as fit.

mod frame;
mod furniture;
pub mod judged;
mod marks;
mod names;
mod sheet;
mod stones;
mod thin;

use self::frame::{Area, Frame};
use self::furniture::Furniture;
use self::marks::Marks;
use self::names::{Names, Paper};
use self::sheet::{Panel, Sheet, SheetStation};
use self::stones::Stones;
use super::image::Image;
use super::svg::{Anchor, PaperPoint, Svg};
use super::theme::{Palette, class_color, elevation_class};
use super::{Drawn, Format, Order, PreviewError, Size, Subject};
use plume_graph::StationId;

/// Colours along one passage.
const MOST_STEPS: usize = 8;

/// The map seen from above.
pub fn plan(subject: &Subject, order: &Order, size: Size) -> Result<Drawn, PreviewError> {
    let sheet = Sheet::plan(subject);
    let px_per_m = Frame::of(&Area::of(size), &sheet)[0].px_per_m;
    let stones = Stones::of(subject, px_per_m, order.stop)?;
    Ok(file(&drawing(subject, order, size, &sheet, &stones), order.format, size))
}

/// The map seen from the side.
pub fn profile(subject: &Subject, order: &Order, size: Size) -> Result<Drawn, PreviewError> {
    let area = Area::of(size);
    let sheet = Sheet::profile(subject, area.height() / area.width());
    Ok(file(&drawing(subject, order, size, &sheet, &Stones::default()), order.format, size))
}

fn file(svg: &str, format: Format, size: Size) -> Drawn {
    match format {
        Format::Png => Drawn::File(Image::of_svg(svg, size).png()),
        _ => Drawn::File(svg.as_bytes().to_vec()),
    }
}

fn drawing(subject: &Subject, order: &Order, size: Size, sheet: &Sheet, stones: &Stones) -> String {
    let palette = order.theme.palette();
    let svg = Svg::new(size, &format!("{} of {}", sheet.what, subject.name), palette.paper);
    let mut furniture = Furniture { svg, palette, area: Area::of(size) };
    furniture.title(subject, sheet);
    let frames = Frame::of(&furniture.area, sheet);
    let marks = Marks::of(subject.graph);
    let names = Names::of(subject.graph);
    let mut paper = Paper::of(&furniture.area);
    for (panel, frame) in sheet.panels.iter().zip(&frames) {
        if sheet.is_upright {
            furniture.heights(sheet, frame);
        }
        draw_panel(&mut furniture.svg, palette, sheet, panel, frame);
        stones.draw(&mut furniture.svg, palette, panel, frame);
        marks.draw(&mut furniture.svg, palette, sheet, panel, frame);
        if !sheet.is_upright {
            names.draw(&mut furniture.svg, palette, sheet, panel, frame, &mut paper);
        }
        label(&mut furniture, panel, frame);
    }
    furniture.legend(sheet);
    furniture.key(&marks);
    furniture.scale_bar(sheet, frames[0].px_per_m);
    if !sheet.is_upright {
        furniture.north();
    }
    furniture.svg.finish()
}

fn label(furniture: &mut Furniture, panel: &Panel, frame: &Frame) {
    let unit = furniture.area.unit;
    let at = [frame.corner[0], frame.corner[1] - 8.0 * unit];
    furniture.svg.text(at, Anchor::Left, 14.0 * unit, furniture.palette.faint, &panel.label);
}

/// The passages of a storey, over faded ones of the others.
fn draw_panel(svg: &mut Svg, palette: &Palette, sheet: &Sheet, panel: &Panel, frame: &Frame) {
    if sheet.panels.len() > 1 {
        let all: Vec<Vec<PaperPoint>> =
            shapes(sheet, &sheet.everything, frame).into_iter().map(|(_, shape)| shape).collect();
        svg.fill(&all, palette.ghost);
    }
    let (classes, shapes): (Vec<usize>, Vec<Vec<PaperPoint>>) = shapes(sheet, panel, frame).into_iter().unzip();
    svg.outline(&shapes, palette.wall, 2.0 * frame.line_px);
    let mut first = 0;
    for run in classes.chunk_by(|one, next| one == next) {
        svg.fill(&shapes[first..first + run.len()], &class_color(run[0]));
        first += run.len();
    }
}

/// The outline of every passage with its elevation class, back to front.
fn shapes(sheet: &Sheet, panel: &Panel, frame: &Frame) -> Vec<(usize, Vec<PaperPoint>)> {
    let mut pieces = thin::pieces(sheet, panel, frame);
    let depth = |[a, b]: [StationId; 2]| sheet[a].depth + sheet[b].depth;
    pieces.sort_by(|&one, &other| depth(one).total_cmp(&depth(other)));
    pieces.into_iter().flat_map(|piece| steps(sheet, piece.map(|end| &sheet[end]), frame)).collect()
}

/// A passage in as many steps as it has colours, up to [`MOST_STEPS`].
fn steps(sheet: &Sheet, [a, b]: [&SheetStation; 2], frame: &Frame) -> Vec<(usize, Vec<PaperPoint>)> {
    let class = |height_m: f64| elevation_class(sheet.share(height_m));
    let count = class(a.height_m).abs_diff(class(b.height_m)).clamp(1, MOST_STEPS);
    let at = |step: usize| a.towards(b, step as f64 / count as f64);
    let step = |i: usize| {
        let ends = [at(i), at(i + 1)];
        (class((ends[0].height_m + ends[1].height_m) / 2.0), frame.shape(ends.each_ref()))
    };
    (0..count).map(step).collect()
}
