//! The prototypes: the meshes of all shapes, cut apart.

use nalgebra::{Point3, UnitQuaternion, Vector3};

use super::Thing;
use super::kind::{KindRow, Kinds};
use super::rest::stable_turns;
use super::shelf::{Shelf, middle_of, slot_at, slots};
use crate::mesh::{self, Grid, MOST_CORNERS, Mesh, MeshSettings, QUANTA_PER_M};

/// Edge of a voxel of the shelf in metres: a stone is 12 wide.
const VOXEL_M: f32 = 0.025;
/// How far simplification may move the surface of a shape, in metres.
const SIMPLIFY_ERROR_M: f32 = 0.003;

/// A closed convex body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Corners in metres.
    pub corners: Vec<Point3<f64>>,
    /// Triangles, counter-clockwise from outside.
    pub faces: Vec<[u32; 3]>,
}

impl Body {
    /// A convex body with at most [`MOST_CORNERS`] corners, as far within the hull of the points as without; `None` if they are
    /// coplanar.
    ///
    /// Starts with the outermost points in a few directions, takes in the point that is furthest outside until there are enough,
    /// and grows the hull of those.
    fn around(points: &[[i32; 3]]) -> Option<Self> {
        let along = |direction: [i32; 3], point: &[i32; 3]| (0..3).map(|i| direction[i] * point[i]).sum::<i32>();
        let outermost = |direction| points.iter().copied().max_by_key(|point| along(direction, point));
        let mut corners: Vec<[i32; 3]> = STARTS.into_iter().filter_map(outermost).collect();
        corners.sort_unstable();
        corners.dedup();
        loop {
            let hull = mesh::hull(&corners)?;
            corners = hull.corners.iter().map(|corner| corners[*corner as usize]).collect();
            match furthest_outside(points, &corners, &hull.faces) {
                Some((_, next)) if corners.len() < MOST_CORNERS => corners.push(next),
                Some((far, _)) => return Self::grown(&corners, 0.5 * far),
                None => return Some(Self { corners: corners.into_iter().map(metres).collect(), faces: hull.faces }),
            }
        }
    }

    /// The hull of these corners, moved away from their mean by so many quanta.
    fn grown(corners: &[[i32; 3]], by: f64) -> Option<Self> {
        let sum = corners.iter().fold([0; 3], |sum, corner| [0, 1, 2].map(|axis| sum[axis] + i64::from(corner[axis])));
        let mean = Vector3::from(sum.map(|sum| sum as f64 / corners.len() as f64));
        let moved = |corner: &[i32; 3]| {
            let at = Vector3::from(corner.map(f64::from));
            <[i32; 3]>::from((at + (at - mean).normalize() * by).map(|c| c.round() as i32))
        };
        let corners: Vec<[i32; 3]> = corners.iter().map(moved).collect();
        let hull = mesh::hull(&corners)?;
        let corners = hull.corners.iter().map(|corner| metres(corners[*corner as usize])).collect();
        Some(Self { corners, faces: hull.faces })
    }

    /// The corners of each edge.
    pub fn edges(&self) -> impl Iterator<Item = [usize; 2]> {
        let sides = self.faces.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
        // Each edge is a side of two triangles, in opposite directions.
        sides.filter(|[from, to]| from < to).map(|edge| edge.map(|corner| corner as usize))
    }

    /// The middle of each edge.
    pub fn middles_of_edges(&self) -> impl Iterator<Item = Point3<f64>> {
        self.edges().map(|edge| self.middle_of(edge))
    }

    /// The middle of the edge between two corners.
    pub(super) fn middle_of(&self, [a, b]: [usize; 2]) -> Point3<f64> {
        nalgebra::center(&self.corners[a], &self.corners[b])
    }
}

/// Towards the faces and the corners of a cube.
pub(super) const STARTS: [[i32; 3]; 14] = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [1, -1, -1],
    [-1, 1, 1],
    [-1, 1, -1],
    [-1, -1, 1],
    [-1, -1, -1],
];

/// The point that is furthest outside of a convex surface, if one is, and how far.
fn furthest_outside(points: &[[i32; 3]], corners: &[[i32; 3]], faces: &[[u32; 3]]) -> Option<(f64, [i32; 3])> {
    let planes: Vec<(Vector3<f64>, f64)> = faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|corner| Vector3::from(corners[corner as usize].map(f64::from)));
            let normal = (b - a).cross(&(c - a)).normalize();
            (normal, normal.dot(&a))
        })
        .collect();
    let outside = |point: &[i32; 3]| {
        let at = Vector3::from(point.map(f64::from));
        planes.iter().map(|(normal, offset)| normal.dot(&at) - offset).fold(f64::NEG_INFINITY, f64::max)
    };
    // Less than a quantum is rounding.
    let far = points.iter().map(|point| (outside(point), *point)).filter(|(distance, _)| *distance > 1.0);
    far.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn metres(point: [i32; 3]) -> Point3<f64> {
    point.map(|q| f64::from(q) / f64::from(QUANTA_PER_M)).into()
}

/// The mesh of all shapes on a shelf.
fn shelf_mesh(shelf: &Shelf) -> Mesh {
    let settings = MeshSettings {
        voxel_m: VOXEL_M,
        divisions: Some([1, 1, 1]),
        simplify_error_m: SIMPLIFY_ERROR_M,
        ..MeshSettings::default()
    };
    let grid = Grid::new(shelf.bounds(), &settings).expect("a shelf is not empty, and its cells are not few");
    let index = grid.indices().next().expect("there is one chunk");
    let mut mesh = mesh::visual_chunk(shelf, &grid, index, &settings).unwrap_or_default();
    shelf.add_halls(&mut mesh);
    mesh
}

/// Points on the shelf, by slot, in quanta.
fn by_slot(vertices: &[[f32; 3]], slots: usize) -> Vec<Vec<[i32; 3]>> {
    let mut points = vec![Vec::new(); slots];
    for vertex in vertices {
        if let Some(points) = slot_at(*vertex).and_then(|slot| points.get_mut(slot)) {
            points.push(vertex.map(|c| (c * QUANTA_PER_M as f32) as i32));
        }
    }
    points
}

/// A shape of a kind.
#[derive(Clone, Debug)]
pub struct Prototype<'a> {
    /// Safe name, such as `boulder_3`.
    pub name: String,
    /// The kind for which it was made.
    pub row: KindRow<'a>,
    /// Its slot on the shelf.
    pub slot: usize,
    /// The origin on the shelf: the centre of mass of a stone, the point of attachment of dripstone; metres.
    pub origin: Point3<f64>,
    /// A convex hull with at most [`MOST_CORNERS`] corners, relative to the origin.
    pub hull: Body,
    /// Volume of the hull in cubic metres.
    pub volume_m3: f64,
    /// Extent of the hull along x, y and z in metres.
    pub size_m: Vector3<f64>,
    /// How far the hull is from its vertical axis at most, in metres.
    pub reach_m: f64,
    /// How a loose one lies on a level floor, from the side with the lowest centre of mass; empty for all else.
    pub(super) lies: Vec<UnitQuaternion<f64>>,
}

/// The prototypes of a rock.
#[derive(Clone, Debug, Default)]
pub struct Library<'a> {
    /// In the order of the slots of the shelf.
    pub prototypes: Vec<Prototype<'a>>,
}

impl<'a> Library<'a> {
    /// The prototypes on a shelf of these kinds, and the mesh of all of them, which is closed and manifold.
    pub fn of_shelf(kinds: Kinds<'a>, shelf: &Shelf) -> (Self, Mesh) {
        let mesh = shelf_mesh(shelf);
        let vertices = mesh.positions_m();
        let library = Self::new(kinds, &vertices);
        let triangles = library.cut(&vertices, &mesh.triangles).concat();
        (library, mesh.part(&triangles))
    }

    /// The prototypes of these kinds, given the vertices of their meshes on the shelf in metres. Loose shapes that lie on no side
    /// are left out.
    pub fn new(kinds: Kinds<'a>, vertices: &[[f32; 3]]) -> Self {
        let slots: Vec<(usize, KindRow<'a>, u32)> = slots(kinds).collect();
        let points = by_slot(vertices, slots.iter().map(|(slot, ..)| slot + 1).max().unwrap_or_default());
        let made = slots.into_iter();
        let prototypes = made
            .filter_map(|(slot, row, number)| Some(Prototype::new(row, number, slot, Body::around(&points[slot])?)));
        Self { prototypes: prototypes.filter(Prototype::is_of_use).collect() }
    }

    /// The prototype of this name.
    pub fn named(&self, name: &str) -> Option<&Prototype<'a>> {
        self.prototypes.iter().find(|prototype| prototype.name == name)
    }

    /// The prototypes of a kind.
    pub fn of(&self, row: &KindRow) -> &[Prototype<'a>] {
        let start = self.prototypes.iter().position(|prototype| prototype.row.name == row.model());
        let all = &self.prototypes[start.unwrap_or(self.prototypes.len())..];
        &all[..all.iter().take_while(|prototype| prototype.row.name == row.model()).count()]
    }

    /// Whether a thing lies loose and is narrower than a limit in metres.
    pub fn is_movable(&self, thing: &Thing, limit_m: f64) -> bool {
        let prototype = self.prototypes.iter().find(|prototype| prototype.name == thing.prototype);
        prototype.is_some_and(|own| own.row.place.is_loose() && own.width_m() * thing.scale < limit_m)
    }

    /// The triangles of each prototype, of those of a mesh with these vertices; in the order of the prototypes.
    pub fn cut(&self, vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<Vec<[u32; 3]>> {
        let slots = self.prototypes.iter().map(|prototype| prototype.slot + 1).max().unwrap_or_default();
        let mut by_slot: Vec<Vec<[u32; 3]>> = vec![Vec::new(); slots];
        for triangle in triangles {
            if let Some(own) = slot_at(vertices[triangle[0] as usize]).and_then(|slot| by_slot.get_mut(slot)) {
                own.push(*triangle);
            }
        }
        self.prototypes.iter().map(|prototype| std::mem::take(&mut by_slot[prototype.slot])).collect()
    }
}

impl<'a> Prototype<'a> {
    fn new(row: KindRow<'a>, number: u32, slot: usize, on_shelf: Body) -> Self {
        let (volume_m3, centre) = centre_of_mass(&on_shelf.corners, &on_shelf.faces);
        let origin = if row.place.is_loose() { centre } else { middle_of(slot).map(f64::from).into() };
        let corners: Vec<Point3<f64>> = on_shelf.corners.iter().map(|corner| (corner - origin).into()).collect();
        let extent = |axis: usize| {
            let along = corners.iter().map(|corner| corner[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let size_m = Vector3::new(extent(0), extent(1), extent(2));
        let reach_m = corners.iter().map(|corner| corner.coords.xy().norm()).fold(0.0, f64::max);
        let hull = Body { corners, faces: on_shelf.faces };
        let lies = if row.place.is_loose() { stable_turns(&hull) } else { Vec::new() };
        Self { name: format!("{}_{number}", row.name), row, slot, origin, hull, volume_m3, size_m, reach_m, lies }
    }

    /// Whether it lies or is fixed somewhere.
    fn is_of_use(&self) -> bool {
        !self.lies.is_empty() || !self.row.place.is_loose()
    }

    /// Mean of its width and depth in metres.
    pub fn width_m(&self) -> f64 {
        0.5 * (self.size_m.x + self.size_m.y)
    }
}

/// Volume and centre of mass of a closed surface.
fn centre_of_mass(corners: &[Point3<f64>], faces: &[[u32; 3]]) -> (f64, Point3<f64>) {
    let first = corners[0];
    let (mut volume, mut moment) = (0.0, Vector3::zeros());
    for face in faces {
        let [a, b, c] = face.map(|corner| corners[corner as usize] - first);
        let tetrahedron = a.dot(&b.cross(&c)) / 6.0;
        volume += tetrahedron;
        moment += (a + b + c) * (tetrahedron / 4.0);
    }
    (volume, first + moment / volume)
}
