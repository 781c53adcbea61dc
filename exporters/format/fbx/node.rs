//! The tree that a binary FBX is made of: nodes with values and children, and properties, which are nodes of one form.

use std::io::{Seek, Write};

use fbxcel::low::FbxVersion;
use fbxcel::low::v7400::ArrayAttributeEncoding;
use fbxcel::writer::v7400::binary::{AttributesWriter, FbxFooter, Writer};

/// Result of writing; the errors are those of fbxcel, and do not name the file.
pub type Written<T = ()> = fbxcel::writer::v7400::binary::Result<T>;

/// Footer code that matches [`CREATED`] and [`FILE_ID`]: a known set, because readers may check them against each other.
const FOOT_ID: [u8; 16] =
    [0xfa, 0xbc, 0xab, 0x09, 0xd0, 0xc8, 0xd4, 0x66, 0xb1, 0x76, 0xfb, 0x83, 0x1c, 0xf7, 0x26, 0x7e];
/// The creation time: always the same, so that the same scene gives the same bytes.
pub const CREATED: &str = "1970-01-01 10:00:00:000";
/// File id that matches [`CREATED`].
pub const FILE_ID: [u8; 16] =
    [0x28, 0xb3, 0x2a, 0xeb, 0xb6, 0x24, 0xcc, 0xc2, 0xbf, 0xc8, 0xb0, 0x2a, 0xa9, 0x2b, 0xfc, 0xf1];

/// A value of a node.
#[derive(Clone, Copy)]
pub enum Value<'a> {
    /// A number of 32 bits.
    Int(i32),
    /// The number of an object.
    Id(i64),
    /// A real number.
    Real(f64),
    /// A text.
    Text(&'a str),
    /// Bytes.
    Bytes(&'a [u8]),
}

/// Shorter arrays are not compressed: a file of convex pieces has thousands, and it would take longer than everything else.
const COMPRESSED_BYTES: usize = 4096;

fn encoding(bytes: usize) -> ArrayAttributeEncoding {
    match bytes < COMPRESSED_BYTES {
        true => ArrayAttributeEncoding::Direct,
        false => ArrayAttributeEncoding::Zlib,
    }
}

/// Writes nodes one after the other.
pub struct Nodes<W: Write>(Writer<W>);

impl<W: Write + Seek> Nodes<W> {
    /// Starts a file.
    pub fn new(sink: W) -> Written<Self> {
        Ok(Self(Writer::new(sink, FbxVersion::V7_4)?))
    }

    /// Ends the file.
    pub fn finish(self) -> Written<W> {
        self.0.finalize_and_flush(&FbxFooter { unknown1: Some(&FOOT_ID), ..FbxFooter::default() })
    }

    /// A node with children.
    pub fn branch(&mut self, name: &str, values: &[Value], children: impl FnOnce(&mut Self) -> Written) -> Written {
        self.open(name, values)?;
        children(self)?;
        self.close()
    }

    /// A node without children.
    pub fn leaf(&mut self, name: &str, values: &[Value]) -> Written {
        self.branch(name, values, |_| Ok(()))
    }

    /// A node that is opened now and [closed](Self::close) later.
    pub fn open(&mut self, name: &str, values: &[Value]) -> Written {
        let mut node = self.0.new_node(name)?;
        values.iter().try_for_each(|value| append(&mut node, *value))
    }

    /// Closes what was [opened](Self::open) last.
    pub fn close(&mut self) -> Written {
        self.0.close_node()
    }

    /// A node that holds `count` numbers.
    pub fn reals(&mut self, name: &str, count: usize, numbers: impl Iterator<Item = f64>) -> Written {
        self.0.new_node(name)?.append_arr_f64_from_iter(encoding(8 * count), numbers)?;
        self.close()
    }

    /// A node that holds `count` whole numbers.
    pub fn ints(&mut self, name: &str, count: usize, numbers: impl Iterator<Item = i32>) -> Written {
        self.0.new_node(name)?.append_arr_i32_from_iter(encoding(4 * count), numbers)?;
        self.close()
    }

    /// The properties of an object.
    pub fn properties(&mut self, properties: &[Property]) -> Written {
        self.branch("Properties70", &[], |nodes| {
            properties.iter().try_for_each(|property| nodes.leaf("P", &property.values()))
        })
    }
}

/// The name and class of an object, combined as in binary FBX.
pub fn full_name(name: &str, kind: &str) -> String {
    format!("{name}\0\x01{kind}")
}

fn append<W: Write + Seek>(node: &mut AttributesWriter<W>, value: Value) -> Written {
    match value {
        Value::Int(number) => node.append_i32(number),
        Value::Id(number) => node.append_i64(number),
        Value::Real(number) => node.append_f64(number),
        Value::Text(text) => node.append_string_direct(text),
        Value::Bytes(bytes) => node.append_binary_direct(bytes),
    }
}

/// A property: its name, its type as the three strings of FBX, and its value.
pub struct Property<'a> {
    name: &'a str,
    kind: [&'static str; 3],
    value: Content<'a>,
}

enum Content<'a> {
    Int(i32),
    Real(f64),
    Vector([f64; 3]),
    Text(&'a str),
    Length(f64),
    None,
}

impl<'a> Property<'a> {
    /// A whole number.
    pub fn int(name: &'a str, number: i32) -> Self {
        Self { name, kind: ["int", "Integer", ""], value: Content::Int(number) }
    }

    /// A boolean.
    pub fn flag(name: &'a str, yes: bool) -> Self {
        Self { name, kind: ["bool", "", ""], value: Content::Int(yes.into()) }
    }

    /// One of several choices.
    pub fn choice(name: &'a str, number: i32) -> Self {
        Self { name, kind: ["enum", "", ""], value: Content::Int(number) }
    }

    /// A real number.
    pub fn real(name: &'a str, number: f64) -> Self {
        Self { name, kind: ["double", "Number", ""], value: Content::Real(number) }
    }

    /// A real number that could be animated.
    pub fn number(name: &'a str, number: f64) -> Self {
        Self { name, kind: ["Number", "", "A"], value: Content::Real(number) }
    }

    /// Three numbers that could be animated, of a type such as `Color` or `Lcl Translation`.
    pub fn vector(name: &'a str, kind: &'static str, vector: [f64; 3]) -> Self {
        Self { name, kind: [kind, "", "A"], value: Content::Vector(vector) }
    }

    /// A text.
    pub fn text(name: &'a str, text: &'a str) -> Self {
        Self { name, kind: ["KString", "", ""], value: Content::Text(text) }
    }

    /// The path of a file.
    pub fn file(name: &'a str, path: &'a str) -> Self {
        Self { name, kind: ["KString", "XRefUrl", ""], value: Content::Text(path) }
    }

    /// A length in metres, stored with its unit.
    pub fn length(name: &'a str, metres: f64) -> Self {
        Self { name, kind: ["Distance", "", ""], value: Content::Length(metres) }
    }

    /// The parent of properties named `<name>|…`.
    pub fn group(name: &'a str) -> Self {
        Self { name, kind: ["Compound", "", ""], value: Content::None }
    }

    fn values(&self) -> Vec<Value<'a>> {
        let head = [self.name, self.kind[0], self.kind[1], self.kind[2]].map(Value::Text);
        let rest = match self.value {
            Content::Int(number) => vec![Value::Int(number)],
            Content::Real(number) => vec![Value::Real(number)],
            Content::Vector(vector) => vector.map(Value::Real).to_vec(),
            Content::Text(text) => vec![Value::Text(text)],
            Content::Length(metres) => vec![Value::Real(metres), Value::Text("m")],
            Content::None => Vec::new(),
        };
        [&head[..], &rest].concat()
    }
}
