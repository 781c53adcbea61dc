//! Meshes a ball of air, chunk by chunk, and writes its wall as one binary STL.
//!
//! ```text
//! cargo run --release --example sphere_to_stl -- sphere.stl
//! ```

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};

use plume::exporters::format::stl;
use plume::exporters::scene::Mesh;
use plume::field::{Aabb, Analytic};
use plume::mesh::{Grid, MeshSettings, chunk};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "sphere.stl".to_owned());
    // Negative in air, in metres: the inside of a ball with a radius of 5 m.
    let ball = Analytic::new(1.0, |[x, y, z]: [f32; 3]| (x * x + y * y + z * z).sqrt() - 5.0);
    let settings = MeshSettings::default();
    let grid = Grid::new(Aabb { min: [-5.0; 3], max: [5.0; 3] }, &settings)?;
    let chunks = grid.indices().filter_map(|index| chunk(&ball, &grid, index, &settings));
    let walls: Vec<Mesh> = chunks.map(|chunk| Mesh::from(&chunk.visual)).collect();

    let mut file = BufWriter::new(File::create(path)?);
    let triangles: u64 = walls.iter().map(Mesh::triangles).sum();
    stl::write_head(&mut file, "a ball of air, metres, Z up", triangles.try_into()?)?;
    for wall in &walls {
        stl::write_triangles(&mut file, wall)?;
    }
    Ok(file.flush()?)
}
