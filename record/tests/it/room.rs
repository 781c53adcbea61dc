//! A room of 8 m by 6 m by 3 m with a cube in it, and recordings in it.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use plume_exporters::ImageFormat;
use plume_exporters::package::Memory;
use plume_exporters::scene::{
    ByZone, Chunk, Chunks, Content, Image, Instance, Light, Lod, Material, Mesh, Network, Piece, Prototype, Scene, Zone,
};
use plume_record::layout;
use plume_record::rig::Rig;
use plume_record::trajectory::{Stamped, Trajectory};
use plume_record::{Order, RecordError, Recording, Watch, record};

/// The corner of the room that is farthest from the origin; the opposite one is its mirror image, on the floor.
pub const FAR: [f64; 3] = [4.0, 3.0, 3.0];
/// The least and the greatest corner of the cube.
pub const CUBE: [[f64; 3]; 2] = [[2.0, 1.0, 0.0], [2.5, 1.5, 0.5]];
/// Linear light that all surfaces reflect: sRGB 188.
pub const ALBEDO: f64 = 0.503;

/// The room.
pub struct Room {
    folder: tempfile::TempDir,
}

impl Room {
    /// With plain images: grey, flat, matt.
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (role, pixel) in [("color", [188; 3]), ("normal", [128, 128, 255]), ("orm", [255, 255, 0])] {
            image::RgbImage::from_pixel(4, 4, image::Rgb(pixel))
                .save(folder.path().join(format!("{role}.png")))
                .unwrap();
        }
        Self { folder }
    }

    /// The scene, with a lamp under the middle of the ceiling.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            name: "room".to_owned(),
            description: "A room".to_owned(),
            generator: "plume test".to_owned(),
            recipe: String::new(),
            fingerprint: "0123".to_owned(),
            seed: 7,
            chunks: self,
            spawns: vec![Isometry3::identity()],
            lights: vec![Light {
                name: "lamp".to_owned(),
                position: Point3::new(0.0, 0.0, 2.9),
                color: [1.0; 3],
                intensity_cd: 10.0,
                range_m: 20.0,
            }],
            georeference: None,
            network: Network::default(),
            sought: Vec::new(),
            friction: ByZone { floor: 0.8, wall: 0.6, ceiling: 0.6 },
            gravity: 9.81,
            collision_error_m: 0.0,
            piece_tolerance_m: ByZone { floor: 0.0, wall: 0.0, ceiling: 0.0 },
        }
    }

    fn material(&self, name: &str) -> Material {
        let image = |role: &str| {
            let path: PathBuf = self.folder.path().join(format!("{role}.png"));
            Image { path, format: ImageFormat::Png }
        };
        Material {
            name: name.to_owned(),
            base_color: image("color"),
            normal: image("normal"),
            orm: image("orm"),
            roughness: image("orm"),
            height: None,
        }
    }

    /// Records with a rig in the syntax of its file.
    pub fn record(&self, rig: &str, path: &Trajectory, layouts: &[&str]) -> Result<(Recording, Memory), RecordError> {
        let rig = Rig::parse(rig, Path::new("rig.toml"))?;
        let layouts = layouts.iter().map(|name| layout::named(name)).collect::<Result<_, _>>()?;
        let mut memory = Memory::default();
        let order = Order { rig: &rig, path, seed: 1, layouts };
        let recording = record(&self.scene(), &order, &mut memory, &Unwatched(AtomicBool::new(false)))?;
        Ok((recording, memory))
    }
}

/// Nobody watches.
pub struct Unwatched(pub AtomicBool);

impl Watch for Unwatched {
    fn begin(&self, _: usize) {}
    fn advance(&self) {}
    fn stop(&self) -> &AtomicBool {
        &self.0
    }
}

impl Chunks for Room {
    fn len(&self) -> usize {
        2
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        let [x, y, z] = FAR;
        let wall = || cuboid([-x, -y, 0.0], [x, y, z], Faces::Inwards);
        let (name, content, visual) = match index {
            0 => ("chunk_0_0_0", Content::Wall, wall()),
            _ => ("things_0_0_0", Content::Things { movable: false }, cuboid(CUBE[0], CUBE[1], Faces::Outwards)),
        };
        let collision =
            Mesh { positions: visual.positions.clone(), indices: visual.indices.clone(), ..Mesh::default() };
        let material = self.material(name);
        Ok(Chunk { name: name.to_owned(), content, visual, lods: Vec::new(), collision, material })
    }

    fn neighbors(&self, _: usize) -> Vec<usize> {
        Vec::new()
    }

    fn pieces(&self, _: usize) -> io::Result<Vec<Piece>> {
        Ok(Vec::new())
    }

    fn instances(&self, index: usize) -> io::Result<Vec<Instance>> {
        let cube = Instance {
            id: 77,
            class: "boulder".to_owned(),
            prototype: "cube".to_owned(),
            level: 0,
            chunk: "things_0_0_0".to_owned(),
            pose: Isometry3::translation(CUBE[0][0], CUBE[0][1], CUBE[0][2]),
            scale: 1.0,
            mass_kg: 100.0,
            embedding_m: 0.0,
            movable: false,
        };
        Ok(if index == 1 { vec![cube] } else { Vec::new() })
    }

    fn prototypes(&self) -> io::Result<Vec<Prototype>> {
        let mesh = cuboid([0.0; 3], [0.5; 3], Faces::Outwards);
        let hull = Mesh { positions: mesh.positions.clone(), indices: mesh.indices.clone(), ..Mesh::default() };
        Ok(vec![Prototype {
            name: "cube".to_owned(),
            levels: vec![Lod { mesh, error_m: 0.0 }],
            hull,
            zone: Zone::Wall,
            material: self.material("things"),
        }])
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Faces {
    Inwards,
    Outwards,
}

/// Six squares, each with its own four corners.
fn cuboid(low: [f64; 3], high: [f64; 3], faces: Faces) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for end in [low, high] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let is_high = end == high;
            let outward: f32 = if is_high { 1.0 } else { -1.0 };
            let normal = if faces == Faces::Outwards { outward } else { -outward };
            let first = mesh.positions.len() as u32;
            for [a, b] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                let mut corner = [0.0; 3];
                corner[axis] = end[axis] as f32;
                corner[u] = [low, high][a][u] as f32;
                corner[v] = [low, high][b][v] as f32;
                mesh.positions.push(corner);
                mesh.normals.push(std::array::from_fn(|k| if k == axis { normal } else { 0.0 }));
                mesh.tangents.push(std::array::from_fn(|k| if k == u || k == 3 { 1.0 } else { 0.0 }));
                mesh.uvs.push([a as f32, b as f32]);
            }
            let turns = if normal > 0.0 { [0, 1, 2, 0, 2, 3] } else { [0, 2, 1, 0, 3, 2] };
            mesh.indices.extend(turns.map(|corner| first + corner));
        }
    }
    mesh
}

/// A path of a second through the room, which bends, climbs and turns.
pub fn bend() -> Trajectory {
    let pose = |n: i32| {
        let s = f64::from(n) * 0.1;
        let turn = UnitQuaternion::from_euler_angles(0.1 * s, 0.05 * s, 0.4 * s);
        let place = Translation3::new(-1.5 + s, 0.2 * s * s, 0.5 + 0.1 * s);
        Stamped { time_ns: 5_000_000_000 + i64::from(n) * 100_000_000, pose: Isometry3::from_parts(place, turn) }
    };
    Trajectory::through(&(0..=10).map(pose).collect::<Vec<_>>()).unwrap()
}

/// A second at a place, looking along a heading in radians.
pub fn rest(place: [f64; 3], heading: f64) -> Trajectory {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
    let pose = Isometry3::from_parts(Translation3::from(Vector3::from(place)), turn);
    Trajectory::through(&[0, 1_000_000_000].map(|time_ns| Stamped { time_ns, pose })).unwrap()
}

/// A PNG of a recording.
pub fn picture(memory: &Memory, path: &str) -> image::DynamicImage {
    image::load_from_memory(&memory.bytes[path]).unwrap()
}
