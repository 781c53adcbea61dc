//! Omits what the paper cannot show.

use rustc_hash::FxHashMap;

use super::frame::Frame;
use super::sheet::{Panel, Sheet, SheetStation};
use plume_graph::StationId;

/// Maximum number of drawn pieces. Tuned: about a second for an SVG viewer.
const MOST_PIECES: usize = 16_000;
/// Stations closer than this are merged, in pixels of a paper of 1280.
const LEAST_PX: f64 = 1.0;

/// The passages of a panel as pairs of stations, or one station twice if it has no visible passage. Of stations in one pixel
/// the nearest to the viewer represents all; the pixel grows until few enough are left.
pub fn pieces(sheet: &Sheet, panel: &Panel, frame: &Frame) -> Vec<[StationId; 2]> {
    let mut cell_m = LEAST_PX * frame.line_px / frame.px_per_m;
    loop {
        let pieces = merged(sheet, panel, cell_m);
        if pieces.len() <= MOST_PIECES {
            return pieces;
        }
        cell_m *= 1.5;
    }
}

fn merged(sheet: &Sheet, panel: &Panel, cell_m: f64) -> Vec<[StationId; 2]> {
    let cell = |station: &SheetStation| station.at.map(|metres| (metres / cell_m).floor() as i64);
    let is_here = |station: &SheetStation| panel.level.is_none_or(|level| station.level == level);
    let mut first: FxHashMap<[i64; 2], StationId> = FxHashMap::default();
    let mut enter = |station: StationId| {
        let slot = first.entry(cell(&sheet[station])).or_insert(station);
        if sheet[station].depth > sheet[*slot].depth {
            *slot = station;
        }
    };
    panel.edges.iter().flatten().for_each(|&end| enter(end));
    let alone: Vec<StationId> =
        StationId::all(sheet.stations.len()).filter(|&station| is_here(&sheet[station])).collect();
    alone.iter().for_each(|&station| enter(station));
    let of = |station: StationId| first[&cell(&sheet[station])];
    let mut pieces: Vec<[StationId; 2]> = panel.edges.iter().map(|&ends| ends.map(of)).collect();
    pieces.extend(alone.into_iter().map(|station| [of(station); 2]));
    pieces.iter_mut().for_each(|piece| piece.sort_unstable());
    pieces.sort_unstable();
    pieces.dedup();
    without_covered(pieces, sheet.stations.len())
}

/// A station at the end of a passage need not be drawn again.
fn without_covered(mut pieces: Vec<[StationId; 2]>, stations: usize) -> Vec<[StationId; 2]> {
    let mut covered = vec![false; stations];
    pieces.iter().filter(|[a, b]| a != b).flatten().for_each(|end| covered[end.index()] = true);
    pieces.retain(|&[a, b]| a != b || !covered[a.index()]);
    pieces
}
