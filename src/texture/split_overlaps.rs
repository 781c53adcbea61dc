//! Splits charts until none overlaps itself.
//!
//! A chart is regrown from its first triangle, edge by edge; a triangle that covers an occupied texel centre is left for the
//! next chart. Overlaps that cover no texel centre at the given scale are not detected, and harmless at that scale.

use std::collections::VecDeque;

use super::adjacency::NONE;
use super::chart::{Chart, Scale};
use super::raster::{self, SUBTEXELS};
use crate::mesh::Mesh;

/// The same triangles in charts that cover no texel centre twice; unaffected charts keep their order and shape, the parts of
/// others follow their first part.
pub(super) fn split_overlaps(mesh: &Mesh, neighbours: &[[u32; 3]], charts: Vec<Chart>, scale: Scale) -> Vec<Chart> {
    let mut peeler = Peeler { mesh, neighbours, scale, state: vec![State::Elsewhere; neighbours.len()] };
    charts.into_iter().flat_map(|chart| peeler.layers(chart)).collect()
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    /// In no layer of this chart yet; refused by the layer with this number.
    Waiting(u32),
    /// In another chart, or already in a layer.
    Elsewhere,
}

struct Peeler<'a> {
    mesh: &'a Mesh,
    neighbours: &'a [[u32; 3]],
    scale: Scale,
    state: Vec<State>,
}

impl Peeler<'_> {
    fn layers(&mut self, chart: Chart) -> Vec<Chart> {
        for &t in &chart.triangles {
            self.state[t as usize] = State::Waiting(0);
        }
        let mut sheet = Sheet::new(chart.size(self.scale));
        let mut layers = vec![];
        for &seed in &chart.triangles {
            if self.state[seed as usize] == State::Elsewhere {
                continue;
            }
            sheet.clear();
            layers.push(self.grow(&chart, seed, layers.len() as u32 + 1, &mut sheet));
        }
        if layers.len() == 1 {
            return vec![chart];
        }
        layers.into_iter().map(|layer| Chart::new(self.mesh, chart.axis, layer)).collect()
    }

    fn grow(&mut self, chart: &Chart, seed: u32, layer: u32, sheet: &mut Sheet) -> Vec<u32> {
        let mut grown = vec![];
        let mut queue = VecDeque::from([seed]);
        while let Some(t) = queue.pop_front() {
            let state = &mut self.state[t as usize];
            if *state == State::Elsewhere || *state == State::Waiting(layer) {
                continue;
            }
            if !sheet.claim(&chart.corners(self.mesh, t, self.scale)) {
                *state = State::Waiting(layer);
                continue;
            }
            *state = State::Elsewhere;
            grown.push(t);
            queue.extend(self.neighbours[t as usize].iter().filter(|&&n| n != NONE));
        }
        grown.sort_unstable();
        grown
    }
}

/// The texels of a chart, occupied or free.
struct Sheet {
    width: usize,
    height: usize,
    taken: Vec<bool>,
    spans: Vec<std::ops::Range<usize>>,
}

impl Sheet {
    fn new(size: [i32; 2]) -> Self {
        let [width, height] = size.map(|steps| (steps / SUBTEXELS + 1) as usize);
        Self { width, height, taken: vec![false; width * height], spans: vec![] }
    }

    fn clear(&mut self) {
        self.taken.fill(false);
    }

    /// Occupies the triangle's texels, all or none.
    fn claim(&mut self, corners: &raster::Corners) -> bool {
        self.spans.clear();
        raster::spans(corners, 0..self.height as i32, |y, xs| {
            let row = y as usize * self.width;
            self.spans.push(row + xs.start as usize..row + xs.end as usize);
        });
        if self.spans.iter().any(|span| self.taken[span.clone()].contains(&true)) {
            return false;
        }
        for span in &self.spans {
            self.taken[span.clone()].fill(true);
        }
        true
    }
}
