//! What each texel of a strip of the atlas shows.

use std::ops::Range;

use super::Textured;
use super::patch::corners;
use super::raster::{self, SUBTEXELS};
use plume_graph::Rows;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;
/// Rings of texels around a chart that extend its rim: the reach of bilinear lookups and the first mip level.
const RINGS: usize = 2;
/// Rings of texels around those that repeat the nearest of them, for the mip levels down to the fourth.
const REPEATED_RINGS: usize = 6;

/// What the texels of a strip show.
pub(super) struct Shown {
    /// Rows from the bottom of the atlas: those of the strip, and beyond it those with texels that it repeats.
    pub rows: Range<i32>,
    /// The triangle at each texel of these rows that is to be sampled, row by row from the lowest; [`NONE`] at the others.
    pub triangles: Vec<u32>,
    /// The texel of these rows that each of them repeats: itself where it has a triangle, [`NONE`] in the background.
    pub sources: Vec<u32>,
}

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

    /// What the texels of a strip show.
    ///
    /// A texel shows the triangle that contains its centre, otherwise the first that touches it; then charts grow by
    /// [`RINGS`] texels, and their rims are repeated in [`REPEATED_RINGS`] more.
    pub fn shown(&self, textured: &Textured, strip: u32) -> Shown {
        let strip_rows = self.rows(strip, textured.size_px);
        let (rings, repeated) = (RINGS as i32, REPEATED_RINGS as i32);
        let rows = strip_rows.start - repeated..strip_rows.end + repeated;
        let mut picture = Picture::new(rows.start - rings..rows.end + rings, textured.size_px);
        for &t in &self.triangles[strip as usize] {
            picture.cover(&corners(textured, t), t);
        }
        for &t in &self.triangles[strip as usize] {
            picture.brush(&corners(textured, t), t);
        }
        for _ in 0..RINGS {
            picture.grow();
        }
        let mut triangles = picture.into_rows(rows.clone());
        let itself = |(texel, triangle): (u32, &u32)| if *triangle == NONE { NONE } else { texel };
        let owners = (0..).zip(&triangles).map(itself).collect();
        let mut picture = Picture { rows: rows.clone(), width: textured.size_px as usize, owners };
        for _ in 0..REPEATED_RINGS {
            picture.grow();
        }
        let sources = picture.owners;
        let beyond = REPEATED_RINGS * textured.size_px as usize;
        let within = beyond..triangles.len() - beyond;
        let mut needed = vec![false; triangles.len()];
        for source in sources[within].iter().filter(|source| **source != NONE) {
            needed[*source as usize] = true;
        }
        triangles.iter_mut().zip(needed).filter(|(_, needed)| !needed).for_each(|(triangle, _)| *triangle = NONE);
        Shown { rows, triangles, sources }
    }
}

fn strips_near(textured: &Textured, triangle: u32, rows: u32, count: u32) -> Range<u32> {
    let ys = corners(textured, triangle).map(|c| c[1].div_euclid(SUBTEXELS));
    let reach = (RINGS + REPEATED_RINGS) as i32;
    let low = ys.into_iter().fold(i32::MAX, i32::min) - reach;
    let high = ys.into_iter().fold(i32::MIN, i32::max) + reach;
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
        let outside = vec![NONE; self.width];
        let rows: Vec<&[u32]> = before.chunks(self.width).collect();
        for (y, owners) in self.owners.chunks_mut(self.width).enumerate() {
            let beside = |row: Option<usize>| row.and_then(|row| rows.get(row)).copied().unwrap_or(&outside);
            grow_row(beside(y.checked_sub(1)), rows[y], beside(Some(y + 1)), owners);
        }
    }

    fn into_rows(mut self, rows: Range<i32>) -> Vec<u32> {
        let skip = (rows.start - self.rows.start) as usize * self.width;
        self.owners.drain(..skip);
        self.owners.truncate(rows.len() * self.width);
        self.owners
    }
}

/// Assigns the free texels of a row, given the rows below and above it.
fn grow_row(below: &[u32], row: &[u32], above: &[u32], owners: &mut [u32]) {
    let taken = |x: usize| (below[x] & row[x] & above[x]) != NONE;
    let last = row.len() - 1;
    for x in 0..row.len() {
        let (left, right) = (x.saturating_sub(1), (x + 1).min(last));
        if row[x] != NONE || !(taken(left) || taken(x) || taken(right)) {
            continue;
        }
        let around = [row[left], row[right], below[x], above[x], below[left], below[right], above[left], above[right]];
        if let Some(owner) = around.into_iter().find(|&owner| owner != NONE) {
            owners[x] = owner;
        }
    }
}
