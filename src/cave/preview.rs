//! A look at a cave before it is made.

use super::{CaveError, Input};
use crate::pipeline::{self, Disk, PipelineError};
use crate::preview::{Drawn, Order, PreviewError, Subject, VIEWS, ViewRow, view};

/// The view called `name`.
///
/// # Errors
/// [`CaveError::Usage`], which names the nearest.
pub fn view_row(name: &str) -> Result<&'static ViewRow, CaveError> {
    view(name).ok_or_else(|| CaveError::unknown("view", name, VIEWS.iter().map(|row| row.name)))
}

/// The file of a view of this cave.
///
/// # Errors
/// A graph that cannot be, nothing to see, the order's stop.
pub fn preview(input: &Input, row: &ViewRow, order: &Order) -> Result<Drawn, CaveError> {
    let recipe = &input.recipe;
    let made = match &input.graph {
        Some(_) => None,
        None => Some(recipe.graph.generate(recipe.seed, &Disk).map_err(PipelineError::from)?),
    };
    let graph = input.graph.as_ref().or(made.as_ref()).expect("it was given or made");
    let field = pipeline::field(recipe, graph);
    let lamp_spacing_m = recipe.world.lights.then_some(recipe.world.light_spacing_m);
    let subject = Subject { name: &recipe.name, graph, passage: &recipe.passage, field: &field, lamp_spacing_m };
    Ok(row.draw(&subject, order)?)
}

impl From<PreviewError> for CaveError {
    fn from(error: PreviewError) -> Self {
        if error == PreviewError::Stopped {
            return Self::Interrupted;
        }
        Self::Usage { message: error.to_string(), hint: error.hint().to_owned() }
    }
}
