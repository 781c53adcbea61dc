//! A look inside a small cave: traces the field under a headlamp and a second lamp further on, and writes a PNG.
//!
//! `cargo run --release --example inside -- basalt passage out.png 960`
//! Rocks: the names in `plume::material::MATERIALS`. Views: passage, junction, room, floor, wall. `bench` instead of a
//! view prints nanoseconds per sample and per texel.

use cpu_time::ProcessTime;
use nalgebra::{Point3, Vector3};
use plume::field::{Aabb, CaveField, Field, PassageSettings, Surface, Texel};
use plume::graph::{Graph, Node, StationId};
use plume::material::{Look, MATERIALS};
use rayon::prelude::*;
use std::error::Error;

/// Rays that are traced together.
const BATCH: usize = 64;
/// Share of the field that is a safe step; the field is steeper than a distance.
const SAFE: f32 = 0.45;
/// Spacing of the simulated texels, metres.
const TEXEL_M: f32 = 1.0 / 150.0;

type V = Vector3<f32>;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [rock, view, rest @ ..] = arguments.as_slice() else {
        return Err("usage: inside ROCK VIEW|bench [OUT.png] [WIDTH]".into());
    };
    let row = MATERIALS.find(rock).ok_or("no such rock")?;
    let material = (row.read)(serde_json::json!({}))?;
    let settings = PassageSettings::default();
    let field = CaveField::new(&graph(&settings), &settings, material, Look::default(), 7);
    if view == "bench" {
        return bench(&field);
    }
    let out = rest.first().map_or("inside.png", String::as_str);
    let width: u32 = rest.get(1).map_or(Ok(640), |width| width.parse())?;
    let exposure = if rock == "basalt" { 0.30 } else { 0.45 };
    let size = [width, width * 9 / 16];
    let camera = Camera::of(view, &field).ok_or("no such view")?;
    write_png(out, size, &camera.picture(&field, size, exposure))
}

/// A passage, a junction, a room: x, y, height of the floor and width of each station in metres.
const STATIONS: [[f64; 4]; 9] = [
    [-14.0, -3.0, 0.5, 3.0],
    [-6.0, -1.0, 0.3, 3.6],
    [2.0, 1.2, 0.1, 3.2],
    [9.0, 0.0, -0.1, 4.0],
    [17.0, 3.0, -0.4, 3.6],
    [24.0, 4.5, -0.8, 8.0],
    [11.5, -7.5, 0.3, 2.8],
    [10.5, -14.0, 0.8, 2.4],
    [32.0, 2.0, -0.6, 3.4],
];

fn graph(settings: &PassageSettings) -> Graph {
    let node = |(id, [x, y, z, width]): (u64, [f64; 4])| Node {
        id,
        parent: None,
        position: Point3::new(x, y, z + width / 2.0 * f64::from(settings.height_ratio * settings.floor_drop)),
        radius: width / f64::from(settings.width_per_radius),
        active: false,
        level: 0,
        section: None,
        name: None,
    };
    let edges = [[0, 1], [1, 2], [2, 3], [3, 4], [3, 6], [4, 5], [5, 8], [6, 7]];
    Graph::new((0..).zip(STATIONS).map(node).collect(), StationId::pairs(edges))
}

struct Lamp {
    at: V,
    color: V,
    /// Direction and cosine of the rim of the beam.
    beam: Option<(V, f32)>,
}

struct Camera {
    eye: V,
    forward: V,
    right: V,
    tangent: f32,
    lamps: Vec<Lamp>,
}

impl Camera {
    fn of(view: &str, field: &CaveField) -> Option<Self> {
        type View = ([f32; 2], [f32; 3], f32, &'static [[f32; 4]]);
        let (eye, target, degrees, lamps): View = match view {
            "passage" => ([-4.5, -0.7], [4.0, 1.0, 0.75], 70.0, &[[4.6, 0.4, 1.6, 20.0]]),
            "junction" => ([3.4, 1.0], [10.0, -1.5, 0.9], 78.0, &[[10.8, -5.2, 1.1, 22.0], [13.8, 1.6, 1.5, 12.0]]),
            "room" => ([18.8, 3.3], [25.0, 4.6, 1.0], 84.0, &[[25.6, 5.2, 2.0, 40.0]]),
            "floor" => ([-3.4, -0.5], [-0.2, 0.5, -0.1], 66.0, &[[0.9, 1.3, 0.9, 9.0]]),
            "wall" => ([-1.6, -0.3], [0.2, 2.4, 0.9], 62.0, &[[1.2, 0.4, 1.6, 6.0]]),
            _ => return None,
        };
        let over_floor = |x: f32, y: f32, height: f32| V::new(x, y, field.floor_z([x, y, 0.8]) + height);
        let eye = over_floor(eye[0], eye[1], 1.15);
        let forward = (over_floor(target[0], target[1], target[2]) - eye).normalize();
        let right = forward.cross(&V::z()).normalize();
        let headlamp = Lamp {
            at: eye + right * 0.36 + V::z() * 0.22,
            color: V::new(1.0, 0.97, 0.92) * 12.0,
            beam: Some((forward, 0.62)),
        };
        let further = lamps.iter().map(|&[x, y, height, power]| Lamp {
            at: over_floor(x, y, height),
            color: V::new(1.0, 0.92, 0.80) * power,
            beam: None,
        });
        let lamps = std::iter::once(headlamp).chain(further).collect();
        Some(Self { eye, forward, right, tangent: (degrees.to_radians() / 2.0).tan(), lamps })
    }

    fn picture(&self, field: &CaveField, [width, height]: [u32; 2], exposure: f32) -> Vec<V> {
        let up = self.right.cross(&self.forward);
        let ray = |i: usize| {
            let (x, y) = ((i as u32 % width) as f32 + 0.5, (i as u32 / width) as f32 + 0.5);
            let x = (x / width as f32 * 2.0 - 1.0) * self.tangent;
            let y = (1.0 - y / height as f32 * 2.0) * self.tangent * height as f32 / width as f32;
            (self.forward + self.right * x + up * y).normalize()
        };
        let pixels: Vec<usize> = (0..(width * height) as usize).collect();
        let light: Vec<V> = pixels
            .par_chunks(BATCH)
            .flat_map_iter(|pixels| {
                let rays: Vec<V> = pixels.iter().map(|&i| ray(i)).collect();
                self.seen(field, &rays)
            })
            .collect();
        developed(light, exposure)
    }

    /// Light along each ray.
    fn seen(&self, field: &CaveField, rays: &[V]) -> Vec<V> {
        let eyes = vec![self.eye; rays.len()];
        let reach = march(field, &eyes, rays, &vec![60.0; rays.len()]);
        let points: Vec<V> = rays.iter().zip(&reach).map(|(ray, t)| self.eye + ray * *t).collect();
        let points_m: Vec<[f32; 3]> = points.iter().map(|p| (*p).into()).collect();
        let bounds = Aabb::from_points(points_m.iter().copied()).expect("there is a ray");
        let normals = field.normals_at(&points_m);
        let mut texels = vec![Texel::default(); points.len()];
        field.texels(bounds, TEXEL_M, &points_m, &normals, &mut texels);
        let mut light = vec![V::zeros(); points.len()];
        for lamp in &self.lamps {
            let from: Vec<V> = points.iter().zip(&normals).map(|(p, n)| p + V::from(*n) * 0.03).collect();
            let to: Vec<V> = from.iter().map(|p| lamp.at - p).collect();
            let far: Vec<f32> = to.iter().map(|to| to.norm()).collect();
            let toward: Vec<V> = to.iter().map(|to| to.normalize()).collect();
            let free = march(field, &from, &toward, &far);
            for i in 0..points.len() {
                let lit = f32::from(u8::from(free[i] >= far[i] - 0.05));
                light[i] += lamp.shine(&texels[i], -rays[i], toward[i], far[i], lit);
            }
        }
        light.iter().zip(&reach).map(|(light, t)| light / (1.0 + 0.008 * t)).collect()
    }
}

impl Lamp {
    /// Light that a texel sends to the eye: direct where `lit`, and a faint share of what bounces about.
    fn shine(&self, texel: &Texel, to_eye: V, to_lamp: V, far: f32, lit: f32) -> V {
        let cone = self.beam.map_or(1.0, |(axis, rim)| {
            let t = ((-to_lamp.dot(&axis) - rim) / (0.97 - rim)).clamp(0.0, 1.0);
            0.06 + 0.94 * t * t * (3.0 - 2.0 * t)
        });
        let arriving = self.color * (cone / (far * far + 0.25));
        let normal = V::from(texel.normal);
        let facing = normal.dot(&to_lamp).max(0.0) * lit;
        let color = V::from(texel.color);
        let gloss = gloss(normal, to_eye, to_lamp, texel.roughness).min(1.6);
        let around = self.color * (0.02 * texel.occlusion * texel.occlusion / (far * far * 0.3 + 6.0));
        let bounced = around * (0.6 + 0.4 * normal.z);
        color.component_mul(&(arriving * facing + bounced)) / std::f32::consts::PI + arriving * (facing * gloss)
    }
}

/// Reflectance of a rough dielectric (GGX).
fn gloss(normal: V, to_eye: V, to_lamp: V, roughness: f32) -> f32 {
    let half = (to_eye + to_lamp).normalize();
    let cosine = |a: V, b: V| a.dot(&b).max(0.02);
    let (nl, nv, nh, vh) =
        (cosine(normal, to_lamp), cosine(normal, to_eye), cosine(normal, half), cosine(to_eye, half));
    let a2 = (roughness * roughness) * (roughness * roughness);
    let spread = nh * nh * (a2 - 1.0) + 1.0;
    let k = roughness * roughness / 2.0;
    let shading = (nl * (1.0 - k) + k) * (nv * (1.0 - k) + k) * 4.0;
    let grazing = 1.0 - vh;
    let fresnel = 0.04 + 0.96 * grazing * grazing * grazing * grazing * grazing;
    a2 / (std::f32::consts::PI * spread * spread) * fresnel / shading
}

/// How far each ray gets before it meets rock, at most `most`.
fn march(field: &CaveField, from: &[V], along: &[V], most: &[f32]) -> Vec<f32> {
    let mut reach = vec![0.01_f32; from.len()];
    let mut free = reach.clone();
    let mut open: Vec<usize> = (0..from.len()).collect();
    for _ in 0..220 {
        if open.is_empty() {
            break;
        }
        let points: Vec<[f32; 3]> = open.iter().map(|&i| (from[i] + along[i] * reach[i]).into()).collect();
        let values = field.distances_at(&points);
        for (&i, &value) in open.iter().zip(&values) {
            if value < 0.0 {
                free[i] = reach[i];
                reach[i] = (reach[i] + (-value * SAFE).max(0.004)).min(most[i]);
            } else {
                // Overshot: halve back towards the last free point.
                reach[i] = (reach[i] + free[i]) / 2.0;
            }
        }
        let mut values = values.into_iter();
        open.retain(|&i| {
            let value = values.next().unwrap_or_default();
            let done = free[i] >= most[i] || (value >= 0.0 && reach[i] - free[i] < 0.001);
            !done
        });
    }
    reach
}

/// Exposes so that the 95th percentile reaches `exposure`, compresses highlights (Narkowicz 2015) and encodes as sRGB.
fn developed(light: Vec<V>, exposure: f32) -> Vec<V> {
    let mut luminance: Vec<f32> = light.iter().map(|c| c.dot(&V::new(0.2126, 0.7152, 0.0722))).collect();
    luminance.sort_by(f32::total_cmp);
    let gain = exposure / luminance[luminance.len() * 95 / 100].max(1e-6);
    let encode = |x: f32| {
        let x = x * gain * 0.8;
        let x = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
        if x < 0.003_130_8 { x * 12.92 } else { 1.055 * libm::powf(x, 1.0 / 2.4) - 0.055 }
    };
    light.into_iter().map(|c| c.map(encode)).collect()
}

fn write_png(path: &str, [width, height]: [u32; 2], pixels: &[V]) -> Result<(), Box<dyn Error>> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|c| [c.x, c.y, c.z]).map(|x| (x * 255.0 + 0.5) as u8).collect();
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(std::fs::File::create(path)?), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}

/// Prints CPU nanoseconds per lattice sample near the wall, per normal and per texel.
#[expect(clippy::print_stdout, reason = "the answer of the bench")]
fn bench(field: &CaveField) -> Result<(), Box<dyn Error>> {
    let near = lattice_near_wall(field, 0.2);
    let count: usize = near.iter().map(|brick| brick.points.len()).sum();
    let mut values = vec![0.0; 4096];
    let mut normals = vec![[0.0; 3]; 4096];
    let mut texels = vec![Texel::default(); 4096];
    let timed = |what: &str, work: &mut dyn FnMut(&Brick)| {
        let best = (0..3).map(|_| {
            let start = ProcessTime::now();
            near.iter().for_each(&mut *work);
            start.elapsed().as_nanos() as f64 / count as f64
        });
        println!("{what}: {:.0} ns", best.fold(f64::INFINITY, f64::min));
    };
    println!("{count} points in {} bricks", near.len());
    timed("lattice sample", &mut |Brick { bounds, points }| {
        field.distances(*bounds, points, &mut values[..points.len()])
    });
    timed("normal", &mut |Brick { bounds, points }| field.normals(*bounds, points, &mut normals[..points.len()]));
    let flat = vec![[0.0, 0.0, 1.0]; 4096];
    timed("texel", &mut |Brick { bounds, points }| {
        let count = points.len();
        field.texels(*bounds, TEXEL_M, points, &flat[..count], &mut texels[..count]);
    });
    Ok(())
}

/// A box of 16 lattice cells a side, and points in it.
struct Brick {
    bounds: Aabb<f32>,
    points: Vec<[f32; 3]>,
}

/// Points of a lattice within 0.25 m of the wall, by brick.
fn lattice_near_wall(field: &CaveField, spacing: f32) -> Vec<Brick> {
    let all = field.bounds();
    let edge = spacing * 16.0;
    let steps = |i: usize| ((all.max[i] - all.min[i]) / edge).ceil() as usize;
    let mut bricks = Vec::new();
    for brick in 0..steps(0) * steps(1) * steps(2) {
        let place = [brick % steps(0), brick / steps(0) % steps(1), brick / steps(0) / steps(1)];
        let min: [f32; 3] = std::array::from_fn(|i| all.min[i] + place[i] as f32 * edge);
        let bounds = Aabb { min, max: min.map(|c| c + edge) };
        let mut points: Vec<[f32; 3]> = (0..4096)
            .map(|i| [i % 16, i / 16 % 16, i / 256])
            .map(|at| std::array::from_fn(|i| min[i] + at[i] as f32 * spacing))
            .collect();
        let mut values = vec![0.0; points.len()];
        field.distances(bounds, &points, &mut values);
        let mut value = values.iter();
        points.retain(|_| value.next().is_some_and(|v| v.abs() < 0.25));
        if !points.is_empty() {
            bricks.push(Brick { bounds, points });
        }
    }
    bricks
}
