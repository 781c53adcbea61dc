//! A file that is being written.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Seek, SeekFrom, Write as _};
use std::path::Path;

use fbxcel::writer::v7400::binary::{CompressionError, Error};
use nalgebra::Isometry3;

use super::head::{self, Counts, Kind};
use super::node::{Nodes, Property, Value, Written, full_name};
use super::pose::Pose;
use super::window::Window;
use super::{Head, Maps, Part, geometry, material};
use crate::error::{ExportError, at};
use crate::frame::Up;
use crate::scene::{Light, Mesh};

/// The root node.
pub(super) const ROOT: i64 = 0;
/// Angular size below which the error of a level is invisible: a pixel of 1080 at 60 degrees.
const PIXEL_RAD: f64 = 1e-3;

/// A file that is being written.
pub struct Document {
    path: String,
    generator: String,
    pub(super) up: Up,
    nodes: Nodes<Window>,
    counts: Counts,
    links: Vec<Link>,
    /// The materials by name, since parts may share them.
    materials: BTreeMap<String, i64>,
    /// The meshes that things share, by name.
    meshes: BTreeMap<String, i64>,
    last_id: i64,
}

/// Connections between objects.
struct Link {
    child: i64,
    parent: i64,
    property: Option<&'static str>,
}

impl Document {
    pub(super) fn create(file: &Path, path: &str, head: &Head) -> Result<Self, ExportError> {
        let start = || {
            let mut nodes = Nodes::new(Window::new(File::create(file)?))?;
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
            materials: BTreeMap::new(),
            meshes: BTreeMap::new(),
            last_id: head::DOCUMENT,
        })
    }

    /// Adds a part.
    ///
    /// # Errors
    /// If the disk fails, or the file gets larger than 4 GiB.
    pub fn add(&mut self, part: &Part) -> Result<(), ExportError> {
        self.add_part(part).map_err(|error| self.told(error))
    }

    /// Adds an empty node at a pose.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_pose(&mut self, name: &str, pose: &Isometry3<f64>) -> Result<(), ExportError> {
        let null = self.add_null(name, &Pose::of_body(pose, self.up));
        null.map(drop).map_err(|error| self.told(error))
    }

    /// Adds a point light. FBX has no unit for its intensity: 100 stands for a candela, as three.js reads it. Its colour is
    /// linear, as Blender reads it.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_light(&mut self, light: &Light) -> Result<(), ExportError> {
        self.add_lamp(light).map_err(|error| self.told(error))
    }

    pub(super) fn told(&self, error: Error) -> ExportError {
        told(&self.path, error)
    }

    pub(super) fn finish(mut self) -> Result<(), ExportError> {
        let path = std::mem::take(&mut self.path);
        self.close().map_err(|error| told(&path, error))
    }

    fn close(mut self) -> Written {
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

    fn add_part(&mut self, part: &Part) -> Written {
        if !part.levels.is_empty() {
            self.add_levels(part)?;
        }
        part.colliders.iter().try_for_each(|collider| self.add_mesh(&collider.name, collider.mesh, ROOT).map(drop))
    }

    fn add_levels(&mut self, part: &Part) -> Written {
        let material = self.add_material(part.material, part.maps)?;
        let errors_m: Vec<f64> = part.levels.iter().map(|level| level.error_m.into()).collect();
        let parent =
            if part.levels.len() > 1 { self.add_group(part.name, &errors_m, &Pose::ORIGIN, ROOT)? } else { ROOT };
        for level in &part.levels {
            let model = self.add_mesh(&level.name, level.mesh, parent)?;
            self.link(material, model, None);
        }
        Ok(())
    }

    fn add_mesh(&mut self, name: &str, mesh: &Mesh, parent: i64) -> Written<i64> {
        let geometry = self.add_geometry(name, mesh)?;
        self.add_shape(name, geometry, &Pose::ORIGIN, parent)
    }

    fn add_geometry(&mut self, name: &str, mesh: &Mesh) -> Written<i64> {
        let up = self.up;
        self.object(Kind::Geometry, name, "Mesh", |nodes| geometry::write(nodes, mesh, up))
    }

    /// The geometry called `name`, which is written when it is first asked for.
    pub(super) fn shared_geometry(&mut self, name: &str, mesh: &Mesh) -> Written<i64> {
        if let Some(made) = self.meshes.get(name) {
            return Ok(*made);
        }
        let geometry = self.add_geometry(name, mesh)?;
        self.meshes.insert(name.to_owned(), geometry);
        Ok(geometry)
    }

    /// A node that shows a geometry.
    pub(super) fn add_shape(&mut self, name: &str, geometry: i64, pose: &Pose, parent: i64) -> Written<i64> {
        let model = self.add_model(name, "Mesh", pose, parent)?;
        self.link(geometry, model, None);
        Ok(model)
    }

    /// A group of levels of detail, given the error of each in metres. It shows a level from the distance at which its error
    /// subtends [`PIXEL_RAD`].
    pub(super) fn add_group(&mut self, name: &str, errors_m: &[f64], pose: &Pose, parent: i64) -> Written<i64> {
        let coarser = errors_m.iter().enumerate().skip(1);
        let thresholds: Vec<(String, f64)> =
            coarser.map(|(level, error_m)| (format!("Thresholds|Level{}", level - 1), error_m / PIXEL_RAD)).collect();
        let mut properties = vec![Property::group("Thresholds")];
        properties.extend(thresholds.iter().map(|(name, distance_m)| Property::length(name, *distance_m)));
        let group = self.add_model(name, "LodGroup", pose, parent)?;
        self.add_attribute(name, "LodGroup", group, &properties, None)?;
        Ok(group)
    }

    /// A node that shows nothing.
    pub(super) fn add_null(&mut self, name: &str, pose: &Pose) -> Written<i64> {
        let model = self.add_model(name, "Null", pose, ROOT)?;
        self.add_attribute(name, "Null", model, &[], Some("Null"))?;
        Ok(model)
    }

    fn add_lamp(&mut self, light: &Light) -> Written {
        let model = self.add_model(&light.name, "Light", &Pose::of_point(light.position, self.up), ROOT)?;
        let properties = [
            Property::choice("LightType", 0),
            Property::vector("Color", "Color", light.color),
            Property::number("Intensity", 100.0 * light.intensity_cd),
            Property::choice("DecayType", 2),
        ];
        self.add_attribute(&light.name, "Light", model, &properties, Some("Light"))
    }

    /// The type of a node that is not a mesh; `flags` is the legacy name that some readers need.
    fn add_attribute(
        &mut self,
        name: &str,
        class: &str,
        model: i64,
        properties: &[Property],
        flags: Option<&str>,
    ) -> Written {
        let attribute = self.object(Kind::NodeAttribute, name, class, |nodes| {
            flags.iter().try_for_each(|flags| nodes.leaf("TypeFlags", &[Value::Text(flags)]))?;
            nodes.properties(properties)
        })?;
        self.link(attribute, model, None);
        Ok(())
    }

    fn add_model(&mut self, name: &str, class: &str, pose: &Pose, parent: i64) -> Written<i64> {
        let model = self.object(Kind::Model, name, class, |nodes| {
            nodes.leaf("Version", &[Value::Int(232)])?;
            nodes.properties(&[
                Property::vector("Lcl Translation", "Lcl Translation", pose.position),
                Property::vector("Lcl Rotation", "Lcl Rotation", pose.degrees),
                Property::vector("Lcl Scaling", "Lcl Scaling", [pose.scale; 3]),
                Property::int("DefaultAttributeIndex", 0),
            ])
        })?;
        self.link(model, parent, None);
        Ok(model)
    }

    pub(super) fn add_material(&mut self, name: &str, maps: &Maps) -> Written<i64> {
        if let Some(made) = self.materials.get(name) {
            return Ok(*made);
        }
        let material = self.object(Kind::Material, name, "", material::write)?;
        for (role, path, property) in [
            ("base_color", Some(&maps.base_color), "DiffuseColor"),
            ("normal", Some(&maps.normal), "NormalMap"),
            ("roughness", maps.roughness.as_ref(), "ShininessExponent"),
            ("occlusion", maps.occlusion_roughness_metalness.as_ref(), "Maya|TEX_ao_map"),
        ] {
            let Some(path) = path else { continue };
            let texture = self.add_texture(&format!("{name}_{role}"), path)?;
            self.link(texture, material, Some(property));
        }
        self.materials.insert(name.to_owned(), material);
        Ok(material)
    }

    fn add_texture(&mut self, name: &str, path: &str) -> Written<i64> {
        let video = self.object(Kind::Video, name, "Clip", |nodes| material::write_video(nodes, path))?;
        let texture = self.object(Kind::Texture, name, "", |nodes| material::write_texture(nodes, name, path))?;
        self.link(video, texture, None);
        Ok(texture)
    }

    fn object(
        &mut self,
        kind: Kind,
        name: &str,
        class: &str,
        fill: impl FnOnce(&mut Nodes<Window>) -> Written,
    ) -> Written<i64> {
        self.last_id += 1;
        self.counts[kind as usize] += 1;
        let name = full_name(name, kind.name());
        self.nodes.branch(kind.name(), &[Value::Id(self.last_id), Value::Text(&name), Value::Text(class)], fill)?;
        Ok(self.last_id)
    }

    pub(super) fn link(&mut self, child: i64, parent: i64, property: Option<&'static str>) {
        self.links.push(Link { child, parent, property });
    }
}

impl Link {
    fn write(&self, nodes: &mut Nodes<Window>) -> Written {
        let ends = [Value::Id(self.child), Value::Id(self.parent)];
        match self.property {
            None => nodes.leaf("C", &[Value::Text("OO"), ends[0], ends[1]]),
            Some(property) => nodes.leaf("C", &[Value::Text("OP"), ends[0], ends[1], Value::Text(property)]),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_beyond_4_gib_is_reported_with_a_hint() {
        let error = told("cave.fbx", Error::FileTooLarge(5 << 30));
        assert_eq!(error.to_string(), "cave.fbx would have 5368709120 bytes, more than FBX 7.4 allows");
        assert!(error.is_usage() && error.hint().unwrap().contains("per_chunk"));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_reported_with_the_file() {
        let head = Head { generator: "plume test", up: Up::Z };
        let document = Document::create(Path::new("/dev/full"), "cave.fbx", &head).unwrap();
        let error = document.finish().unwrap_err();
        assert_eq!(error.to_string(), "cave.fbx: No space left on device (os error 28)");
        assert!(error.hint().unwrap().starts_with("free some space"));
    }
}
