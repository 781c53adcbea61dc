//! A short passage of each rock, baked as it is exported, and the field where its texels are.

use image::RgbImage;
use nalgebra::Point3;
use plume::field::{Aabb, CaveField, Field, PassageSettings, Surface, Texel};
use plume::graph::{Graph, Node, StationId};
use plume::material::{Look, MATERIALS};
use plume::mesh::{Grid, MeshSettings, chunk};
use plume::texture::settings::TextureSettings;
use plume::texture::{Maps, Textured, texture};
use serde_json::json;

use super::bands::Image;
use super::{cross, dot};

/// A passage 4.5 m long, its textures as files and as a renderer reads them.
pub struct Baked {
    pub rock: &'static str,
    pub textured: Textured,
    pub base_color: RgbImage,
    pub normal: RgbImage,
    pub orm: RgbImage,
    field: CaveField,
    /// The triangle whose inside holds the centre of each texel, row by row from the lowest.
    owners: Vec<Option<u32>>,
}

/// Floor or wall, by the normal of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zone {
    Floor,
    Wall,
}

impl Zone {
    pub const ALL: [Self; 2] = [Self::Floor, Self::Wall];

    fn has(self, normal: [f64; 3]) -> bool {
        let upright = normal[2] / dot(normal, normal).sqrt();
        if self == Self::Floor { upright > 0.7 } else { upright.abs() <= 0.7 }
    }
}

/// A passage in every rock of the table, with the default settings but for the humidity.
pub fn passages(humidity: f32, seed: u64) -> Vec<Baked> {
    let node = |id, x| Node {
        id,
        parent: None,
        position: Point3::new(x, 0.4 * x, 0.1 * x),
        radius: 1.2,
        active: false,
        level: 0,
        section: None,
        name: None,
    };
    let graph = Graph::new(vec![node(0, 0.0), node(1, 4.5)], StationId::pairs([[0, 1]]));
    MATERIALS
        .iter()
        .map(|row| {
            let rock = (row.read)(json!({})).expect("an empty object is valid");
            let look = Look { humidity, ..Look::default() };
            let field = CaveField::new(&graph, &PassageSettings::default(), rock, look, seed);
            Baked::new(row.name, field)
        })
        .collect()
}

impl Baked {
    fn new(rock: &'static str, field: CaveField) -> Self {
        let settings = MeshSettings::default();
        let grid = Grid::new(field.bounds(), &settings).expect("the bounds suit");
        let meshes: Vec<_> = grid.indices().filter_map(|index| chunk(&field, &grid, index, &settings)).collect();
        let [mesh] = &meshes[..] else { panic!("{} chunks", meshes.len()) };
        let mut maps: Maps<Vec<u8>> = Maps::default();
        let textured = texture(&mesh.visual, &field, &TextureSettings::default(), maps.as_mut()).expect("it fits");
        let picture = |bytes: &[u8]| image::load_from_memory(bytes).expect("a map is a picture").to_rgb8();
        let owners = owners(&textured);
        Self {
            rock,
            base_color: picture(&maps.base_color),
            normal: picture(&maps.normal),
            orm: picture(&maps.orm),
            field,
            owners,
            textured,
        }
    }

    /// The owner of a texel, y up.
    fn owner(&self, x: usize, y: usize) -> Option<u32> {
        self.owners[y * self.textured.size_px as usize + x]
    }

    /// An attribute at the corners of a triangle.
    fn of<const N: usize>(&self, triangle: u32, rows: &[[f32; N]]) -> [[f64; N]; 3] {
        self.textured.triangles[triangle as usize].map(|vertex| rows[vertex as usize].map(f64::from))
    }

    /// Weights of the corners of a triangle at a place in texels.
    fn weights(&self, triangle: u32, at: [f64; 2]) -> [f64; 3] {
        weights(corners(&self.textured, triangle), at)
    }

    /// All texels with a triangle, of one zone.
    pub fn texels(&self, zone: Zone) -> impl Iterator<Item = [usize; 2]> + '_ {
        let size = self.textured.size_px as usize;
        let texels = (0..size).flat_map(move |y| (0..size).map(move |x| [x, y]));
        texels.filter(move |&[x, y]| self.zone_of(x, y, zone))
    }

    fn zone_of(&self, x: usize, y: usize, zone: Zone) -> bool {
        self.owner(x, y).is_some_and(|triangle| {
            let weights = self.weights(triangle, [x as f64 + 0.5, y as f64 + 0.5]);
            zone.has(mix(weights, self.of(triangle, &self.textured.normals)))
        })
    }

    /// Angle between the normal that a texel shows and that of the mesh.
    pub fn lean_deg(&self, [x, y]: [usize; 2]) -> f64 {
        let pixel = self.normal.get_pixel(x as u32, self.textured.size_px - 1 - y as u32);
        let [x, y, z] = pixel.0.map(|c| 2.0 * f64::from(c) / 255.0 - 1.0);
        libm::atan2(libm::hypot(x, y), z).to_degrees()
    }

    /// At most `most` squares of texels, each in one chart and its middle in the zone, by their lower left texel.
    pub fn windows(&self, zone: Zone, side: usize, most: usize) -> Vec<[usize; 2]> {
        let size = self.textured.size_px as usize;
        let starts = || (0..size - side).step_by(side / 2);
        let chart = |x, y| self.owner(x, y).map(|triangle| self.textured.charts[triangle as usize]);
        let mut found: Vec<[usize; 2]> = vec![];
        for [x, y] in starts().flat_map(|y| starts().map(move |x| [x, y])) {
            let clear = found.iter().all(|[fx, fy]| fx.abs_diff(x) >= side || fy.abs_diff(y) >= side);
            let inside =
                || (y..y + side).all(|y| (x..x + side).all(|c| chart(c, y).is_some() && chart(c, y) == chart(x, y)));
            if clear && self.zone_of(x + side / 2, y + side / 2, zone) && inside() {
                found.push([x, y]);
            }
        }
        let step = found.len().div_ceil(most).max(1);
        found.into_iter().step_by(step).collect()
    }

    /// What the files show in a square of texels.
    pub fn shown(&self, [left, bottom]: [usize; 2], side: usize) -> Appearance {
        let size = self.textured.size_px as usize;
        let at = |k: usize| [(left + k % side) as u32, (size - 1 - bottom - k / side) as u32];
        let image =
            |value: &dyn Fn([u32; 2]) -> f64| Image { side, values: (0..side * side).map(|k| value(at(k))).collect() };
        let of = |map: &RgbImage, [x, y]: [u32; 2]| map.get_pixel(x, y).0.map(|c| f64::from(c) / 255.0);
        Appearance {
            albedo: image(&|p| log2_luminance(of(&self.base_color, p).map(from_srgb))),
            normal: [0, 1, 2].map(|k| image(&|p| 2.0 * of(&self.normal, p)[k] - 1.0)),
            roughness: image(&|p| of(&self.orm, p)[1]),
        }
    }

    /// What the field has in a square of texels, `finer` samples along each side of a texel.
    pub fn in_field(&self, [left, bottom]: [usize; 2], side: usize, finer: usize) -> Appearance {
        let mut points = vec![];
        let mut frames = vec![];
        for k in 0..side * side * finer * finer {
            let [dx, dy] = [k % (side * finer), k / (side * finer)];
            let triangle = self.owner(left + dx / finer, bottom + dy / finer).expect("the window is inside a chart");
            let at = [(left, dx), (bottom, dy)].map(|(from, d)| from as f64 + (d as f64 + 0.5) / finer as f64);
            let weights = self.weights(triangle, at);
            points.push(mix(weights, self.of(triangle, &self.textured.positions)).map(|c| c as f32));
            frames.push(Frame {
                normal: mix(weights, self.of(triangle, &self.textured.normals)),
                tangent: mix(weights, self.of(triangle, &self.textured.tangents)),
            });
        }
        let up: Vec<[f32; 3]> = frames.iter().map(|frame| super::unit(frame.normal).map(|c| c as f32)).collect();
        let texels = self.at_wall(points, &up, self.textured.texels_per_m.recip() / finer as f32);
        let side = side * finer;
        let image = |values: Vec<f64>| Image { side, values };
        let local: Vec<[f64; 3]> =
            frames.iter().zip(&texels).map(|(frame, texel)| frame.local(texel.normal.map(f64::from))).collect();
        Appearance {
            albedo: image(texels.iter().map(|texel| log2_luminance(texel.color.map(f64::from))).collect()),
            normal: [0, 1, 2].map(|k| image(local.iter().map(|normal| normal[k]).collect())),
            roughness: image(texels.iter().map(|texel| f64::from(texel.roughness)).collect()),
        }
    }

    /// The surface at these points of the mesh, moved along its normals to the wall.
    fn at_wall(&self, mut points: Vec<[f32; 3]>, normals: &[[f32; 3]], texel_m: f32) -> Vec<Texel> {
        for _ in 0..4 {
            let values = self.field.distances_at(&points);
            for ((point, value), normal) in points.iter_mut().zip(values).zip(normals) {
                *point = std::array::from_fn(|axis| point[axis] + 0.7 * value * normal[axis]);
            }
        }
        let bounds = Aabb::from_points(points.iter().copied()).expect("there are points");
        let mut texels = vec![Texel::default(); points.len()];
        self.field.texels(bounds, texel_m, &points, normals, &mut texels);
        texels
    }
}

/// A square of the wall in the terms of a renderer.
pub struct Appearance {
    /// Binary logarithm of the luminance.
    pub albedo: Image,
    /// In tangent space.
    pub normal: [Image; 3],
    pub roughness: Image,
}

/// Normal and tangent as a shader interpolates them.
struct Frame {
    normal: [f64; 3],
    tangent: [f64; 4],
}

impl Frame {
    /// A vector of the cave in tangent space, of unit length.
    fn local(&self, vector: [f64; 3]) -> [f64; 3] {
        let [x, y, z, sign] = self.tangent;
        let (t, n) = ([x, y, z], self.normal);
        let b = cross(n, t).map(|c| c * sign);
        let whole = dot(t, cross(b, n));
        super::unit([cross(b, n), cross(n, t), cross(t, b)].map(|row| dot(row, vector) / whole))
    }
}

fn mix<const N: usize>(weights: [f64; 3], [a, b, c]: [[f64; N]; 3]) -> [f64; N] {
    std::array::from_fn(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k])
}

/// Corners of a triangle in texels, y up.
fn corners(textured: &Textured, triangle: u32) -> [[f64; 2]; 3] {
    let size = f64::from(textured.size_px);
    textured.triangles[triangle as usize].map(|vertex| textured.uvs[vertex as usize].map(|c| f64::from(c) * size))
}

fn weights([a, b, c]: [[f64; 2]; 3], at: [f64; 2]) -> [f64; 3] {
    let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    [area(at, b, c), area(a, at, c), area(a, b, at)].map(|part| part / area(a, b, c))
}

fn owners(textured: &Textured) -> Vec<Option<u32>> {
    let size = textured.size_px as usize;
    let mut owners = vec![None; size * size];
    for triangle in 0..textured.triangles.len() as u32 {
        let corners = corners(textured, triangle);
        let extent = |axis: usize| {
            let along = corners.map(|corner| corner[axis]);
            let low = along.into_iter().fold(f64::INFINITY, f64::min);
            low as usize..along.into_iter().fold(0.0, f64::max).ceil() as usize
        };
        for [x, y] in extent(1).flat_map(|y| extent(0).map(move |x| [x, y])) {
            if weights(corners, [x as f64 + 0.5, y as f64 + 0.5]).iter().all(|&weight| weight > 0.0) {
                owners[y * size + x] = Some(triangle);
            }
        }
    }
    owners
}

fn from_srgb(c: f64) -> f64 {
    if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
}

fn log2_luminance([r, g, b]: [f64; 3]) -> f64 {
    libm::log2(0.2126 * r + 0.7152 * g + 0.0722 * b + 1e-3)
}
