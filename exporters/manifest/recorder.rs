//! Observes chunks on their way from a scene to a target, so that nothing is loaded twice for the manifest.

use std::io;
use std::sync::{Mutex, PoisonError};

use crate::error::ExportError;
use crate::scene::{Chunk, Chunks, Content, Gravel, Instance, Material, Piece, Prototype, Scene};

use super::LodEntry;

/// The manifest's data about a chunk.
#[derive(Clone)]
pub struct ChunkFacts {
    pub name: String,
    pub bounds: [[f32; 3]; 2],
    pub triangles: u64,
    pub lods: Vec<LodEntry>,
    pub collision_triangles: u64,
    pub pieces: Option<u64>,
    /// Number of stones, if it is gravel.
    pub gravel: Option<u64>,
    pub material: Material,
    /// Indices of chunks.
    pub neighbors: Vec<usize>,
}

/// Passes chunks on and records their data.
pub struct RecordingChunks<'a> {
    inner: &'a dyn Chunks,
    notes: Mutex<Vec<Notes>>,
}

#[derive(Clone, Default)]
struct Notes {
    chunk: Option<ChunkFacts>,
    pieces: Option<u64>,
}

impl<'a> RecordingChunks<'a> {
    /// Observes the chunks of a scene.
    pub fn new(scene: &Scene<'a>) -> Self {
        Self { inner: scene.chunks, notes: Mutex::new(vec![Notes::default(); scene.chunks.len()]) }
    }

    /// The recorded data. Chunks that the target did not load are loaded now.
    ///
    /// # Errors
    /// As [`Scene::chunk`].
    pub fn facts(&self, scene: &Scene) -> Result<Vec<ChunkFacts>, ExportError> {
        (0..self.len()).map(|index| self.one(index, scene)).collect()
    }

    fn one(&self, index: usize, scene: &Scene) -> Result<ChunkFacts, ExportError> {
        let notes = self.note(index, |notes| notes.clone());
        let chunk = match notes.chunk {
            Some(chunk) => chunk,
            None => self.describe(index, &scene.chunk(index)?),
        };
        Ok(ChunkFacts { pieces: notes.pieces, ..chunk })
    }

    fn note<T>(&self, index: usize, write: impl FnOnce(&mut Notes) -> T) -> T {
        write(&mut self.notes.lock().unwrap_or_else(PoisonError::into_inner)[index])
    }

    fn describe(&self, index: usize, chunk: &Chunk) -> ChunkFacts {
        let lod = |lod: &crate::scene::Lod| LodEntry { triangles: lod.mesh.triangles(), error_m: lod.error_m };
        ChunkFacts {
            name: chunk.name.clone(),
            bounds: chunk.visual.bounds(),
            triangles: chunk.visual.triangles(),
            lods: chunk.lods.iter().map(lod).collect(),
            collision_triangles: chunk.collision.triangles(),
            pieces: None,
            gravel: match chunk.content {
                Content::Gravel { stones } => Some(stones as u64),
                Content::Wall | Content::Things { .. } => None,
            },
            material: chunk.material.clone(),
            neighbors: self.inner.neighbors(index),
        }
    }
}

impl Chunks for RecordingChunks<'_> {
    fn len(&self) -> usize {
        self.inner.len()
    }

    fn load(&self, index: usize) -> io::Result<Chunk> {
        let chunk = self.inner.load(index)?;
        let facts = self.describe(index, &chunk);
        self.note(index, |notes| notes.chunk = Some(facts));
        Ok(chunk)
    }

    fn neighbors(&self, index: usize) -> Vec<usize> {
        self.inner.neighbors(index)
    }

    fn instances(&self, index: usize) -> io::Result<Vec<Instance>> {
        self.inner.instances(index)
    }

    fn gravel(&self, index: usize) -> io::Result<Gravel> {
        self.inner.gravel(index)
    }

    fn prototypes(&self) -> io::Result<Vec<Prototype>> {
        self.inner.prototypes()
    }

    fn pieces(&self, index: usize) -> io::Result<Vec<Piece>> {
        let pieces = self.inner.pieces(index)?;
        self.note(index, |notes| notes.pieces = Some(pieces.len() as u64));
        Ok(pieces)
    }
}
