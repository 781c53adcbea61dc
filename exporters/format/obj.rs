//! Wavefront OBJ with its material library: Z up, metres, UV origin at the lower left.
//!
//! Positions are printed with the fewest digits that give back the same `f32`, so neighbouring chunks still share
//! their border vertices exactly. Normals have 4 decimals and texture coordinates 6 (a 500th of a texel of 2048).
//! PBR keys follow <http://exocortex.com/blog/extending_wavefront_mtl_to_support_pbr>; other readers see the base colour.
//! Normals are not also written as `map_Bump`, the only such key that Blender reads: Blender takes them for sRGB colours
//! there, others for heights, and wrong normals look worse than none.
//!
//! ```
//! use plume_exporters::format::obj;
//! use plume_exporters::scene::Mesh;
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = Mesh { positions, indices: vec![0, 1, 2], ..Mesh::default() };
//! let mut file = Vec::new();
//! obj::write_collision(&mut file, "floor", &mesh, 0)?;
//! assert!(String::from_utf8_lossy(&file).contains("f 1//1 2//2 3//3"));
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

use nalgebra::Vector3;

use crate::scene::Mesh;

/// Files that a material names, relative to the material library.
pub struct Maps<'a> {
    /// Base colour.
    pub base_color: &'a str,
    /// Tangent-space normals.
    pub normal: &'a str,
    /// Roughness.
    pub roughness: &'a str,
}

/// Names the file of the materials, relative to this one.
///
/// # Errors
/// Those of `file`.
pub fn write_library(file: &mut dyn Write, library: &str) -> io::Result<()> {
    writeln!(file, "mtllib {library}")
}

/// Writes an object with normals and texture coordinates that uses a material of the library; `before` is the number of
/// vertices already in the file.
///
/// # Errors
/// Those of `file`.
pub fn write_visual(file: &mut dyn Write, name: &str, material: &str, mesh: &Mesh, before: u64) -> io::Result<()> {
    writeln!(file, "o {name}")?;
    write_positions(file, mesh)?;
    let mut line = Vec::new();
    for uv in &mesh.uvs {
        write_fixed(file, &mut line, "vt", uv, 1_000_000)?;
    }
    for normal in &mesh.normals {
        write_fixed(file, &mut line, "vn", normal, 10_000)?;
    }
    writeln!(file, "usemtl {material}")?;
    for [a, b, c] in corners(mesh, before) {
        writeln!(file, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?;
    }
    Ok(())
}

/// Writes each mesh with [`write_collision`], as a separate object.
///
/// # Errors
/// Those of `file`.
pub fn write_pieces(file: &mut dyn Write, name: &str, meshes: &[&Mesh]) -> io::Result<()> {
    let mut before = 0;
    for (number, mesh) in meshes.iter().enumerate() {
        write_collision(file, &format!("{name}_{number}"), mesh, before)?;
        before += mesh.positions.len() as u64;
    }
    Ok(())
}

/// Writes an object of positions and triangles, with normals of the triangles only because Gazebo's DART engine silently
/// drops a collision mesh without them; `before` is the number of vertices already in the file.
///
/// # Errors
/// Those of `file`.
pub fn write_collision(file: &mut dyn Write, name: &str, mesh: &Mesh, before: u64) -> io::Result<()> {
    writeln!(file, "o {name}")?;
    write_positions(file, mesh)?;
    let mut line = Vec::new();
    for normal in vertex_normals(mesh) {
        write_fixed(file, &mut line, "vn", &normal, 10_000)?;
    }
    for [a, b, c] in corners(mesh, before) {
        writeln!(file, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    Ok(())
}

/// Writes a material library with the one material `name`.
///
/// # Errors
/// Those of `file`.
pub fn write_material(file: &mut dyn Write, name: &str, maps: &Maps) -> io::Result<()> {
    writeln!(file, "newmtl {name}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nPr 1\nPm 0\nillum 2")?;
    writeln!(file, "map_Kd {}\nnorm {}\nmap_Pr {}", maps.base_color, maps.normal, maps.roughness)
}

/// Adds a displacement to the material: black is `-amplitude_m`, white is `amplitude_m`.
///
/// # Errors
/// Those of `file`.
pub fn write_displacement(file: &mut dyn Write, height: &str, amplitude_m: f32) -> io::Result<()> {
    writeln!(file, "disp -mm {} {} {height}", -amplitude_m, 2.0 * amplitude_m)
}

fn write_positions(file: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    for [x, y, z] in &mesh.positions {
        writeln!(file, "v {x} {y} {z}")?;
    }
    Ok(())
}

/// Area-weighted mean normals of the triangles at each vertex; up where they cancel.
fn vertex_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![Vector3::zeros(); mesh.positions.len()];
    for corners in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| Vector3::from(mesh.positions[corners[i] as usize]));
        let normal = (b - a).cross(&(c - a));
        corners.iter().for_each(|&corner| sums[corner as usize] += normal);
    }
    sums.iter().map(|sum| sum.try_normalize(0.0).unwrap_or_else(Vector3::z).into()).collect()
}

/// OBJ counts from one, through the whole file.
fn corners(mesh: &Mesh, before: u64) -> impl Iterator<Item = [u64; 3]> {
    mesh.indices.chunks_exact(3).map(move |corner| [0, 1, 2].map(|i| before + u64::from(corner[i]) + 1))
}

fn write_fixed(file: &mut dyn Write, line: &mut Vec<u8>, key: &str, numbers: &[f32], scale: u32) -> io::Result<()> {
    line.clear();
    line.extend_from_slice(key.as_bytes());
    for &number in numbers {
        line.push(b' ');
        push_fixed(line, number, scale);
    }
    line.push(b'\n');
    file.write_all(line)
}

/// Writes a number with a fixed number of decimals (`scale` is a power of ten); three times as fast as printing the float.
fn push_fixed(line: &mut Vec<u8>, number: f32, scale: u32) {
    let parts = (f64::from(number.abs()) * f64::from(scale) + 0.5) as u64;
    if number < 0.0 && parts > 0 {
        line.push(b'-');
    }
    let scale = u64::from(scale);
    push_integer(line, parts / scale);
    let (mut rest, mut unit) = (parts % scale, scale / 10);
    if rest > 0 {
        line.push(b'.');
    }
    while rest > 0 {
        line.push(b'0' + (rest / unit) as u8);
        (rest, unit) = (rest % unit, unit / 10);
    }
}

fn push_integer(line: &mut Vec<u8>, number: u64) {
    if number >= 10 {
        push_integer(line, number / 10);
    }
    line.push(b'0' + (number % 10) as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_numbers() {
        for (number, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.25, "0.25"),
            (-1.0, "-1"),
            (0.000_06, "0.0001"),
            (-0.000_01, "0"),
            (0.999_96, "1"),
            (12.0625, "12.0625"),
            (-0.123_456, "-0.1235"),
        ] {
            let mut line = Vec::new();
            push_fixed(&mut line, number, 10_000);
            assert_eq!(String::from_utf8(line).unwrap(), text);
        }
    }

    #[test]
    fn positions_come_back_bit_for_bit() {
        let positions: Vec<[f32; 3]> =
            (0..999_u16).map(|i| [1, 7, 1001].map(|k| f32::from(i) * k as f32 / 4096.0)).collect();
        let mesh = Mesh { positions: positions.clone(), indices: vec![0, 1, 2], ..Mesh::default() };
        let mut text = Vec::new();
        write_collision(&mut text, "rock", &mesh, 0).unwrap();
        let text = String::from_utf8(text).unwrap();
        let read: Vec<f32> = text
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .flat_map(|line| line.split(' ').map(|number| number.parse::<f32>().unwrap()))
            .collect();
        assert_eq!(read, positions.concat());
    }
}
