//! The scene: everything that an exporter needs, resolved; metres, kilograms, seconds, radians; right-handed, Z up.
//!
//! Chunks are loaded one at a time, so memory does not grow with their number.
//!
//! ```
//! use plume_exporters::scene::Mesh;
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, -1.0]];
//! let mesh = Mesh { positions, indices: vec![0, 1, 2], ..Mesh::default() };
//! assert_eq!((mesh.triangles(), mesh.bounds()), (1, [[0.0, 0.0, -1.0], [1.0, 1.0, 0.0]]));
//! ```

use std::path::PathBuf;

use nalgebra::{Isometry3, Point3, Translation3};

use crate::error::ExportError;
use crate::image_format::ImageFormat;
use crate::names;

pub use self::network::{Georeference, Landmark, MOST_FRAMES, Network, Station};
pub use self::things::{Gravel, Instance, Prototype, Stone};

mod network;
mod things;

/// A static world in chunks.
#[derive(Clone)]
pub struct Scene<'a> {
    /// Safe name: `[a-z][a-z0-9_]*` (see `names`).
    pub name: String,
    /// One sentence for a human.
    pub description: String,
    /// What made it, e.g. `plume 0.1.0`.
    pub generator: String,
    /// The text from which alone this scene can be made again, if there is one.
    pub recipe: String,
    /// SHA-256 of everything that a package of it follows from, by which an existing one is recognised; may be empty.
    pub fingerprint: String,
    /// The seed in the recipe.
    pub seed: u64,
    /// The chunks, in a fixed order.
    pub chunks: &'a dyn Chunks,
    /// Start poses; never empty. +X points along the passage, +Z is up, the origin is on the ground.
    pub spawns: Vec<Isometry3<f64>>,
    /// Lights.
    pub lights: Vec<Light>,
    /// The passages, as far as they are known; may be empty.
    pub network: Network,
    /// Where the world lies in the coordinates of a survey, if it was made from one.
    pub georeference: Option<Georeference>,
    /// Classes of things that are there to be searched for.
    pub sought: Vec<String>,
    /// Coulomb friction of rubber on the rock.
    pub friction: ByZone,
    /// Downward acceleration in m/s².
    pub gravity: f64,
    /// Upper bound of the distance between collision mesh and visual mesh, in metres.
    pub collision_error_m: f64,
    /// Upper bound of how far convex pieces reach into the air beyond the visual mesh, in metres.
    pub piece_tolerance_m: ByZone,
}

impl Scene<'_> {
    /// Checks what can be checked without loading a chunk.
    ///
    /// # Errors
    /// [`ExportError::BadScene`] if a name is not safe or not unique, there is no chunk or no start pose, or a passage leads nowhere.
    pub fn check(&self) -> Result<(), ExportError> {
        if !names::is_safe(&self.name) {
            return Err(self.fault("its name is not `[a-z][a-z0-9_]*`".to_owned()));
        }
        if self.chunks.is_empty() || self.spawns.is_empty() {
            return Err(self.fault("it has no chunk or no spawn pose".to_owned()));
        }
        let mut lights: Vec<&str> = self.lights.iter().map(|light| light.name.as_str()).collect();
        lights.sort_unstable();
        if lights.windows(2).any(|pair| pair[0] == pair[1]) || !lights.into_iter().all(names::is_safe) {
            return Err(self.fault("the name of a light is taken or not `[a-z][a-z0-9_]*`".to_owned()));
        }
        self.network.fault().map_or(Ok(()), |fault| Err(self.fault(fault.to_owned())))
    }

    /// Loads a chunk and checks it, so that exporters may index its arrays.
    ///
    /// # Errors
    /// [`ExportError::Load`] if it cannot be read, [`ExportError::BadScene`] if its arrays are inconsistent.
    pub fn chunk(&self, index: usize) -> Result<Chunk, ExportError> {
        let chunk =
            self.chunks.load(index).map_err(|source| ExportError::Load { scene: self.name.clone(), index, source })?;
        let fault = |part, fault: &str| self.fault(format!("{part} of chunk `{}` {fault}", chunk.name));
        if !names::is_safe(&chunk.name) {
            return Err(fault("name", "is not `[a-z][a-z0-9_]*`"));
        }
        if !names::is_safe(&chunk.material.name) {
            return Err(fault("material", "has a name that is not `[a-z][a-z0-9_]*`"));
        }
        chunk.visual.check(Part::Visual).map_err(|text| fault("visual mesh", text))?;
        for lod in &chunk.lods {
            lod.mesh.check(Part::Visual).map_err(|text| fault("coarser visual mesh", text))?;
        }
        if chunk.collides() {
            chunk.collision.check(Part::Collision).map_err(|text| fault("collision mesh", text))?;
        }
        Ok(chunk)
    }

    /// Loads the convex pieces of a chunk and checks them. Only for targets that [use](crate::Target::wants_pieces) them.
    ///
    /// # Errors
    /// As [`Scene::chunk`].
    pub fn pieces(&self, index: usize) -> Result<Vec<Piece>, ExportError> {
        let pieces = self.chunks.pieces(index).map_err(|source| ExportError::Load {
            scene: self.name.clone(),
            index,
            source,
        })?;
        for (number, piece) in pieces.iter().enumerate() {
            let checked = piece.mesh.check(Part::Collision);
            checked.map_err(|text| self.fault(format!("piece {number} of chunk {index} {text}")))?;
        }
        Ok(pieces)
    }

    /// The things of a chunk.
    ///
    /// # Errors
    /// [`ExportError::Load`] if they cannot be read.
    pub fn instances(&self, index: usize) -> Result<Vec<Instance>, ExportError> {
        let load = |source| ExportError::Load { scene: self.name.clone(), index, source };
        self.chunks.instances(index).map_err(load)
    }

    /// The stones of a chunk of gravel.
    ///
    /// # Errors
    /// [`ExportError::Load`] if they cannot be read, [`ExportError::BadScene`] if the arrays of a shape are inconsistent or
    /// one is missing.
    pub fn gravel(&self, index: usize) -> Result<Gravel, ExportError> {
        let load = |source| ExportError::Load { scene: self.name.clone(), index, source };
        let gravel = self.chunks.gravel(index).map_err(load)?;
        let fault = |text: &str| self.fault(format!("a shape of the gravel of chunk {index} {text}"));
        gravel.shapes.iter().try_for_each(|shape| shape.check(Part::Visual)).map_err(fault)?;
        match gravel.stones.iter().any(|stone| stone.shape >= gravel.shapes.len()) {
            true => Err(fault("is missing")),
            false => Ok(gravel),
        }
    }

    /// Loads the prototypes of all things and checks them.
    ///
    /// # Errors
    /// [`ExportError::Load`] if they cannot be read, [`ExportError::BadScene`] if their arrays are inconsistent.
    pub fn prototypes(&self) -> Result<Vec<Prototype>, ExportError> {
        let load = |source| ExportError::Load { scene: self.name.clone(), index: self.chunks.len(), source };
        let prototypes = self.chunks.prototypes().map_err(load)?;
        for Prototype { name, levels, hull, .. } in &prototypes {
            let fault = |text: &str| self.fault(format!("a mesh of prototype `{name}` {text}"));
            levels.iter().try_for_each(|level| level.mesh.check(Part::Visual)).map_err(fault)?;
            hull.check(Part::Collision).map_err(fault)?;
        }
        Ok(prototypes)
    }

    /// The initial viewpoint: 1 m above the first start pose. +X points ahead, +Z is up.
    pub fn viewpoint(&self) -> Isometry3<f64> {
        self.spawns[0] * Translation3::new(0.0, 0.0, 1.0)
    }

    fn fault(&self, fault: String) -> ExportError {
        ExportError::BadScene { scene: self.name.clone(), fault }
    }
}

/// Loads chunks one at a time.
pub trait Chunks: Sync {
    /// Number of chunks.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Loads a chunk.
    ///
    /// # Errors
    /// If it cannot be read.
    fn load(&self, index: usize) -> Result<Chunk, std::io::Error>;

    /// The neighbours of a chunk, which share a face, an edge or a corner of the grid with it, in their order.
    fn neighbors(&self, index: usize) -> Vec<usize>;

    /// Loads the convex pieces of a chunk.
    ///
    /// # Errors
    /// When they cannot be read.
    fn pieces(&self, index: usize) -> Result<Vec<Piece>, std::io::Error>;

    /// The things of a chunk, in the order of its pieces and of its visual mesh; none unless it [consists](Content) of things.
    ///
    /// # Errors
    /// When they cannot be read.
    fn instances(&self, _index: usize) -> Result<Vec<Instance>, std::io::Error> {
        Ok(Vec::new())
    }

    /// The stones of a chunk, in the order of its visual mesh; none unless it [consists](Content) of gravel.
    ///
    /// # Errors
    /// When they cannot be read.
    fn gravel(&self, _index: usize) -> Result<Gravel, std::io::Error> {
        Ok(Gravel::default())
    }

    /// The shapes of which the things of all chunks are copies.
    ///
    /// # Errors
    /// When they cannot be read.
    fn prototypes(&self) -> Result<Vec<Prototype>, std::io::Error> {
        Ok(Vec::new())
    }
}

/// A part of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// Safe name, unique in the scene, e.g. `chunk_0_2_1`.
    pub name: String,
    /// What it consists of.
    pub content: Content,
    /// The visual mesh in full detail.
    pub visual: Mesh,
    /// Coarser levels of detail with the same material, for distant cameras; may be empty. Vertices on the border of a chunk
    /// are those of `visual` at every level, so that levels of neighbouring chunks meet without cracks.
    pub lods: Vec<Lod>,
    /// The collision mesh: fewer triangles, positions and triangles only.
    pub collision: Mesh,
    /// Material of the visual mesh.
    pub material: Material,
}

/// What a chunk consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// The wall, which continues in its neighbours.
    Wall,
    /// Closed bodies on the wall, each with one convex piece.
    Things {
        /// Whether they move when they are pushed. If not, they are part of the static world.
        movable: bool,
    },
    /// Gravel, with which nothing collides.
    Gravel {
        /// Number of its stones.
        stones: usize,
    },
}

impl Chunk {
    /// Whether it has a collision mesh and convex pieces; without, its collision mesh is empty.
    pub fn collides(&self) -> bool {
        !matches!(self.content, Content::Gravel { .. })
    }

    /// Every level of detail, the full one first, with an upper bound of its distance from the full one, in metres.
    pub fn levels(&self) -> impl Iterator<Item = (&Mesh, f32)> {
        let coarser = self.lods.iter().map(|lod| (&lod.mesh, lod.error_m));
        std::iter::once((&self.visual, 0.0)).chain(coarser)
    }
}

/// A coarser level of detail of a visual mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Lod {
    /// The triangles, with all attributes.
    pub mesh: Mesh,
    /// Upper bound of its distance from the full detail, in metres.
    pub error_m: f32,
}

/// A convex piece of the rock behind the wall, for simulators that collide convex shapes only. Together the pieces of a
/// chunk cover its wall; they may overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its surface: closed, convex, at least four vertices that are not coplanar, every vertex a corner; positions and
    /// triangles only.
    pub mesh: Mesh,
    /// The zone of the wall that it covers.
    pub zone: Zone,
}

/// A zone of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Zone {
    /// What wheels stand on.
    Floor,
    /// What they bump into.
    Wall,
    /// What is overhead.
    Ceiling,
}

impl Zone {
    /// All zones.
    pub const ALL: [Self; 3] = [Self::Floor, Self::Wall, Self::Ceiling];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Floor => "floor",
            Self::Wall => "wall",
            Self::Ceiling => "ceiling",
        }
    }
}

/// A number for each zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByZone {
    /// Value of the floor.
    pub floor: f64,
    /// Value of the walls.
    pub wall: f64,
    /// Value of the ceiling.
    pub ceiling: f64,
}

impl ByZone {
    /// The value of a zone.
    pub fn of(self, zone: Zone) -> f64 {
        match zone {
            Zone::Floor => self.floor,
            Zone::Wall => self.wall,
            Zone::Ceiling => self.ceiling,
        }
    }
}

/// Triangles; counter-clockwise from outside the solid. Attribute arrays are as long as `positions` in a visual mesh
/// and empty in a collision mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in metres, scene frame.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, origin at the lower left of the image.
    pub uvs: Vec<[f32; 2]>,
    /// Tangents (MikkTSpace): unit x, y, z along +u, and the handedness w = ±1 of the bitangent (+v).
    pub tangents: Vec<[f32; 4]>,
    /// Vertex indices, three a triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// Number of triangles.
    pub fn triangles(&self) -> u64 {
        self.indices.len() as u64 / 3
    }

    /// Minimum and maximum corner of the bounding box of the vertices.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        bounds(self.positions.iter().copied())
    }

    fn check(&self, part: Part) -> Result<(), &'static str> {
        let count = self.positions.len();
        let attributes = match part {
            Part::Visual => count,
            Part::Collision => 0,
        };
        if self.indices.is_empty() || !self.indices.len().is_multiple_of(3) {
            return Err("has no triangles, or a part of one");
        }
        if self.indices.iter().any(|&vertex| vertex as usize >= count) {
            return Err("has a triangle whose corner is not a vertex");
        }
        if [self.normals.len(), self.uvs.len(), self.tangents.len()] != [attributes; 3] {
            return Err("has a different number of normals, texture coordinates or tangents than vertices");
        }
        if !self.positions.iter().flatten().all(|coordinate| coordinate.is_finite()) {
            return Err("has a vertex that is not finite");
        }
        Ok(())
    }
}

/// Minimum and maximum corner of the bounding box of some points.
pub(crate) fn bounds(points: impl Iterator<Item = [f32; 3]>) -> [[f32; 3]; 2] {
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis]);
            bounds[1][axis] = bounds[1][axis].max(point[axis]);
        }
    }
    bounds
}

/// Which mesh of a chunk: the visual one has every attribute, the collision one positions only.
#[derive(Clone, Copy)]
enum Part {
    Visual,
    Collision,
}

/// Metallic-roughness material. Images are files already encoded.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Safe name of its images, such as that of the chunk. Chunks with the same name have the same images, which are written
    /// once.
    pub name: String,
    /// Base colour, sRGB.
    pub base_color: Image,
    /// Tangent-space normals, +Y up (OpenGL), linear.
    pub normal: Image,
    /// Occlusion in red, roughness in green, metalness (0) in blue; linear.
    pub orm: Image,
    /// Roughness alone, grey, linear.
    pub roughness: Image,
    /// Height, where the scene has it.
    pub height: Option<Height>,
}

impl Material {
    /// Refuses images that the readers of `target` do not support; the height map is not checked.
    ///
    /// # Errors
    /// [`ExportError::UnfitImage`], which names the supported formats.
    pub(crate) fn refuse_unless(
        &self,
        target: &'static str,
        wanted: &'static [ImageFormat],
    ) -> Result<(), ExportError> {
        let images = [&self.base_color, &self.normal, &self.orm, &self.roughness];
        match images.into_iter().find(|image| !wanted.contains(&image.format)) {
            Some(image) => Err(ExportError::UnfitImage { target, path: image.path.clone(), wanted }),
            None => Ok(()),
        }
    }
}

/// Height of the rock above the visual mesh, along its normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Height {
    /// A PNG with one channel of 16 bits, linear: black is `-amplitude_m`, white is `amplitude_m`.
    pub image: Image,
    /// The largest height that the image can represent, in metres.
    pub amplitude_m: f32,
}

/// An encoded image on disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// File to copy.
    pub path: PathBuf,
    /// Its encoding.
    pub format: ImageFormat,
}

/// A point light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Safe name, unique in the scene.
    pub name: String,
    /// Position.
    pub position: Point3<f64>,
    /// Linear RGB, 0–1.
    pub color: [f64; 3],
    /// Luminous intensity in candela.
    pub intensity_cd: f64,
    /// Distance beyond which it can be ignored, metres.
    pub range_m: f64,
}
