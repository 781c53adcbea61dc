//! Segments the wall into regions that can be flattened.
//!
//! Every triangle is assigned the axis (of six) that its smoothed surroundings face most, regions are connected triangles
//! with one axis, large ones are tiled for packing, tiny ones join a neighbour. O(triangles). No triangle is projected at a
//! steeper angle than [`MIN_FACING`] allows, so stretch is bounded; regions may still overlap themselves (see
//! [`super::split_overlaps`]).

use std::collections::VecDeque;

use super::adjacency::NONE;
use super::chart::{Axis, Chart, seen_area};
use crate::mesh::Mesh;
use plume_graph::{Aabb, Rows};

/// Minimum cosine between a triangle and its axis. Tuned: lower stretches more, higher frays the charts.
const MIN_FACING: f32 = 0.5;
/// Iterations of smoothing of the triangles' area vectors, and of the vote among neighbours. Tuned.
const SMOOTHING_ROUNDS: usize = 4;
const VOTES: usize = 4;
/// Longest side of a chart as a share of the square root of the area of all charts. Tuned for utilisation; measured
/// best within 0.25–0.4.
const TILE: f64 = 0.3;
/// A region with less than this share of a full tile's area joins a neighbour. Tuned.
const CRUMB: f64 = 1.0 / 40.0;
/// Slivers that only border on slivers are merged in later rounds.
const SWEEPS: usize = 3;

/// The regions of `mesh`, each connected and with one axis.
pub(super) fn charts(mesh: &Mesh, neighbours: &[[u32; 3]]) -> Vec<Chart> {
    let faces = Faces { mesh, neighbours, areas: area_vectors(mesh) };
    let mut axes = faces.axes();
    let tile = TILE * faces.seen_area_of_all(&axes).sqrt();
    let regions = Regions::connected(neighbours, |a, b| axes[a] == axes[b]);
    let cells = faces.tiles(&regions, &axes, tile);
    let mut regions = Regions::connected(neighbours, |a, b| axes[a] == axes[b] && cells[a] == cells[b]);
    for _ in 0..SWEEPS {
        if !faces.sweep(&mut regions, &mut axes, CRUMB * tile * tile) {
            break;
        }
    }
    let groups = regions.triangles();
    groups.iter().map(|group| Chart::new(mesh, axes[group[0] as usize], group.to_vec())).collect()
}

struct Faces<'a> {
    mesh: &'a Mesh,
    neighbours: &'a [[u32; 3]],
    areas: Vec<[f32; 3]>,
}

/// Normal times twice the area of each triangle, in square quanta.
fn area_vectors(mesh: &Mesh) -> Vec<[f32; 3]> {
    let vector = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].map(i64::from));
        let [p, q] = [b, c].map(|end| [end[0] - a[0], end[1] - a[1], end[2] - a[2]]);
        [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            (p[i] * q[j] - p[j] * q[i]) as f32
        })
    };
    mesh.triangles.iter().map(vector).collect()
}

impl Faces<'_> {
    fn axes(&self) -> Vec<Axis> {
        let smooth = self.smoothed_areas();
        let mut axes: Vec<Axis> = (0..smooth.len())
            .map(|t| {
                let wanted = facing(smooth[t]);
                if self.may_be_seen(t, wanted) { wanted } else { facing(self.areas[t]) }
            })
            .collect();
        for _ in 0..VOTES {
            self.vote(&mut axes);
        }
        axes
    }

    fn smoothed_areas(&self) -> Vec<[f32; 3]> {
        let mut areas = self.areas.clone();
        for _ in 0..SMOOTHING_ROUNDS {
            areas = (0..areas.len())
                .map(|t| {
                    let around = self.neighbours[t].iter().filter(|&&n| n != NONE);
                    around.fold(areas[t], |sum, &n| add(sum, areas[n as usize]))
                })
                .collect();
        }
        areas
    }

    fn may_be_seen(&self, triangle: usize, axis: Axis) -> bool {
        let area = self.areas[triangle];
        let length = (area[0] * area[0] + area[1] * area[1] + area[2] * area[2]).sqrt();
        axis.along(area) >= MIN_FACING * length
    }

    /// Each triangle adopts the axis of two neighbours that agree.
    fn vote(&self, axes: &mut [Axis]) {
        for t in 0..axes.len() {
            let around = self.neighbours[t].map(|n| (n != NONE).then(|| axes[n as usize]));
            let [a, b, c] = around;
            let majority = if a == b || a == c {
                a
            } else if b == c {
                b
            } else {
                None
            };
            if let Some(axis) = majority
                && self.may_be_seen(t, axis)
            {
                axes[t] = axis;
            }
        }
    }

    fn seen_area_of_all(&self, axes: &[Axis]) -> f64 {
        (0..axes.len()).map(|t| seen_area(self.mesh, t as u32, axes[t])).sum()
    }

    /// The tile of its region that contains each triangle's centre.
    fn tiles(&self, regions: &Regions, axes: &[Axis], tile: f64) -> Vec<[u16; 2]> {
        let centres: Vec<[i32; 2]> = (0..axes.len()).map(|t| self.tripled_centre(t, axes[t])).collect();
        let mut boxes: Vec<Option<Aabb<i32, 2>>> = vec![None; regions.count as usize];
        for (&p, &region) in centres.iter().zip(&regions.of) {
            let grown = boxes[region as usize].map_or(p.into(), |bounds| bounds.including(p));
            boxes[region as usize] = Some(grown);
        }
        let cell = |p: &[i32; 2], region: u32| {
            let bounds = boxes[region as usize].expect("a region has triangles");
            [0, 1].map(|k| {
                let extent = f64::from(bounds.size()[k]) + 1.0;
                let count = (extent / (3.0 * tile)).ceil();
                (f64::from(p[k] - bounds.min[k]) / extent * count).floor() as u16
            })
        };
        centres.iter().zip(&regions.of).map(|(p, &region)| cell(p, region)).collect()
    }

    fn tripled_centre(&self, triangle: usize, axis: Axis) -> [i32; 2] {
        let corners = self.mesh.triangles[triangle].map(|v| axis.project(self.mesh.positions[v as usize]));
        [0, 1].map(|k| corners[0][k] + corners[1][k] + corners[2][k])
    }

    /// Joins regions smaller than `sliver` (square quanta) to the larger one with which they share most edges, if all their
    /// triangles fit its axis. Returns whether anything changed.
    fn sweep(&self, regions: &mut Regions, axes: &mut [Axis], sliver: f64) -> bool {
        let mut areas = vec![0.0; regions.count as usize];
        for (t, &region) in regions.of.iter().enumerate() {
            areas[region as usize] += seen_area(self.mesh, t as u32, axes[t]);
        }
        let mut changed = false;
        for (region, group) in regions.triangles().iter().enumerate() {
            if areas[region] >= sliver {
                continue;
            }
            let Some(host) = self.host(group, regions, axes, |r| areas[r as usize] >= sliver) else {
                continue;
            };
            for &t in group {
                axes[t as usize] = axes[host as usize];
                regions.of[t as usize] = regions.of[host as usize];
            }
            changed = true;
        }
        if changed {
            regions.renumber();
        }
        changed
    }

    /// A triangle of the region that `group` should join.
    fn host(&self, group: &[u32], regions: &Regions, axes: &[Axis], is_large: impl Fn(u32) -> bool) -> Option<u32> {
        // Few regions touch a sliver: a list beats a map. Each with its shared edges and one of its triangles.
        let mut touching: Vec<(u32, u32, u32)> = vec![];
        for &t in group {
            for &n in self.neighbours[t as usize].iter().filter(|&&n| n != NONE) {
                let region = regions.of[n as usize];
                match touching.iter_mut().find(|entry| entry.0 == region) {
                    Some(entry) => entry.1 += 1,
                    None if is_large(region) => touching.push((region, 1, n)),
                    None => {}
                }
            }
        }
        touching.sort_by_key(|&(region, edges, _)| (u32::MAX - edges, region));
        let welcome = |host: u32| group.iter().all(|&t| self.may_be_seen(t as usize, axes[host as usize]));
        touching.into_iter().map(|(_, _, host)| host).find(|&host| welcome(host))
    }
}

fn facing(vector: [f32; 3]) -> Axis {
    let better = |best: Axis, axis: Axis| {
        if axis.along(vector) > best.along(vector) { axis } else { best }
    };
    Axis::ALL.into_iter().fold(Axis::ALL[0], better)
}

fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// A partition of the triangles, numbered by first triangle.
struct Regions {
    of: Vec<u32>,
    count: u32,
}

impl Regions {
    /// Connected components across edges for which `same` holds.
    fn connected(neighbours: &[[u32; 3]], same: impl Fn(usize, usize) -> bool) -> Self {
        let mut regions = Self { of: vec![NONE; neighbours.len()], count: 0 };
        let mut queue = VecDeque::new();
        for seed in 0..neighbours.len() {
            if regions.of[seed] != NONE {
                continue;
            }
            regions.of[seed] = regions.count;
            queue.push_back(seed);
            while let Some(t) = queue.pop_front() {
                for &n in neighbours[t].iter().filter(|&&n| n != NONE) {
                    let n = n as usize;
                    if regions.of[n] == NONE && same(t, n) {
                        regions.of[n] = regions.count;
                        queue.push_back(n);
                    }
                }
            }
            regions.count += 1;
        }
        regions
    }

    /// The triangles of each region, ascending.
    fn triangles(&self) -> Rows<u32> {
        Rows::from_pairs(self.count as usize, self.of.iter().zip(0..).map(|(&region, t)| (region as usize, t)))
    }

    fn renumber(&mut self) {
        let mut names = vec![NONE; self.count as usize];
        self.count = 0;
        for region in &mut self.of {
            let name = &mut names[*region as usize];
            if *name == NONE {
                *name = self.count;
                self.count += 1;
            }
            *region = *name;
        }
    }
}
