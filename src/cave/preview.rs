//! Previews of a cave before it is made.

use std::borrow::Cow;

use super::{CaveError, Input};
use crate::pipeline::{self, Observer, PipelineError};
use crate::preview::{Drawn, Order, PreviewError, VIEWS, ViewRow, view};
use plume_graph::Graph;

/// The view called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which suggests the nearest.
pub fn view_row(name: &str) -> Result<&'static ViewRow, CaveError> {
    view(name).ok_or_else(|| CaveError::unknown("view", name, VIEWS.iter().map(|row| row.name)))
}

/// The file of a view of this cave.
///
/// # Errors
/// An impossible graph, nothing to see, the order's stop.
pub fn preview(input: &Input, row: &ViewRow, order: &Order, observer: &dyn Observer) -> Result<Drawn, CaveError> {
    let graph = graph_of(input, observer)?;
    let files = pipeline::user_files(&input.recipe, observer)?;
    let field = pipeline::field_with(&input.recipe, &graph, &files);
    pipeline::with_large_stacks(|| {
        let stock = row.shows_things.then(|| pipeline::stock(&input.recipe, &files)).flatten();
        let subject = pipeline::furnished(&input.recipe, &graph, &field, stock.as_ref());
        Ok(row.draw(&subject, order)?)
    })
}

/// The graph that the pipeline would use.
pub(super) fn graph_of<'a>(input: &'a Input, observer: &dyn Observer) -> Result<Cow<'a, Graph>, CaveError> {
    if let Some(graph) = &input.graph {
        return Ok(Cow::Borrowed(graph));
    }
    match pipeline::generated(&input.recipe, observer) {
        Err(PipelineError::Interrupted) => Err(CaveError::Interrupted),
        made => Ok(Cow::Owned(made?)),
    }
}

impl From<PreviewError> for CaveError {
    fn from(error: PreviewError) -> Self {
        if error == PreviewError::Stopped {
            return Self::Interrupted;
        }
        Self::Usage { message: error.to_string(), hint: error.hint().to_owned() }
    }
}
