//! Turns a thinned plan into centrelines: smooth, without the spurs and steps of cells, each vertex with its width.

use nalgebra::Point3;

use super::{Mask, distance, thin};
use plume_graph::centreline::{CentrelineBuilder, Vertex, VertexId};
use plume_graph::{Section, Shape};

/// Smoothing passes: a step of one cell becomes a bend of about five (tuned: fewer leave stairs, more cut corners).
const SMOOTHING: usize = 12;
/// Of this many vertices of a smooth line, one is kept.
const EVERY: usize = 3;
/// Junctions nearer to each other than this fraction of their width are merged (tuned).
const ONE_JUNCTION: f64 = 0.6;

/// The centrelines of a plan in metres, its middle at the origin, its first row in the north. Widths are from wall to wall;
/// heights are left at 0.
pub(crate) fn traced(mask: &Mask, cell_m: f64) -> CentrelineBuilder {
    rough(mask, cell_m).without_spurs().with_junctions_merged(ONE_JUNCTION).smoothed(SMOOTHING).with_every(EVERY)
}

/// A vertex in each remaining cell, joined to its neighbours.
fn rough(mask: &Mask, cell_m: f64) -> CentrelineBuilder {
    let squares = distance::squares(mask);
    let thin = thin::thinned(mask, &squares);
    let mut centreline = CentrelineBuilder::default();
    let mut vertices = vec![VertexId::default(); thin.open.len()];
    for cell in (0..thin.open.len()).filter(|&cell| thin.open[cell]) {
        vertices[cell] = centreline.add(vertex(mask, &squares, cell, cell_m));
        for to in earlier_neighbours(&thin, cell) {
            centreline.join(vertices[to], vertices[cell]);
        }
    }
    centreline
}

fn vertex(mask: &Mask, squares: &[u32], cell: usize, cell_m: f64) -> Vertex {
    let [column, row] = mask.place(cell).map(|at| at as f64 + 0.5);
    let x = (column - 0.5 * mask.columns as f64) * cell_m;
    let y = (0.5 * mask.rows() as f64 - row) * cell_m;
    // From the centre of a rock cell to its side is half a cell.
    let half_width_m = (f64::from(squares[cell]).sqrt() - 0.5) * cell_m;
    let section = Section { width_m: 2.0 * half_width_m, height_m: 0.0, shape: Shape::Cave };
    Vertex { position: Point3::new(x, y, 0.0), section: Some(section), level: 0 }
}

/// The open neighbours of a cell that precede it; diagonal ones only if no cell at a side joins the two.
fn earlier_neighbours(thin: &Mask, cell: usize) -> impl Iterator<Item = usize> {
    let open = |to: usize| thin.open[to];
    let c = thin.columns;
    let (west, north, east) = (cell - 1, cell - c, cell + 1);
    let corner = |to: usize, side: usize| open(to) && !open(side) && !open(north);
    let joined = [
        (west, open(west)),
        (north, open(north)),
        (north - 1, corner(north - 1, west)),
        (north + 1, corner(north + 1, east)),
    ];
    joined.into_iter().filter(|(_, joined)| *joined).map(|(to, _)| to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passage_is_traced_along_its_middle_with_its_width() {
        let closed = "#".repeat(41);
        let open = format!("#{}#", ".".repeat(39));
        let mask = Mask::drawn(&[&closed, &open, &open, &open, &closed, &closed, &closed]);
        let centreline = traced(&mask, 2.0);
        let inner: Vec<&Vertex> = centreline.vertices.iter().filter(|vertex| vertex.position.x.abs() < 12.0).collect();
        assert!(inner.len() >= 3 && centreline.lines.len() == centreline.vertices.len() - 1, "{centreline:?}");
        // The middle of the passage is the third row of seven.
        for vertex in inner {
            let width_m = vertex.section.map_or(0.0, |section| section.width_m);
            assert!((vertex.position.y - 2.0).abs() < 0.01 && (width_m - 6.0).abs() < 0.01, "{vertex:?}");
        }
    }

    #[test]
    fn passages_that_cross_meet_in_one_junction() {
        let wall = "#".repeat(23);
        let across = format!("#{}#", ".".repeat(21));
        let along = format!("#{0}...{0}#", "#".repeat(9));
        let mut rows: Vec<&str> = vec![&along; 21];
        rows[9..12].fill(&across);
        let rows: Vec<&str> = [&wall[..]].into_iter().chain(rows).chain([&wall[..]]).collect();
        let centreline = traced(&Mask::drawn(&rows), 1.0);
        let mut degrees: Vec<usize> = centreline.neighbors().degrees().filter(|&degree| degree != 2).collect();
        degrees.sort_unstable();
        assert_eq!(degrees, [1, 1, 1, 1, 4]);
    }
}
