//! What a camera sees: a ray for each pixel, and what follows from where it ends.

use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use rayon::prelude::*;

use crate::lens::Lens;
use crate::library::Library;
use crate::light::{Lights, Received, Sight};
use crate::noise::Noise;
use crate::rig::{Camera, Depth};
use crate::world::{Hit, NO_THING, World};

/// How far rays go, in metres.
const FAR_M: f64 = 1e4;
/// Two pixels are on different surfaces if their depths differ by more than this share beyond what a slope explains. Tuned by eye.
const EDGE: f64 = 0.04;
/// Rays of a pixel on the edge of a surface, along either axis.
const FINER: usize = 2;
/// Pixels along either side of a tile, whose rays are followed together.
const TILE: usize = 8;

/// A camera with the ray of each of its pixels.
pub struct Eye {
    /// Its lens.
    pub lens: Lens,
    /// From its optical frame to the body.
    pub body_from_optical: Isometry3<f64>,
    rays: Vec<Option<Vector3<f64>>>,
    pixel_rad: f32,
}

/// What it sees from a place.
pub struct View<'a> {
    eye: &'a Eye,
    world: &'a World,
    /// From its optical frame to the scene.
    pub scene_from_optical: Isometry3<f64>,
    /// The same of directions, which turns many of them in less time.
    turn: Rotation3<f64>,
    hits: Vec<Option<Hit>>,
}

impl Eye {
    /// The eye of a camera.
    pub fn of(camera: &Camera) -> Self {
        let lens = Lens::of(camera);
        let [width, height] = lens.size;
        let row = |y: u32| {
            let lens = &lens;
            (0..width).map(move |x| lens.ray([f64::from(x), f64::from(y)]))
        };
        let rays = (0..height).into_par_iter().flat_map_iter(row).collect();
        let pixel_rad = (1.0 / lens.focal) as f32;
        Self { lens, body_from_optical: camera.body_from_optical(), rays, pixel_rad }
    }

    /// Number of pixels in a row.
    pub fn width(&self) -> usize {
        self.lens.size[0] as usize
    }

    /// What it sees if the body is at a pose.
    pub fn look<'a>(&'a self, world: &'a World, scene_from_body: &Isometry3<f64>) -> View<'a> {
        let scene_from_optical = scene_from_body * self.body_from_optical;
        let origin = Point3::from(scene_from_optical.translation.vector);
        let turn = scene_from_optical.rotation.to_rotation_matrix();
        let hits_of = |tile: Tile| {
            let rays = tile.places().filter_map(|place| Some((place, turn * self.rays[place]?)));
            let (places, rays): (Vec<usize>, Vec<Vector3<f64>>) = rays.unzip();
            places.into_iter().zip(world.hits(&origin, &rays, FAR_M)).collect()
        };
        View { eye: self, world, scene_from_optical, turn, hits: self.by_tiles(None, hits_of) }
    }

    /// A value for every pixel, from those of each tile and their places; those that are left out have the first.
    fn by_tiles<T: Copy + Send>(&self, nothing: T, of: impl Fn(Tile) -> Vec<(usize, T)> + Send + Sync) -> Vec<T> {
        let [width, height] = self.lens.size.map(|side| side as usize);
        let mut all = vec![nothing; width * height];
        all.par_chunks_mut(TILE * width).enumerate().for_each(|(row, values)| {
            let (y, first) = (TILE * row, TILE * row * width);
            for x in (0..width).step_by(TILE) {
                let tile = Tile { x: [x, width.min(x + TILE)], y: [y, height.min(y + TILE)], width };
                of(tile).into_iter().for_each(|(place, value)| values[place - first] = value);
            }
        });
        all
    }
}

/// A part of an image.
#[derive(Clone, Copy)]
struct Tile {
    /// From the first column to behind the last one.
    x: [usize; 2],
    /// Likewise with rows.
    y: [usize; 2],
    /// Of the image.
    width: usize,
}

impl Tile {
    /// The places of its pixels in the image.
    fn places(self) -> impl Iterator<Item = usize> {
        (self.y[0]..self.y[1]).flat_map(move |y| (self.x[0]..self.x[1]).map(move |x| y * self.width + x))
    }
}

impl View<'_> {
    /// Depth along the axis of a pinhole, or distance from a fisheye, in metres; 0 where nothing is.
    pub fn depth(&self) -> Vec<f32> {
        self.each(0.0, |ray, hit| self.depth_of(ray, hit) as f32)
    }

    /// What a depth sensor makes of it, with the noise of stream `name`, image `number`.
    pub fn measured_depth(&self, sensor: &Depth, seed: u64, name: &str, number: u64) -> Vec<f32> {
        let width = self.eye.width();
        let mut depth = self.depth();
        let rows = depth.len() / width;
        depth.par_chunks_mut(width).enumerate().for_each(|(row, pixels)| {
            let mut noise = Noise::new(Rng::new(stream(seed, name, number * rows as u64 + row as u64)));
            for pixel in pixels {
                let spread = sensor.noise_m as f32 * *pixel * *pixel;
                let measured = *pixel + spread * noise.normal();
                let is_seen = *pixel > 0.0 && (sensor.min_m..=sensor.max_m).contains(&f64::from(measured));
                *pixel = if is_seen { measured } else { 0.0 };
            }
        });
        depth
    }

    /// Unit normals of the faces in the optical frame, towards the camera; zero where nothing is.
    pub fn normals(&self) -> Vec<[f32; 3]> {
        let optical_from_scene = self.turn.inverse();
        self.each([0.0; 3], |ray, hit| {
            let normal = optical_from_scene * self.world.facet(hit.face).flat_normal;
            let towards = if normal.dot(ray) > 0.0 { -normal } else { normal };
            towards.cast::<f32>().into()
        })
    }

    /// Labels; 0 where nothing is.
    pub fn labels(&self) -> Vec<u8> {
        self.each(0, |_, hit| self.world.kind(hit.face).label)
    }

    /// Numbers of things.
    pub fn things(&self) -> Vec<u32> {
        self.each(NO_THING, |_, hit| self.world.kind(hit.face).thing)
    }

    /// From each pixel to where its point will be in the image from another pose of the body, in pixels; `None` where nothing is, or
    /// where it will be outside of the image.
    pub fn flow(&self, next_scene_from_body: &Isometry3<f64>) -> Vec<Option<[f32; 2]>> {
        let next_from_now = (next_scene_from_body * self.eye.body_from_optical).inverse() * self.scene_from_optical;
        let lens = &self.eye.lens;
        let width = self.eye.width();
        let moved = |place: usize| {
            let ray = self.eye.rays[place]?;
            let point = next_from_now * Point3::from(ray * self.hits[place]?.distance);
            let pixel = lens.pixel(&point.coords)?;
            let is_inside = (0..2).all(|axis| pixel[axis] > -0.5 && pixel[axis] < f64::from(lens.size[axis]) - 0.5);
            let from = [place % width, place / width];
            is_inside.then(|| [0, 1].map(|axis| (pixel[axis] - from[axis] as f64) as f32))
        };
        (0..self.hits.len()).into_par_iter().map(moved).collect()
    }

    /// Luminances in cd/m².
    pub fn image(&self, lights: &Lights, library: &Library) -> Vec<[f32; 3]> {
        let edges = self.edges();
        let received = self.eye.by_tiles(Received::default(), |tile| self.received(tile, &edges, lights, library));
        let mut mean = [0.0; 3];
        for pixel in &received {
            (0..3).for_each(|channel| mean[channel] += f64::from(pixel.direct[channel]));
        }
        let mean = mean.map(|sum| (sum / received.len() as f64) as f32);
        received.iter().map(|received| lights.luminance(received, mean)).collect()
    }

    /// The materials that are in view.
    pub fn materials(&self) -> Vec<u32> {
        let mut seen = vec![false; self.world.materials.len()];
        for hit in self.hits.iter().flatten() {
            seen[self.world.kind(hit.face).material as usize] = true;
        }
        (0..).zip(seen).filter(|(_, is_seen)| *is_seen).map(|(number, _)| number).collect()
    }

    fn depth_of(&self, ray: &Vector3<f64>, hit: &Hit) -> f64 {
        if self.eye.lens.is_fisheye() { hit.distance } else { hit.distance * ray.z }
    }

    fn each<T: Copy + Send + Sync>(&self, nothing: T, of: impl Fn(&Vector3<f64>, &Hit) -> T + Sync) -> Vec<T> {
        let pixels = self.eye.rays.par_iter().zip(&self.hits);
        pixels.map(|(ray, hit)| ray.as_ref().zip(hit.as_ref()).map_or(nothing, |(ray, hit)| of(ray, hit))).collect()
    }

    /// What the pixels of a tile receive.
    fn received(&self, tile: Tile, edges: &[bool], lights: &Lights, library: &Library) -> Vec<(usize, Received)> {
        let (mut places, mut sights) = (Vec::with_capacity(TILE * TILE), Vec::with_capacity(TILE * TILE));
        let mut fine = Vec::new();
        for place in tile.places() {
            if edges[place] {
                fine.push(place);
            } else if let Some(sight) = self.sight(place) {
                places.push(place);
                sights.push(sight);
            }
        }
        for (place, sight) in self.fine(&fine) {
            places.push(place);
            sights.push(sight);
        }
        let received = lights.received(&self.origin(), &sights, library, self.eye.pixel_rad);
        let by_ray: Vec<(usize, Received)> = places.into_iter().zip(received).collect();
        let mean = |of_pixel: &[(usize, Received)]| {
            let place = of_pixel[0].0;
            let rays = if edges[place] { FINER * FINER } else { 1 };
            (place, Received::mean(of_pixel.iter().map(|(_, received)| received), rays))
        };
        by_ray.chunk_by(|a, b| a.0 == b.0).map(mean).collect()
    }

    /// What the ray of a pixel sees.
    fn sight(&self, place: usize) -> Option<Sight> {
        Some(Sight { ray: self.turn * self.eye.rays[place]?, hit: self.hits[place]? })
    }

    /// What several rays through each of some pixels see.
    fn fine(&self, places: &[usize]) -> Vec<(usize, Sight)> {
        let rays_of = |place: usize| {
            let corner = [place % self.eye.width(), place / self.eye.width()].map(|along| along as f64 - 0.5);
            (0..FINER * FINER).filter_map(move |part| {
                let within = [part % FINER, part / FINER].map(|along| (along as f64 + 0.5) / FINER as f64);
                Some((place, self.eye.lens.ray([corner[0] + within[0], corner[1] + within[1]])?))
            })
        };
        if places.is_empty() {
            return Vec::new();
        }
        let (places, rays): (Vec<usize>, Vec<Vector3<f64>>) = places.iter().copied().flat_map(rays_of).unzip();
        let turned: Vec<Vector3<f64>> = rays.iter().map(|ray| self.turn * ray).collect();
        let hits = self.world.hits(&self.origin(), &turned, FAR_M);
        let seen = places.into_iter().zip(turned).zip(hits);
        seen.filter_map(|((place, ray), hit)| Some((place, Sight { ray, hit: hit? }))).collect()
    }

    /// Where the camera is.
    fn origin(&self) -> Point3<f64> {
        Point3::from(self.scene_from_optical.translation.vector)
    }

    /// Pixels at which the depth jumps: its second difference is large.
    fn edges(&self) -> Vec<bool> {
        let [width, height] = self.eye.lens.size.map(|side| side as usize);
        let away = |place: usize| self.hits[place].map_or(FAR_M, |hit| hit.distance);
        let jumps = |place: usize, step: usize| {
            let middle = away(place);
            (away(place - step) - 2.0 * middle + away(place + step)).abs() > EDGE * middle
        };
        let is_edge = |place: usize| {
            let (x, y) = (place % width, place / width);
            x > 0 && x + 1 < width && jumps(place, 1) || y > 0 && y + 1 < height && jumps(place, width)
        };
        (0..self.hits.len()).into_par_iter().map(is_edge).collect()
    }
}
