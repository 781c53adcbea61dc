//! Convex pieces as binary PLY: faces have the number of their piece (`piece`) and its zone (`zone`: 0 floor, 1 wall, 2
//! ceiling). Pieces do not share vertices.

use std::io::{self, Write};

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{
    Addable, BeginList, ElementDef, Encoding, Header, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use ply_rs_bw::writer::Writer;

use super::{CaveFolder, FileRecord, StoreError, pieces_path};
use crate::mesh::{Piece, QUANTA_PER_M, Zone};

/// Writes the convex pieces of a chunk.
///
/// # Errors
/// If the disk fails.
pub fn write_pieces(folder: &CaveFolder, name: &str, pieces: &[Piece]) -> Result<FileRecord, StoreError> {
    folder.write(&pieces_path(name), |out| write(pieces, out))
}

/// Reads the convex pieces of a chunk back, bit for bit.
///
/// # Errors
/// If they are missing or damaged.
pub fn read_pieces(folder: &CaveFolder, name: &str) -> Result<Vec<Piece>, StoreError> {
    let path = pieces_path(name);
    let content = folder.read(&path)?;
    read(&mut content.as_slice()).map_err(|error| StoreError::damaged(&folder.root().join(path), error))
}

/// One row of either element: a vertex uses `at`, a face the others.
#[derive(Default)]
struct Row {
    at: [f32; 3],
    indices: Vec<u32>,
    piece: u32,
    zone: u8,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        let Some(axis) = AXES.iter().position(|axis| *axis == name) else {
            return PropertyAccessResult::UnsupportedType;
        };
        self.at[axis] = value;
        PropertyAccessResult::Set
    }

    fn set_uint(&mut self, _name: &str, value: u32) -> PropertyAccessResult {
        self.piece = value;
        PropertyAccessResult::Set
    }

    fn set_uchar(&mut self, _name: &str, value: u8) -> PropertyAccessResult {
        self.zone = value;
        PropertyAccessResult::Set
    }

    fn begin_list_uint(&mut self, _name: &str, _len: usize) -> BeginList<'_, u32> {
        BeginList::Fill(&mut self.indices)
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        AXES.iter().position(|axis| *axis == name).map(|axis| self.at[axis])
    }

    fn get_uint(&self, _name: &str) -> Option<u32> {
        Some(self.piece)
    }

    fn get_uchar(&self, _name: &str) -> Option<u8> {
        Some(self.zone)
    }

    fn get_list_uint(&self, _name: &str) -> Option<&[u32]> {
        Some(&self.indices)
    }
}

fn write(pieces: &[Piece], out: &mut dyn Write) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".into());
    vertex.count = pieces.iter().map(|piece| piece.positions.len()).sum();
    for axis in AXES {
        vertex.properties.add(PropertyDef::new(axis.into(), PropertyType::Scalar(ScalarType::Float)));
    }
    let mut face = ElementDef::new("face".into());
    face.count = pieces.iter().map(|piece| piece.triangles.len()).sum();
    let list = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
    face.properties.add(PropertyDef::new("vertex_indices".into(), list));
    face.properties.add(PropertyDef::new("piece".into(), PropertyType::Scalar(ScalarType::UInt)));
    face.properties.add(PropertyDef::new("zone".into(), PropertyType::Scalar(ScalarType::UChar)));
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.comments.push("Plume: convex pieces, metres, right-handed, Z up".into());
    header.elements.add(vertex.clone());
    header.elements.add(face.clone());

    let writer = Writer::<Row>::new();
    let mut out = out;
    writer.write_header(&mut out, &header)?;
    let mut row = Row::default();
    for position in pieces.iter().flat_map(|piece| &piece.positions) {
        row.at = position.map(|q| q as f32 / QUANTA_PER_M as f32);
        writer.write_little_endian_element(&mut out, &row, &vertex)?;
    }
    let mut first = 0;
    for (number, piece) in pieces.iter().enumerate() {
        (row.piece, row.zone) = (number as u32, piece.zone as u8);
        for triangle in &piece.triangles {
            row.indices.clear();
            row.indices.extend(triangle.map(|corner| corner + first));
            writer.write_little_endian_element(&mut out, &row, &face)?;
        }
        first += piece.positions.len() as u32;
    }
    Ok(())
}

fn read(source: &mut dyn io::BufRead) -> io::Result<Vec<Piece>> {
    let mut source = source;
    let ply = Parser::<Row>::new().read_ply(&mut source)?;
    let rows = |name: &str| ply.payload.get(name).map(Vec::as_slice).unwrap_or_default();
    let vertices = rows("vertex");
    let mut pieces = Vec::new();
    let mut first = 0;
    for faces in rows("face").chunk_by(|a, b| a.piece == b.piece) {
        let piece = piece(faces, first, vertices).ok_or_else(|| io::Error::other("a piece is incomplete"))?;
        first += piece.positions.len() as u32;
        pieces.push(piece);
    }
    Ok(pieces)
}

/// The piece with these faces, whose vertices begin with `first`.
fn piece(faces: &[Row], first: u32, vertices: &[Row]) -> Option<Piece> {
    let local = |row: &Row| {
        let corners: [u32; 3] = row.indices.as_slice().try_into().ok()?;
        corners.iter().all(|&corner| corner >= first).then(|| corners.map(|corner| corner - first))
    };
    let triangles: Vec<[u32; 3]> = faces.iter().map(local).collect::<Option<_>>()?;
    let count = triangles.iter().flatten().max()? + 1;
    let own = vertices.get(first as usize..(first + count) as usize)?;
    let quantum = |metres: f32| (metres * QUANTA_PER_M as f32) as i32;
    let zone = *Zone::ALL.get(usize::from(faces.first()?.zone))?;
    Some(Piece { positions: own.iter().map(|row| row.at.map(quantum)).collect(), triangles, zone })
}
