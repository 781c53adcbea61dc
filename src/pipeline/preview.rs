//! Plan and profile of the cave, for people who look into its folder.

use super::{Pipeline, PipelineError, field, refuse_absurd_size, subject};
use crate::preview::{Drawn, Format, Order, Pace, Subject, Theme, view};
use crate::store::{self, Facts, FileRecord, Stage};

/// The views that are drawn, and their files.
const MAPS: [(&str, &str); 2] = [("plan", store::PLAN), ("profile", store::PROFILE)];

impl Pipeline<'_> {
    /// Draws the maps of the cave.
    ///
    /// # Errors
    /// If there is nothing to draw, the cave is too large, the disk fails, or the observer stops.
    pub fn preview(&self) -> Result<(), PipelineError> {
        self.each(Stage::Preview, &[store::WHOLE_CAVE], |name| {
            self.unit(Stage::Preview, name, || {
                refuse_absurd_size(self.recipe, &self.graph)?;
                let field = field(self.recipe, &self.graph);
                let subject = subject(self.recipe, &self.graph, &field);
                let maps: Result<Vec<_>, _> = MAPS.iter().map(|map| self.draw(map, &subject)).collect();
                Ok((maps?, Facts::Preview {}))
            })
        })
    }

    /// On white paper, in the default size of the view.
    fn draw(&self, (map, path): &(&str, &str), subject: &Subject) -> Result<FileRecord, PipelineError> {
        let order = Order {
            format: Format::Png,
            theme: Theme::Light,
            size: None,
            at: None,
            look_rad: None,
            pace: Pace::default(),
            stop: self.observer.stop(),
        };
        let Drawn::File(bytes) = view(map).expect("a map is a view").draw(subject, &order)? else {
            unreachable!("a map stands still");
        };
        Ok(self.folder.write(path, |out| out.write_all(&bytes))?)
    }
}
