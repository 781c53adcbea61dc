//! A scene that changes under every mirroring and rotation: arms of three lengths and shapes along +x, +y and +z in one
//! chunk, a wedge in another, each face with its own part of an image of letters F. The expected result does not depend on
//! any exporter.

use std::io;
use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Vector3};
use plume_exporters::ImageFormat;
use plume_exporters::scene::{ByZone, Chunk, Chunks, Content, Image, Material, Mesh, Network, Piece, Scene, Zone};
use serde_json::{Value, json};

use crate::sample::write_png;

/// Injected faults that an exporter could have, applied to the meshes before export.
pub const FAULTS: [(&str, Change); 6] = [
    ("mirrored", mirror),
    ("turned", |mesh| move_all(mesh, |[x, y, z]| [-y, x, z])),
    ("upside_down_images", |mesh| mesh.uvs.iter_mut().for_each(|[_, v]| *v = 1.0 - *v)),
    ("reversed_winding", reverse),
    ("negated_normals", |mesh| mesh.normals.as_flattened_mut().iter_mut().for_each(|part| *part = -*part)),
    ("other_handedness", |mesh| mesh.tangents.iter_mut().for_each(|[.., w]| *w = -*w)),
];

/// A modification of a mesh.
pub type Change = fn(&mut Mesh);

/// Its two chunks.
pub struct Marker {
    textures: PathBuf,
    change: Change,
}

/// A solid between two rectangles perpendicular to `axis`.
struct Block {
    axis: usize,
    /// Positions of the rectangles along the axis, metres.
    ends: [f32; 2],
    /// For each rectangle its ranges along the next axis and the one after that, metres.
    rectangles: [[[f32; 2]; 2]; 2],
}

const CHUNKS: [&[Block]; 2] = [
    &[
        Block { axis: 0, ends: [0.25, 3.0], rectangles: [[[0.0, 0.5], [0.0, 0.25]]; 2] },
        Block { axis: 1, ends: [0.5, 2.5], rectangles: [[[0.0, 0.375], [-0.25, 0.25]], [[0.0, 0.25], [0.0, 0.125]]] },
        Block { axis: 2, ends: [0.5, 1.75], rectangles: [[[0.0, 0.5], [0.0, 0.25]], [[0.375, 0.5], [0.125, 0.25]]] },
    ],
    &[Block {
        axis: 0,
        ends: [-2.0, -1.25],
        rectangles: [[[-1.5, -0.5], [-0.75, -0.5]], [[-1.5, -1.25], [-0.75, 0.0]]],
    }],
];

/// Faces of a block by the ends of its ranges, counter-clockwise from outside; the first edge is at the bottom of its
/// letter.
const FACES: [[[usize; 3]; 4]; 6] = [
    [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
    [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
    [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
];

/// Letters per row and column of the image, with a column per face and a row per block; pixels per letter.
const CELLS: [u32; 2] = [6, 4];
const CELL_PX: u32 = 16;

impl Marker {
    /// Writes the textures into `folder`; `change` is applied to every mesh.
    pub fn new(folder: &Path, change: Change) -> io::Result<Self> {
        let size = CELLS.map(|cells| cells * CELL_PX);
        for (role, pixel) in [
            ("base_color", letters as fn(u32, u32) -> [u8; 3]),
            ("normal", |_, _| [128, 128, 255]),
            ("orm", |_, _| [255, 200, 0]),
            ("roughness", |_, _| [200; 3]),
        ] {
            write_png(&folder.join(format!("{role}.png")), size, pixel)?;
        }
        Ok(Self { textures: folder.to_owned(), change })
    }

    /// A scene around the chunks.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            name: "marker".to_owned(),
            description: "Arms that tell where x, y and z are".to_owned(),
            generator: "plume test".to_owned(),
            recipe: String::new(),
            fingerprint: String::new(),
            seed: 0,
            chunks: self,
            spawns: vec![Isometry3::translation(-1.0, 1.0, 0.0)],
            lights: Vec::new(),
            network: Network::default(),
            georeference: None,
            sought: Vec::new(),
            friction: ByZone { floor: 0.8, wall: 0.6, ceiling: 0.6 },
            gravity: 9.80665,
            collision_error_m: 0.0,
            piece_tolerance_m: ByZone { floor: 0.0, wall: 0.0, ceiling: 0.0 },
        }
    }

    fn image(&self, role: &str) -> Image {
        Image { path: self.textures.join(format!("{role}.png")), format: ImageFormat::Png }
    }

    fn changed(&self, mut mesh: Mesh) -> Mesh {
        (self.change)(&mut mesh);
        mesh
    }
}

/// Every triangle of the marker as expected: per corner position, normal, texture coordinate from the lower left, and
/// tangent with handedness.
pub fn truth() -> Value {
    let triangles: Vec<Value> = CHUNKS
        .iter()
        .enumerate()
        .flat_map(|(index, blocks)| {
            let mesh = visual(blocks, index == 1);
            let of = |corners: &[u32]| {
                let each = |corner: &u32| {
                    let vertex = *corner as usize;
                    let (position, normal) = (mesh.positions[vertex], mesh.normals[vertex]);
                    json!({ "position": position, "normal": normal, "uv": mesh.uvs[vertex], "tangent": mesh.tangents[vertex] })
                };
                corners.iter().map(each).collect()
            };
            mesh.indices.chunks_exact(3).map(of).collect::<Vec<Value>>()
        })
        .collect();
    json!({ "triangles": triangles })
}

impl Chunks for Marker {
    fn len(&self) -> usize {
        CHUNKS.len()
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        Ok(Chunk {
            name: format!("marker_{index}"),
            content: Content::Wall,
            visual: self.changed(visual(CHUNKS[index], index == 1)),
            lods: Vec::new(),
            collision: self.changed(solids(CHUNKS[index])),
            material: Material {
                name: format!("marker_{index}"),
                base_color: self.image("base_color"),
                normal: self.image("normal"),
                orm: self.image("orm"),
                roughness: self.image("roughness"),
                height: None,
            },
        })
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        vec![1 - index]
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        let piece = |block| Piece { mesh: self.changed(solids(std::slice::from_ref(block))), zone: Zone::Floor };
        Ok(CHUNKS[index].iter().map(piece).collect())
    }
}

impl Block {
    fn corner(&self, [end, i, j]: [usize; 3]) -> [f32; 3] {
        let [first, second] = self.rectangles[end];
        let mut corner = [0.0; 3];
        for (step, metres) in [self.ends[end], first[i], second[j]].into_iter().enumerate() {
            corner[(self.axis + step) % 3] = metres;
        }
        corner
    }
}

/// Four vertices per face. Mirrored letters have the opposite handedness.
fn visual(blocks: &[Block], mirrored: bool) -> Mesh {
    let mut mesh = Mesh::default();
    for (row, block) in blocks.iter().enumerate() {
        for (column, face) in FACES.iter().enumerate() {
            add_face(&mut mesh, face.map(|corner| block.corner(corner)), [column, row], mirrored);
        }
    }
    mesh
}

fn add_face(mesh: &mut Mesh, corners: [[f32; 3]; 4], cell: [usize; 2], mirrored: bool) {
    let first = mesh.positions.len() as u32;
    let [a, b, c, _] = corners.map(Vector3::from);
    let normal = (b - a).cross(&(c - a)).normalize();
    let along = (b - a).normalize() * if mirrored { -1.0 } else { 1.0 };
    for (corner, mut place) in corners.into_iter().zip([[0.1_f32, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]]) {
        if mirrored {
            place[0] = 1.0 - place[0];
        }
        mesh.positions.push(corner);
        mesh.normals.push(normal.into());
        mesh.tangents.push([along.x, along.y, along.z, if mirrored { -1.0 } else { 1.0 }]);
        mesh.uvs.push([0, 1].map(|axis| (cell[axis] as f32 + place[axis]) / CELLS[axis] as f32));
    }
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
}

/// Closed surfaces of eight vertices, positions and triangles only.
fn solids(blocks: &[Block]) -> Mesh {
    let mut mesh = Mesh::default();
    for block in blocks {
        let first = mesh.positions.len();
        mesh.positions.extend((0..8).map(|corner| block.corner([corner / 4, corner / 2 % 2, corner % 2])));
        for face in FACES {
            let corners = face.map(|[end, i, j]| (first + 4 * end + 2 * i + j) as u32);
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| corners[corner]));
        }
    }
    mesh
}

fn mirror(mesh: &mut Mesh) {
    move_all(mesh, |[x, y, z]| [-x, y, z]);
    mesh.tangents.iter_mut().for_each(|[.., w]| *w = -*w);
    reverse(mesh);
}

fn reverse(mesh: &mut Mesh) {
    mesh.indices.chunks_exact_mut(3).for_each(|corners| corners.swap(1, 2));
}

fn move_all(mesh: &mut Mesh, to: fn([f32; 3]) -> [f32; 3]) {
    mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(|vector| *vector = to(*vector));
    for [x, y, z, _] in &mut mesh.tangents {
        [*x, *y, *z] = to([*x, *y, *z]);
    }
}

/// A letter F in each cell, each cell in a different colour.
fn letters(x: u32, y: u32) -> [u8; 3] {
    const F: [&[u8]; 8] =
        [b"        ", b" #####  ", b" #      ", b" ####   ", b" #      ", b" #      ", b" #      ", b"        "];
    let [column, row] = [x / CELL_PX, y / CELL_PX];
    let is_ink = F[(y % CELL_PX / 2) as usize][(x % CELL_PX / 2) as usize] == b'#';
    if is_ink { [20; 3] } else { [90 + 25 * column as u8, 220 - 40 * row as u8, 160] }
}
