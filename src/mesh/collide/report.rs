//! Statistics of convex pieces, by sampling: number, thickness, and how far they reach into the air.

use nalgebra::Vector3;
use serde::Serialize;

use super::super::nearest::{Point, Triangle};
use super::super::{Mesh, QUANTA_PER_M};
use super::rock_mass::RockMass;
use super::{Piece, PieceSettings, Zone};
use crate::field::Field;

/// Sample spacing relative to the tolerance.
const SPACING: f64 = 0.5;
/// Deeper in the rock than this, in metres, no point is in the air of the field, because mesh and field are closer.
const DEEP_M: f64 = 0.2;

/// Reach and shape of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceMeasures {
    /// The zone of the wall that it covers.
    pub zone: Zone,
    /// Number of its corners.
    pub corners: usize,
    /// Width: the smallest distance of two parallel planes that enclose it, one of them along a face, in metres.
    pub width_m: f64,
    /// How far beyond the wall it reaches into the air, in metres; 0 if it does not.
    pub intrusion_m: f64,
    /// The same over floors, except within the tolerance of steeper zones.
    pub floor_intrusion_m: f64,
    /// How far beyond the zero of the field it reaches, in metres.
    pub field_intrusion_m: f64,
    /// The same over floors.
    pub field_floor_intrusion_m: f64,
}

/// Measures the pieces of a chunk; `around` are the chunks around it.
pub fn measure_pieces(
    pieces: &[Piece],
    wall: &Mesh,
    around: &[Mesh],
    field: &dyn Field,
    settings: &PieceSettings,
) -> Vec<PieceMeasures> {
    if pieces.is_empty() {
        return Vec::new();
    }
    let rock = RockMass::new(wall, around, settings);
    pieces.iter().map(|piece| measured(piece, &rock, field, settings)).collect()
}

fn measured(piece: &Piece, rock: &RockMass, field: &dyn Field, settings: &PieceSettings) -> PieceMeasures {
    let quanta = f64::from(QUANTA_PER_M);
    let spacing = SPACING * f64::from(settings.tolerance_m(piece.zone)) * quanta;
    let (mut intrusion_m, mut floor_intrusion_m) = (0.0, 0.0);
    let (mut near_wall, mut over_floor) = (Vec::new(), Vec::new());
    let shift = rock.at([0; 3]);
    for face in faces(piece) {
        for point in spread(face, spacing) {
            let (distance, zone) = rock.distance(point + shift);
            let distance_m = distance / quanta;
            if distance_m < -DEEP_M {
                continue;
            }
            intrusion_m = f64::max(intrusion_m, distance_m);
            near_wall.push((point / quanta).map(|c| c as f32).into());
            if zone == Zone::Floor && !rock.is_by_steeper(point + shift) {
                floor_intrusion_m = f64::max(floor_intrusion_m, distance_m);
                over_floor.push((point / quanta).map(|c| c as f32).into());
            }
        }
    }
    PieceMeasures {
        zone: piece.zone,
        corners: piece.positions.len(),
        width_m: width(piece) / quanta,
        intrusion_m,
        floor_intrusion_m,
        field_intrusion_m: deepest(&near_wall, field),
        field_floor_intrusion_m: deepest(&over_floor, field),
    }
}

/// The largest depth of some points in the air of a field.
fn deepest(points: &[[f32; 3]], field: &dyn Field) -> f64 {
    field.distances_at(points).into_iter().fold(0.0, |most, distance| f64::max(most, -f64::from(distance)))
}

fn faces(piece: &Piece) -> impl Iterator<Item = Triangle> {
    let corner = |corner: u32| Vector3::from(piece.positions[corner as usize].map(f64::from));
    piece.triangles.iter().map(move |face| face.map(corner))
}

/// Points of a triangle, at most `spacing` apart along its sides, including its corners.
fn spread([a, b, c]: Triangle, spacing: f64) -> impl Iterator<Item = Point> {
    let longest = [b - a, c - b, a - c].map(|side| side.norm()).into_iter().fold(0.0, f64::max);
    let steps = (longest / spacing).ceil().max(1.0) as u32;
    let (along, across) = ((b - a) / f64::from(steps), (c - a) / f64::from(steps));
    let row = move |i: u32| (0..=steps - i).map(move |j| a + along * f64::from(i) + across * f64::from(j));
    (0..=steps).flat_map(row)
}

fn width(piece: &Piece) -> f64 {
    let across = |[a, b, c]: Triangle| {
        let normal = (b - a).cross(&(c - a)).normalize();
        let depth = |corner: &[i32; 3]| normal.dot(&(a - Vector3::from(corner.map(f64::from))));
        piece.positions.iter().map(depth).fold(0.0, f64::max)
    };
    faces(piece).map(across).fold(f64::INFINITY, f64::min)
}

/// Statistics of the pieces of a cave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PieceReport {
    /// Number of pieces.
    pub pieces: usize,
    /// Number of floor pieces.
    pub floor_pieces: usize,
    /// Number of ceiling pieces.
    pub ceiling_pieces: usize,
    /// Maximum number of corners of a piece.
    pub piece_most_corners: usize,
    /// Minimum width of a piece, in metres.
    pub piece_least_width_m: f64,
    /// Maximum reach beyond the wall into the air, in metres.
    pub intrusion_max_m: f64,
    /// The 99th percentile.
    pub intrusion_p99_m: f64,
    /// The median.
    pub intrusion_median_m: f64,
    /// The maximum over a floor, except within the tolerance of steeper zones.
    pub floor_intrusion_max_m: f64,
    /// Maximum reach beyond the zero of the field, in metres.
    pub field_intrusion_max_m: f64,
    /// The 99th percentile.
    pub field_intrusion_p99_m: f64,
    /// The median.
    pub field_intrusion_median_m: f64,
    /// The maximum over a floor.
    pub field_floor_intrusion_max_m: f64,
}

impl PieceReport {
    /// Summarises the measures of all pieces.
    pub fn of(measures: &[PieceMeasures]) -> Self {
        let of_zone = |zone| measures.iter().filter(move |piece| piece.zone == zone);
        let [mesh, field] =
            [|piece: &PieceMeasures| piece.intrusion_m, |piece: &PieceMeasures| piece.field_intrusion_m];
        Self {
            pieces: measures.len(),
            floor_pieces: of_zone(Zone::Floor).count(),
            ceiling_pieces: of_zone(Zone::Ceiling).count(),
            piece_most_corners: measures.iter().map(|piece| piece.corners).max().unwrap_or(0),
            piece_least_width_m: measures.iter().map(|piece| piece.width_m).min_by(f64::total_cmp).unwrap_or(0.0),
            intrusion_max_m: quantile(measures.iter().map(mesh), 1.0),
            intrusion_p99_m: quantile(measures.iter().map(mesh), 0.99),
            intrusion_median_m: quantile(measures.iter().map(mesh), 0.5),
            floor_intrusion_max_m: quantile(measures.iter().map(|piece| piece.floor_intrusion_m), 1.0),
            field_intrusion_max_m: quantile(measures.iter().map(field), 1.0),
            field_intrusion_p99_m: quantile(measures.iter().map(field), 0.99),
            field_intrusion_median_m: quantile(measures.iter().map(field), 0.5),
            field_floor_intrusion_max_m: quantile(measures.iter().map(|piece| piece.field_floor_intrusion_m), 1.0),
        }
    }
}

/// A quantile.
fn quantile(numbers: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().saturating_sub(1);
    numbers.get((last as f64 * share) as usize).copied().unwrap_or(0.0)
}
