//! A chunk as an MJCF fragment: its images, its visual mesh, and what wheels touch.
//!
//! Numbers of collision shapes are inline, since thousands of small files compile slower and take more memory. File paths
//! are relative to the model that includes the fragment.

use std::io::{self, Write};

use crate::error::ExportError;
use crate::msh;
use crate::package::Package;
use crate::scene::{Chunk, Image, ImageFormat, Mesh, Piece};

/// What wheels touch in a chunk.
pub enum Collision {
    /// Convex pieces.
    Pieces(Vec<Piece>),
}

impl Collision {
    /// Triangles that wheels touch.
    pub fn triangles(&self) -> u64 {
        match self {
            Self::Pieces(pieces) => pieces.iter().map(|piece| piece.mesh.triangles()).sum(),
        }
    }
}

/// Path of the fragment of the chunk called `chunk`.
pub fn path(chunk: &str) -> String {
    format!("assets/{chunk}.mjcf")
}

/// Writes the fragment of a chunk of the scene called `scene`, its visual mesh and its images.
///
/// # Errors
/// [`ExportError::UnfitImage`] for images that are not PNG; those of the package.
pub fn write(scene: &str, chunk: &Chunk, collision: &Collision, out: &mut dyn Package) -> Result<(), ExportError> {
    let name = &chunk.name;
    for (role, image) in images(chunk) {
        let file = format!("{name}_{role}.png");
        if image.format != ImageFormat::Png {
            return Err(ExportError::UnfitImage { target: "mujoco", path: image.path.clone(), wanted: "PNG" });
        }
        out.copy(&format!("assets/{file}"), &image.path)?;
    }
    out.write(&format!("assets/{name}.msh"), |file| Ok(msh::write_visual(file, &chunk.visual)?))?;
    out.write(&path(name), |file| Ok(write_fragment(file, scene, name, collision)?))
}

fn images(chunk: &Chunk) -> [(&'static str, &Image); 3] {
    let material = &chunk.material;
    [("base_color", &material.base_color), ("normal", &material.normal), ("orm", &material.orm)]
}

fn write_fragment(file: &mut dyn Write, scene: &str, chunk: &str, collision: &Collision) -> io::Result<()> {
    let name = format!("{scene}_{chunk}");
    writeln!(file, "<mujoco>\n  <asset>")?;
    for (role, space) in [("base_color", "sRGB"), ("normal", "linear"), ("orm", "linear")] {
        let path = format!("assets/{chunk}_{role}.png");
        writeln!(file, r#"    <texture name="{name}_{role}" type="2d" colorspace="{space}" file="{path}"/>"#)?;
    }
    writeln!(file, r#"    <material name="{name}" specular="0" shininess="0">"#)?;
    for (role, image) in [("rgb", "base_color"), ("normal", "normal"), ("orm", "orm")] {
        writeln!(file, r#"      <layer role="{role}" texture="{name}_{image}"/>"#)?;
    }
    writeln!(file, "    </material>")?;
    writeln!(file, r#"    <mesh name="{name}" file="assets/{chunk}.msh" inertia="shell"/>"#)?;
    let Collision::Pieces(pieces) = collision;
    for (number, piece) in pieces.iter().enumerate() {
        write!(file, r#"    <mesh name="{name}_{number}" vertex=""#)?;
        write_positions(file, &piece.mesh)?;
        writeln!(file, r#""/>"#)?;
    }
    writeln!(file, "  </asset>\n  <worldbody>\n    <body name=\"{name}\">")?;
    writeln!(file, r#"      <geom name="{name}" class="{scene}_visual" mesh="{name}" material="{name}"/>"#)?;
    for (number, piece) in pieces.iter().enumerate() {
        let (geom, zone) = (format!("{name}_{number}"), piece.zone.name());
        writeln!(file, r#"      <geom name="{geom}" class="{scene}_{zone}" mesh="{geom}"/>"#)?;
    }
    writeln!(file, "    </body>\n  </worldbody>\n</mujoco>")
}

fn write_positions(file: &mut dyn Write, mesh: &Mesh) -> io::Result<()> {
    for (number, [x, y, z]) in mesh.positions.iter().enumerate() {
        let space = if number == 0 { "" } else { " " };
        write!(file, "{space}{x} {y} {z}")?;
    }
    Ok(())
}
