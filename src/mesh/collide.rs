//! Convex pieces of the rock behind the wall of a chunk, for engines that collide convex shapes only.
//!
//! Each triangle of the wall starts a piece: its corners, half a tolerance behind it, and a few points deeper in the rock.
//! Neighbours then merge greedily while the hull of both stays in the rock within the tolerance, as in hierarchical
//! approximate convex decomposition (Mamou and Ghorbel, *A simple and efficient approach for 3D mesh approximate convex
//! decomposition*, 2009), but measured against the open air instead of the mesh.
//!
//! Promised: every point of the surface of a piece is in the rock, or no further from some triangle of the wall that cameras
//! see than the tolerance of the zone of that triangle (bounded part by part, not sampled): at the foot of a wall, the floor may
//! be off by the tolerance of the wall. The wall moved back by half a tolerance at most is covered without a gap, across the
//! borders of chunks too, so no ray leaves the cave. A piece is closed and convex in exact arithmetic, not flat, and has at most
//! [`MOST_CORNERS`] corners. It follows from the wall of its chunk and those around it. Not promised: that a piece holds no
//! bubble of air inside, that the tolerance is kept where rock is thinner than a fiftieth of [`PieceSettings::thickness_m`], or
//! that pieces do not overlap.

mod body;
mod cells;
mod hull;
mod merge;
mod report;
mod rock_mass;
mod settings;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub(crate) use self::hull::hull;
pub use self::report::{PieceMeasures, PieceReport, measure_pieces};
use self::rock_mass::RockMass;
pub use self::settings::PieceSettings;
use super::Mesh;

/// A convex piece of rock.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Corners in units of 1/[`QUANTA_PER_M`](super::QUANTA_PER_M) m, cave frame.
    pub positions: Vec<[i32; 3]>,
    /// Its surface; counter-clockwise triangles face outwards.
    pub triangles: Vec<[u32; 3]>,
    /// The zone of the wall that it covers.
    pub zone: Zone,
}

/// A zone of the wall, by slope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Zone {
    /// What robots drive on.
    Floor,
    /// What they bump into.
    Wall,
    /// What is overhead.
    Ceiling,
}

impl Zone {
    /// All zones.
    pub const ALL: [Self; 3] = [Self::Floor, Self::Wall, Self::Ceiling];

    /// Floors are no steeper than 45°: the cosine of that, with the vertical. Ceilings mirror them.
    pub const STEEPEST_FLOOR: f64 = std::f64::consts::FRAC_1_SQRT_2;

    fn of(normal: &Vector3<f64>) -> Self {
        match normal.z / normal.norm() {
            up if up > Self::STEEPEST_FLOOR => Self::Floor,
            up if up < -Self::STEEPEST_FLOOR => Self::Ceiling,
            _ => Self::Wall,
        }
    }
}

/// Maximum number of corners of a piece, which hence has at most 60 triangles: PhysX on a GPU allows 64 of either.
pub const MOST_CORNERS: usize = 32;

/// The pieces of a chunk; `around` are its neighbours within the thickness of pieces.
pub fn pieces(wall: &Mesh, around: &[Mesh], settings: &PieceSettings) -> Vec<Piece> {
    if wall.triangles.is_empty() {
        return Vec::new();
    }
    merge::merged(wall, &RockMass::new(wall, around, settings))
}
