//! Target `obj`: Wavefront OBJ with MTL and images, Z up, metres: what nearly every 3D program opens.
//!
//! ```text
//! <name>.obj, <name>.mtl, textures/            an object per chunk, and its material
//! <name>_lod1.obj, …                           coarser levels, with `lods`
//! <name>_collision.obj                         collision shapes, unless `collision = "none"`
//! README.md
//! ```
//! or the same below `chunks/` for each chunk. OBJ has no units or axes: a comment states them. Occlusion is omitted, since
//! MTL has no key for it.
//!
//! A level of the whole cave has each chunk at that level, or at its coarsest; the borders of chunks are the same at every
//! level.

use std::collections::BTreeSet;
use std::io::Write;

use minijinja::context;
use minijinja::value::Serde;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::chunk_files::{self, ChunkFiles, Stem, TempFile, Triangles};
use crate::error::ExportError;
use crate::format::obj::{self, Maps};
use crate::frame::{Axes, sdf_pose};
use crate::image_format::ImageFormat;
use crate::package::Package;
use crate::scene::{Chunk, Material, Mesh, Scene};
use crate::{Build, Open, Summary, Target, TargetRow, template};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "obj",
    summary: "Wavefront OBJ with PBR keys in the MTL, and a collision mesh",
    revision: 0,
    opened_by: "nearly every 3D program",
    contents: "OBJ and MTL with PBR keys; collision mesh and coarser levels as options",
    tested_by: "tobj, trimesh, Blender 4.2, assimp",
    checks: &["trimesh", "blender", "libassimp", "orient"],
    images: &ImageFormat::COMMON,
    is_single_file: false,
    has_pieces: true,
    bundles: &[],
    settings: plume_registry::settings_schema::<ObjSettings>,
    build: Build::Plain(|table| Ok(Box::new(Obj(serde_json::from_value(table)?)))),
};

/// Settings of target `obj`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct ObjSettings {
    /// Write one set of files per chunk instead of a single one.
    pub per_chunk: bool,
    /// Write coarser levels of detail, one file each.
    pub lods: bool,
    /// Collision shapes, in a separate file.
    pub collision: SeparateCollision,
}

/// Collision shapes in separate files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SeparateCollision {
    /// None.
    None,
    /// A concave mesh per chunk.
    #[default]
    Triangles,
    /// Convex pieces of the rock behind the wall, one object each.
    Pieces,
}

/// The target.
pub struct Obj(
    /// Its settings.
    pub ObjSettings,
);

impl Target for Obj {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let comment = format!("{}, made by {}; metres, right-handed, Z up", scene.name, scene.generator);
        let [visual_triangles, collision_triangles] =
            chunk_files::write(scene, self.0.per_chunk, out, |stem| ObjFiles::start(&self.0, &comment, stem))?;
        let open = chunk_files::how_to_open(scene, self.0.per_chunk, "obj");
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            stations => scene.network.has_names(),
            per_chunk => self.0.per_chunk,
            lods => self.0.lods,
            collision => Serde(self.0.collision),
            collision_error_mm => (scene.collision_error_m * 1000.0).ceil() as u64,
            view => sdf_pose(&scene.viewpoint()),
            triangles => visual_triangles,
        };
        let readme = include_str!("../templates/obj/README.md.jinja");
        out.text("README.md", &template::fill("README.md", readme, &values))?;
        Ok(Summary { visual_triangles, collision_triangles, open: Open::Words(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }

    fn wants_pieces(&self) -> bool {
        self.0.collision == SeparateCollision::Pieces
    }
}

/// The files of the whole cave or of a chunk.
struct ObjFiles<'a> {
    settings: &'a ObjSettings,
    stem: Stem,
    materials: TempFile,
    /// Names of the materials so far, since chunks may share them.
    known: BTreeSet<String>,
    /// Levels, full detail first. Each has the chunks so far at its level or at their coarsest.
    levels: Vec<ObjFile>,
    collision: Option<ObjFile>,
}

impl<'a> ObjFiles<'a> {
    fn start(settings: &'a ObjSettings, comment: &'a str, stem: Stem) -> Result<Self, ExportError> {
        let mut full = ObjFile::create(&stem, ".obj", comment)?;
        obj::write_library(&mut full.file, &format!("{}.mtl", stem.name))?;
        let collision = match settings.collision {
            SeparateCollision::None => None,
            _ => Some(ObjFile::create(&stem, "_collision.obj", comment)?),
        };
        Ok(Self {
            settings,
            materials: stem.grow(".mtl")?,
            known: BTreeSet::new(),
            stem,
            levels: vec![full],
            collision,
        })
    }

    fn add_levels(&mut self, chunk: &Chunk) -> Result<(), ExportError> {
        let lods = if self.settings.lods { &chunk.lods[..] } else { &[] };
        // A missing file starts as a copy of the coarsest so far: no earlier chunk had more levels.
        while self.levels.len() <= lods.len() {
            let ending = format!("_lod{}.obj", self.levels.len());
            let deepest = self.levels.last_mut().expect("full detail is always there");
            let deeper = ObjFile { file: self.stem.grow_from(&mut deepest.file, &ending)?, vertices: deepest.vertices };
            self.levels.push(deeper);
        }
        for (level, file) in self.levels.iter_mut().enumerate() {
            let mesh = match level.min(lods.len()) {
                0 => &chunk.visual,
                level => &lods[level - 1].mesh,
            };
            obj::write_visual(&mut file.file, &chunk.name, &chunk.material.name, mesh, file.vertices)?;
            file.vertices += mesh.positions.len() as u64;
        }
        Ok(())
    }

    fn add_collision(&mut self, scene: &Scene, index: usize, chunk: &Chunk) -> Result<u64, ExportError> {
        let Some(file) = self.collision.as_mut().filter(|_| chunk.collides()) else { return Ok(0) };
        if self.settings.collision == SeparateCollision::Triangles {
            return file.add_collision(&chunk.name, &chunk.collision);
        }
        let mut triangles = 0;
        for (number, piece) in scene.pieces(index)?.iter().enumerate() {
            triangles += file.add_collision(&format!("{}_{number}", chunk.name), &piece.mesh)?;
        }
        Ok(triangles)
    }

    fn add_material(&mut self, material: &Material, out: &mut dyn Package) -> Result<(), ExportError> {
        if !self.known.insert(material.name.clone()) {
            return Ok(());
        }
        let mut copy = |role, image| out.texture(self.stem.folder, &material.name, role, image);
        let base_color = copy("base_color", &material.base_color)?;
        let normal = copy("normal", &material.normal)?;
        let roughness = copy("roughness", &material.roughness)?;
        let maps = Maps { base_color: &base_color, normal: &normal, roughness: &roughness };
        let height = material.height.as_ref();
        let displacement =
            height.map(|height| Ok::<_, ExportError>((copy("height", &height.image)?, height.amplitude_m)));
        obj::write_material(&mut self.materials, &material.name, &maps)?;
        match displacement.transpose()? {
            Some((file, amplitude_m)) => Ok(obj::write_displacement(&mut self.materials, &file, amplitude_m)?),
            None => Ok(()),
        }
    }
}

impl ChunkFiles for ObjFiles<'_> {
    fn add(
        &mut self,
        scene: &Scene,
        index: usize,
        chunk: &Chunk,
        out: &mut dyn Package,
    ) -> Result<Triangles, ExportError> {
        chunk.material.refuse_unless(ROW.name, ROW.images)?;
        self.add_material(&chunk.material, out)?;
        self.add_levels(chunk)?;
        Ok([chunk.visual.triangles(), self.add_collision(scene, index, chunk)?])
    }

    fn finish(self, out: &mut dyn Package) -> Result<(), ExportError> {
        let collision = self.collision.filter(|collision| collision.vertices > 0);
        let meshes = self.levels.into_iter().chain(collision).map(|mesh| mesh.file);
        [self.materials].into_iter().chain(meshes).try_for_each(|file| file.finish(out))
    }
}

/// An OBJ being written.
struct ObjFile {
    file: TempFile,
    vertices: u64,
}

impl ObjFile {
    fn create(stem: &Stem, ending: &str, comment: &str) -> Result<Self, ExportError> {
        let mut file = stem.grow(ending)?;
        writeln!(file, "# {comment}")?;
        Ok(Self { file, vertices: 0 })
    }

    /// Returns the number of triangles.
    fn add_collision(&mut self, name: &str, mesh: &Mesh) -> Result<u64, ExportError> {
        obj::write_collision(&mut self.file, name, mesh, self.vertices)?;
        self.vertices += mesh.positions.len() as u64;
        Ok(mesh.triangles())
    }
}
