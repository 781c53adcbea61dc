//! What a lidar measures in a sweep, during which it moves.
//!
//! Each point is in the frame of the lidar at the moment at which it was measured, as a real one tells it. Intensity is the albedo of
//! the surface, as luminance of its base colour, times the cosine of the angle of incidence: corrected for range, as most lidars
//! have it, and without speckle. Left out: more than one return, the width of the beam, rain and dust.

use nalgebra::{Point3, Vector3};
use plume_exporters::ExportError;
use plume_graph::rng::Rng;
use plume_graph::seed::stream;
use rayon::prelude::*;

use crate::library::Library;
use crate::maps::Footprint;
use crate::rig::{Lidar, Scan};
use crate::trajectory::Trajectory;
use crate::world::{Hit, World};

/// Width of the spot over which the albedo is averaged, in radians: the divergence of common lidars.
const SPOT_RAD: f32 = 3e-3;
/// Points whose noise comes from one stream.
const BLOCK: usize = 1024;

/// A sweep.
pub struct Sweep {
    /// Number of the lidar.
    pub lidar: usize,
    /// Number of the sweep.
    pub number: u64,
    /// When it begins.
    pub time_ns: i64,
    /// Its points, in the order of their times.
    pub points: Vec<Return>,
}

/// A point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// In the frame of the lidar at its time, in metres.
    pub place: [f32; 3],
    /// Albedo times cosine, 0 to 1.
    pub intensity: f32,
    /// Number of the beam from below; 0 for a rosette.
    pub ring: u16,
    /// Nanoseconds since the beginning of the sweep.
    pub after_ns: u32,
}

impl Return {
    /// Appends x, y, z, intensity, ring and seconds since the beginning of the sweep: 22 bytes, little-endian.
    pub fn append_to(&self, bytes: &mut Vec<u8>) {
        self.place.iter().for_each(|along| bytes.extend(along.to_le_bytes()));
        bytes.extend(self.intensity.to_le_bytes());
        bytes.extend(self.ring.to_le_bytes());
        bytes.extend(((f64::from(self.after_ns) * 1e-9) as f32).to_le_bytes());
    }
}

/// A direction and its moment.
#[derive(Clone, Copy)]
struct Shot {
    after_ns: u32,
    ring: u16,
    ray: Vector3<f64>,
}

/// Where a beam ends.
struct Met {
    shot: Shot,
    /// Its direction in the scene.
    ray: Vector3<f64>,
    hit: Hit,
}

/// Sweep number `number` of lidar `lidar` from `time_ns` on.
///
/// # Errors
/// If the maps of what it sees cannot be read.
pub fn sweep(
    (number, time_ns): (u64, i64),
    (lidar, settings): (usize, &Lidar),
    path: &Trajectory,
    world: &World,
    library: &mut Library,
    seed: u64,
) -> Result<Sweep, ExportError> {
    let shots = shots(settings, number);
    let body_from_lidar = settings.body_from_lidar();
    let meet = |shot: &Shot| {
        let scene_from_lidar = path.at_ns(time_ns + i64::from(shot.after_ns)).pose * body_from_lidar;
        let (origin, ray) = (Point3::from(scene_from_lidar.translation.vector), scene_from_lidar.rotation * shot.ray);
        let hit = world.hit(&origin, &ray, settings.max_m)?;
        (hit.distance >= settings.min_m).then_some(Met { shot: *shot, ray, hit })
    };
    // In blocks, since what neighbours meet is in the cache; points are found in order.
    let met: Vec<Met> = shots.par_chunks(BLOCK).flat_map_iter(|block| block.iter().filter_map(meet)).collect();
    let mut materials: Vec<u32> = met.iter().map(|met| world.kind(met.hit.face).material).collect();
    materials.sort_unstable();
    materials.dedup();
    library.need(&materials)?;
    let library = &*library;
    let name = format!("lidar {}", settings.name);
    let block = |(block, met): (usize, &[Met])| {
        let mut noise = Rng::new(stream(seed, &name, number * 4096 + block as u64));
        let points = met.iter().map(|Met { shot, ray, hit }| {
            let range_m = hit.distance + settings.noise_m * noise.normal();
            let facet = world.facet(hit.face);
            let width = SPOT_RAD * hit.distance as f32 * facet.uv_per_m;
            let footprint = Footprint { width, length: [width, 0.0] };
            let look = library.maps(facet.kind.material).map(|maps| maps.mean(facet.at(hit.weights).uv, footprint));
            let albedo = look.map_or(0.0, |look| luminance(look.color));
            Return {
                place: (shot.ray * range_m).cast::<f32>().into(),
                intensity: albedo * facet.flat_normal.dot(ray).abs() as f32,
                ring: shot.ring,
                after_ns: shot.after_ns,
            }
        });
        points.collect::<Vec<_>>()
    };
    let points = met.par_chunks(BLOCK).enumerate().flat_map_iter(block).collect();
    Ok(Sweep { lidar, number, time_ns, points })
}

/// Where its beams go during a sweep.
fn shots(lidar: &Lidar, number: u64) -> Vec<Shot> {
    let sweep_ns = 1e9 / lidar.rate_hz;
    match lidar.scan {
        Scan::Spinning { beams, lowest_deg, highest_deg, columns } => {
            let step = (highest_deg - lowest_deg).to_radians() / f64::from(beams.max(2) - 1);
            let elevation = |ring: u32| lowest_deg.to_radians() + f64::from(ring) * step;
            let column = |column: u32| {
                let share = f64::from(column) / f64::from(columns);
                let azimuth = share * std::f64::consts::TAU;
                (0..beams).map(move |ring| Shot {
                    after_ns: (share * sweep_ns) as u32,
                    ring: ring as u16,
                    ray: direction(azimuth, elevation(ring)),
                })
            };
            (0..columns).flat_map(column).collect()
        }
        Scan::Rosette { cone_deg, points, prisms_hz } => {
            let half = 0.25 * cone_deg.to_radians();
            let shot = |point: u32| {
                let after_ns = f64::from(point) / f64::from(points) * sweep_ns;
                let time_s = number as f64 / lidar.rate_hz + after_ns * 1e-9;
                // Thin prisms add up: each bends the beam by a quarter of the cone towards where its thick side is.
                let turns = prisms_hz.map(|hz| {
                    let turns = hz * time_s;
                    (turns - turns.floor()) * std::f64::consts::TAU
                });
                let left = half * (libm::cos(turns[0]) + libm::cos(turns[1]));
                let up = half * (libm::sin(turns[0]) + libm::sin(turns[1]));
                let angle = libm::hypot(left, up);
                let share = if angle > 0.0 { libm::sin(angle) / angle } else { 1.0 };
                let ray = Vector3::new(libm::cos(angle), left * share, up * share);
                Shot { after_ns: after_ns as u32, ring: 0, ray }
            };
            (0..points).map(shot).collect()
        }
    }
}

fn direction(azimuth: f64, elevation: f64) -> Vector3<f64> {
    let across = libm::cos(elevation);
    Vector3::new(across * libm::cos(azimuth), across * libm::sin(azimuth), libm::sin(elevation))
}

/// Of linear colours of sRGB's primaries.
fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lidar(scan: Scan) -> Lidar {
        Lidar { scan, ..crate::rig::Rig::preset("rgbd").unwrap().lidars[0].clone() }
    }

    #[test]
    fn a_spinning_lidar_covers_its_band() {
        let spinning = lidar(Scan::Spinning { beams: 16, lowest_deg: -15.0, highest_deg: 15.0, columns: 8 });
        let shots = shots(&spinning, 3);
        assert_eq!(shots.len(), 16 * 8);
        assert!((shots[0].ray.z - libm::sin(-15_f64.to_radians())).abs() < 1e-12);
        assert!((shots[15].ray.z - libm::sin(15_f64.to_radians())).abs() < 1e-12);
        assert!(shots[2 * 16 + 8].ray.y > 0.99 * libm::cos(1_f64.to_radians()), "a quarter of a turn is left");
        assert_eq!(shots[16].after_ns, 12_500_000);
    }

    #[test]
    fn a_rosette_stays_in_its_cone_and_does_not_repeat() {
        let rosette = lidar(Scan::Rosette { cone_deg: 70.0, points: 2000, prisms_hz: Scan::usual_prisms_hz() });
        let [first, second] = [0, 1].map(|number| shots(&rosette, number));
        let edge = libm::cos(35_f64.to_radians());
        assert!(first.iter().all(|shot| shot.ray.x >= edge - 1e-9));
        assert!(first.iter().any(|shot| shot.ray.x < edge + 0.01) && first.iter().any(|shot| shot.ray.x > 0.999));
        let nearest = |ray: &Vector3<f64>| second.iter().map(|other| (other.ray - ray).norm()).fold(f64::MAX, f64::min);
        let repeated = first.iter().filter(|shot| nearest(&shot.ray) < 1e-4).count();
        assert!(repeated < first.len() / 50, "{repeated}");
    }
}
