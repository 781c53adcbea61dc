//! The chamber with things in it: copies of one box, in place or movable.

use std::io;
use std::path::Path;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plume_exporters::scene::{Chunk, Chunks, Content, Instance, Lod, Material, Mesh, Piece, Prototype, Scene, Zone};

use crate::sample::Chamber;

/// Half the edge of the box, metres.
const HALF_M: f32 = 0.1;
/// Sizes of the copies relative to it: two of three are the same.
const SCALES: [f64; 3] = [1.0, 1.5, 1.0];

/// The chamber and, as its last chunk, the things.
pub struct Strewn {
    /// The wall.
    pub chamber: Chamber,
    /// Whether they move when pushed.
    pub movable: bool,
}

impl Strewn {
    /// The chamber with textures in `folder`, and things that move when pushed, or do not.
    pub fn new(folder: &Path, movable: bool) -> io::Result<Self> {
        Ok(Self { chamber: Chamber::new(folder)?, movable })
    }

    /// A scene around them.
    pub fn scene(&self) -> Scene<'_> {
        Scene { chunks: self, ..self.chamber.scene() }
    }

    /// The things.
    pub fn things(&self) -> Vec<Instance> {
        let thing = |(number, scale): (usize, f64)| Instance {
            id: number as u64,
            class: "box".to_owned(),
            prototype: "box_0".to_owned(),
            level: 0,
            chunk: "things_0_0_0".to_owned(),
            pose: Isometry3::from_parts(
                Vector3::new(number as f64, 0.0, -1.0).into(),
                UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
            ),
            scale,
            mass_kg: 2.0,
            embedding_m: 0.0,
            movable: self.movable,
        };
        SCALES.into_iter().enumerate().map(thing).collect()
    }

    fn material(&self) -> io::Result<Material> {
        Ok(Material { name: "prototypes".to_owned(), ..self.chamber.load(0)?.material })
    }
}

impl Chunks for Strewn {
    fn len(&self) -> usize {
        self.chamber.len() + 1
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        if index < self.chamber.len() {
            return self.chamber.load(index);
        }
        let (mut visual, mut collision) = (Mesh::default(), Mesh::default());
        for thing in self.things() {
            append(&mut visual, &solid(), &thing);
            append(&mut collision, &bare(), &thing);
        }
        Ok(Chunk {
            name: "things_0_0_0".to_owned(),
            content: Content::Things { movable: self.movable },
            visual,
            lods: Vec::new(),
            collision,
            material: self.material()?,
        })
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        if index < self.chamber.len() { self.chamber.neighbors(index) } else { Vec::new() }
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        if index < self.chamber.len() {
            return self.chamber.pieces(index);
        }
        let piece = |thing: &Instance| {
            let mut mesh = Mesh::default();
            append(&mut mesh, &bare(), thing);
            Piece { mesh, zone: Zone::Floor }
        };
        Ok(self.things().iter().map(piece).collect())
    }

    fn instances(&self, index: usize) -> io::Result<Vec<Instance>> {
        Ok(if index < self.chamber.len() { Vec::new() } else { self.things() })
    }

    fn prototypes(&self) -> io::Result<Vec<Prototype>> {
        let hull = bare();
        let levels = vec![Lod { mesh: solid(), error_m: 0.0 }, Lod { mesh: coarse(), error_m: HALF_M }];
        let name = "box_0".to_owned();
        Ok(vec![Prototype { name, levels, hull, zone: Zone::Floor, material: self.material()? }])
    }
}

/// The box in its own frame, with normals away from its centre.
fn solid() -> Mesh {
    let positions: Vec<[f32; 3]> =
        (0..8).map(|corner| [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { HALF_M } else { -HALF_M })).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh {
        normals: positions.iter().map(|at| at.map(|c| c / (HALF_M * 3.0_f32.sqrt()))).collect(),
        uvs: positions.iter().map(|[x, y, _]| [0.5 + x, 0.5 + y]).collect(),
        tangents: vec![[1.0, 0.0, 0.0, 1.0]; 8],
        indices: faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect(),
        positions,
    }
}

/// A tetrahedron between every other corner of the box.
fn coarse() -> Mesh {
    let full = solid();
    let indices = [[0, 3, 5], [0, 6, 3], [0, 5, 6], [3, 6, 5]].concat();
    Mesh { indices, ..full }
}

/// Its positions and triangles alone.
fn bare() -> Mesh {
    let Mesh { positions, indices, .. } = solid();
    Mesh { positions, indices, ..Mesh::default() }
}

fn append(mesh: &mut Mesh, shape: &Mesh, thing: &Instance) {
    let first = mesh.positions.len() as u32;
    let place = |at: &[f32; 3]| {
        let at = thing.pose * nalgebra::Point3::from(at.map(|c| f64::from(c) * thing.scale));
        <[f64; 3]>::from(at).map(|c| c as f32)
    };
    mesh.positions.extend(shape.positions.iter().map(place));
    mesh.normals.extend(&shape.normals);
    mesh.uvs.extend(&shape.uvs);
    mesh.tangents.extend(&shape.tangents);
    mesh.indices.extend(shape.indices.iter().map(|corner| corner + first));
}
