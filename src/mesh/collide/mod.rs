//! Convex pieces of the rock behind the wall of a chunk.

mod settings;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

pub use self::settings::PieceSettings;
use super::{Mesh, QUANTA_PER_M};

/// A convex piece of rock.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Corners in units of 1/[`QUANTA_PER_M`] m, cave frame.
    pub positions: Vec<[i32; 3]>,
    /// Its surface; counter-clockwise triangles face outwards.
    pub triangles: Vec<[u32; 3]>,
    /// Which part of the wall it stands for.
    pub zone: Zone,
}

/// A part of the wall, by its slope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Zone {
    /// What wheels stand on.
    Floor,
    /// What they bump into.
    Wall,
    /// What is overhead.
    Ceiling,
}

impl Zone {
    /// Every zone.
    pub const ALL: [Self; 3] = [Self::Floor, Self::Wall, Self::Ceiling];

    fn of(normal: &Vector3<f64>) -> Self {
        match normal.z / normal.norm() {
            up if up > 0.7 => Self::Floor,
            up if up < -0.7 => Self::Ceiling,
            _ => Self::Wall,
        }
    }
}

/// The pieces of a chunk; `around` are the chunks around it.
pub fn pieces(wall: &Mesh, around: &[Mesh], settings: &PieceSettings) -> Vec<Piece> {
    let _ = around;
    let thickness = f64::from(settings.thickness_m) * f64::from(QUANTA_PER_M);
    let wedge = |corners: &[u32; 3]| {
        let front = corners.map(|corner| wall.positions[corner as usize]);
        let [a, b, c] = front.map(|at| Vector3::from(at.map(f64::from)));
        let normal = (b - a).cross(&(c - a));
        let behind =
            [a, b, c].map(|at| <[f64; 3]>::from(at - normal.normalize() * thickness).map(|q| q.round() as i32));
        let sides = [[0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
        Piece {
            positions: [front, behind].concat(),
            triangles: [[0, 1, 2], [5, 4, 3]].into_iter().chain(sides).collect(),
            zone: Zone::of(&normal),
        }
    };
    wall.triangles.iter().map(wedge).collect()
}
