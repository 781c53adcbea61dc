//! The clouds: the same points in three formats.

use std::io;
use std::path::Path;

use plume_truth::samples;
use sha2::{Digest, Sha256};

use super::Part;
use super::table::{Entry, Table};
use crate::chunk_files::{Stem, TempFile};
use crate::error::ExportError;
use crate::format::points::{self, Point};
use crate::format::{las, pcd, ply};
use crate::labels;
use crate::package::Package;
use crate::scene::{Mesh, Scene, Zone};
use crate::slope;

/// A cloud that grows on the disk.
pub struct Cloud {
    per_m2: f64,
    seed: u64,
    rows: TempFile,
    points: u64,
    /// Number of things so far.
    things: u32,
    bounds_m: [[f32; 3]; 2],
}

impl Cloud {
    /// An empty cloud of so many points per square metre.
    pub fn new(seed: u64, per_m2: f64, scratch: &Path) -> Result<Self, ExportError> {
        let rows = Stem::new("cloud", scratch).grow(".rows")?;
        let bounds_m = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        Ok(Self { per_m2, seed, rows, points: 0, things: 0, bounds_m })
    }

    /// Adds points on a chunk, given the labels of its triangles and the number of triangles of each of its things, in its order.
    pub fn add(&mut self, index: usize, mesh: &Mesh, labels: &[u8], things: &[usize]) -> io::Result<()> {
        let normals = slope::face_normals(mesh);
        let thing_of: Vec<u32> =
            (self.things + 1..).zip(things).flat_map(|(thing, count)| std::iter::repeat_n(thing, *count)).collect();
        self.things += things.len() as u32;
        for sample in samples(&mesh.positions, &mesh.indices, self.per_m2, self.stream(index)) {
            let point = Point {
                position: sample.at_m,
                normal: normals[sample.triangle],
                label: labels[sample.triangle].into(),
                chunk: index as u32,
                thing: thing_of.get(sample.triangle).copied().unwrap_or(0),
            };
            point.write(&mut self.rows)?;
            self.points += 1;
            for (axis, along_m) in sample.at_m.into_iter().enumerate() {
                self.bounds_m[0][axis] = self.bounds_m[0][axis].min(along_m);
                self.bounds_m[1][axis] = self.bounds_m[1][axis].max(along_m);
            }
        }
        Ok(())
    }

    /// The random stream of a chunk.
    fn stream(&self, index: usize) -> [u8; 32] {
        let mut hash = Sha256::new();
        hash.update(self.seed.to_le_bytes());
        hash.update((index as u64).to_le_bytes());
        hash.update("cloud");
        hash.finalize().into()
    }

    /// Writes the files of these parts.
    pub fn write(
        mut self,
        scene: &Scene,
        parts: &[Part],
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let points = self.points;
        let comment = format!("{}, made by {}: metres, right-handed, Z up", scene.name, scene.generator);
        if parts.contains(&Part::Ply) {
            let element = ply::Element { name: "vertex", count: points, properties: &points::PLY };
            out.write("cloud.ply", |file| {
                ply::write_head(file, std::slice::from_ref(&comment), &[element])?;
                Ok(io::copy(&mut self.rows.reader()?, file).map(drop)?)
            })?;
        }
        if parts.contains(&Part::Pcd) {
            out.write("cloud.pcd", |file| {
                pcd::write_head(file, &comment, points)?;
                Ok(io::copy(&mut self.rows.reader()?, file).map(drop)?)
            })?;
        }
        if parts.contains(&Part::Las) {
            let ground = u32::from(labels::of_zone(Zone::Floor));
            let bounds_m = if points == 0 { [[0.0; 3]; 2] } else { self.bounds_m };
            let head = las::Head { generator: &scene.generator, points, bounds_m, ground };
            out.write("cloud.las", |file| {
                let mut rows = self.rows.reader()?;
                Ok(las::write(file, &head, (0..points).map(|_| Point::read(&mut rows)))?)
            })?;
        }
        for (part, file) in [(Part::Ply, "cloud.ply"), (Part::Pcd, "cloud.pcd"), (Part::Las, "cloud.las")] {
            if parts.contains(&part) {
                table.add(Entry::of_points(file, CONTENT, self.per_m2));
            }
        }
        Ok(())
    }
}

const CONTENT: &str = "points on the surface, each with its normal, label, chunk and thing";
