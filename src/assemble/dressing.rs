//! The things of a chunk: copies of the prototypes, or one mesh of all of them.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Point3, Vector3};
use plume_exporters::scene::{self, Instance, Lod, Material, Mesh, Piece, Zone};

use crate::store::Prototypes;
use crate::store::ply::PlyMesh;
use crate::things::{Prototype, Thing};

/// What the things of a chunk are to a simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Parts of the static world.
    Fixed,
    /// Bodies that move when pushed.
    Movable,
    /// Gravel, which is only drawn.
    Gravel,
}

/// The prototypes, cut apart at every level of detail.
pub struct Dressing<'a> {
    prototypes: Prototypes<'a>,
    /// By level and prototype.
    cuts: Vec<Vec<Cut>>,
}

/// The triangles of a prototype, and the level that they are of.
#[derive(Clone)]
struct Cut {
    level: usize,
    triangles: Vec<[u32; 3]>,
}

/// A level with a larger share of the triangles of the previous one is not worth its bytes. Tuned.
const MOST_SHARE: f64 = 0.8;
/// Density of rock: granite and solid limestone have about the same.
const ROCK_KG_M3: f64 = 2650.0;
/// Widths in metres under which a thing starts with the second, third and fourth level of detail. Tuned: a triangle of any
/// stone is a few centimetres wide, and gravel has about forty.
const SMALL_M: [f64; 3] = [0.36, 0.14, 0.055];
/// Coarser levels of gravel, and the fewest stones in one.
const GRAVEL_LEVELS: u32 = 2;
const FEWEST_STONES: usize = 8;

impl<'a> Dressing<'a> {
    /// Cuts the prototypes apart.
    pub fn new(prototypes: Prototypes<'a>) -> Self {
        let mut cuts: Vec<Vec<Cut>> = Vec::new();
        for level in 0..prototypes.levels.len() {
            cuts.push(cuts_at(&prototypes, level, cuts.last()));
        }
        Self { cuts, prototypes }
    }

    /// The things of this role, given the width under which loose ones move. What moves lies on the ground instead of in it, or
    /// it would be pushed out.
    pub fn share(&self, mut things: Vec<Thing>, movable_m: f64, role: Role) -> Vec<Thing> {
        let role_of = |thing: &Thing| match thing.is_gravel() {
            true => Role::Gravel,
            false if self.prototypes.library.is_movable(thing, movable_m) => Role::Movable,
            false => Role::Fixed,
        };
        things.retain(|thing| role_of(thing) == role);
        if role == Role::Movable {
            for thing in &mut things {
                thing.pose.translation.z += std::mem::take(&mut thing.embedding_m);
            }
        }
        things
    }

    /// Each thing with the index of its prototype.
    fn known<'b>(&'b self, things: &'b [Thing]) -> impl Iterator<Item = (usize, &'b Prototype<'a>, &'b Thing)> {
        things.iter().filter_map(|thing| {
            let all = &self.prototypes.library.prototypes;
            let index = all.iter().position(|own| own.name == thing.prototype)?;
            Some((index, &all[index], thing))
        })
    }

    /// Full detail, and the coarser levels.
    pub fn levels(&self, things: &[Thing]) -> (Mesh, Vec<Lod>) {
        let (full, _) = self.level(things, 0);
        let mut lods: Vec<Lod> = Vec::new();
        for level in 1..self.cuts.len() {
            let (mesh, error_m) = self.level(things, level);
            let finer = lods.last().map_or(&full, |lod| &lod.mesh);
            // Small things have no coarser level from some point on.
            if mesh.triangles() as f64 <= MOST_SHARE * finer.triangles() as f64 {
                lods.push(Lod { mesh, error_m });
            }
        }
        (full, lods)
    }

    /// Gravel in full detail, and levels that leave out the smaller half of what the level before has. Its stones are sorted
    /// from large to small.
    pub fn gravel_levels(&self, stones: &[Thing]) -> (Mesh, Vec<Lod>) {
        let lod = |shown: &usize| {
            let (shown, left_out) = stones.split_at(*shown);
            let sizes = self.known(left_out).map(|(_, prototype, stone)| prototype.size_m.max() * stone.scale);
            Lod { mesh: self.level(shown, 0).0, error_m: sizes.fold(0.0, f64::max) as f32 }
        };
        (self.level(stones, 0).0, shown_by_level(stones.len())[1..].iter().map(lod).collect())
    }

    /// The stones of gravel, in their order, and the shapes that they have.
    pub fn gravel(&self, stones: &[Thing]) -> scene::Gravel {
        let mut gravel = scene::Gravel { shown: shown_by_level(stones.len()), ..scene::Gravel::default() };
        let mut shapes: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for (index, prototype, stone) in self.known(stones) {
            let level = self.finest(prototype, stone);
            let shape = *shapes.entry((index, level)).or_insert_with(|| {
                let mut mesh = Mesh::default();
                self.append(&mut mesh, index, level, &as_made(prototype));
                gravel.shapes.push(mesh);
                gravel.shapes.len() - 1
            });
            gravel.stones.push(scene::Stone { shape, pose: stone.pose, scale: stone.scale });
        }
        gravel
    }

    /// All things, this many levels coarser than at their best.
    fn level(&self, things: &[Thing], coarser: usize) -> (Mesh, f32) {
        let (mut mesh, mut error_m) = (Mesh::default(), 0.0_f64);
        for (index, prototype, thing) in self.known(things) {
            let level = (self.finest(prototype, thing) + coarser).min(self.cuts.len() - 1);
            error_m = error_m.max(self.append(&mut mesh, index, level, thing));
        }
        (mesh, error_m as f32)
    }

    /// Appends a prototype at this level, at the place of a thing. Returns how far that is from full detail in metres.
    fn append(&self, mesh: &mut Mesh, index: usize, level: usize, thing: &Thing) -> f64 {
        let cut = &self.cuts[level][index];
        let prototype = &self.prototypes.library.prototypes[index];
        append(mesh, &self.prototypes.levels[cut.level], &cut.triangles, prototype, thing);
        self.prototypes.errors_m[cut.level] * thing.scale
    }

    /// The level of the prototype that a thing shows in full detail.
    fn finest(&self, prototype: &Prototype, thing: &Thing) -> usize {
        if prototype.row.is_solid() {
            return 0;
        }
        let width_m = prototype.width_m() * thing.scale;
        let finest = SMALL_M.iter().filter(|limit| width_m < **limit).count();
        finest.min(self.cuts.len() - 1)
    }

    /// The prototypes, each in its own frame.
    pub fn prototypes(&self, material: &Material) -> Vec<scene::Prototype> {
        let all = self.prototypes.library.prototypes.iter().enumerate();
        let one = |(index, prototype): (usize, &Prototype)| {
            let as_made = as_made(prototype);
            let level = |level: usize| {
                let mut mesh = Mesh::default();
                let error_m = self.append(&mut mesh, index, level, &as_made) as f32;
                Lod { mesh, error_m }
            };
            let Piece { mesh: hull, zone } = piece(prototype, &as_made);
            let levels = (0..self.cuts.len()).map(level).collect();
            scene::Prototype { name: prototype.name.clone(), levels, hull, zone, material: material.clone() }
        };
        all.map(one).collect()
    }

    /// The hulls of all things as one mesh.
    pub fn collision(&self, things: &[Thing]) -> Mesh {
        let mut all = Mesh::default();
        for Piece { mesh, .. } in self.pieces(things) {
            let first = all.positions.len() as u32;
            all.positions.extend(mesh.positions);
            all.indices.extend(mesh.indices.iter().map(|corner| corner + first));
        }
        all
    }

    /// What each thing is, and where.
    pub fn instances(&self, chunk: &str, movable: bool, things: &[Thing]) -> Vec<Instance> {
        let instance = |(_, prototype, thing): (usize, &Prototype, &Thing)| Instance {
            id: thing.id,
            class: thing.kind.clone(),
            prototype: thing.prototype.clone(),
            level: self.finest(prototype, thing),
            chunk: chunk.to_owned(),
            pose: thing.pose,
            scale: thing.scale,
            mass_kg: ROCK_KG_M3 * prototype.volume_m3 * thing.scale * thing.scale * thing.scale,
            embedding_m: thing.embedding_m,
            movable,
        };
        self.known(things).map(instance).collect()
    }

    /// The hull of each thing.
    pub fn pieces(&self, things: &[Thing]) -> Vec<Piece> {
        self.known(things).map(|(_, prototype, thing)| piece(prototype, thing)).collect()
    }
}

/// The prototypes at a level of detail, given the next finer one: what has too few triangles for its edges does not get
/// coarser.
fn cuts_at(prototypes: &Prototypes, level: usize, finer: Option<&Vec<Cut>>) -> Vec<Cut> {
    let mesh = &prototypes.levels[level];
    let all = prototypes.library.cut(&mesh.positions, &mesh.triangles);
    let cut = |(index, triangles): (usize, Vec<[u32; 3]>)| match finer {
        Some(finer) if !faces_its_normals(mesh, &triangles) => finer[index].clone(),
        _ => Cut { level, triangles },
    };
    all.into_iter().enumerate().map(cut).collect()
}

/// How many of these stones of gravel each level of detail shows.
fn shown_by_level(stones: usize) -> Vec<usize> {
    let coarser = (1..=GRAVEL_LEVELS).map(|halvings| stones >> halvings);
    std::iter::once(stones).chain(coarser.take_while(|shown| *shown >= FEWEST_STONES)).collect()
}

/// A prototype as a thing in its own frame.
fn as_made(prototype: &Prototype) -> Thing {
    Thing {
        id: 0,
        kind: prototype.row.name.to_owned(),
        prototype: prototype.name.clone(),
        scale: 1.0,
        pose: Isometry3::identity(),
        embedding_m: 0.0,
    }
}

/// The hull of a thing at its place.
fn piece(prototype: &Prototype, thing: &Thing) -> Piece {
    let place = |corner: &Point3<f64>| (thing.pose * (corner * thing.scale)).map(|c| c as f32).into();
    let mesh = Mesh {
        positions: prototype.hull.corners.iter().map(place).collect(),
        indices: prototype.hull.faces.iter().flatten().copied().collect(),
        ..Mesh::default()
    };
    Piece { mesh, zone: if prototype.row.place.is_loose() { Zone::Floor } else { Zone::Wall } }
}

/// Whether nearly all triangles face the side of their normals, which are those of full detail on every level.
fn faces_its_normals(mesh: &PlyMesh, triangles: &[[u32; 3]]) -> bool {
    /// Share of the triangles that may face away, on edges sharper than the triangles. Tuned.
    const MOST_AWAY: f64 = 0.03;
    let is_away = |triangle: &&[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| Vector3::from(mesh.positions[vertex as usize]));
        let normal: Vector3<f32> = triangle.iter().map(|&vertex| Vector3::from(mesh.normals[vertex as usize])).sum();
        (b - a).cross(&(c - a)).dot(&normal) <= 0.0
    };
    triangles.iter().filter(is_away).count() as f64 <= MOST_AWAY * triangles.len() as f64
}

/// Appends these triangles of all prototypes at the place of a thing.
fn append(mesh: &mut Mesh, from: &PlyMesh, triangles: &[[u32; 3]], prototype: &Prototype, thing: &Thing) {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let first = mesh.positions.len() as u32;
    let turned = |v: [f32; 3]| -> [f32; 3] {
        let turned: Vector3<f64> = thing.pose.rotation * Vector3::from(v.map(f64::from));
        turned.map(|c| c as f32).into()
    };
    for vertex in used.iter().map(|&vertex| vertex as usize) {
        let local = (Point3::from(from.positions[vertex].map(f64::from)) - prototype.origin) * thing.scale;
        let at: Point3<f64> = thing.pose * Point3::from(local);
        mesh.positions.push(at.map(|c| c as f32).into());
        mesh.normals.push(turned(from.normals[vertex]));
        mesh.uvs.push(from.uvs[vertex]);
        let [x, y, z, sign] = from.tangents[vertex];
        let [x, y, z] = turned([x, y, z]);
        mesh.tangents.push([x, y, z, sign]);
    }
    let name = |vertex: &u32| used.binary_search(vertex).expect("it is used") as u32 + first;
    mesh.indices.extend(triangles.iter().flatten().map(name));
}
