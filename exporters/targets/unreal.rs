//! Target `unreal`: meshes, textures and a Python script that imports them as a level into Unreal Engine 5.3 and later.
//!
//! ```text
//! README.md
//! import_cave.py   run inside the editor
//! scene.json       what it reads: chunks, things, spawn poses, lights and friction in Unreal's frame
//! meshes/<chunk>.fbx, <chunk>_collision.fbx, <prototype>_level<n>.fbx
//! textures/<chunk>_{base_color,normal,orm}.*
//! ```
//! FBX is metres, right-handed, Z up, its front −Y: Unreal's importer then only changes the unit and mirrors y
//! ([`frame::unreal_from_scene`](crate::frame::unreal_from_scene)). All chunks are placed at the origin. Normal maps have
//! the green channel of DirectX; the other images are those of the scene. Height maps are omitted.
//!
//! Unreal finds convex pieces by the name of a mesh, not of its LOD group: those of `<chunk>` are called
//! `UCX_<chunk>_LOD0_<NN>`. With triangles, bodies collide with a separate mesh ("complex collision mesh"), because Nanite
//! keeps only a coarse fallback of the visual mesh for physics.
//!
//! Things with the same mesh are instances of one component, in place, with a convex piece each, whatever the collision of the
//! walls.
//!
//! Not tested in Unreal itself. The script is tested with a stub that has only the documented names, and it compares what
//! was imported with what is expected.

use minijinja::context;
use minijinja::value::Serde;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::collision::Collision;
use crate::error::ExportError;
use crate::format::{fbx, pixels};
use crate::frame::{Axes, Up, micro};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Content, Material, Piece, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, names, template};
use index::{Entry, Textures};
use things::{Shape, Things};

mod index;
mod things;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "unreal",
    summary: "FBX with levels of detail and collision, textures, and a script that imports them",
    revision: 0,
    opened_by: "Unreal Engine 5.3 and later",
    contents: "an FBX per chunk with levels of detail and collision, one per shape of things, normal maps in the DirectX \
        convention, and a Python script that builds materials, Nanite, collision and a level with instanced things (5.3 and \
        later)",
    tested_by: "not in Unreal itself: the script runs against a strict stub of the module `unreal`, which lists every \
        call; ufbx",
    checks: &["blender", "libassimp"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<UnrealSettings>,
    build: Build::Plain(|table| Ok(Box::new(Unreal(serde_json::from_value(table)?)))),
};

/// Settings of target `unreal`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct UnrealSettings {
    /// Collision shapes. All have the friction of the floor, because Unreal has one physical material per mesh.
    pub collision: Collision,
    /// Render the chunks with Nanite; where it is not supported, Unreal falls back to levels of detail.
    pub nanite: bool,
    /// Include coarser levels of detail. Each is shown where its error is below a pixel, on a screen of 1920 × 1080 with
    /// a field of view of 90°.
    pub lods: bool,
    /// Include the lights of the scene; without them only the robot's own lights shine.
    pub lights: bool,
}

impl Default for UnrealSettings {
    fn default() -> Self {
        Self { collision: Collision::Triangles, nanite: true, lods: true, lights: true }
    }
}

/// The target.
pub struct Unreal(
    /// Its settings.
    pub UnrealSettings,
);

impl Target for Unreal {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (mut entries, mut things) = (Vec::new(), Things::of(scene)?);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            match chunk.content {
                Content::Wall | Content::Gravel { .. } => entries.push(self.write_chunk(scene, index, &chunk, out)?),
                Content::Things { .. } => things.add(self, scene, &scene.instances(index)?, out)?,
            }
        }
        let shapes = things.shapes();
        index::write(scene, &self.0, &entries, &shapes, out)?;
        out.text("import_cave.py", include_str!("../templates/unreal/import_cave.py"))?;
        out.text("README.md", &self.readme(scene, &entries, &shapes))?;
        Ok(Summary {
            visual_triangles: entries.iter().map(Entry::visual_triangles).sum::<u64>()
                + shapes.iter().map(|shape| shape.entry.visual_triangles() * shape.count()).sum::<u64>(),
            collision_triangles: entries.iter().map(|entry| entry.collision_triangles).sum::<u64>()
                + shapes.iter().map(|shape| shape.entry.collision_triangles * shape.count()).sum::<u64>(),
            open: Open::Words("in Unreal's command box: py <this folder>/import_cave.py".to_owned()),
        })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == Collision::Pieces
    }
}

impl Unreal {
    fn write_chunk(
        &self,
        scene: &Scene,
        index: usize,
        chunk: &Chunk,
        out: &mut dyn Package,
    ) -> Result<Entry, ExportError> {
        let textures = write_textures(&chunk.material, out)?;
        let mut entry = Entry::new(&chunk.name, &chunk.material.name, &chunk.visual, textures);
        let levels = self.levels(fbx::levels(chunk));
        entry.set_levels(&levels);
        let head = fbx::Head { generator: &scene.generator, up: Up::Z };
        match self.0.collision {
            Collision::Triangles => {
                write_visual(&head, &entry, levels, Vec::new(), out)?;
                if chunk.collides() {
                    write_collision(&head, chunk, &mut entry, out)?;
                }
            }
            Collision::Pieces => {
                let pieces = scene.pieces(index)?;
                entry.set_pieces(&pieces);
                write_visual(&head, &entry, levels, colliders(&chunk.name, &pieces), out)?;
            }
        }
        Ok(entry)
    }

    /// The full detail and, if requested, the coarser levels.
    fn levels<'a>(&self, all: impl Iterator<Item = fbx::Level<'a>>) -> Vec<fbx::Level<'a>> {
        all.take(if self.0.lods { usize::MAX } else { 1 }).collect()
    }

    fn readme(&self, scene: &Scene, entries: &[Entry], shapes: &[Shape]) -> String {
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            settings => Serde(&self.0),
            chunks => entries.len(),
            shapes => shapes.len(),
            things => shapes.iter().map(Shape::count).sum::<u64>(),
            pieces => entries.iter().map(|entry| entry.convex_pieces).sum::<usize>(),
            friction => micro(scene.friction.floor),
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            spawns => scene.spawns.len(),
            lights => if self.0.lights { scene.lights.len() } else { 0 },
            stations => scene.network.has_names(),
        };
        template::fill("README.md", include_str!("../templates/unreal/README.md.jinja"), &values)
    }
}

fn write_textures(material: &Material, out: &mut dyn Package) -> Result<Textures, ExportError> {
    material.refuse_unless(ROW.name, ROW.images)?;
    let path = |role: &str, extension: &str| format!("textures/{}_{role}.{extension}", material.name);
    let textures = Textures {
        base_color: path("base_color", material.base_color.format.extension()),
        normal: path("normal", "png"),
        orm: path("orm", material.orm.format.extension()),
    };
    out.share(&textures.base_color, &material.base_color)?;
    if !out.has(&textures.normal) {
        out.write(&textures.normal, |file| pixels::remap(&material.normal, file, |[r, g, b]| [r, 255 - g, b]))?;
    }
    out.share(&textures.orm, &material.orm)?;
    Ok(textures)
}

fn write_visual(
    head: &fbx::Head,
    entry: &Entry,
    levels: Vec<fbx::Level>,
    colliders: Vec<fbx::Collider>,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let maps = entry.textures.maps();
    fbx::write(out, &entry.mesh, head, |document, _| {
        document.add(&fbx::Part { name: &entry.name, levels, colliders, material: &entry.material, maps: &maps })
    })
}

/// The collision mesh, in a separate file: for Unreal it is a mesh like any other.
fn write_collision(
    head: &fbx::Head,
    chunk: &Chunk,
    entry: &mut Entry,
    out: &mut dyn Package,
) -> Result<(), ExportError> {
    let name = format!("{}_collision", chunk.name);
    let path = format!("meshes/{name}.fbx");
    let colliders = vec![fbx::Collider { name: name.clone(), mesh: &chunk.collision }];
    fbx::write(out, &path, head, |document, _| {
        document.add(&fbx::Part {
            name: &name,
            levels: Vec::new(),
            colliders,
            material: &name,
            maps: &fbx::Maps::default(),
        })
    })?;
    entry.collision_triangles = chunk.collision.triangles();
    entry.collision_mesh = Some(path);
    Ok(())
}

/// Convex pieces, with names by which Unreal finds their mesh.
fn colliders<'a>(chunk: &str, pieces: &'a [Piece]) -> Vec<fbx::Collider<'a>> {
    fbx::convex_pieces(&names::level(chunk, 0), pieces)
}
