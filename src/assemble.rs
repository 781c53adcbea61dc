//! From a cave folder to a scene: chunks, images, lamps and start poses for the exporters.

mod dressing;

use std::collections::BTreeMap;
use std::io;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::{Isometry3, Point3};
use plume_exporters::scene::{self, ByZone, Chunks, Content, Georeference, Light, Network, Scene, Station};

use self::dressing::{Dressing, Role};
use crate::field::{Field, PassageSettings};
use crate::mesh;
use crate::placement::{self, Lamp};
use crate::recipe::{Recipe, WorldSettings};
use crate::store::ply::PlyMesh;
use crate::store::{self, CaveFolder, Facts, LodFacts, Stage, ThingFacts, Unit};
use crate::texture::{HEIGHT_AMPLITUDE_M, Maps, TextureSettings};
use crate::things::{Kinds, Thing};
use plume_graph::{Graph, Node, StationId};
use plume_truth::Passage;

/// The things of a role in a chunk of the wall.
struct Dressed {
    /// The chunk of the wall.
    wall: String,
    role: Role,
}

impl Dressed {
    fn of(unit: Unit) -> impl Iterator<Item = Self> {
        let ThingFacts { things, gravel, movable, .. } = match unit.facts {
            Facts::Things(facts) => facts,
            _ => ThingFacts::default(),
        };
        let fixed = things.saturating_sub(movable);
        let counts = [(fixed, Role::Fixed), (movable, Role::Movable), (gravel, Role::Gravel)].into_iter();
        let wall = unit.name;
        counts.filter(|(count, _)| *count > 0).map(move |(_, role)| Self { wall: wall.clone(), role })
    }

    fn name(&self) -> String {
        let prefix = match self.role {
            Role::Fixed => "things_",
            Role::Movable => "movable_",
            Role::Gravel => "gravel_",
        };
        self.wall.replace("chunk_", prefix)
    }
}

/// Light of a lamp per metre of spacing squared, cd/m²: tuned by eye so that walls between two lamps are legible.
const LAMP_CD_PER_M2: f64 = 0.12;
/// Range of a lamp, in spacings.
const LAMP_REACH: f64 = 2.0;
/// Warm white, linear RGB.
const LAMP_COLOR: [f64; 3] = [1.0, 0.86, 0.68];

/// The chunks of a finished cave folder, loaded one at a time.
pub struct FolderChunks<'a> {
    folder: &'a CaveFolder,
    names: Vec<String>,
    /// Things of chunks, which are chunks of their own after those of the wall.
    dressed: Vec<Dressed>,
    /// Width in metres under which loose things are movable.
    movable_m: f64,
    prototypes: OnceLock<Option<Dressing<'a>>>,
    kinds: Kinds<'a>,
    /// The coarser levels of each chunk.
    lods: Vec<Vec<LodFacts>>,
    settings: &'a TextureSettings,
    stop: &'a AtomicBool,
}

impl<'a> FolderChunks<'a> {
    /// The chunks of `walls`. Once `stop` is set no more are loaded: an export ends with [`io::ErrorKind::Interrupted`].
    pub fn new(folder: &'a CaveFolder, walls: &[Unit], recipe: &'a Recipe, stop: &'a AtomicBool) -> Self {
        let levels = |unit: Unit| match unit.facts {
            Facts::Texture(facts) => Some((unit.name, facts.lods)),
            _ => None,
        };
        let mut textured: BTreeMap<String, Vec<LodFacts>> =
            folder.units(Stage::Texture).into_iter().filter_map(levels).collect();
        let things = folder.units(Stage::Things).into_iter();
        let dressed = things.filter(|unit| walls.iter().any(|wall| wall.name == unit.name));
        let lods = |wall: &Unit| textured.remove(&wall.name).unwrap_or_default();
        Self {
            folder,
            names: walls.iter().map(|wall| wall.name.clone()).collect(),
            dressed: dressed.flat_map(Dressed::of).collect(),
            movable_m: recipe.things().movable_m,
            prototypes: OnceLock::new(),
            kinds: recipe.kinds(),
            lods: walls.iter().map(lods).collect(),
            settings: recipe.texture(),
            stop,
        }
    }

    fn read(&self, path: &str) -> Result<scene::Mesh, io::Error> {
        Ok(scene_mesh(store::read_ply(self.folder, path).map_err(io::Error::other)?))
    }

    /// Images are read by the exporters; their hashes are verified here.
    fn verify_images(&self, name: &str) -> Result<(), io::Error> {
        let verify = |(image, format)| self.folder.verify(&store::image_path(name, image, format));
        store::IMAGES.zip(self.settings.formats()).into_iter().try_for_each(verify).map_err(io::Error::other)
    }

    fn lods(&self, index: usize) -> Result<Vec<scene::Lod>, io::Error> {
        let lod = |(before, facts): (usize, &LodFacts)| {
            let mesh = self.read(&store::lod_path(&self.names[index], before + 1))?;
            Ok(scene::Lod { mesh, error_m: facts.error_m as f32 })
        };
        self.lods[index].iter().enumerate().map(lod).collect()
    }

    fn material(&self, name: &str) -> scene::Material {
        let image = |(image, format)| {
            let path = self.folder.root().join(store::image_path(name, image, format));
            scene::Image { path, format }
        };
        let Maps { base_color, normal, orm, roughness, height } = store::IMAGES.zip(self.settings.formats()).map(image);
        let height = height.map(|image| scene::Height { image, amplitude_m: HEIGHT_AMPLITUDE_M });
        scene::Material { name: name.to_owned(), base_color, normal, orm, roughness, height }
    }
}

impl FolderChunks<'_> {
    /// The prototypes, read when first needed.
    fn dressing(&self) -> Result<&Dressing<'_>, io::Error> {
        let missing = || io::Error::other("there are things, but no prototypes of them");
        if let Some(dressing) = self.prototypes.get() {
            return dressing.as_ref().ok_or_else(missing);
        }
        let prototypes = store::read_prototypes(self.folder, self.kinds).map_err(io::Error::other)?;
        self.prototypes.get_or_init(|| prototypes.map(Dressing::new)).as_ref().ok_or_else(missing)
    }

    fn dressed(&self, index: usize) -> &Dressed {
        &self.dressed[index - self.names.len()]
    }

    fn things(&self, index: usize) -> Result<Vec<Thing>, io::Error> {
        let Dressed { wall, role } = self.dressed(index);
        let things = store::read_things(self.folder, wall).map_err(io::Error::other)?;
        Ok(self.dressing()?.share(things, self.movable_m, *role))
    }

    fn load_things(&self, index: usize) -> Result<scene::Chunk, io::Error> {
        self.verify_images(store::PROTOTYPES)?;
        let (dressing, things) = (self.dressing()?, self.things(index)?);
        let Dressed { role, .. } = *self.dressed(index);
        let (content, (visual, lods), collision) = match role {
            Role::Gravel => {
                let stones = things.len();
                (Content::Gravel { stones }, dressing.gravel_levels(&things), scene::Mesh::default())
            }
            Role::Fixed | Role::Movable => {
                let movable = role == Role::Movable;
                (Content::Things { movable }, dressing.levels(&things), dressing.collision(&things))
            }
        };
        let (name, material) = (self.dressed(index).name(), self.material(store::PROTOTYPES));
        Ok(scene::Chunk { name, content, visual, lods, collision, material })
    }
}

impl Chunks for FolderChunks<'_> {
    fn len(&self) -> usize {
        self.names.len() + self.dressed.len()
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        let Some(own) = self.names.get(index) else { return Vec::new() };
        (0..self.names.len()).filter(|&other| store::adjacent(own, &self.names[other])).collect()
    }

    fn pieces(&self, index: usize) -> Result<Vec<scene::Piece>, io::Error> {
        if index >= self.names.len() {
            return match self.dressed(index).role {
                Role::Gravel => Ok(Vec::new()),
                Role::Fixed | Role::Movable => Ok(self.dressing()?.pieces(&self.things(index)?)),
            };
        }
        let pieces = store::read_pieces(self.folder, &self.names[index]).map_err(io::Error::other)?;
        Ok(pieces.into_iter().map(scene_piece).collect())
    }

    fn instances(&self, index: usize) -> Result<Vec<scene::Instance>, io::Error> {
        if index < self.names.len() {
            return Ok(Vec::new());
        }
        let dressed = self.dressed(index);
        match dressed.role {
            Role::Gravel => Ok(Vec::new()),
            role => Ok(self.dressing()?.instances(&dressed.name(), role == Role::Movable, &self.things(index)?)),
        }
    }

    fn gravel(&self, index: usize) -> Result<scene::Gravel, io::Error> {
        if index < self.names.len() || self.dressed(index).role != Role::Gravel {
            return Ok(scene::Gravel::default());
        }
        Ok(self.dressing()?.gravel(&self.things(index)?))
    }

    fn prototypes(&self) -> Result<Vec<scene::Prototype>, io::Error> {
        if self.dressed.is_empty() {
            return Ok(Vec::new());
        }
        self.verify_images(store::PROTOTYPES)?;
        Ok(self.dressing()?.prototypes(&self.material(store::PROTOTYPES)))
    }

    fn load(&self, index: usize) -> Result<scene::Chunk, io::Error> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(io::Error::new(io::ErrorKind::Interrupted, "interrupted"));
        }
        if index >= self.names.len() {
            return self.load_things(index);
        }
        let name = &self.names[index];
        self.verify_images(name)?;
        Ok(scene::Chunk {
            name: name.clone(),
            content: Content::Wall,
            visual: self.read(&store::textured_path(name))?,
            lods: self.lods(index)?,
            collision: self.read(&store::collision_path(name))?,
            material: self.material(name),
        })
    }
}

impl From<&mesh::Mesh> for scene::Mesh {
    fn from(mesh: &mesh::Mesh) -> Self {
        Self {
            positions: mesh.positions_m(),
            normals: mesh.normals.clone(),
            indices: mesh.triangles.iter().flatten().copied().collect(),
            ..Self::default()
        }
    }
}

fn scene_mesh(ply: PlyMesh) -> scene::Mesh {
    scene::Mesh {
        positions: ply.positions,
        normals: ply.normals,
        uvs: ply.uvs,
        tangents: ply.tangents,
        indices: ply.triangles.into_iter().flatten().collect(),
    }
}

fn scene_piece(piece: mesh::Piece) -> scene::Piece {
    let mesh = scene::Mesh {
        positions: piece.positions.iter().map(|at| at.map(|q| q as f32 / mesh::QUANTA_PER_M as f32)).collect(),
        indices: piece.triangles.into_iter().flatten().collect(),
        ..scene::Mesh::default()
    };
    let zone = match piece.zone {
        mesh::Zone::Floor => scene::Zone::Floor,
        mesh::Zone::Wall => scene::Zone::Wall,
        mesh::Zone::Ceiling => scene::Zone::Ceiling,
    };
    scene::Piece { mesh, zone }
}

/// The scene of a finished cave, without its fingerprint.
pub fn scene<'a>(recipe: &Recipe, graph: &Graph, field: &dyn Field, chunks: &'a FolderChunks<'a>) -> Scene<'a> {
    let world = recipe.world();
    Scene {
        name: recipe.name().replace('-', "_"),
        description: format!("Underground world made by Plume: {} stations, seed {}", graph.nodes.len(), recipe.seed()),
        generator: format!("plume {}", crate::VERSION),
        recipe: recipe.to_portable_toml(),
        fingerprint: String::new(),
        seed: recipe.seed(),
        chunks,
        spawns: spawns(field, graph, world.spawns),
        lights: if world.lights { lights(field, graph, world) } else { Vec::new() },
        network: network(graph, recipe.passage()),
        georeference: graph.georeference.as_ref().map(|known| Georeference {
            origin_m: known.origin_m.into(),
            system: known.system.as_deref().map(str::to_owned),
        }),
        sought: recipe.kinds().sought().map(str::to_owned).collect(),
        friction: ByZone { floor: world.friction, wall: world.wall_friction, ceiling: world.wall_friction },
        gravity: world.gravity,
        collision_error_m: recipe.mesh().collision_error_m.into(),
        piece_tolerance_m: ByZone {
            floor: recipe.pieces().floor_tolerance_m.into(),
            wall: recipe.pieces().wall_tolerance_m.into(),
            ceiling: recipe.pieces().ceiling_tolerance_m.into(),
        },
    }
}

/// The stations and passages of a graph, in its order.
fn network(graph: &Graph, sizes: &PassageSettings) -> Network {
    let station = |node: &Node| Station {
        name: node.id.to_string(),
        position: node.position,
        level: node.level,
        label: node.name.as_deref().map(str::to_owned),
    };
    let passage = |ends: &[StationId; 2]| {
        let reaches = ends.map(|end| f64::from(sizes.reach(&graph[end]).aside_m));
        Passage { ends: ends.map(StationId::index), reach_m: reaches[0].max(reaches[1]) }
    };
    Network { stations: graph.nodes.iter().map(station).collect(), passages: graph.edges.iter().map(passage).collect() }
}

/// Start poses; if there is no headroom anywhere, the first station, since a scene must have one.
fn spawns(field: &dyn Field, graph: &Graph, count: usize) -> Vec<Isometry3<f64>> {
    let spawns: Vec<_> = placement::spawns(field, graph, count).into_iter().map(|spawn| spawn.pose).collect();
    if !spawns.is_empty() {
        return spawns;
    }
    let first = graph.nodes.first().map_or(Point3::origin(), |node| node.position);
    vec![Isometry3::translation(first.x, first.y, first.z)]
}

fn lights(field: &dyn Field, graph: &Graph, world: &WorldSettings) -> Vec<Light> {
    let spacing_m = world.light_spacing_m;
    let light = |(i, lamp): (usize, Lamp)| Light {
        name: format!("lamp_{i}"),
        position: lamp.position,
        color: LAMP_COLOR,
        intensity_cd: LAMP_CD_PER_M2 * spacing_m * spacing_m,
        range_m: LAMP_REACH * spacing_m,
    };
    placement::lamps(field, graph, spacing_m).into_iter().enumerate().map(light).collect()
}
