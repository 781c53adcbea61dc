//! The header: creator, units, axes, and the number of objects.

use std::io::{Seek, Write};

use super::Head;
use super::node::{CREATED, FILE_ID, Nodes, Property, Value, Written};
use crate::frame::Up;

/// Kinds of objects, in the order in which they are counted.
#[derive(Clone, Copy)]
pub enum Kind {
    /// Triangles.
    Geometry,
    /// A node of the scene.
    Model,
    /// The type of a node that is not a mesh.
    NodeAttribute,
    /// A material.
    Material,
    /// The use of an image.
    Texture,
    /// An image.
    Video,
}

impl Kind {
    const ALL: [Self; 6] =
        [Self::Geometry, Self::Model, Self::NodeAttribute, Self::Material, Self::Texture, Self::Video];

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "Geometry",
            Self::Model => "Model",
            Self::NodeAttribute => "NodeAttribute",
            Self::Material => "Material",
            Self::Texture => "Texture",
            Self::Video => "Video",
        }
    }
}

/// Objects by kind.
pub type Counts = [i32; Kind::ALL.len()];

/// The id of the document, which is distinct from those of objects; that of its root is 0.
pub const DOCUMENT: i64 = 1;

/// Writes the header. Its length does not depend on the counts, so it can be overwritten when they are known.
pub fn write<W: Write + Seek>(nodes: &mut Nodes<W>, head: &Head, counts: &Counts) -> Written {
    nodes.branch("FBXHeaderExtension", &[], |nodes| {
        nodes.leaf("FBXHeaderVersion", &[Value::Int(1003)])?;
        nodes.leaf("FBXVersion", &[Value::Int(7400)])?;
        nodes.leaf("EncryptionType", &[Value::Int(0)])?;
        nodes.leaf("Creator", &[Value::Text(head.generator)])
    })?;
    nodes.leaf("FileId", &[Value::Bytes(&FILE_ID)])?;
    nodes.leaf("CreationTime", &[Value::Text(CREATED)])?;
    nodes.leaf("Creator", &[Value::Text(head.generator)])?;
    nodes.branch("GlobalSettings", &[], |nodes| {
        nodes.leaf("Version", &[Value::Int(1000)])?;
        nodes.properties(&settings(head.up))
    })?;
    write_document(nodes)?;
    nodes.leaf("References", &[])?;
    write_counts(nodes, counts)
}

/// A unit is 100 cm. FBX numbers axes from x = 0; its front axis points at the viewer, and the last axis makes the frame
/// right-handed.
fn settings(up: Up) -> Vec<Property<'static>> {
    let (up, front, front_sign) = match up {
        Up::Z => (2, 1, -1),
        Up::Y => (1, 2, 1),
    };
    vec![
        Property::int("UpAxis", up),
        Property::int("UpAxisSign", 1),
        Property::int("FrontAxis", front),
        Property::int("FrontAxisSign", front_sign),
        Property::int("CoordAxis", 0),
        Property::int("CoordAxisSign", 1),
        Property::int("OriginalUpAxis", up),
        Property::int("OriginalUpAxisSign", 1),
        Property::real("UnitScaleFactor", 100.0),
        Property::real("OriginalUnitScaleFactor", 100.0),
    ]
}

fn write_document<W: Write + Seek>(nodes: &mut Nodes<W>) -> Written {
    nodes.branch("Documents", &[], |nodes| {
        nodes.leaf("Count", &[Value::Int(1)])?;
        nodes.branch("Document", &[Value::Id(DOCUMENT), Value::Text("Scene"), Value::Text("Scene")], |nodes| {
            nodes.properties(&[])?;
            nodes.leaf("RootNode", &[Value::Id(0)])
        })
    })
}

fn write_counts<W: Write + Seek>(nodes: &mut Nodes<W>, counts: &Counts) -> Written {
    let count = |nodes: &mut Nodes<W>, name: &str, count: i32| {
        nodes.branch("ObjectType", &[Value::Text(name)], |nodes| nodes.leaf("Count", &[Value::Int(count)]))
    };
    nodes.branch("Definitions", &[], |nodes| {
        nodes.leaf("Version", &[Value::Int(100)])?;
        nodes.leaf("Count", &[Value::Int(1 + counts.iter().sum::<i32>())])?;
        count(nodes, "GlobalSettings", 1)?;
        Kind::ALL.iter().try_for_each(|kind| count(nodes, kind.name(), counts[*kind as usize]))
    })
}
