//! Materials of the kind that every reader of FBX knows, Phong, with textures where they are looked for.

use std::io::{Seek, Write};

use super::geometry::UV_SET;
use super::node::{Nodes, Property, Value, Written, full_name};

/// Writes the inside of a material: white and as rough as can be, which textures override; as reflective as stone, 4 %
/// head-on.
pub fn write<W: Write + Seek>(nodes: &mut Nodes<W>) -> Written {
    nodes.leaf("Version", &[Value::Int(102)])?;
    nodes.leaf("ShadingModel", &[Value::Text("phong")])?;
    nodes.leaf("MultiLayer", &[Value::Int(0)])?;
    nodes.properties(&[
        Property::vector("DiffuseColor", "Color", [1.0; 3]),
        Property::number("DiffuseFactor", 1.0),
        Property::vector("SpecularColor", "Color", [0.16; 3]),
        Property::number("SpecularFactor", 0.25),
        Property::number("Shininess", 0.0),
        Property::number("ShininessExponent", 0.0),
        Property::number("ReflectionFactor", 0.0),
    ])
}

/// Writes the inside of an image.
pub fn write_video<W: Write + Seek>(nodes: &mut Nodes<W>, path: &str) -> Written {
    nodes.leaf("Type", &[Value::Text("Clip")])?;
    nodes.properties(&[Property::file("Path", path)])?;
    nodes.leaf("UseMipMap", &[Value::Int(0)])?;
    nodes.leaf("Filename", &[Value::Text(path)])?;
    nodes.leaf("RelativeFilename", &[Value::Text(path)])
}

/// Writes the inside of the use of an image.
pub fn write_texture<W: Write + Seek>(nodes: &mut Nodes<W>, name: &str, path: &str) -> Written {
    nodes.leaf("Type", &[Value::Text("TextureVideoClip")])?;
    nodes.leaf("Version", &[Value::Int(202)])?;
    nodes.leaf("TextureName", &[Value::Text(&full_name(name, "Texture"))])?;
    nodes.properties(&[Property::text("UVSet", UV_SET), Property::flag("UseMaterial", true)])?;
    nodes.leaf("Media", &[Value::Text(&full_name(name, "Video"))])?;
    nodes.leaf("FileName", &[Value::Text(path)])?;
    nodes.leaf("RelativeFilename", &[Value::Text(path)])
}
