//! ROS 2 messages: their definitions, how they are encoded, and bags of them.
//!
//! Encoded as Common Data Representation (CDR of OMG, little-endian, in its version 1): numbers are aligned to their size from behind
//! the four bytes of its head. Definitions are those of `common_interfaces` and `grid_map_msgs`, without comments.

use nalgebra::Isometry3;

mod bag;
mod grid_map;

pub use bag::{Bag, Message};
pub use grid_map::GridMap;

/// A kind of message.
pub struct Kind {
    /// Such as `sensor_msgs/msg/Image`.
    pub name: &'static str,
    /// Its fields.
    pub fields: &'static str,
    /// The kinds of its fields and theirs.
    pub parts: &'static [&'static Kind],
}

impl Kind {
    /// Its fields, and those of its parts.
    pub fn definition(&self) -> String {
        let line = "=".repeat(80);
        let part = |part: &&Kind| format!("{line}\nMSG: {}\n{}", part.name.replace("/msg/", "/"), part.fields);
        self.fields.to_owned() + &self.parts.iter().map(part).collect::<String>()
    }
}

/// A time.
pub const TIME: Kind = Kind { name: "builtin_interfaces/msg/Time", fields: "int32 sec\nuint32 nanosec\n", parts: &[] };
/// When and in which frame.
pub const HEADER: Kind =
    Kind { name: "std_msgs/msg/Header", fields: "builtin_interfaces/Time stamp\nstring frame_id\n", parts: &[] };
/// A point.
pub const POINT: Kind =
    Kind { name: "geometry_msgs/msg/Point", fields: "float64 x\nfloat64 y\nfloat64 z\n", parts: &[] };
/// A rotation.
pub const QUATERNION: Kind = Kind {
    name: "geometry_msgs/msg/Quaternion",
    fields: "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    parts: &[],
};
/// A place and a rotation.
pub const POSE: Kind = Kind {
    name: "geometry_msgs/msg/Pose",
    fields: "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    parts: &[],
};

/// A message that is being encoded: its head, then what follows it.
pub struct Cdr(Vec<u8>);

/// Little-endian, version 1.
const HEAD: [u8; 4] = [0, 1, 0, 0];

impl Default for Cdr {
    fn default() -> Self {
        Self(HEAD.to_vec())
    }
}

impl Cdr {
    /// A message that begins with a header.
    pub fn stamped(time_ns: i64, frame: &str) -> Self {
        let mut cdr = Self::default();
        cdr.header(time_ns, frame);
        cdr
    }

    /// A header: a time and the name of a frame.
    pub fn header(&mut self, time_ns: i64, frame: &str) {
        self.u32(time_ns.div_euclid(1_000_000_000) as u32);
        self.u32(time_ns.rem_euclid(1_000_000_000) as u32);
        self.text(frame);
    }

    /// A position, or a translation, and a quaternion.
    pub fn pose(&mut self, pose: &Isometry3<f64>) {
        self.f64s(pose.translation.vector.as_slice());
        self.f64s(pose.rotation.coords.as_slice());
    }

    /// A byte, or whether something is so.
    pub fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    /// A small number.
    pub fn u16(&mut self, value: u16) {
        self.align(2);
        self.0.extend(value.to_le_bytes());
    }

    /// A number, or the length of what follows.
    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// An array of known length.
    pub fn f64s(&mut self, values: &[f64]) {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }

    /// An array with its length.
    pub fn f32s(&mut self, values: impl ExactSizeIterator<Item = f32>) {
        self.u32(values.len() as u32);
        values.for_each(|value| self.0.extend(value.to_le_bytes()));
    }

    /// A text, with a zero at its end.
    pub fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// An array of bytes with its length.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.u32(bytes.len() as u32);
        self.0.extend(bytes);
    }

    /// The message.
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, size: usize) {
        let end = (self.0.len() - HEAD.len()).next_multiple_of(size) + HEAD.len();
        self.0.resize(end, 0);
    }
}
