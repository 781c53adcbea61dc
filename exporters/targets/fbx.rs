//! Target `fbx`: binary FBX 7.4 with separate textures, metres.
//!
//! ```text
//! <name>.fbx     chunks, start poses and lights
//! chunks/        with `per_chunk`: the chunks
//! textures/
//! README.md
//! ```
//! Start poses are empty nodes `spawn_<N>`, whose +X points ahead and whose +Z is up, as are stations that a survey names.
//!
//! Levels of detail are nodes `<chunk>_LOD<N>` in a group `<chunk>` (`LodGroup`). Without coarser levels there is one node
//! `<chunk>`. Programs that do not support such groups, among them Blender and three.js, show all levels together.
//!
//! Things are nodes `<class>_<id>` below a node `<chunk>`, at their poses and in their sizes. They share one geometry per
//! prototype and level. With coarser levels a thing is a group (`LodGroup`) of nodes `<class>_<id>_LOD<N>`.
//!
//! Collision meshes are identified by names, since FBX does not support them. A concave mesh is called `<chunk>_collision`. A
//! convex piece is called `UCX_<mesh>_<NN>` after the full-detail mesh, `<chunk>_LOD0` or `<chunk>`, by which Unreal knows
//! that it belongs to that mesh and is not rendered. Other programs render both. The convex pieces of things share their
//! geometries, too.
//!
//! Materials are Phong, the only kind that every reader supports. It has no slot for roughness: the map is where Blender looks
//! for it, in place of shininess. Unreal reads metalness there, so it should not import materials.
//!
//! Memory: one chunk, loaded once, and the prototypes of things.

use minijinja::context;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::format::fbx::{self, Collider, Document, Head, Level, Maps, Part, Things};
use crate::frame::{Axes, Up};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, template};

use self::loaded::Loaded;

mod loaded;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "fbx",
    summary: "binary FBX 7.4 with textures, levels of detail, start poses and lights",
    revision: 0,
    opened_by: "Blender, Maya, 3ds Max, Houdini, three.js, most mesh tools",
    contents: "binary FBX 7.4, metres: levels of detail in LOD groups, tangents, things that share geometry, collision \
        meshes by name, start poses, lights",
    tested_by: "ufbx without a warning; Blender 4.2; assimp; three.js in Chromium",
    checks: &["three-fbx", "blender", "libassimp"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<FbxSettings>,
    build: Build::Plain(|table| Ok(Box::new(Fbx(serde_json::from_value(table)?)))),
};

/// Settings of target `fbx`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct FbxSettings {
    /// Write one file per chunk instead of a single file: for streaming, or beyond the format's limit of 4 GiB.
    pub per_chunk: bool,
    /// Which axis points up. Most readers rotate the world according to the axes in the file; `y` suits those that do not.
    pub up: Up,
    /// Include coarser levels of detail.
    pub lods: bool,
    /// Include the lights of the scene.
    pub lights: bool,
    /// Collision shapes.
    pub collision: FbxCollision,
}

/// Collision meshes recognised by importers by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FbxCollision {
    /// No collision meshes.
    #[default]
    None,
    /// A concave mesh per chunk, named `<chunk>_collision`.
    Triangles,
    /// Convex pieces of the rock behind the wall, named `UCX_<mesh>_<NN>` as Unreal expects.
    Pieces,
}

impl Default for FbxSettings {
    fn default() -> Self {
        Self { per_chunk: false, up: Up::Z, lods: true, lights: true, collision: FbxCollision::None }
    }
}

/// The target.
pub struct Fbx(
    /// Its settings.
    pub FbxSettings,
);

impl Target for Fbx {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let head = Head { generator: &scene.generator, up: self.0.up };
        let path = format!("{}.fbx", scene.name);
        let prototypes = scene.prototypes()?;
        let mut triangles = [0, 0];
        fbx::write(out, &path, &head, |document, out| {
            self.add_places(scene, document)?;
            for index in 0..scene.chunks.len() {
                let chunk = Loaded::new(scene, index, &prototypes, self.0.collision)?;
                match self.0.per_chunk {
                    true => self.write_chunk(&chunk, &head, out)?,
                    false => self.add_chunk(&chunk, "", document, out)?,
                }
                triangles[0] += chunk.chunk.visual.triangles();
                triangles[1] += chunk.collision_triangles(self.0.collision);
            }
            Ok(())
        })?;
        self.write_readme(scene, !prototypes.is_empty(), out)?;
        Ok(Summary {
            visual_triangles: triangles[0],
            collision_triangles: triangles[1],
            open: Open::Words(self.how_to_open(&scene.name)),
        })
    }

    fn axes(&self) -> Axes {
        match self.0.up {
            Up::Y => Axes::GLTF,
            Up::Z => Axes::SCENE,
        }
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == FbxCollision::Pieces
    }
}

impl Fbx {
    /// Start poses, surveyed stations and lights.
    fn add_places(&self, scene: &Scene, document: &mut Document) -> Result<(), ExportError> {
        for (number, pose) in scene.spawns.iter().enumerate() {
            document.add_pose(&format!("spawn_{number}"), pose)?;
        }
        for landmark in scene.network.landmarks() {
            document.add_pose(&landmark.frame, &landmark.pose())?;
        }
        match self.0.lights {
            true => scene.lights.iter().try_for_each(|light| document.add_light(light)),
            false => Ok(()),
        }
    }

    fn write_chunk(&self, chunk: &Loaded, head: &Head, out: &mut dyn Package) -> Result<(), ExportError> {
        let path = format!("chunks/{}.fbx", chunk.chunk.name);
        fbx::write(out, &path, head, |document, out| self.add_chunk(chunk, "../", document, out))
    }

    /// Adds a chunk to a file; `to_package` is the relative path from it to the folder of the package.
    fn add_chunk(
        &self,
        chunk: &Loaded,
        to_package: &str,
        document: &mut Document,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let maps = copy_textures(&chunk.chunk, to_package, out)?;
        match chunk.chunk.content {
            Content::Wall | Content::Gravel { .. } => self.add_wall(chunk, &maps, document),
            Content::Things { .. } => self.add_things(chunk, &maps, document),
        }
    }

    fn add_wall(&self, chunk: &Loaded, maps: &Maps, document: &mut Document) -> Result<(), ExportError> {
        let levels = self.levels(&chunk.chunk);
        let colliders = match self.0.collision {
            FbxCollision::None => Vec::new(),
            FbxCollision::Triangles if chunk.chunk.collides() => vec![concave(&chunk.chunk)],
            FbxCollision::Triangles => Vec::new(),
            FbxCollision::Pieces => fbx::convex_pieces(&levels[0].name, &chunk.pieces),
        };
        let name = &chunk.chunk.name;
        document.add(&Part { name, levels, colliders, material: &chunk.chunk.material.name, maps })
    }

    fn add_things(&self, chunk: &Loaded, maps: &Maps, document: &mut Document) -> Result<(), ExportError> {
        let (name, material) = (chunk.chunk.name.as_str(), chunk.chunk.material.name.as_str());
        let hulls = self.0.collision == FbxCollision::Pieces;
        document.add_things(&Things { name, things: &chunk.things, lods: self.0.lods, hulls, material, maps })?;
        match self.0.collision {
            FbxCollision::Triangles => {
                let colliders = vec![concave(&chunk.chunk)];
                document.add(&Part { name, levels: Vec::new(), colliders, material, maps })
            }
            FbxCollision::None | FbxCollision::Pieces => Ok(()),
        }
    }

    fn levels<'a>(&self, chunk: &'a Chunk) -> Vec<Level<'a>> {
        match self.0.lods && !chunk.lods.is_empty() {
            true => fbx::levels(chunk).collect(),
            false => vec![Level { name: chunk.name.clone(), mesh: &chunk.visual, error_m: 0.0 }],
        }
    }

    fn write_readme(&self, scene: &Scene, things: bool, out: &mut dyn Package) -> Result<(), ExportError> {
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            per_chunk => self.0.per_chunk,
            y_up => self.0.up == Up::Y,
            lods => self.0.lods,
            things,
            lights => if self.0.lights { scene.lights.len() } else { 0 },
            triangles => self.0.collision == FbxCollision::Triangles,
            pieces => self.0.collision == FbxCollision::Pieces,
            spawns => scene.spawns.len(),
            open => self.how_to_open(&scene.name),
        };
        out.text("README.md", &template::fill("README.md", include_str!("../templates/fbx/README.md.jinja"), &values))
    }

    fn how_to_open(&self, name: &str) -> String {
        match self.0.per_chunk {
            true => format!("import the files of chunks/ together, and {name}.fbx for start poses and lights"),
            false => format!("import {name}.fbx"),
        }
    }
}

/// The collision mesh of a chunk.
fn concave(chunk: &Chunk) -> Collider<'_> {
    Collider { name: format!("{}_collision", chunk.name), mesh: &chunk.collision }
}

fn copy_textures(chunk: &Chunk, to_package: &str, out: &mut dyn Package) -> Result<Maps, ExportError> {
    let mut copy =
        |role, image| out.texture("", &chunk.material.name, role, image).map(|path| format!("{to_package}{path}"));
    let material = &chunk.material;
    Ok(Maps {
        base_color: copy("base_color", &material.base_color)?,
        normal: copy("normal", &material.normal)?,
        roughness: Some(copy("roughness", &material.roughness)?),
        occlusion_roughness_metalness: Some(copy("orm", &material.orm)?),
    })
}
