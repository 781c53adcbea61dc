//! The grid of tiles, and how it grows.

use rustc_hash::FxHashMap;

use super::Tiles;
use plume_graph::rng::Rng;

/// Column, row and level.
pub(super) type Cell = [i32; 3];

/// Steps to the neighbours of a cell, in circular order; the side of a cell is an index into this list.
pub(super) const SIDES: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
/// Probability that growth continues at the last tile (tuned: less makes a cluster, more a worm).
const GOES_ON: f64 = 0.25;
/// Attempts to find a place for a way down.
const TRIES: usize = 200;

/// Connectors of a tile: a bit for each side.
pub(super) type Doors = u8;

/// A tile on the grid.
pub(super) struct Tile {
    pub(super) cell: Cell,
    pub(super) doors: Doors,
    pub(super) is_room: bool,
}

/// A way down from a side of a cell on one level to the far side of the last of a row of cells on the next level.
pub(super) struct Link {
    pub(super) cell: Cell,
    /// The side by which it leaves the cell; it enters by the opposite one.
    pub(super) side: usize,
    pub(super) tiles: usize,
}

pub(super) struct Board {
    pub(super) tiles: Vec<Tile>,
    pub(super) links: Vec<Link>,
    /// Length of all passages in tile sizes.
    pub(super) length: f64,
    doors: FxHashMap<Cell, Doors>,
    /// Index of each tile in `tiles`.
    places: FxHashMap<Cell, usize>,
    /// Connectors that lead into free cells, and some that no longer do so.
    open: Vec<(Cell, usize)>,
}

impl Board {
    /// A board with a first tile.
    pub(super) fn new(settings: &Tiles, rng: &mut Rng) -> Self {
        let mut board = Self {
            tiles: Vec::new(),
            links: Vec::new(),
            length: 0.0,
            doors: FxHashMap::default(),
            places: FxHashMap::default(),
            open: Vec::new(),
        };
        board.place(settings, [0, 0, 0], None, rng);
        board
    }

    /// Adds a tile to this level.
    pub(super) fn grow(&mut self, settings: &Tiles, level: i32, rng: &mut Rng) {
        match self.draw_open(level, rng) {
            Some((cell, side)) => self.place(settings, next(cell, side), Some(opposite(side)), rng),
            None => self.reopen(level, rng),
        }
    }

    /// A connector that leads into a free cell.
    fn draw_open(&mut self, level: i32, rng: &mut Rng) -> Option<(Cell, usize)> {
        while !self.open.is_empty() {
            let last = self.open.len() - 1;
            let place = if rng.chance(GOES_ON) { last } else { rng.index(self.open.len()) };
            let (cell, side) = self.open.swap_remove(place);
            if cell[2] == level && !self.doors.contains_key(&next(cell, side)) {
                return Some((cell, side));
            }
        }
        None
    }

    /// Puts a random tile on a free cell, which is entered by this side.
    fn place(&mut self, settings: &Tiles, cell: Cell, entry: Option<usize>, rng: &mut Rng) {
        let surroundings = self.surroundings(cell);
        let choices: Vec<(f64, Doors, bool)> = choices(settings, entry.is_none())
            .filter(|&(_, doors, _)| entry.is_none_or(|side| doors & bit(side) != 0) && doors & surroundings.walls == 0)
            .map(|(weight, doors, is_room)| (weight * surroundings.liking(doors, entry, settings), doors, is_room))
            .collect();
        // If nothing fits, the passage ends here.
        let only_entry = entry.map_or(bit(0), bit);
        let (doors, is_room) = drawn(&choices, rng).unwrap_or((only_entry, false));
        self.length += 0.5 * f64::from(doors.count_ones());
        self.doors.insert(cell, doors);
        self.places.insert(cell, self.tiles.len());
        self.tiles.push(Tile { cell, doors, is_room });
        self.open.extend((0..4).filter(|&side| doors & bit(side) != 0).map(|side| (cell, side)));
    }

    fn surroundings(&self, cell: Cell) -> Surroundings {
        let mut found = Surroundings { walls: 0, connectors: 0 };
        for side in 0..4 {
            match self.doors.get(&next(cell, side)) {
                Some(doors) if doors & bit(opposite(side)) != 0 => found.connectors |= bit(side),
                Some(_) => found.walls |= bit(side),
                None => {}
            }
        }
        found
    }

    /// Gives a tile of this level one more connector into a free cell.
    fn reopen(&mut self, level: i32, rng: &mut Rng) {
        for place in self.places_in_turn(rng) {
            let tile = &mut self.tiles[place];
            let cell = tile.cell;
            let free = (0..4).find(|&side| cell[2] == level && !self.doors.contains_key(&next(cell, side)));
            if let Some(side) = free {
                if tile.doors & bit(side) == 0 {
                    self.length += 0.5;
                }
                tile.doors |= bit(side);
                self.doors.insert(cell, tile.doors);
                self.open.push((cell, side));
                return;
            }
        }
        // A level that has only links starts beyond one of them.
        let beyond = |link: &Link| (link.last(), link.side);
        self.open.extend(self.links.iter().map(beyond).filter(|(cell, _)| cell[2] == level));
    }

    /// The indices of all tiles in turn, starting at random.
    fn places_in_turn(&self, rng: &mut Rng) -> impl Iterator<Item = usize> + use<> {
        let (len, start) = (self.tiles.len(), rng.index(self.tiles.len()));
        (0..len).map(move |step| (start + step) % len)
    }

    /// Digs a way down to the next level over this many cells in a row; whether there was room.
    pub(super) fn descend(&mut self, tiles: usize, level: i32, rng: &mut Rng) -> bool {
        let tries = TRIES + 4 * self.tiles.len();
        let heads = self.places_in_turn(rng).filter(|&place| self.tiles[place].cell[2] == level).take(tries);
        let ways = heads.flat_map(|place| (0..4).map(move |side| (place, side)));
        let link =
            |(place, side): (usize, usize)| (place, Link { cell: next(self.tiles[place].cell, side), side, tiles });
        let Some((place, link)) = ways.map(link).find(|(_, link)| self.has_room(link)) else { return false };
        let tile = &mut self.tiles[place];
        tile.doors |= bit(link.side);
        self.doors.insert(tile.cell, tile.doors);
        for cell in link.cells() {
            self.doors.insert(cell, 0);
        }
        self.doors.insert(link.cell, bit(opposite(link.side)));
        self.doors.insert(link.last(), bit(link.side));
        self.open.push((link.last(), link.side));
        self.length += tiles as f64;
        self.links.push(link);
        true
    }

    /// Whether all cells of a link and the one beyond it are free.
    fn has_room(&self, link: &Link) -> bool {
        let beyond = next(link.last(), link.side);
        link.cells().chain([beyond]).all(|cell| !self.doors.contains_key(&cell))
    }

    /// Whether a passage leads across this side of a cell into another tile.
    pub(super) fn leads_on(&self, cell: Cell, side: usize) -> bool {
        self.doors.get(&next(cell, side)).is_some_and(|doors| doors & bit(opposite(side)) != 0)
    }
}

impl Link {
    /// The cells it covers, on both levels.
    fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let ([x, y, level], [dx, dy]) = (self.cell, SIDES[self.side]);
        (0..self.tiles as i32).flat_map(move |step| [0, 1].map(|down| [x + step * dx, y + step * dy, level + down]))
    }

    /// Its last cell, on the lower level.
    pub(super) fn last(&self) -> Cell {
        let (step, [dx, dy]) = (self.tiles as i32 - 1, SIDES[self.side]);
        [self.cell[0] + step * dx, self.cell[1] + step * dy, self.cell[2] + 1]
    }
}

/// The surroundings of a free cell: closed sides, and sides with a connector.
struct Surroundings {
    walls: Doors,
    connectors: Doors,
}

impl Surroundings {
    /// How well a tile fits the connectors other than the one it grows from.
    fn liking(&self, doors: Doors, entry: Option<usize>, settings: &Tiles) -> f64 {
        let others = self.connectors & !entry.map_or(0, bit);
        (0..4).filter(|&side| others & bit(side) != 0).fold(1.0, |liking, side| {
            let joins = doors & bit(side) != 0;
            liking * if joins { settings.loop_closure } else { 1.0 - settings.loop_closure }
        })
    }
}

/// All tiles in all orientations: weight, connectors, and whether it is a room. A first tile has several connectors.
fn choices(settings: &Tiles, is_first: bool) -> impl Iterator<Item = (f64, Doors, bool)> {
    let weights = [
        if is_first { 0.0 } else { settings.dead_ends },
        settings.straights,
        settings.bends,
        settings.tees,
        settings.crosses,
    ];
    let rooms = settings.rooms;
    (1..16_u8).flat_map(move |doors| {
        // A tile has as many orientations that fit an entry as it has connectors, rooms have six.
        let kind = match doors.count_ones() {
            1 => 0,
            2 if doors == 0b0101 || doors == 0b1010 => 1,
            2 => 2,
            3 => 3,
            _ => 4,
        };
        let fits = [1.0, 1.0, 2.0, 3.0, 1.0];
        let room = if kind == 0 { 0.0 } else { rooms / 7.0 };
        [(weights[kind] / fits[kind], doors, false), (room, doors, true)]
    })
}

/// A random choice by weight.
fn drawn(choices: &[(f64, Doors, bool)], rng: &mut Rng) -> Option<(Doors, bool)> {
    let sum: f64 = choices.iter().map(|(weight, ..)| weight).sum();
    let mut left = rng.unit() * sum;
    let chosen = choices.iter().find(|(weight, ..)| {
        left -= weight;
        *weight > 0.0 && left <= 0.0
    });
    chosen.map(|&(_, doors, is_room)| (doors, is_room))
}

pub(super) fn bit(side: usize) -> Doors {
    1 << side
}

pub(super) fn opposite(side: usize) -> usize {
    (side + 2) % 4
}

pub(super) fn next(cell: Cell, side: usize) -> Cell {
    [cell[0] + SIDES[side][0], cell[1] + SIDES[side][1], cell[2]]
}
