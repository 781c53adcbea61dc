//! Phong materials, which every reader of FBX supports, with textures where readers look for them.

use std::io::{Seek, Write};

use super::geometry::UV_SET;
use super::node::{Nodes, Property, Value, Written, full_name};

/// Writes the body of a material: white and fully rough, which textures override; reflectance of stone, 4 % at normal
/// incidence.
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

/// Writes the body of an image.
pub fn write_video<W: Write + Seek>(nodes: &mut Nodes<W>, path: &str) -> Written {
    nodes.leaf("Type", &[Value::Text("Clip")])?;
    nodes.properties(&[Property::file("Path", path)])?;
    nodes.leaf("UseMipMap", &[Value::Int(0)])?;
    nodes.leaf("Filename", &[Value::Text(path)])?;
    nodes.leaf("RelativeFilename", &[Value::Text(path)])
}

/// Writes the body of a texture, i.e. the use of an image.
pub fn write_texture<W: Write + Seek>(nodes: &mut Nodes<W>, name: &str, path: &str) -> Written {
    nodes.leaf("Type", &[Value::Text("TextureVideoClip")])?;
    nodes.leaf("Version", &[Value::Int(202)])?;
    nodes.leaf("TextureName", &[Value::Text(&full_name(name, "Texture"))])?;
    nodes.properties(&[Property::text("UVSet", UV_SET), Property::flag("UseMaterial", true)])?;
    nodes.leaf("Media", &[Value::Text(&full_name(name, "Video"))])?;
    nodes.leaf("FileName", &[Value::Text(path)])?;
    nodes.leaf("RelativeFilename", &[Value::Text(path)])
}
