//! The triangle shown at each texel of a strip of the atlas.

use std::ops::Range;

use super::Textured;
use super::patch::corners;
use super::raster::{self, SUBTEXELS};
use plume_graph::Rows;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Rings of texels around a chart that extend its rim: the reach of bilinear lookups and the first mip level.
const RINGS: usize = 2;

/// The triangles of the atlas by horizontal strip.
pub(super) struct Strips {
    rows_per_strip: u32,
    triangles: Rows<u32>,
}

impl Strips {
    pub fn new(textured: &Textured, rows_per_strip: u32) -> Self {
        let count = textured.size_px.div_ceil(rows_per_strip);
        let near = |t: u32| strips_near(textured, t, rows_per_strip, count).map(move |strip| (strip as usize, t));
        let triangles = Rows::from_pairs(count as usize, (0..textured.triangles.len() as u32).flat_map(near));
        Self { rows_per_strip, triangles }
    }

    pub fn count(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// The rows of a strip, counted from the bottom of the atlas.
    pub fn rows(&self, strip: u32, size_px: u32) -> Range<i32> {
        let start = strip * self.rows_per_strip;
        start as i32..(start + self.rows_per_strip).min(size_px) as i32
    }

    /// The triangle shown at each texel of a strip, row by row from its lowest, [`NONE`] for background.
    ///
    /// A texel shows the triangle that contains its centre, otherwise the first that touches it; then charts grow by
    /// [`RINGS`] texels.
    pub fn owners(&self, textured: &Textured, strip: u32) -> Vec<u32> {
        let halo = RINGS as i32;
        let rows = self.rows(strip, textured.size_px);
        let mut picture = Picture::new(rows.start - halo..rows.end + halo, textured.size_px);
        for &t in &self.triangles[strip as usize] {
            picture.cover(&corners(textured, t), t);
        }
        for &t in &self.triangles[strip as usize] {
            picture.brush(&corners(textured, t), t);
        }
        for _ in 0..RINGS {
            picture.grow();
        }
        picture.into_rows(rows)
    }
}

fn strips_near(textured: &Textured, triangle: u32, rows: u32, count: u32) -> Range<u32> {
    let ys = corners(textured, triangle).map(|c| c[1].div_euclid(SUBTEXELS));
    let low = ys.into_iter().fold(i32::MAX, i32::min) - RINGS as i32;
    let high = ys.into_iter().fold(i32::MIN, i32::max) + RINGS as i32;
    low.max(0) as u32 / rows..(high as u32 / rows + 1).min(count)
}

/// Owners of some rows.
struct Picture {
    rows: Range<i32>,
    width: usize,
    owners: Vec<u32>,
}

impl Picture {
    fn new(rows: Range<i32>, size_px: u32) -> Self {
        let width = size_px as usize;
        Self { owners: vec![NONE; rows.len() * width], rows, width }
    }

    /// Shows the triangle at texels whose centre it contains.
    fn cover(&mut self, corners: &raster::Corners, triangle: u32) {
        raster::spans(corners, self.rows.clone(), |y, xs| self.claim(y, xs, triangle));
    }

    /// Shows the triangle at texels that it touches.
    fn brush(&mut self, corners: &raster::Corners, triangle: u32) {
        raster::touched(corners, SUBTEXELS, |y, xs| {
            if self.rows.contains(&y) {
                self.claim(y, xs.start.max(0)..xs.end.min(self.width as i32), triangle);
            }
        });
    }

    /// The free texels.
    fn claim(&mut self, y: i32, xs: Range<i32>, triangle: u32) {
        let row = (y - self.rows.start) as usize * self.width;
        for owner in &mut self.owners[row + xs.start as usize..row + xs.end as usize] {
            if *owner == NONE {
                *owner = triangle;
            }
        }
    }

    /// Assigns free texels to the owner of a neighbour: horizontal before vertical before diagonal.
    fn grow(&mut self) {
        let before = self.owners.clone();
        let (width, height) = (self.width as isize, self.rows.len() as isize);
        for y in 0..height {
            for x in 0..width {
                let at = (y * width + x) as usize;
                if before[at] != NONE {
                    continue;
                }
                let neighbour = |&(dx, dy): &(isize, isize)| {
                    let inside = (0..width).contains(&(x + dx)) && (0..height).contains(&(y + dy));
                    let owner = inside.then(|| before[((y + dy) * width + x + dx) as usize]);
                    owner.filter(|&owner| owner != NONE)
                };
                if let Some(owner) = AROUND.iter().find_map(neighbour) {
                    self.owners[at] = owner;
                }
            }
        }
    }

    fn into_rows(mut self, rows: Range<i32>) -> Vec<u32> {
        let skip = (rows.start - self.rows.start) as usize * self.width;
        self.owners.drain(..skip);
        self.owners.truncate(rows.len() * self.width);
        self.owners
    }
}

const AROUND: [(isize, isize); 8] = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
