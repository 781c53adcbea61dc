//! Tiles as centrelines.

use nalgebra::{Point3, Vector3};
use rustc_hash::FxHashMap;

use super::board::{Board, Cell, Link, SIDES, Tile, bit, opposite};
use super::{Access, Tiles};
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::rng::Rng;
use plume_graph::{Section, Shape};

/// Distance of the end of a capped connector from the middle of its tile, in tile sizes.
const CAPPED: f64 = 0.35;
/// Inner vertices of a bend.
const BEND_KNOTS: usize = 3;

/// All tiles and links of the board, the first tile first.
pub(super) fn drawn(settings: &Tiles, board: &Board, rng: &mut Rng) -> CentrelineBuilder {
    let mut drawing =
        Drawing { settings, board, rng, centreline: CentrelineBuilder::default(), borders: FxHashMap::default() };
    for tile in &board.tiles {
        drawing.tile(tile);
    }
    for link in &board.links {
        drawing.link(link);
    }
    drawing.centreline
}

struct Drawing<'a> {
    settings: &'a Tiles,
    board: &'a Board,
    rng: &'a mut Rng,
    centreline: CentrelineBuilder,
    /// The vertex in the middle of each crossed side, by the cell to the west or south and the side.
    borders: FxHashMap<(Cell, usize), VertexId>,
}

impl Drawing<'_> {
    fn tile(&mut self, tile: &Tile) {
        let ends: Vec<VertexId> =
            (0..4).filter(|&side| tile.doors & bit(side) != 0).map(|side| self.door(tile.cell, side)).collect();
        match ends.as_slice() {
            &[a, b] if !tile.is_room => self.way(tile, a, b),
            _ => {
                let width_m = if tile.is_room { self.settings.room_width_m } else { self.width() };
                let middle = self.middle(tile);
                let middle = self.vertex(middle, width_m, tile.cell[2]);
                ends.into_iter().for_each(|end| self.centreline.join(middle, end));
            }
        }
    }

    /// A passage between two connectors: straight or a quarter circle, displaced in its middle.
    fn way(&mut self, tile: &Tile, a: VertexId, b: VertexId) {
        let [from, to] = [a, b].map(|end| self.centreline[end].position);
        let pull = self.middle(tile);
        let mut before = a;
        for place in 1..=BEND_KNOTS {
            let t = place as f64 / (BEND_KNOTS + 1) as f64;
            // A quadratic Bézier curve with the middle of the tile as control point.
            let at = from.coords * ((1.0 - t) * (1.0 - t)) + pull.coords * (2.0 * t * (1.0 - t)) + to.coords * (t * t);
            let width_m = self.width();
            let vertex = self.vertex(at.into(), width_m, tile.cell[2]);
            self.centreline.join(before, vertex);
            before = vertex;
        }
        self.centreline.join(before, b);
    }

    /// The vertex at the end of a connector: shared with the next tile, or capped.
    fn door(&mut self, cell: Cell, side: usize) -> VertexId {
        let [dx, dy] = SIDES[side];
        if !self.board.leads_on(cell, side) {
            let at = self.at(cell, [CAPPED * f64::from(dx), CAPPED * f64::from(dy)]);
            let width_m = self.width();
            return self.vertex(at, width_m, cell[2]);
        }
        let key = if side < 2 { (cell, side) } else { ([cell[0] + dx, cell[1] + dy, cell[2]], opposite(side)) };
        if let Some(&vertex) = self.borders.get(&key) {
            return vertex;
        }
        let at = self.at(cell, [0.5 * f64::from(dx), 0.5 * f64::from(dy)]);
        let width_m = self.width();
        let vertex = self.vertex(at, width_m, cell[2]);
        self.borders.insert(key, vertex);
        vertex
    }

    /// A way down: straight in the plan, or vertical in the middle of its cell.
    fn link(&mut self, link: &Link) {
        let [top, bottom] = [self.door(link.cell, opposite(link.side)), self.door(link.last(), link.side)];
        let mut chain = vec![top];
        if self.settings.access == Access::Shaft {
            let width_m = self.settings.width_min_m;
            chain.push(self.vertex(self.at(link.cell, [0.0; 2]), width_m, link.cell[2]));
            chain.push(self.vertex(self.at(link.last(), [0.0; 2]), width_m, link.last()[2]));
        }
        chain.push(bottom);
        chain.windows(2).for_each(|pair| self.centreline.join(pair[0], pair[1]));
    }

    /// The displaced middle of a tile.
    fn middle(&mut self, tile: &Tile) -> Point3<f64> {
        let wobble = self.settings.wobble;
        let off = [0, 1].map(|_| self.rng.between(-wobble, wobble));
        self.at(tile.cell, off)
    }

    /// A point of a cell, relative to its middle, in tile sizes.
    fn at(&self, cell: Cell, off: [f64; 2]) -> Point3<f64> {
        let [x, y] = [0, 1].map(|axis| (f64::from(cell[axis]) + off[axis]) * self.settings.pitch_m);
        Point3::from(Vector3::new(x, y, -f64::from(cell[2]) * self.settings.level_spacing_m))
    }

    fn width(&mut self) -> f64 {
        self.rng.between(self.settings.width_min_m, self.settings.width_max_m)
    }

    fn vertex(&mut self, position: Point3<f64>, width_m: f64, level: i32) -> VertexId {
        let section = Section { width_m, height_m: self.settings.height_m, shape: Shape::Drift };
        self.centreline.add(Vertex { position, section: Some(section), level: level as u32 })
    }
}
