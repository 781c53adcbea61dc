//! A convex piece: the hull of corners of the wall and of a few points in the rock behind them.

use nalgebra::Vector3;

use super::super::QUANTA_PER_M;
use super::super::nearest::{Point, Triangle};
use super::hull::{Hull, hull};
use super::rock_mass::RockMass;
use super::{MOST_CORNERS, Piece, Zone};

/// Maximum extent of a piece along any axis, in metres, unless a triangle of the wall is larger.
const LONGEST_M: i32 = 8;

/// Ways to close a piece behind the wall: share of the thickness, and remaining share of the width. Tuned.
const BACKS: [[f64; 2]; 6] = [[1.0, 1.0], [1.0, 0.5], [0.5, 0.5], [0.25, 0.5], [0.1, 0.5], [0.02, 0.3]];

/// A part of the wall.
#[derive(Clone)]
pub(super) struct Front {
    /// Its corners in the rock behind the wall, in quanta. Those that no hull needs may be omitted.
    pub(super) corners: Vec<[i32; 3]>,
    /// Sum of the normals of its triangles into the air, weighted by twice the area.
    pub(super) leaning: Point,
    /// Twice the area of each zone.
    pub(super) areas: [f64; 3],
}

impl Front {
    /// The union of two parts, if a piece may have that extent.
    fn of_both(a: &Self, b: &Self) -> Option<Self> {
        let mut corners = [&a.corners[..], &b.corners[..]].concat();
        corners.sort_unstable();
        corners.dedup();
        let is_long = |axis: usize| {
            let (low, high) = corners.iter().fold((i32::MAX, i32::MIN), |(l, h), p| (l.min(p[axis]), h.max(p[axis])));
            high - low > LONGEST_M * QUANTA_PER_M
        };
        if (0..3).any(is_long) {
            return None;
        }
        let areas = std::array::from_fn(|zone| a.areas[zone] + b.areas[zone]);
        Some(Self { corners, leaning: a.leaning + b.leaning, areas })
    }

    /// Its corners, and those of its outline displaced into the rock.
    fn closed(&self, thickness: f64, [depth, width]: [f64; 2]) -> Option<Vec<[i32; 3]>> {
        let into = -self.leaning.try_normalize(0.0)?;
        let places: Vec<Point> = self.corners.iter().map(|&corner| Vector3::from(corner.map(f64::from))).collect();
        let centre = places.iter().sum::<Point>() / places.len() as f64;
        let farthest = |direction: Point| {
            let along = |place: &Point| direction.dot(&(place - centre));
            places.iter().fold(places[0], |best, place| if along(place) > along(&best) { *place } else { best })
        };
        let behind = |direction| {
            let place = centre + (farthest(direction) - centre) * width + into * (thickness * depth);
            place.map(|q| q.round() as i32).into()
        };
        Some(self.corners.iter().copied().chain(across(into).map(behind)).collect())
    }

    /// Drops the corners inside its own hull. Those hidden only by the points behind it may reappear after a merge.
    fn pruned(self) -> Self {
        let Some(hull) = hull(&self.corners) else { return self };
        let corners = hull.corners.iter().map(|&corner| self.corners[corner as usize]).collect();
        Self { corners, ..self }
    }

    fn zone(&self) -> Zone {
        let larger = |best, zone| if self.areas[zone as usize] > self.areas[best as usize] { zone } else { best };
        Zone::ALL.into_iter().fold(Zone::Floor, larger)
    }
}

/// Six directions perpendicular to another.
fn across(into: Point) -> [Point; 6] {
    let one = into.cross(&Vector3::ith(into.iamin(), 1.0)).normalize();
    let other = into.cross(&one) * 0.75f64.sqrt();
    let half = one * 0.5;
    [one, -one, other + half, other - half, half - other, -other - half]
}

/// A piece under construction.
#[derive(Clone)]
pub(super) struct Body {
    front: Front,
    /// Index into [`BACKS`].
    back: usize,
    /// Its corners, those at the wall first, in quanta.
    positions: Vec<[i32; 3]>,
    /// Number of them at the wall.
    fronts: usize,
    faces: Vec<[u32; 3]>,
}

impl Body {
    /// The body behind one triangle of the wall.
    pub(super) fn behind(front: Front, rock: &RockMass) -> Self {
        let way = |back| Self::closed(front.clone(), back, rock);
        let fits = |body: &Self| body.front_share(&[], rock).is_some() && body.is_backed(rock);
        let thinnest = || way(BACKS.len() - 1).expect("a triangle has an area, and a back of its own");
        (0..BACKS.len()).filter_map(way).find(fits).unwrap_or_else(thinnest)
    }

    /// The body around two, and the share of the tolerance that it uses, if samples of the faces at the wall stay within. The
    /// part behind the wall seldom fails, and may then be closed in another way.
    pub(super) fn around(a: &Self, b: &Self, rock: &RockMass) -> Option<(Self, f64)> {
        let front = Front::of_both(&a.front, &b.front)?;
        let known = [a.front_edges(), b.front_edges()].concat();
        let body = Self::closed(front, a.back.max(b.back), rock).filter(|body| body.positions.len() <= MOST_CORNERS)?;
        let share = body.front_share(&known, rock)?;
        Some((body, share))
    }

    fn closed(front: Front, back: usize, rock: &RockMass) -> Option<Self> {
        let points = front.closed(rock.thickness, BACKS[back])?;
        let Hull { corners, faces } = hull(&points)?;
        let fronts = corners.partition_point(|&corner| (corner as usize) < front.corners.len());
        let positions = corners.iter().map(|&corner| points[corner as usize]).collect();
        Some(Self { front, back, positions, fronts, faces })
    }

    /// The body, possibly with another back, if every point of its surface stays within the tolerance.
    pub(super) fn held(&self, rock: &RockMass) -> Option<Self> {
        let holds = |body: &Self, face: &[u32; 3]| rock.holds(body.place(face, rock));
        if !self.faces.iter().filter(|face| self.is_front(face)).all(|face| holds(self, face)) {
            return None;
        }
        if self.faces.iter().filter(|face| !self.is_front(face)).all(|face| holds(self, face)) {
            return Some(self.clone());
        }
        let others = (self.back + 1..BACKS.len()).filter_map(|back| Self::closed(self.front.clone(), back, rock));
        let mut others = others.filter(|body| body.positions.len() <= MOST_CORNERS);
        others.find(|body| body.faces.iter().all(|face| holds(body, face)))
    }

    /// The share of the tolerance used by samples of the faces at the wall; `None` if one exceeds it. `known` edges, and faces
    /// between them, need no samples.
    fn front_share(&self, known: &[Edge], rock: &RockMass) -> Option<f64> {
        let mut most = f64::NEG_INFINITY;
        for face in self.faces.iter().filter(|face| self.is_front(face)) {
            let mut is_new = false;
            for edge in self.edges(face).filter(|edge| !known.contains(edge)) {
                let [a, b] = edge.map(|corner| rock.at(corner));
                most = most.max(rock.share((a + b) * 0.5)?);
                is_new = true;
            }
            if is_new {
                most = most.max(rock.share(self.place(face, rock).iter().sum::<Point>() / 3.0)?);
            }
        }
        Some(most)
    }

    /// Whether the corners behind the wall stay within.
    fn is_backed(&self, rock: &RockMass) -> bool {
        self.positions[self.fronts..].iter().all(|&corner| rock.share(rock.at(corner)).is_some())
    }

    /// The edges of the faces at the wall.
    fn front_edges(&self) -> Vec<Edge> {
        self.faces.iter().filter(|face| self.is_front(face)).flat_map(|face| self.edges(face)).collect()
    }

    fn edges(&self, face: &[u32; 3]) -> impl Iterator<Item = Edge> {
        let [a, b, c] = face.map(|corner| self.positions[corner as usize]);
        [[a, b], [b, c], [c, a]].into_iter().map(|[a, b]| [a.min(b), a.max(b)])
    }

    fn is_front(&self, face: &[u32; 3]) -> bool {
        face.iter().all(|&corner| (corner as usize) < self.fronts)
    }

    fn place(&self, face: &[u32; 3], rock: &RockMass) -> Triangle {
        face.map(|corner| rock.at(self.positions[corner as usize]))
    }

    /// The body, ready to be merged again.
    pub(super) fn pruned(self) -> Self {
        Self { front: self.front.pruned(), ..self }
    }

    /// The finished piece.
    pub(super) fn piece(&self) -> Piece {
        Piece { positions: self.positions.clone(), triangles: self.faces.clone(), zone: self.front.zone() }
    }
}

/// Two corners, the lower first.
type Edge = [[i32; 3]; 2];
