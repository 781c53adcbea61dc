//! LAS 1.4 point clouds: point format 6, with what else is known of a point in extra bytes.
//!
//! Follows the LAS 1.4 R15 specification of the ASPRS, <https://github.com/ASPRSorg/LAS>. Coordinates are rounded to a tenth of a
//! millimetre. The crate `las` is not used: its writer panics where the disk is full, and what is left of it is this.

use std::io::{self, Write};

use super::points::Point;

/// What a step of a coordinate is, in metres.
const STEP_M: f64 = 1e-4;

/// Bytes of the header, of the head of a variable length record, and of a description of extra bytes.
const HEADER: usize = 375;
const RECORD_HEAD: usize = 54;
const DESCRIPTION: usize = 192;

/// Bytes of a point without and with the extra ones.
const PLAIN: usize = 30;
const POINT: usize = PLAIN + 21;

/// The extra bytes of a point: name, code of the type, meaning.
const EXTRA: [(&str, u8, &str); 6] = [
    ("NormalX", FLOAT, "unit normal"),
    ("NormalY", FLOAT, "unit normal"),
    ("NormalZ", FLOAT, "unit normal"),
    ("label", BYTE, "see labels.json"),
    ("chunk", LONG, "number in manifest.json"),
    ("thing", LONG, "number in instances.json, or 0"),
];
const BYTE: u8 = 1;
const LONG: u8 = 5;
const FLOAT: u8 = 9;

/// The classes of LAS: there is one for the floor, and none for anything else that is in the clouds.
const UNCLASSIFIED: u8 = 1;
const GROUND: u8 = 2;

/// What is known of a cloud before its points are written.
pub struct Head<'a> {
    /// What made it.
    pub generator: &'a str,
    /// Number of points.
    pub points: u64,
    /// Lowest and highest coordinates in metres.
    pub bounds_m: [[f32; 3]; 2],
    /// The label that is ground.
    pub ground: u32,
}

/// Writes a cloud; as many points as its head says.
///
/// # Errors
/// Those of `file` and of the points.
pub fn write(file: &mut dyn Write, head: &Head, mut points: impl Iterator<Item = io::Result<Point>>) -> io::Result<()> {
    file.write_all(&header(head))?;
    file.write_all(&record_of_extra())?;
    points.try_for_each(|point| file.write_all(&record(&point?, head.ground)))
}

fn header(head: &Head) -> [u8; HEADER] {
    /// What formats from 6 on must state: a reference system would be in WKT.
    const IS_WKT: u16 = 1 << 4;
    let mut header = [0; HEADER];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    put(6, &IS_WKT.to_le_bytes());
    put(24, &[1, 4]);
    put(26, b"OTHER");
    put(58, &head.generator.as_bytes()[..head.generator.len().min(31)]);
    put(94, &(HEADER as u16).to_le_bytes());
    put(96, &((HEADER + RECORD_HEAD + EXTRA.len() * DESCRIPTION) as u32).to_le_bytes());
    put(100, &1_u32.to_le_bytes());
    put(104, &[6]);
    put(105, &(POINT as u16).to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &STEP_M.to_le_bytes());
        let [low, high] = head.bounds_m.map(|corner| f64::from(steps(corner[axis])) * STEP_M);
        put(179 + 16 * axis, &high.to_le_bytes());
        put(187 + 16 * axis, &low.to_le_bytes());
    }
    // All points are the first of one return.
    put(247, &head.points.to_le_bytes());
    put(255, &head.points.to_le_bytes());
    header
}

/// The variable length record that describes the extra bytes.
fn record_of_extra() -> Vec<u8> {
    let mut record = vec![0; RECORD_HEAD];
    record[2..11].copy_from_slice(b"LASF_Spec");
    record[18] = 4;
    record[20..22].copy_from_slice(&((EXTRA.len() * DESCRIPTION) as u16).to_le_bytes());
    for (name, code, meaning) in EXTRA {
        let mut description = [0; DESCRIPTION];
        description[2] = code;
        description[4..4 + name.len()].copy_from_slice(name.as_bytes());
        description[160..160 + meaning.len()].copy_from_slice(meaning.as_bytes());
        record.extend(description);
    }
    record
}

fn record(point: &Point, ground: u32) -> [u8; POINT] {
    let mut record = [0; POINT];
    let mut put = |at: usize, bytes: &[u8]| record[at..at + bytes.len()].copy_from_slice(bytes);
    for axis in 0..3 {
        put(4 * axis, &steps(point.position[axis]).to_le_bytes());
        put(PLAIN + 4 * axis, &point.normal[axis].to_le_bytes());
    }
    // The first of one return.
    put(14, &[0x11]);
    put(16, &[if point.label == ground { GROUND } else { UNCLASSIFIED }]);
    put(PLAIN + 12, &[point.label as u8]);
    put(PLAIN + 13, &point.chunk.to_le_bytes());
    put(PLAIN + 17, &point.thing.to_le_bytes());
    record
}

fn steps(along_m: f32) -> i32 {
    (f64::from(along_m) / STEP_M).round() as i32
}
