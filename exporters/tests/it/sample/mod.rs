//! A closed, bumpy, egg-shaped chamber seen from inside, in two chunks, with tiny textures: the smallest scene with
//! everything that an export can contain. Analytic, so tests know the expected result.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use plume_exporters::ImageFormat;
use plume_exporters::scene::{
    ByZone, Chunk, Chunks, Content, Image, Light, Lod, Material, Mesh, Network, Piece, Scene, Zone,
};

/// Half the length of the chamber along x, metres.
const REACH_M: f64 = 6.0;
/// Its radius, metres.
const RADIUS_M: f64 = 2.0;
/// Cells from pole to pole, and around.
const CELLS: [usize; 2] = [64, 96];
/// Cells along the chamber that the coarser level merges into one; the border between the chunks is a ring of both levels.
const COARSE: usize = 2;
/// Pixels along an image.
const SIZE_PX: u32 = 64;

/// The chunks of the chamber, one on either side of x = 0.
pub struct Chamber {
    textures: PathBuf,
    format: ImageFormat,
}

impl Chamber {
    /// Writes the textures into `folder`.
    pub fn new(folder: &Path) -> io::Result<Self> {
        for chunk in 0..2 {
            for (role, pixel) in [
                ("base_color", base_color as Pixel),
                ("normal", normal_map),
                ("orm", |_, _, y| [255, 128 + y as u8, 0]),
                ("roughness", |_, _, y| [128 + y as u8; 3]),
            ] {
                let path = folder.join(format!("{chunk}_{role}.png"));
                write_png(&path, [SIZE_PX; 2], |x, y| pixel(chunk, x, y))?;
            }
        }
        Ok(Self { textures: folder.to_owned(), format: ImageFormat::Png })
    }

    /// The same with textures in WebP, of the same pixels.
    #[allow(dead_code, reason = "few tests use it")]
    pub fn in_webp(folder: &Path) -> io::Result<Self> {
        let chamber = Self::new(folder)?;
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "png") {
                write_webp(&path, &path.with_extension("webp"))?;
            }
        }
        Ok(Self { format: ImageFormat::WebP, ..chamber })
    }

    /// A scene around the chunks.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            name: "chamber".to_owned(),
            description: "A bumpy chamber for tests & <examples>".to_owned(),
            generator: "plume test".to_owned(),
            recipe: "name = \"chamber\"\nseed = 7\n".to_owned(),
            fingerprint: String::new(),
            seed: 7,
            chunks: self,
            spawns: vec![Isometry3::from_parts(
                point([0.5, 0.75]).into(),
                UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5),
            )],
            lights: [-3.0, 3.0].map(lamp).into(),
            network: Network::default(),
            georeference: None,
            sought: Vec::new(),
            friction: ByZone { floor: 0.8, wall: 0.6, ceiling: 0.6 },
            gravity: 9.80665,
            collision_error_m: 0.0,
            piece_tolerance_m: ByZone { floor: 0.0, wall: 0.0, ceiling: 0.0 },
        }
    }

    fn image(&self, chunk: usize, role: &str) -> Image {
        let path = self.textures.join(format!("{chunk}_{role}.{}", self.format.extension()));
        Image { path, format: self.format }
    }
}

impl Chunks for Chamber {
    fn len(&self) -> usize {
        2
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        let visual = mesh(index, 1);
        let collision =
            Mesh { positions: visual.positions.clone(), indices: visual.indices.clone(), ..Mesh::default() };
        Ok(Chunk {
            name: format!("chunk_{index}_0_0"),
            content: Content::Wall,
            visual,
            lods: vec![Lod { mesh: mesh(index, COARSE), error_m: coarse_error_m(index) }],
            collision,
            material: Material {
                name: format!("chunk_{index}_0_0"),
                base_color: self.image(index, "base_color"),
                normal: self.image(index, "normal"),
                orm: self.image(index, "orm"),
                roughness: self.image(index, "roughness"),
                height: None,
            },
        })
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        vec![1 - index]
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        let wall = mesh(index, COARSE);
        let corners = |triangle: &[u32]| [0, 1, 2].map(|k| wall.positions[triangle[k] as usize]);
        Ok(wall.indices.chunks(3).map(|triangle| piece(corners(triangle))).collect())
    }
}

/// Thickness of pieces behind the wall, metres.
const THICKNESS_M: f64 = 0.3;

/// A wedge behind a triangle.
fn piece(corners: [[f32; 3]; 3]) -> Piece {
    let [a, b, c] = corners.map(|corner| Point3::from(corner.map(f64::from)));
    let normal = (b - a).cross(&(c - a)).normalize();
    let behind = [a, b, c].map(|corner| <[f64; 3]>::from(corner - normal * THICKNESS_M).map(|part| part as f32));
    let zone = match normal.z {
        z if z > 0.7 => Zone::Floor,
        z if z < -0.7 => Zone::Ceiling,
        _ => Zone::Wall,
    };
    let sides = [[0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0]];
    let indices = [[0, 1, 2], [5, 4, 3]].into_iter().chain(sides).flatten().collect();
    Piece { mesh: Mesh { positions: [corners, behind].concat(), indices, ..Mesh::default() }, zone }
}

fn lamp(x: f64) -> Light {
    Light {
        name: if x < 0.0 { "lamp_west".to_owned() } else { "lamp_east".to_owned() },
        position: Point3::new(x, 0.0, 1.0),
        color: [1.0, 0.9, 0.75],
        intensity_cd: 8.0,
        range_m: 15.0,
    }
}

/// A point of the wall: `s` from the west pole (0) to the east pole (1), `t` once around from +y via +z; 0.75 is down.
fn point([s, t]: [f64; 2]) -> Point3<f64> {
    let (along, around) = (s * std::f64::consts::PI, t * std::f64::consts::TAU);
    let bumps = libm::sin(9.0 * along) * libm::sin(7.0 * around) + libm::cos(4.0 * around);
    let radius = RADIUS_M * libm::sin(along) * (1.0 - 0.04 * bumps);
    Point3::new(-REACH_M * libm::cos(along), radius * libm::cos(around), radius * libm::sin(around))
}

/// Derivatives along `s` and `t`, by central differences.
fn slopes([s, t]: [f64; 2]) -> [Vector3<f64>; 2] {
    let step = 1e-5;
    [
        (point([s + step, t]) - point([s - step, t])) / (2.0 * step),
        (point([s, t + step]) - point([s, t - step])) / (2.0 * step),
    ]
}

/// The mesh of every ring of cells, or of every `stride`th with all its spokes.
fn mesh(chunk: usize, stride: usize) -> Mesh {
    let rings = chunk * CELLS[0] / 2..=(chunk + 1) * CELLS[0] / 2;
    let mut mesh = Mesh::default();
    for ring in rings.step_by(stride) {
        for spoke in 0..=CELLS[1] {
            add_vertex(&mut mesh, ring, spoke);
        }
    }
    let row = CELLS[1] as u32 + 1;
    for cell in (0..(CELLS[0] / 2 / stride) as u32).flat_map(|i| (0..row - 1).map(move |j| i * row + j)) {
        let [a, b, c, d] = [cell, cell + row, cell + row + 1, cell + 1];
        for corners in [[a, b, c], [a, c, d]] {
            if has_area(&mesh, corners) {
                mesh.indices.extend(corners);
            }
        }
    }
    mesh
}

/// Distance of the coarser level from the full one. Both are flat between the points where their edges cross, which are on
/// the rings that the coarser one omits: at the spokes, and half-way on a diagonal.
fn coarse_error_m(chunk: usize) -> f32 {
    let full = mesh(chunk, 1);
    let row = CELLS[1] + 1;
    let at = |vertex: usize| Point3::from(full.positions[vertex].map(f64::from));
    let middle = |a: usize, b: usize| nalgebra::center(&at(a), &at(b));
    let left_out = (1..CELLS[0] / 2).step_by(COARSE).flat_map(|ring| ring * row..(ring + 1) * row - 1);
    let distances = left_out.flat_map(|v| {
        let spoke = nalgebra::distance(&at(v), &middle(v - row, v + row));
        [spoke, nalgebra::distance(&middle(v, v + 1), &middle(v - row, v + row + 1))]
    });
    (distances.fold(0.0, f64::max) as f32).next_up()
}

fn add_vertex(mesh: &mut Mesh, ring: usize, spoke: usize) {
    let at = [ring as f64 / CELLS[0] as f64, spoke as f64 / CELLS[1] as f64];
    // The first and last spoke, and all vertices of a pole, must coincide exactly, or the wall has a crack.
    let pole = ring.is_multiple_of(CELLS[0]);
    let same = [at[0], if pole { 0.0 } else { (spoke % CELLS[1]) as f64 / CELLS[1] as f64 }];
    let snap = |metres: f64| (libm::round(metres * 4096.0) / 4096.0) as f32;
    mesh.positions.push([point(same).x, point(same).y, point(same).z].map(snap));

    let inside = [at[0].clamp(0.01, 0.99), at[1]];
    let [along, around] = slopes(inside);
    let normal = along.cross(&around).normalize();
    let tangent = (along - normal * normal.dot(&along)).normalize();
    let handedness = if normal.cross(&tangent).dot(&around) > 0.0 { 1.0 } else { -1.0 };
    let [x, y, z]: [f64; 3] = tangent.into();
    mesh.normals.push(<[f64; 3]>::from(normal).map(|part| part as f32));
    mesh.tangents.push([x, y, z, handedness].map(|part| part as f32));
    mesh.uvs.push([4.0 * at[0], 6.0 * at[1]].map(|part| part as f32));
}

fn has_area(mesh: &Mesh, corners: [u32; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
    a != b && b != c && c != a
}

type Pixel = fn(usize, u32, u32) -> [u8; 3];

fn base_color(chunk: usize, x: u32, y: u32) -> [u8; 3] {
    let dark = (x / 16 + y / 16).is_multiple_of(2);
    [[150, 110, 80], [100, 110, 130]][chunk].map(|channel: u8| if dark { channel / 2 } else { channel })
}

/// Rows of domes that protrude from the wall: lit from above, their upper edge in the image is bright.
fn normal_map(_: usize, x: u32, y: u32) -> [u8; 3] {
    let across = |pixel: u32| f64::from(pixel % 16) / 8.0 - 15.0 / 16.0;
    let (x, y) = (across(x), -across(y));
    let up = (1.0 - 0.3 * (x * x + y * y)).sqrt();
    let length = (0.09 * (x * x + y * y) + up * up).sqrt();
    [0.3 * x, 0.3 * y, up].map(|part| libm::round(127.5 + 127.5 * part / length) as u8)
}

fn write_webp(png: &Path, webp: &Path) -> io::Result<()> {
    let mut reader = png::Decoder::new(io::BufReader::new(File::open(png)?)).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().expect("a tiny image fits into memory")];
    let info = reader.next_frame(&mut pixels)?;
    let encoder = image_webp::WebPEncoder::new(File::create(webp)?);
    encoder.encode(&pixels, info.width, info.height, image_webp::ColorType::Rgb8).map_err(io::Error::other)
}

/// Writes an image of `size` pixels, each computed by `pixel` from its position from the upper left.
pub fn write_png(path: &Path, size: [u32; 2], pixel: impl Fn(u32, u32) -> [u8; 3]) -> io::Result<()> {
    let mut encoder = png::Encoder::new(File::create(path)?, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0..size[0] * size[1]).flat_map(|i| pixel(i % size[0], i / size[0])).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    Ok(writer.finish()?)
}
