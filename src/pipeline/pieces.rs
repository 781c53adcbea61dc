//! Convex pieces of every chunk, made if a target needs them.

use rayon::prelude::*;

use super::{Pipeline, PipelineError};
use crate::mesh::{self, Mesh, PieceMeasures};
use crate::store::{self, Facts, PieceFacts, Stage, StoreError, Unit};

impl Pipeline<'_> {
    /// Makes the convex pieces of all chunks.
    ///
    /// # Errors
    /// If the meshes are missing, the disk fails, or the observer stops.
    pub fn pieces(&self) -> Result<(), PipelineError> {
        let walls = self.walls();
        self.pieces_behind(&walls, &walls)
    }

    /// Makes the pieces behind some of the walls; `all` has their neighbours.
    pub(super) fn pieces_behind(&self, walls: &[Unit], all: &[Unit]) -> Result<(), PipelineError> {
        self.each(Stage::Pieces, walls, |wall| {
            self.unit(Stage::Pieces, &wall.name, || {
                let (mesh, around) = self.with_neighbours(&wall.name, all)?;
                let pieces = mesh::pieces(&mesh, &around, self.recipe.pieces());
                let file = store::write_pieces(self.folder, &wall.name, &pieces)?;
                Ok((vec![file], Facts::Pieces(PieceFacts { pieces: pieces.len() })))
            })
        })
    }

    /// Measures the existing convex pieces.
    ///
    /// # Errors
    /// If a mesh or a piece cannot be read.
    pub fn measure_pieces(&self) -> Result<Vec<PieceMeasures>, PipelineError> {
        let (field, walls) = (self.field(), self.walls());
        let of_chunk = |unit: &Unit| {
            let (mesh, around) = self.with_neighbours(&unit.name, &walls)?;
            let pieces = store::read_pieces(self.folder, &unit.name)?;
            Ok(mesh::measure_pieces(&pieces, &mesh, &around, &field, self.recipe.pieces()))
        };
        let chunks: Result<Vec<_>, PipelineError> = self.units(Stage::Pieces).par_iter().map(of_chunk).collect();
        Ok(chunks?.concat())
    }

    /// The wall of a chunk, and those of its neighbours, from all `walls`.
    pub(super) fn with_neighbours(&self, name: &str, walls: &[Unit]) -> Result<(Mesh, Vec<Mesh>), StoreError> {
        let mesh = store::read_mesh(self.folder, name)?;
        let around = walls.iter().filter(|other| store::adjacent(name, &other.name));
        let around: Result<Vec<_>, _> = around.map(|other| store::read_mesh(self.folder, &other.name)).collect();
        Ok((mesh, around?))
    }

    /// Whether every wall has its convex pieces.
    pub fn has_pieces(&self) -> bool {
        let made = self.names(Stage::Pieces);
        self.walls().iter().all(|wall| made.contains(&wall.name))
    }
}
