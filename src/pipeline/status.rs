//! Progress of a cave folder, and what the next run would do there.

use std::collections::BTreeSet;

use rayon::prelude::*;
use serde::Serialize;

use super::{Pipeline, PipelineError};
use crate::mesh::{self, Grid};
use crate::store::{Stage, WHOLE_CAVE, chunk_name};

/// Progress of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Nothing is there.
    Missing,
    /// Part of it is there.
    Partial,
    /// It follows from another recipe, graph or version, and will be remade.
    Outdated,
    /// It is finished but empty: a mesh without a wall.
    Empty,
    /// It is finished.
    Done,
}

/// Status of a stage of a cave folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageStatus {
    /// The stage.
    pub stage: Stage,
    /// Its progress.
    pub state: State,
    /// Intact units that follow from the current recipe and graph.
    pub done: usize,
    /// Total number of units; `None` while it depends on an earlier stage.
    pub total: Option<usize>,
    /// Units of another recipe, graph or version.
    pub outdated: usize,
    /// Units whose files are missing or changed.
    pub damaged: Vec<String>,
}

impl Pipeline<'_> {
    /// The status of each stage; reads every file of the folder, and writes nothing.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn status(&self) -> Result<Vec<StageStatus>, PipelineError> {
        let graph = self.stage_status(Stage::Graph, Some(vec!["cave".to_owned()]))?;
        let preview = self.stage_status(Stage::Preview, Some(vec!["cave".to_owned()]))?;
        let mut mesh = self.stage_status(Stage::Mesh, self.meshed_chunks())?;
        if mesh.state == State::Done && self.walls().is_empty() {
            mesh.state = State::Empty;
        }
        let walls = || self.walls().into_iter().map(|unit| unit.name).collect();
        let walls: Option<Vec<String>> = (mesh.state == State::Done).then(walls);
        let with_prototypes = |mut walls: Vec<String>| {
            walls.push(WHOLE_CAVE.to_owned());
            walls
        };
        let things = self.stage_status(Stage::Things, walls.clone().map(with_prototypes))?;
        let texture = self.stage_status(Stage::Texture, walls.clone())?;
        let pieces = self.stage_status(Stage::Pieces, walls)?;
        Ok(vec![graph, preview, mesh, things, texture, pieces])
    }

    /// Names of the chunks that are units of the mesh; `None` if there is no grid.
    fn meshed_chunks(&self) -> Option<Vec<String>> {
        let field = self.field();
        let grid = Grid::new(field.bounds(), self.recipe.mesh()).ok()?;
        let chunks = grid.indices().filter(|index| mesh::may_have_wall(&field, &grid, *index));
        Some(chunks.map(chunk_name).collect())
    }

    fn stage_status(&self, stage: Stage, wanted: Option<Vec<String>>) -> Result<StageStatus, PipelineError> {
        let units = self.units(stage);
        let outdated = self.folder.units(stage).len() - units.len();
        let wanted: Option<BTreeSet<String>> = wanted.map(|names| names.into_iter().collect());
        let total = wanted.as_ref().map(BTreeSet::len);
        let counts = |name: &str| wanted.as_ref().is_none_or(|wanted| wanted.contains(name));
        let whole: Result<Vec<bool>, _> = units
            .par_iter()
            .map(|unit| Ok(self.folder.finished(stage, &unit.name, self.fingerprint(stage))?.is_some()))
            .collect::<Result<_, PipelineError>>();
        let (mut done, mut damaged) = (0, Vec::new());
        for (unit, whole) in units.iter().zip(whole?).filter(|(unit, _)| counts(&unit.name)) {
            if whole {
                done += 1;
            } else {
                damaged.push(unit.name.clone());
            }
        }
        let state = match (done, total) {
            (done, Some(total)) if done == total => State::Done,
            (0, _) if outdated > 0 => State::Outdated,
            (0, _) if damaged.is_empty() => State::Missing,
            _ => State::Partial,
        };
        Ok(StageStatus { stage, state, done, total, outdated, damaged })
    }
}
