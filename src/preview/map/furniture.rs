//! Map furniture: title, scale bar, north arrow, legend.

use super::frame::{Area, Frame};
use super::marks::{self, Mark, Marks};
use super::sheet::{Sheet, whole};
use crate::preview::Subject;
use crate::preview::svg::{Anchor, PaperPoint, Svg};
use crate::preview::theme::{Palette, VIRIDIS, class_color};

/// Paper, and what is drawn on it.
pub struct Furniture {
    /// The drawing.
    pub svg: Svg,
    /// Its colours.
    pub palette: &'static Palette,
    /// Layout of the map.
    pub area: Area,
}

impl Furniture {
    /// The name of the cave and its statistics.
    pub fn title(&mut self, subject: &Subject, sheet: &Sheet) {
        let unit = self.area.unit;
        let graph = subject.graph;
        let (nodes, loops) = (counted(graph.nodes.len(), "node"), counted(graph.loops(), "loop"));
        let mut numbers = format!("{} · {nodes} · {} m of passage · {loops}", sheet.what, whole(graph.length_m()));
        if !sheet.note.is_empty() {
            numbers = format!("{numbers} · {}", sheet.note);
        }
        let right = self.area.paper[0] - 136.0 * unit;
        self.fitted([32.0 * unit, 44.0 * unit], right, 26.0 * unit, self.palette.ink, subject.name);
        self.fitted([32.0 * unit, 70.0 * unit], right, 15.0 * unit, self.palette.faint, &numbers);
    }

    /// A text that is shrunk if it would extend beyond `right`.
    fn fitted(&mut self, at: PaperPoint, right: f64, size: f64, fill: &str, text: &str) {
        let share = (right - at[0]) / self.svg.text_width(text, size).max(1e-9);
        self.svg.text(at, Anchor::Left, size * share.min(1.0), fill, text);
    }

    /// An arrow to the top of the paper.
    pub fn north(&mut self) {
        let unit = self.area.unit;
        let [x, y] = [self.area.paper[0] - 104.0 * unit, 40.0 * unit];
        let half = |side: f64| vec![[x, y], [x + side * 9.0 * unit, y + 34.0 * unit], [x, y + 26.0 * unit]];
        self.svg.fill(&[half(-1.0)], self.palette.ink);
        self.svg.outline(&[half(-1.0), half(1.0)], self.palette.ink, 1.2 * unit);
        self.svg.text([x, y - 8.0 * unit], Anchor::Middle, 16.0 * unit, self.palette.ink, "N");
    }

    /// A scale bar with a round number of metres, and the vertical exaggeration.
    pub fn scale_bar(&mut self, sheet: &Sheet, px_per_m: f64) {
        let unit = self.area.unit;
        let length_m = round_below(240.0 * unit / px_per_m);
        let half_px = length_m * px_per_m / 2.0;
        let [x, y] = [32.0 * unit, self.area.paper[1] - 36.0 * unit];
        self.svg.rectangle([x, y], [half_px, 6.0 * unit], self.palette.ink);
        let right = vec![
            [x + half_px, y],
            [x + 2.0 * half_px, y],
            [x + 2.0 * half_px, y + 6.0 * unit],
            [x + half_px, y + 6.0 * unit],
        ];
        self.svg.outline(&[right], self.palette.ink, unit);
        let ends = [(0.0, "0".to_owned()), (half_px, metres(length_m / 2.0)), (2.0 * half_px, metres(length_m) + " m")];
        for (across, label) in ends {
            let at = [x + across, y - 6.0 * unit];
            let anchor = if across == 0.0 { Anchor::Left } else { Anchor::Middle };
            self.svg.text(at, anchor, 13.0 * unit, self.palette.ink, &label);
        }
        if sheet.is_upright {
            let text = match sheet.stretch {
                1.0 => "heights to the same scale".to_owned(),
                stretch => format!("heights × {stretch}"),
            };
            let at = [x + 2.0 * half_px + 40.0 * unit, y + 6.0 * unit];
            self.svg.text(at, Anchor::Left, 14.0 * unit, self.palette.ink, &text);
        }
    }

    /// Lines at round heights behind a profile.
    pub fn heights(&mut self, sheet: &Sheet, frame: &Frame) {
        let unit = self.area.unit;
        let bounds = sheet.bounds();
        let [low, high] = [bounds.min, bounds.max].map(|[_, metres]| metres / sheet.stretch);
        for height_m in ticks(low, high, 6.0) {
            let y = frame.paper_point([0.0, height_m * sheet.stretch])[1];
            let [left, right] = [self.area.min[0], self.area.max[0]];
            self.svg.strokes(&[vec![[left, y], [right, y]]], self.palette.grid, unit);
            let at = [left - 8.0 * unit, y + 4.5 * unit];
            self.svg.text(at, Anchor::Right, 12.0 * unit, self.palette.faint, &metres(height_m));
        }
    }

    /// The legend of elevations.
    pub fn legend(&mut self, sheet: &Sheet) {
        let unit = self.area.unit;
        let [x, y] = [self.area.paper[0] - 136.0 * unit, 150.0 * unit];
        let (width, height) = (18.0 * unit, 224.0 * unit);
        self.svg.text([x, y - 16.0 * unit], Anchor::Left, 14.0 * unit, self.palette.ink, "elevation, m");
        let step = height / VIRIDIS.len() as f64;
        for class in (0..VIRIDIS.len()).rev() {
            // Each extends under the next one, so that no paper shows between them.
            let top = y + height - (class + 1) as f64 * step;
            self.svg.rectangle([x, top], [width, y + height - top], &class_color(class));
        }
        let [low, high] = sheet.heights_m;
        let marks = if high > low { ticks(low, high, 6.0) } else { vec![low] };
        for height_m in marks {
            let at = y + height * (1.0 - sheet.share(height_m));
            let line = vec![[x + width, at], [x + width + 5.0 * unit, at]];
            self.svg.strokes(&[line], self.palette.ink, unit);
            let label = [x + width + 10.0 * unit, at + 4.5 * unit];
            self.svg.text(label, Anchor::Left, 13.0 * unit, self.palette.ink, &metres(height_m));
        }
    }

    /// The legend of marks.
    pub fn key(&mut self, marks: &Marks) {
        let unit = self.area.unit;
        let [x, mut y] = [self.area.paper[0] - 127.0 * unit, 416.0 * unit];
        for (mark, what) in [(Mark::Origin, "origin"), (Mark::Loop, "loop"), (Mark::DeadEnd, "dead end")] {
            let count = marks.count(mark);
            if count == 0 {
                continue;
            }
            marks::draw(&mut self.svg, self.palette, mark, [x, y], unit);
            let at = [x + 18.0 * unit, y + 5.0 * unit];
            let right = self.area.paper[0] - 4.0 * unit;
            self.fitted(at, right, 13.0 * unit, self.palette.ink, &counted(count, what));
            y += 24.0 * unit;
        }
    }
}

/// A count with singular or plural.
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `most`.
fn round_below(most: f64) -> f64 {
    let mut power = 1.0;
    while power * 10.0 <= most {
        power *= 10.0;
    }
    while power > most {
        power /= 10.0;
    }
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|length| *length <= most).unwrap_or(power)
}

/// Multiples of a round number, about `count` of them.
fn ticks(low: f64, high: f64, count: f64) -> Vec<f64> {
    let least = (high - low) / count;
    let step = [1.0, 2.0, 2.5, 5.0].map(|digits| digits * round_below(least)).into_iter().find(|step| *step >= least);
    let step = step.unwrap_or(least);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// A length without needless digits.
fn metres(length_m: f64) -> String {
    // Adding zero turns -0.0 into 0.0.
    format!("{}", (length_m * 1000.0).round() / 1000.0 + 0.0).replace('-', "−")
}
