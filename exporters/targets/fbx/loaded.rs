//! A chunk with what else goes into its part of a file.

use super::{FbxCollision, ROW};
use crate::error::ExportError;
use crate::scene::{Chunk, Content, Instance, Piece, Prototype, Scene};

/// A chunk with what else goes into its part of a file.
pub struct Loaded<'a> {
    /// The chunk.
    pub chunk: Chunk,
    /// Its convex pieces if they are wanted, unless it consists of things.
    pub pieces: Vec<Piece>,
    /// The things that it consists of, each with its prototype.
    pub things: Vec<(Instance, &'a Prototype)>,
}

impl<'a> Loaded<'a> {
    /// The chunk `index`, with things that are copies of `prototypes`.
    ///
    /// # Errors
    /// As [`Scene::chunk`], and if a prototype is missing or an image does not suit the target.
    pub fn new(
        scene: &Scene,
        index: usize,
        prototypes: &'a [Prototype],
        collision: FbxCollision,
    ) -> Result<Self, ExportError> {
        let chunk = scene.chunk(index)?;
        chunk.material.refuse_unless(ROW.name, ROW.images)?;
        let (mut pieces, mut things) = (Vec::new(), Vec::new());
        match chunk.content {
            Content::Wall if collision == FbxCollision::Pieces => pieces = scene.pieces(index)?,
            Content::Wall | Content::Gravel { .. } => {}
            Content::Things { .. } => {
                for thing in scene.instances(index)? {
                    let prototype = thing.prototype_in(prototypes)?;
                    things.push((thing, prototype));
                }
            }
        }
        Ok(Self { chunk, pieces, things })
    }

    /// Number of triangles of its collision shapes.
    pub fn collision_triangles(&self, collision: FbxCollision) -> u64 {
        match collision {
            FbxCollision::None => 0,
            FbxCollision::Triangles => self.chunk.collision.triangles(),
            FbxCollision::Pieces => {
                let pieces = self.pieces.iter().map(|piece| &piece.mesh);
                let hulls = self.things.iter().map(|(_, prototype)| &prototype.hull);
                pieces.chain(hulls).map(crate::scene::Mesh::triangles).sum()
            }
        }
    }
}
