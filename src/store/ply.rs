//! Meshes as binary PLY, which most mesh tools support.
//!
//! Vertices have `x y z` and, where present, `nx ny nz`, `s t` (origin at the lower left of the image), the tangent
//! `tx ty tz tw`, and `border` (1 where the vertex is shared with another chunk).

use std::io::{self, BufRead, Write};

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{
    Addable, BeginList, ElementDef, Encoding, Header, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

const NAMES: [&str; 12] = ["x", "y", "z", "nx", "ny", "nz", "s", "t", "tx", "ty", "tz", "tw"];

/// A mesh in a file. Attribute arrays are empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyMesh {
    /// Vertices, m.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, origin at the lower left.
    pub uvs: Vec<[f32; 2]>,
    /// Tangents and handedness.
    pub tangents: Vec<[f32; 4]>,
    /// Whether the vertex is shared with another chunk.
    pub border: Vec<bool>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

/// One row of either element: a vertex uses `floats` and `border`, a face uses `indices`.
#[derive(Default)]
struct Row {
    floats: [f32; 12],
    border: u8,
    indices: Vec<u32>,
}

fn slot(name: &str) -> Option<usize> {
    NAMES.iter().position(|n| *n == name)
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        let Some(slot) = slot(name) else {
            return PropertyAccessResult::UnsupportedType;
        };
        self.floats[slot] = value;
        PropertyAccessResult::Set
    }

    fn set_uchar(&mut self, _name: &str, value: u8) -> PropertyAccessResult {
        self.border = value;
        PropertyAccessResult::Set
    }

    fn begin_list_uint(&mut self, _name: &str, _len: usize) -> BeginList<'_, u32> {
        BeginList::Fill(&mut self.indices)
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        slot(name).map(|slot| self.floats[slot])
    }

    fn get_uchar(&self, _name: &str) -> Option<u8> {
        Some(self.border)
    }

    fn get_list_uint(&self, _name: &str) -> Option<&[u32]> {
        Some(&self.indices)
    }
}

impl PlyMesh {
    /// Writes the mesh.
    ///
    /// # Errors
    /// If `out` fails.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let (vertex, face) = (self.vertex_definition(), self.face_definition());
        let mut header = Header::new();
        header.encoding = Encoding::BinaryLittleEndian;
        header.comments.push("Plume: metres, right-handed, Z up".into());
        header.elements.add(vertex.clone());
        header.elements.add(face.clone());
        let writer = Writer::<Row>::new();
        let mut out = out;
        writer.write_header(&mut out, &header)?;
        let mut row = Row::default();
        for i in 0..self.positions.len() {
            self.fill(&mut row, i);
            writer.write_little_endian_element(&mut out, &row, &vertex)?;
        }
        for triangle in &self.triangles {
            row.indices.clear();
            row.indices.extend(triangle);
            writer.write_little_endian_element(&mut out, &row, &face)?;
        }
        Ok(())
    }

    /// Reads what [`PlyMesh::write`] wrote.
    ///
    /// # Errors
    /// If it is not such a file.
    pub fn read(source: &mut dyn BufRead) -> io::Result<Self> {
        let mut source = source;
        let ply = Parser::<Row>::new().read_ply(&mut source)?;
        let rows = |name: &str| ply.payload.get(name).map(Vec::as_slice).unwrap_or_default();
        let vertex = ply.header.elements.get("vertex");
        let has = |name: &str| vertex.is_some_and(|v| v.properties.contains_key(name));
        let vertices = rows("vertex");
        let mut mesh = Self { positions: column(vertices, 0), ..Self::default() };
        if has("nx") {
            mesh.normals = column(vertices, 3);
        }
        if has("s") {
            mesh.uvs = column(vertices, 6);
        }
        if has("tx") {
            mesh.tangents = column(vertices, 8);
        }
        if has("border") {
            mesh.border = vertices.iter().map(|row| row.border == 1).collect();
        }
        let triangle = |row: &Row| row.indices.as_slice().try_into().ok();
        let triangles: Option<Vec<[u32; 3]>> = rows("face").iter().map(triangle).collect();
        mesh.triangles = triangles.ok_or_else(|| io::Error::other("a face is not a triangle"))?;
        let count = mesh.positions.len() as u32;
        if mesh.triangles.iter().flatten().any(|index| *index >= count) {
            return Err(io::Error::other("a face refers to a vertex that does not exist"));
        }
        Ok(mesh)
    }

    fn vertex_definition(&self) -> ElementDef {
        let mut vertex = ElementDef::new("vertex".into());
        vertex.count = self.positions.len();
        let widths = [3, 3 * present(&self.normals), 2 * present(&self.uvs), 4 * present(&self.tangents)];
        let starts = [0, 3, 6, 8];
        for (start, width) in starts.into_iter().zip(widths) {
            for name in &NAMES[start..start + width] {
                vertex.properties.add(PropertyDef::new((*name).into(), PropertyType::Scalar(ScalarType::Float)));
            }
        }
        if !self.border.is_empty() {
            vertex.properties.add(PropertyDef::new("border".into(), PropertyType::Scalar(ScalarType::UChar)));
        }
        vertex
    }

    fn face_definition(&self) -> ElementDef {
        let mut face = ElementDef::new("face".into());
        face.count = self.triangles.len();
        let list = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
        face.properties.add(PropertyDef::new("vertex_indices".into(), list));
        face
    }

    fn fill(&self, row: &mut Row, i: usize) {
        row.floats[..3].copy_from_slice(&self.positions[i]);
        if let Some(normal) = self.normals.get(i) {
            row.floats[3..6].copy_from_slice(normal);
        }
        if let Some(uv) = self.uvs.get(i) {
            row.floats[6..8].copy_from_slice(uv);
        }
        if let Some(tangent) = self.tangents.get(i) {
            row.floats[8..].copy_from_slice(tangent);
        }
        row.border = self.border.get(i).copied().unwrap_or_default().into();
    }
}

fn present<T>(attribute: &[T]) -> usize {
    usize::from(!attribute.is_empty())
}

/// `N` consecutive floats of every row.
fn column<const N: usize>(rows: &[Row], start: usize) -> Vec<[f32; N]> {
    rows.iter().map(|row| std::array::from_fn(|i| row.floats[start + i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_reads_back_unchanged() {
        let mesh = PlyMesh {
            positions: vec![[0.0, 0.5, -1.25], [1.0, 0.0, 0.0], [0.0, 1.0, 3.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            uvs: vec![[0.0, 1.0], [0.25, 0.5], [1.0, 0.0]],
            tangents: vec![[1.0, 0.0, 0.0, -1.0]; 3],
            border: vec![true, false, true],
            triangles: vec![[0, 1, 2]],
        };
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).unwrap();
        assert_eq!(PlyMesh::read(&mut bytes.as_slice()).unwrap(), mesh);
    }

    #[test]
    fn a_face_outside_the_mesh_is_refused() {
        let mesh = PlyMesh { positions: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 3]], ..PlyMesh::default() };
        let mut bytes = Vec::new();
        mesh.write(&mut bytes).unwrap();
        assert!(PlyMesh::read(&mut bytes.as_slice()).is_err());
    }
}
