//! Target `unity`: a package for Unity's Package Manager, for Unity 2021.3 and later.
//!
//! ```text
//! package.json, README.md
//! Runtime/<name>.prefab
//! Runtime/Things/<prototype>_level<n>[_movable].prefab
//! Runtime/Meshes/{<chunk>,<prototype>}.fbx          <chunk>_LOD0, _LOD1, … and <chunk>_collision
//! Runtime/Textures/<chunk>_{base_color,normal,mask}
//! Runtime/Materials/<chunk>.mat
//! Runtime/Physics/<zone>.physicMaterial
//! ```
//! Each file and folder has its `.meta`. GUIDs follow from the content ([`identity`]).
//!
//! - **Frame**: the FBX are Y up, in metres. Unity's importer negates x and reverses the winding; the prefab has start poses
//!   and lights in the resulting frame ([`frame::unity_from_scene`](crate::frame::unity_from_scene)).
//! - **References into an FBX**: Unity derives the id of a mesh from its name, and [`identity::mesh`] does the same, as
//!   confirmed by ids that Unity has written into public projects. The table `internalIDToNameTable` of the `.meta` has the
//!   same ids, so that either rule finds the meshes.
//! - **Tangents**: Unity recomputes them with MikkTSpace, which was also used for baking the normal maps.
//! - **Levels of detail** switch where their error is a line of an image of 1080 lines with a field of view of 60°. The last
//!   one is never hidden.
//! - **Things** are instances of nested prefabs, with the mass of movable ones as an override: the format of 2021.3, which
//!   later versions read. Static ones are convex colliders without a body, whatever the collision of the walls.
//! - **Friction** is that of the scene; it overrides lower values of touching bodies (`frictionCombine` is the maximum).
//!
//! Not tested in Unity itself. Independent readers check the YAML against the documented fields, that all references
//! resolve, and the frame of the meshes.

use minijinja::context;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::bundle::Bundle;
use crate::collision::Collision;
use crate::error::ExportError;
use crate::format::fbx;
use crate::frame::{Axes, Up, micro};
use crate::image_format::ImageFormat;
use crate::instances::INSTANCES;
use crate::package::MANIFEST;
use crate::package::{Package, write_pretty};
use crate::place::LICENSE;
use crate::scene::{Chunk, Content, Mesh, Piece, Scene, Zone};
use crate::stations::STATIONS;
use crate::{Build, Open, Summary, Target, TargetRow, template};

use asset::{Assets, Importer};
use identity::Guid;
use material::Pipeline;
use prefab::{Model, Prefab};
use texture::Textures;
use things::Things;

mod asset;
pub mod identity;
mod lod;
pub mod material;
mod nested;
mod prefab;
mod texture;
mod things;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "unity",
    summary: "package for Unity's Package Manager: FBX with levels of detail, materials and prefabs with colliders",
    revision: 0,
    opened_by: "Unity 2021.3 and later",
    contents: "package for Unity's Package Manager (2021.3 and later): an FBX per chunk with levels of detail, materials \
        for the built-in pipeline, URP or HDRP, a prefab with LODGroups, colliders, start poses and lights, a prefab per \
        shape of things; `--bundle tgz`",
    tested_by: "no Unity runs here: PyYAML with Unity's tags against the documented fields, every GUID and file ID \
        resolved; ufbx without a warning",
    checks: &["unity", "blender", "libassimp"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[Bundle::Tgz],
    settings: plume_registry::settings_schema::<UnitySettings>,
    build: Build::Plain(|table| Ok(Box::new(Unity(serde_json::from_value(table)?)))),
};

/// Settings of target `unity`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct UnitySettings {
    /// Render pipeline for which the materials are made.
    pub pipeline: Pipeline,
    /// Collision shapes. Pieces have separate friction for floor, wall and ceiling; triangles have that of the floor.
    pub collision: Collision,
    /// Include the lights of the scene, without shadows.
    pub lights: bool,
}

impl Default for UnitySettings {
    fn default() -> Self {
        Self { pipeline: Pipeline::default(), collision: Collision::default(), lights: true }
    }
}

/// The target.
pub struct Unity(
    /// Its settings.
    pub UnitySettings,
);

impl Target for Unity {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (name, bundle) = (package_name(&scene.name), out.bundle());
        let mut writer = Writer {
            settings: &self.0,
            scene,
            assets: Assets::new(out, name.clone()),
            prefab: Prefab::new(&scene.name),
            friction: Vec::new(),
            triangles: [0, 0],
            things: Things::of(scene)?,
        };
        (0..scene.chunks.len()).try_for_each(|index| writer.write_chunk(index))?;
        let [visual_triangles, collision_triangles] = writer.triangles;
        writer.finish(&name)?;
        let install = match bundle {
            Some(Bundle::Tgz) => "in Unity: Package Manager, +, Add package from tarball".to_owned(),
            _ => format!("copy the folder to Packages/{name} of a Unity project"),
        };
        let open = format!("{install}; then drag Runtime/{}.prefab into a scene", scene.name);
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::UNITY
    }

    fn references(&self) -> &'static [&'static str] {
        &["Materials name a shader of Unity (Unity Companion License), which comes with its render pipeline."]
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == Collision::Pieces
    }

    fn moves_things(&self) -> bool {
        true
    }
}

/// Its name for the Package Manager, which allows no capital letters and at most 214 characters.
fn package_name(scene: &str) -> String {
    let name: String = scene.chars().take(200).collect();
    format!("com.plume.{}", name.replace('_', "-"))
}

/// A collision mesh of a chunk.
struct Shape {
    name: String,
    mesh: Mesh,
    zone: Zone,
}

/// A package being written.
struct Writer<'a> {
    settings: &'a UnitySettings,
    scene: &'a Scene<'a>,
    assets: Assets<'a>,
    prefab: Prefab,
    friction: Vec<(Zone, Guid)>,
    triangles: [u64; 2],
    things: Things,
}

impl Writer<'_> {
    fn write_chunk(&mut self, index: usize) -> Result<(), ExportError> {
        let chunk = self.scene.chunk(index)?;
        self.triangles[0] += chunk.visual.triangles();
        self.triangles[1] += match chunk.content {
            Content::Wall | Content::Gravel { .. } => self.add_wall(&chunk, index)?,
            Content::Things { .. } => self.add_things(&chunk, index)?,
        };
        Ok(())
    }

    /// Writes the wall of a chunk and adds it to the prefab. Returns the number of its collision triangles.
    fn add_wall(&mut self, chunk: &Chunk, index: usize) -> Result<u64, ExportError> {
        let shapes = match self.settings.collision {
            Collision::Triangles if chunk.collides() => vec![whole(chunk)],
            Collision::Triangles => Vec::new(),
            Collision::Pieces => pieces(&chunk.name, self.scene.pieces(index)?),
        };
        let meshes: Vec<&Mesh> = chunk.levels().map(|(mesh, _)| mesh).collect();
        let textures = texture::write(&chunk.material, &meshes, &mut self.assets)?;
        let material = material::write(&chunk.material.name, self.settings.pipeline, &textures, &mut self.assets)?;
        let colliders = shapes.iter().map(|shape| fbx::Collider { name: shape.name.clone(), mesh: &shape.mesh });
        let part = fbx::Part {
            name: &chunk.name,
            levels: fbx::levels(chunk).collect(),
            colliders: colliders.collect(),
            material: &chunk.material.name,
            maps: &maps(&textures),
        };
        let model = Model { guid: self.write_model(&part, material)?, material };
        let group = self.prefab.add_chunk(chunk, &part.levels, model);
        for zone in Zone::ALL {
            let of_zone: Vec<&Shape> = shapes.iter().filter(|shape| shape.zone == zone).collect();
            if !of_zone.is_empty() {
                self.add_colliders(group, &chunk.name, zone, &of_zone, model)?;
            }
        }
        Ok(shapes.iter().map(|shape| shape.mesh.triangles()).sum())
    }

    fn write_model(&mut self, part: &fbx::Part, material: Guid) -> Result<Guid, ExportError> {
        let path = format!("Runtime/Meshes/{}.fbx", part.name);
        let head = fbx::Head { generator: &self.scene.generator, up: Up::Y };
        fbx::write(self.assets.out, &path, &head, |document, _| document.add(part))?;
        let levels = part.levels.iter().map(|level| &level.name);
        let meshes = levels.chain(part.colliders.iter().map(|collider| &collider.name));
        let table = meshes.map(|name| context! { name, id => identity::mesh(name) });
        let values = context! {
            name => part.material,
            material => material.to_string(),
            meshes => table.collect::<Vec<_>>(),
        };
        self.assets.fill_meta(&path, include_str!("../templates/unity/model.meta.jinja"), &values)
    }

    fn add_colliders(
        &mut self,
        group: usize,
        chunk: &str,
        zone: Zone,
        shapes: &[&Shape],
        model: Model,
    ) -> Result<(), ExportError> {
        let friction = self.friction(zone)?;
        let convex = self.settings.collision == Collision::Pieces;
        let colliders: Vec<_> =
            shapes.iter().map(|shape| prefab::Collider { mesh: &shape.name, convex, friction }).collect();
        let name = match self.settings.collision {
            Collision::Triangles => format!("{chunk}_collision"),
            Collision::Pieces => format!("{chunk}_{}", zone.name()),
        };
        self.prefab.add_colliders(group, &name, &colliders, model);
        Ok(())
    }

    /// The friction asset of a zone, written on first use.
    fn friction(&mut self, zone: Zone) -> Result<Guid, ExportError> {
        if let Some((_, guid)) = self.friction.iter().find(|(known, _)| *known == zone) {
            return Ok(*guid);
        }
        let path = format!("Runtime/Physics/{}.physicMaterial", zone.name());
        let values = context! { zone => zone.name(), friction => micro(self.scene.friction.of(zone)) };
        let text = template::fill(&path, include_str!("../templates/unity/friction.jinja"), &values);
        let guid = self.assets.text(&path, &text, Importer::Native(FRICTION_OBJECT))?;
        self.friction.push((zone, guid));
        Ok(guid)
    }

    /// Writes what is shared by all chunks.
    fn finish(mut self, name: &str) -> Result<(), ExportError> {
        let scene = self.scene;
        self.prefab.add_spawns(&scene.spawns);
        self.prefab.add_stations(&scene.network.landmarks());
        if self.settings.lights {
            self.prefab.add_lights(&scene.lights, self.settings.pipeline.per_candela());
        }
        let path = format!("Runtime/{}.prefab", scene.name);
        let Self { assets, prefab, things, .. } = &mut self;
        assets.write(&path, Importer::Prefab, |file| {
            prefab.write(file)?;
            things.write(scene, prefab, file)
        })?;
        self.assets.write("package.json", Importer::Manifest, |file| write_pretty(file, &manifest(scene, name)))?;
        let readme = self.readme(name);
        self.assets.text("README.md", &readme, Importer::Text)?;
        let later = [
            (LICENSE, true),
            (INSTANCES, self.things.are_there()),
            (STATIONS, scene.network.has_names()),
            (MANIFEST, true),
        ];
        let later: Vec<&str> = later.into_iter().filter(|(_, is_there)| *is_there).map(|(path, _)| path).collect();
        self.assets.finish(&later)
    }

    fn readme(&self, package: &str) -> String {
        let scene = self.scene;
        let zones = self.friction.iter().map(|&(zone, _)| (zone.name(), micro(scene.friction.of(zone))));
        let values = context! {
            package,
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            pipeline => self.settings.pipeline.title(),
            pieces => self.settings.collision == Collision::Pieces,
            things => self.things.are_there(),
            lights => if self.settings.lights { scene.lights.len() } else { 0 },
            zones => zones.collect::<Vec<_>>(),
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            gravity => micro(scene.gravity),
            spawns => scene.spawns.len(),
        };
        template::fill("README.md", include_str!("../templates/unity/README.md.jinja"), &values)
    }
}

/// The main object of a `.physicMaterial`.
const FRICTION_OBJECT: u32 = 13_400_000;

/// The images of a model.
fn maps(textures: &Textures) -> fbx::Maps {
    fbx::Maps {
        base_color: format!("../Textures/{}", textures.base_color.file),
        normal: format!("../Textures/{}", textures.normal.file),
        roughness: None,
        occlusion_roughness_metalness: None,
    }
}

/// The collision mesh of a chunk, with the friction of the floor.
fn whole(chunk: &Chunk) -> Shape {
    Shape { name: format!("{}_collision", chunk.name), mesh: chunk.collision.clone(), zone: Zone::Floor }
}

fn pieces(chunk: &str, pieces: Vec<Piece>) -> Vec<Shape> {
    let shape = |(number, piece): (usize, Piece)| Shape {
        name: format!("{chunk}_piece_{number}"),
        mesh: piece.mesh,
        zone: piece.zone,
    };
    pieces.into_iter().enumerate().map(shape).collect()
}

/// `package.json` (<https://docs.unity3d.com/Manual/upm-manifestPkg.html>).
fn manifest(scene: &Scene, name: &str) -> Value {
    json!({
        "name": name,
        "version": "1.0.0",
        "displayName": scene.name.replace('_', " "),
        "description": scene.description,
        "unity": "2021.3",
        "keywords": ["cave", "environment", "robotics"],
        "hideInEditor": false,
    })
}
