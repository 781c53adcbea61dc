//! Triangles with their attributes.

use std::io::{Seek, Write};

use nalgebra::Vector3;

use super::node::{Nodes, Value, Written};
use crate::frame::{self, Up};
use crate::scene::Mesh;

/// The name of the texture coordinates, to which textures refer.
pub const UV_SET: &str = "UVMap";

/// Writes the body of a geometry; missing attributes are omitted. Numbers are converted to `f64` one by one.
pub fn write<W: Write + Seek>(nodes: &mut Nodes<W>, mesh: &Mesh, up: Up) -> Written {
    nodes.properties(&[])?;
    nodes.leaf("GeometryVersion", &[Value::Int(124)])?;
    nodes.reals("Vertices", 3 * mesh.positions.len(), mesh.positions.iter().flat_map(|&point| real(up, point)))?;
    nodes.ints("PolygonVertexIndex", mesh.indices.len(), corners(mesh))?;
    if mesh.normals.is_empty() {
        return Ok(());
    }
    by_vertex(nodes, "Normal", mesh.normals.iter().map(|&normal| real(up, normal)))?;
    by_vertex(nodes, "Tangent", mesh.tangents.iter().map(|&[x, y, z, _]| real(up, [x, y, z])))?;
    by_vertex(nodes, "Binormal", binormals(mesh, up))?;
    write_uvs(nodes, mesh)?;
    layer(nodes, "Material", "", ["AllSame", "IndexToDirect"], |nodes| nodes.ints("Materials", 1, std::iter::once(0)))?;
    write_layer(nodes)
}

fn real(up: Up, vector: [f32; 3]) -> [f64; 3] {
    let vector = vector.map(f64::from);
    match up {
        Up::Z => vector,
        Up::Y => frame::gltf_from_scene(vector),
    }
}

/// FBX marks the last corner of a polygon by its complement.
fn corners(mesh: &Mesh) -> impl Iterator<Item = i32> {
    let (corners, _) = mesh.indices.as_chunks::<3>();
    corners.iter().flat_map(|&[a, b, c]| [a as i32, b as i32, !(c as i32)])
}

/// Along +v of the image.
fn binormals(mesh: &Mesh, up: Up) -> impl ExactSizeIterator<Item = [f64; 3]> {
    mesh.normals.iter().zip(&mesh.tangents).map(move |(&normal, &[x, y, z, w])| {
        let across = Vector3::from(real(up, normal)).cross(&Vector3::from(real(up, [x, y, z])));
        (across * f64::from(w)).into()
    })
}

fn by_vertex<W: Write + Seek>(
    nodes: &mut Nodes<W>,
    element: &str,
    vectors: impl ExactSizeIterator<Item = [f64; 3]>,
) -> Written {
    layer(nodes, element, "", ["ByVertice", "Direct"], |nodes| {
        nodes.reals(&format!("{element}s"), 3 * vectors.len(), vectors.flatten())
    })
}

/// Per corner, because that is where readers look for them first.
fn write_uvs<W: Write + Seek>(nodes: &mut Nodes<W>, mesh: &Mesh) -> Written {
    layer(nodes, "UV", UV_SET, ["ByPolygonVertex", "IndexToDirect"], |nodes| {
        nodes.reals("UV", 2 * mesh.uvs.len(), mesh.uvs.iter().flatten().map(|&part| part.into()))?;
        nodes.ints("UVIndex", mesh.indices.len(), mesh.indices.iter().map(|&corner| corner as i32))
    })
}

fn layer<W: Write + Seek>(
    nodes: &mut Nodes<W>,
    element: &str,
    name: &str,
    [mapping, reference]: [&str; 2],
    fill: impl FnOnce(&mut Nodes<W>) -> Written,
) -> Written {
    nodes.branch(&format!("LayerElement{element}"), &[Value::Int(0)], |nodes| {
        nodes.leaf("Version", &[Value::Int(101)])?;
        nodes.leaf("Name", &[Value::Text(name)])?;
        nodes.leaf("MappingInformationType", &[Value::Text(mapping)])?;
        nodes.leaf("ReferenceInformationType", &[Value::Text(reference)])?;
        fill(nodes)
    })
}

/// Lists all elements as one layer.
fn write_layer<W: Write + Seek>(nodes: &mut Nodes<W>) -> Written {
    nodes.branch("Layer", &[Value::Int(0)], |nodes| {
        nodes.leaf("Version", &[Value::Int(100)])?;
        ["Normal", "Tangent", "Binormal", "UV", "Material"].iter().try_for_each(|element| {
            nodes.branch("LayerElement", &[], |nodes| {
                nodes.leaf("Type", &[Value::Text(&format!("LayerElement{element}"))])?;
                nodes.leaf("TypedIndex", &[Value::Int(0)])
            })
        })
    })
}
