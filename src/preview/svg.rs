//! An SVG writer with filled and stroked outlines only, including text.
//!
//! Without fonts, style sheets and arcs, so that every viewer shows the same.

use std::fmt::Write;

use ttf_parser::{Face, OutlineBuilder};

use super::Size;

/// A subset of DejaVu Sans.
static FONT: &[u8] = include_bytes!("../../templates/preview/DejaVuSans-subset.ttf");

/// A point on the paper in pixels, y down.
pub type PaperPoint = [f64; 2];

/// Alignment of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Left,
    /// Its middle.
    Middle,
    /// Its right end.
    Right,
}

/// An SVG under construction.
pub struct Svg {
    text: String,
    face: Face<'static>,
}

impl Svg {
    /// Paper of this size and colour; `title` is for accessibility.
    pub fn new(size: Size, title: &str, paper: &str) -> Self {
        let Size { width, height } = size;
        let face = Face::parse(FONT, 0).expect("the font in the binary is whole");
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n<title>{}</title>\n",
            escaped(title)
        );
        let mut svg = Self { text, face };
        svg.rectangle([0.0, 0.0], [f64::from(width), f64::from(height)], paper);
        svg
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, corner: PaperPoint, size: PaperPoint, fill: &str) {
        let ([x, y], [width, height]) = (corner.map(Px), size.map(Px));
        self.line(format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>"));
    }

    /// Filled polygons.
    pub fn fill(&mut self, polygons: &[Vec<PaperPoint>], fill: &str) {
        let data = closed(polygons);
        self.line(format_args!("<path fill=\"{fill}\" d=\"{data}\"/>"));
    }

    /// The edges of polygons.
    pub fn outline(&mut self, polygons: &[Vec<PaperPoint>], stroke: &str, width: f64) {
        let (data, width) = (closed(polygons), Px(width));
        self.line(format_args!(
            "<path fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" d=\"{data}\"/>"
        ));
    }

    /// Open lines.
    pub fn strokes(&mut self, lines: &[Vec<PaperPoint>], stroke: &str, width: f64) {
        let (data, width) = (lines.iter().map(|line| open(line)).collect::<String>(), Px(width));
        self.line(format_args!("<path fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\" d=\"{data}\"/>"));
    }

    /// A text in one line, `size` pixels high.
    pub fn text(&mut self, at: PaperPoint, anchor: Anchor, size: f64, fill: &str, text: &str) {
        let scale = size / f64::from(self.face.units_per_em());
        let width = self.text_width(text, size);
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Middle => at[0] - width / 2.0,
            Anchor::Right => at[0] - width,
        };
        let mut pen = Pen { at: [left, at[1]], scale, data: String::new() };
        for letter in text.chars() {
            let glyph = self.face.glyph_index(letter).unwrap_or_default();
            self.face.outline_glyph(glyph, &mut pen);
            pen.at[0] += f64::from(self.face.glyph_hor_advance(glyph).unwrap_or_default()) * scale;
        }
        let (label, data) = (escaped(text), pen.data);
        self.line(format_args!("<path aria-label=\"{label}\" fill=\"{fill}\" d=\"{data}\"/>"));
    }

    /// Width of a text of this height, in pixels.
    pub fn text_width(&self, text: &str, size: f64) -> f64 {
        let advance = |letter| self.face.glyph_hor_advance(self.face.glyph_index(letter).unwrap_or_default());
        let units: f64 = text.chars().map(|letter| f64::from(advance(letter).unwrap_or_default())).sum();
        units * size / f64::from(self.face.units_per_em())
    }

    /// The whole file.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    fn line(&mut self, line: std::fmt::Arguments) {
        writeln!(self.text, "{line}").expect("a text takes all");
    }
}

/// Draws glyphs.
struct Pen {
    at: PaperPoint,
    scale: f64,
    data: String,
}

impl Pen {
    fn put(&mut self, command: char, points: &[[f32; 2]]) {
        self.data.push(command);
        for (i, [x, y]) in points.iter().enumerate() {
            let (x, y) = (self.at[0] + f64::from(*x) * self.scale, self.at[1] - f64::from(*y) * self.scale);
            let gap = if i == 0 { "" } else { " " };
            write!(self.data, "{gap}{} {}", Px(x), Px(y)).expect("a text takes all");
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.put('M', &[[x, y]]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.put('L', &[[x, y]]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.put('Q', &[[x1, y1], [x, y]]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.put('C', &[[x1, y1], [x2, y2], [x, y]]);
    }

    fn close(&mut self) {
        self.data.push('Z');
    }
}

/// A length in pixels, to a hundredth.
struct Px(f64);

impl std::fmt::Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        // Adding zero turns -0.0 into 0.0.
        let hundredths = (self.0 * 100.0).round() + 0.0;
        write!(f, "{}", hundredths / 100.0)
    }
}

fn open(line: &[PaperPoint]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in line.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        write!(data, "{command}{} {}", Px(*x), Px(*y)).expect("a text takes all");
    }
    data
}

fn closed(polygons: &[Vec<PaperPoint>]) -> String {
    polygons.iter().map(|polygon| open(polygon) + "Z").collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
