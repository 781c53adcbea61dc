//! Layout of a map on the paper, and conversion from metres to pixels.

use std::f64::consts::TAU;

use super::sheet::{Sheet, SheetStation};
use crate::preview::Size;
use crate::preview::svg::PaperPoint;

/// The part of the paper that maps are drawn on. Lengths in units of a paper of 1280 × 640 pixels.
pub struct Area {
    /// Pixels per unit.
    pub unit: f64,
    /// Size of the whole paper in pixels.
    pub paper: PaperPoint,
    /// Upper left corner.
    pub min: PaperPoint,
    /// Lower right corner.
    pub max: PaperPoint,
}

impl Area {
    /// The area of a paper of this size, with room for title, scale and legend around it.
    pub fn of(size: Size) -> Self {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        let unit = (width / 1280.0).min(height / 640.0);
        let max = [width - 196.0 * unit, height - 76.0 * unit];
        Self { unit, paper: [width, height], min: [64.0 * unit, 104.0 * unit], max }
    }

    /// Width in pixels.
    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    /// Height in pixels.
    pub fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }
}

/// Position of a panel.
pub struct Frame {
    /// Scale of lengths, the same in all panels.
    pub px_per_m: f64,
    /// Width of a thin line.
    pub line_px: f64,
    /// Upper left corner, in pixels.
    pub corner: PaperPoint,
    /// Leftmost and highest coordinates, in metres, at the corner.
    origin: [f64; 2],
}

impl Frame {
    /// The frames of all panels, as large as the area allows.
    pub fn of(area: &Area, sheet: &Sheet) -> Vec<Self> {
        let bounds = sheet.bounds();
        let [wide, tall] = bounds.size();
        let count = sheet.panels.len();
        let gap_of = |panels: usize| if panels > 1 { 32.0 * area.unit } else { 0.0 };
        let room = |columns: usize| {
            let rows = count.div_ceil(columns);
            let across = area.width() / columns as f64 - gap_of(columns);
            let down = area.height() / rows as f64 - gap_of(rows);
            (across / wide).min(down / tall)
        };
        let columns = (1..=count).rev().max_by(|&one, &other| room(one).total_cmp(&room(other))).unwrap_or(1);
        let px_per_m = room(columns);
        let cell = [area.width() / columns as f64, area.height() / count.div_ceil(columns) as f64];
        let slack = [(cell[0] - wide * px_per_m) / 2.0, (cell[1] - tall * px_per_m) / 2.0];
        let frame = |panel: usize| {
            let place = [(panel % columns) as f64, (panel / columns) as f64];
            let corner = [0, 1].map(|i| area.min[i] + place[i] * cell[i] + slack[i]);
            Self { px_per_m, line_px: area.unit, corner, origin: [bounds.min[0], bounds.max[1]] }
        };
        (0..count).map(frame).collect()
    }

    /// The position on paper.
    pub fn paper_point(&self, at: [f64; 2]) -> PaperPoint {
        let [left, high] = self.origin;
        [self.corner[0] + (at[0] - left) * self.px_per_m, self.corner[1] + (high - at[1]) * self.px_per_m]
    }

    /// The outline of the passage between two stations: the hull of its sections there.
    pub fn shape(&self, ends: [&SheetStation; 2]) -> Vec<PaperPoint> {
        let mut spots = self.section(ends[0]);
        spots.extend(self.section(ends[1]));
        hull(spots)
    }

    /// A passage as seen at its station: a circle from above, egg-shaped from the side.
    fn section(&self, station: &SheetStation) -> Vec<PaperPoint> {
        let [aside, up, down] = station.reach.map(|reach| (reach * self.px_per_m).max(0.6 * self.line_px));
        let corners = 4 * ((aside.max(up) / 3.0) as usize + 2).min(8);
        let [x, y] = self.paper_point(station.at);
        let corner = |i: usize| {
            let angle = TAU * i as f64 / corners as f64;
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            [x + aside * cosine, y - sine * if sine > 0.0 { up } else { down }]
        };
        (0..corners).map(corner).collect()
    }
}

/// The convex hull of points (Andrew's monotone chain).
pub fn hull(mut points: Vec<PaperPoint>) -> Vec<PaperPoint> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let mut hull = chain(points.iter());
    hull.extend(chain(points.iter().rev()));
    hull
}

/// One side of a hull, without its last point.
fn chain<'a>(points: impl Iterator<Item = &'a PaperPoint>) -> Vec<PaperPoint> {
    let mut side: Vec<PaperPoint> = Vec::new();
    for &point in points {
        while let [.., a, b] = side[..] {
            let turn = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
            if turn > 0.0 {
                break;
            }
            side.pop();
        }
        side.push(point);
    }
    side.pop();
    side
}
