//! Binary FBX 7.4: metres, right-handed, normals and tangents by vertex, UV origin at the lower left.
//!
//! There is no specification. What is written is what readers read: ufbx, Blender, assimp and three.js were asked. Nodes
//! stand at the origin and are not turned, so the vertices are those of the scene to the last bit. The bytes depend on the
//! scene alone: the time is always the same, objects are numbered in order, and arrays are compressed by Rust code.
//!
//! Memory: one part. How many objects there are stands before them, so the head is written twice, the second time when
//! they are counted.

use std::fs::File;
use std::io::{BufWriter, Cursor, Seek, SeekFrom, Write as _};
use std::path::Path;

use fbxcel::writer::v7400::binary::{CompressionError, Error, Result};
use nalgebra::Isometry3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{ExportError, at};
use crate::frame;
use crate::package::Package;
use crate::scene::{Light, Mesh};
use head::{Counts, Kind};
use node::{Nodes, Property, Value};

mod geometry;
mod head;
mod material;
mod node;

/// Which axis points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    /// The third, as in the scene.
    #[default]
    Z,
    /// The second: everything is turned as for glTF.
    Y,
}

/// What a file says of itself.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// The program that writes.
    pub generator: &'a str,
    /// Which axis points up.
    pub up: Up,
}

/// Files of a material, relative to the FBX, with forward slashes; an empty one is left out.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Base colour.
    pub base_color: String,
    /// Tangent-space normals.
    pub normal: String,
    /// Roughness alone.
    pub roughness: String,
    /// Occlusion, roughness and metalness in red, green and blue.
    pub occlusion_roughness_metalness: String,
}

/// A level of detail.
#[derive(Clone, Debug)]
pub struct Level<'a> {
    /// Name of its node.
    pub name: String,
    /// Triangles with every attribute.
    pub mesh: &'a Mesh,
    /// How far it lies from the full detail at most, in metres.
    pub error_m: f32,
}

/// Triangles to touch, not to see.
#[derive(Clone, Debug)]
pub struct Collider<'a> {
    /// Name of its node.
    pub name: String,
    /// Positions and triangles.
    pub mesh: &'a Mesh,
}

/// A part of the world with one material.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Name of the group of levels, where there are several.
    pub name: &'a str,
    /// Full detail first; several are put into a group (`LodGroup`).
    pub levels: Vec<Level<'a>>,
    /// What robots touch; these have no material.
    pub colliders: Vec<Collider<'a>>,
    /// Name of the material.
    pub material: &'a str,
    /// Its files.
    pub maps: &'a Maps,
}

/// Writes the file `path` of a package: `fill` adds the parts, one at a time, and may write other files meanwhile.
///
/// # Errors
/// As [`write`](../../package/trait.Package.html#method.write); [`ExportError::TooLarge`] past 4 GiB, which is all that this
/// version of FBX can hold; and the errors of `fill`.
pub fn write(
    out: &mut dyn Package,
    path: &str,
    head: &Head,
    fill: impl FnOnce(&mut Document, &mut dyn Package) -> std::result::Result<(), ExportError>,
) -> std::result::Result<(), ExportError> {
    let scratch = out.scratch()?;
    let gathered = scratch.path().join("gathered.fbx");
    let mut document = Document::create(&gathered, path, head)?;
    fill(&mut document, out)?;
    document.finish()?;
    out.copy(path, &gathered)
}

/// The node that all others hang on.
const ROOT: i64 = 0;
/// What a level may differ in, as an angle: a pixel of 1080 on 60 degrees.
const PIXEL_RAD: f64 = 1e-3;

/// A file that is being written.
pub struct Document {
    path: String,
    generator: String,
    up: Up,
    nodes: Nodes<BufWriter<File>>,
    counts: Counts,
    links: Vec<Link>,
    last_id: i64,
}

/// Who belongs to whom, and as what.
struct Link {
    child: i64,
    parent: i64,
    property: Option<&'static str>,
}

impl Document {
    fn create(file: &Path, path: &str, head: &Head) -> std::result::Result<Self, ExportError> {
        let start = || {
            let mut nodes = Nodes::new(BufWriter::new(File::create(file)?))?;
            head::write(&mut nodes, head, &Counts::default())?;
            nodes.open("Objects", &[])?;
            Ok(nodes)
        };
        Ok(Self {
            path: path.to_owned(),
            generator: head.generator.to_owned(),
            up: head.up,
            nodes: start().map_err(|error| told(path, error))?,
            counts: Counts::default(),
            links: Vec::new(),
            last_id: head::DOCUMENT,
        })
    }

    /// Adds a part.
    ///
    /// # Errors
    /// When the disk refuses, or the file gets larger than 4 GiB.
    pub fn add(&mut self, part: &Part) -> std::result::Result<(), ExportError> {
        self.add_part(part).map_err(|error| told(&self.path, error))
    }

    /// Adds an empty node at a pose.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_pose(&mut self, name: &str, pose: &Isometry3<f64>) -> std::result::Result<(), ExportError> {
        let (position, angles) = match self.up {
            Up::Z => frame::euler_pose(pose),
            Up::Y => frame::gltf_euler_pose_from_scene(pose),
        };
        let null = self.add_null(name, [position, angles.map(f64::to_degrees)]);
        null.map_err(|error| told(&self.path, error))
    }

    /// Adds a point light. FBX has no unit for its intensity: 100 stands for a candela, as three.js reads it.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_light(&mut self, light: &Light) -> std::result::Result<(), ExportError> {
        self.add_lamp(light).map_err(|error| told(&self.path, error))
    }

    fn finish(mut self) -> std::result::Result<(), ExportError> {
        let path = std::mem::take(&mut self.path);
        self.close().map_err(|error| told(&path, error))
    }

    fn close(mut self) -> Result<()> {
        self.nodes.close()?;
        let links = std::mem::take(&mut self.links);
        self.nodes.branch("Connections", &[], |nodes| links.iter().try_for_each(|link| link.write(nodes)))?;
        let mut file = self.nodes.finish()?;
        let mut counted = Cursor::new(Vec::new());
        let head = Head { generator: &self.generator, up: self.up };
        head::write(&mut Nodes::new(&mut counted)?, &head, &self.counts)?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(counted.get_ref())?;
        Ok(file.flush()?)
    }

    fn add_part(&mut self, part: &Part) -> Result<()> {
        let material = self.add_material(part.material, part.maps)?;
        let parent = match part.levels.len() {
            0 | 1 => ROOT,
            _ => self.add_group(part)?,
        };
        for level in &part.levels {
            let model = self.add_mesh(&level.name, level.mesh, parent)?;
            self.link(material, model, None);
        }
        part.colliders.iter().try_for_each(|collider| self.add_mesh(&collider.name, collider.mesh, ROOT).map(drop))
    }

    fn add_mesh(&mut self, name: &str, mesh: &Mesh, parent: i64) -> Result<i64> {
        let up = self.up;
        let geometry = self.object(Kind::Geometry, name, "Mesh", |nodes| geometry::write(nodes, mesh, up))?;
        let model = self.add_model(name, "Mesh", [[0.0; 3]; 2], parent)?;
        self.link(geometry, model, None);
        Ok(model)
    }

    /// The group shows a level from the distance at which its error is seen under [`PIXEL_RAD`].
    fn add_group(&mut self, part: &Part) -> Result<i64> {
        let names: Vec<String> = (1..part.levels.len()).map(|level| format!("Thresholds|Level{}", level - 1)).collect();
        let mut properties = vec![Property::group("Thresholds")];
        for (name, level) in names.iter().zip(&part.levels[1..]) {
            properties.push(Property::length(name, f64::from(level.error_m) / PIXEL_RAD));
        }
        let group = self.add_model(part.name, "LodGroup", [[0.0; 3]; 2], ROOT)?;
        self.add_attribute(part.name, "LodGroup", group, &properties, None)?;
        Ok(group)
    }

    fn add_null(&mut self, name: &str, pose: [[f64; 3]; 2]) -> Result<()> {
        let model = self.add_model(name, "Null", pose, ROOT)?;
        self.add_attribute(name, "Null", model, &[], Some("Null"))
    }

    fn add_lamp(&mut self, light: &Light) -> Result<()> {
        let position = match self.up {
            Up::Z => light.position.into(),
            Up::Y => frame::gltf_from_scene(light.position.into()),
        };
        let model = self.add_model(&light.name, "Light", [position, [0.0; 3]], ROOT)?;
        let properties = [
            Property::choice("LightType", 0),
            Property::vector("Color", "Color", light.color),
            Property::number("Intensity", 100.0 * light.intensity_cd),
            Property::choice("DecayType", 2),
        ];
        self.add_attribute(&light.name, "Light", model, &properties, Some("Light"))
    }

    /// What a node is, where it is no mesh; `flags` is the old word for it that some readers ask for.
    fn add_attribute(
        &mut self,
        name: &str,
        class: &str,
        model: i64,
        properties: &[Property],
        flags: Option<&str>,
    ) -> Result<()> {
        let attribute = self.object(Kind::NodeAttribute, name, class, |nodes| {
            flags.iter().try_for_each(|flags| nodes.leaf("TypeFlags", &[Value::Text(flags)]))?;
            nodes.properties(properties)
        })?;
        self.link(attribute, model, None);
        Ok(())
    }

    fn add_model(&mut self, name: &str, class: &str, [position, degrees]: [[f64; 3]; 2], parent: i64) -> Result<i64> {
        let model = self.object(Kind::Model, name, class, |nodes| {
            nodes.leaf("Version", &[Value::Int(232)])?;
            nodes.properties(&[
                Property::vector("Lcl Translation", "Lcl Translation", position),
                Property::vector("Lcl Rotation", "Lcl Rotation", degrees),
                Property::vector("Lcl Scaling", "Lcl Scaling", [1.0; 3]),
                Property::int("DefaultAttributeIndex", 0),
            ])
        })?;
        self.link(model, parent, None);
        Ok(model)
    }

    fn add_material(&mut self, name: &str, maps: &Maps) -> Result<i64> {
        let material = self.object(Kind::Material, name, "", material::write)?;
        let maps = [
            ("base_color", &maps.base_color, "DiffuseColor"),
            ("normal", &maps.normal, "NormalMap"),
            ("roughness", &maps.roughness, "ShininessExponent"),
            ("occlusion", &maps.occlusion_roughness_metalness, "Maya|TEX_ao_map"),
        ];
        for (role, path, property) in maps.into_iter().filter(|(_, path, _)| !path.is_empty()) {
            let name = format!("{name}_{role}");
            let video = self.object(Kind::Video, &name, "Clip", |nodes| material::write_video(nodes, path))?;
            let texture = self.object(Kind::Texture, &name, "", |nodes| material::write_texture(nodes, &name, path))?;
            self.link(video, texture, None);
            self.link(texture, material, Some(property));
        }
        Ok(material)
    }

    fn object(
        &mut self,
        kind: Kind,
        name: &str,
        class: &str,
        fill: impl FnOnce(&mut Nodes<BufWriter<File>>) -> Result<()>,
    ) -> Result<i64> {
        self.last_id += 1;
        self.counts[kind as usize] += 1;
        let name = full_name(name, kind.name());
        self.nodes.branch(kind.name(), &[Value::Id(self.last_id), Value::Text(&name), Value::Text(class)], fill)?;
        Ok(self.last_id)
    }

    fn link(&mut self, child: i64, parent: i64, property: Option<&'static str>) {
        self.links.push(Link { child, parent, property });
    }
}

impl Link {
    fn write(&self, nodes: &mut Nodes<BufWriter<File>>) -> Result<()> {
        let ends = [Value::Id(self.child), Value::Id(self.parent)];
        match self.property {
            None => nodes.leaf("C", &[Value::Text("OO"), ends[0], ends[1]]),
            Some(property) => nodes.leaf("C", &[Value::Text("OP"), ends[0], ends[1], Value::Text(property)]),
        }
    }
}

/// The name of an object and what it is, as a binary FBX puts them together.
fn full_name(name: &str, kind: &str) -> String {
    format!("{name}\0\x01{kind}")
}

/// An error of the writer as one of the file `path`.
fn told(path: &str, error: Error) -> ExportError {
    let too_large = |bytes: u64| ExportError::TooLarge { path: path.to_owned(), format: "FBX 7.4", bytes };
    match error {
        Error::Io(error) | Error::Compression(CompressionError::Zlib(error)) => at(path, &error).into(),
        Error::FileTooLarge(bytes) => too_large(bytes),
        Error::AttributeTooLong(bytes) => too_large(bytes as u64),
        error => ExportError::Library { library: "fbxcel", path: path.to_owned(), message: error.to_string() },
    }
}
