//! `plume status`: the progress of a cave folder.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::access::Outside;
use super::fault::CliError;
use super::progress::Console;
use plume::cave::Input;
use plume::pipeline::{Pipeline, StageStatus, State};
use plume::store::{CaveFolder, Stage};

/// Shows what is finished in a cave folder, what is outdated or damaged, and which command to run next; writes nothing.
#[derive(Args)]
pub struct Status {
    /// A cave folder, finished or not
    #[arg(value_name = "CAVE_DIR")]
    folder: PathBuf,
    #[command(flatten)]
    pub(super) outside: Outside,
}

impl Status {
    /// Prints a line for each stage on stdout.
    ///
    /// # Errors
    /// If the folder contains no cave or cannot be read.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let Input { recipe, graph, .. } = Input::read(Some(&self.folder), &[], console.disk())?;
        let folder = CaveFolder::open(&self.folder)?;
        let is_busy = folder.is_in_use();
        let pipeline = Pipeline::plan(&recipe, graph, &folder, console)?;
        let stages = pipeline.status()?;
        let next = self.next(&stages, is_busy);
        if console.is_json() {
            let is_finished = next.is_none();
            let json = json!({
                "name": recipe.name(), "seed": recipe.seed(), "stages": stages,
                "busy": is_busy, "finished": is_finished, "next": next,
            });
            return console.result(&format!("{json:#}\n"));
        }
        let mut text = format!("{}: {}, seed {}\n", self.folder.display(), recipe.name(), recipe.seed());
        stages.iter().for_each(|stage| text += &line(stage));
        text += &without_wall(&stages, pipeline.walls().len());
        text +=
            &format!("  next      {}\n", next.unwrap_or_else(|| format!("plume export {} …", self.folder.display())));
        console.result(&text)
    }

    /// What to do next to finish the cave.
    fn next(&self, stages: &[StageStatus], is_busy: bool) -> Option<String> {
        if is_busy {
            return Some("wait: another run is using this folder".to_owned());
        }
        let needed = stages.iter().filter(|status| status.stage != Stage::Pieces);
        let open = needed.filter(|status| status.state != State::Done).count();
        (open > 0).then(|| format!("plume generate {}", self.folder.display()))
    }
}

fn line(status: &StageStatus) -> String {
    let state = match status.state {
        State::Missing if status.stage == Stage::Pieces => "not made; made for targets that need them".to_owned(),
        State::Missing => "missing".to_owned(),
        State::Empty => "empty     no open space at this voxel size".to_owned(),
        State::Done => format!("done      {}", units(status.stage, status.done)),
        State::Outdated => {
            format!("outdated  {} from an earlier recipe, graph or version", units(status.stage, status.outdated))
        }
        State::Partial => match status.total {
            Some(total) => format!("partial   {} of {total}", status.done),
            None => format!("partial   {}", units(status.stage, status.done)),
        },
    };
    let damaged = match status.damaged.as_slice() {
        [] => String::new(),
        damaged => format!("; changed or missing: {}", damaged.join(", ")),
    };
    format!("  {:9} {state}{damaged}\n", status.stage.name())
}

/// Why later stages have fewer chunks than the mesh.
fn without_wall(stages: &[StageStatus], walls: usize) -> String {
    let mesh = stages.iter().find(|status| status.stage == Stage::Mesh && status.state == State::Done);
    match mesh.map_or(0, |mesh| mesh.done.saturating_sub(walls)) {
        0 => String::new(),
        1 => "  note      1 chunk of the mesh is all rock or all air, and has nothing to texture\n".to_owned(),
        empty => {
            format!("  note      {empty} chunks of the mesh are all rock or all air, and have nothing to texture\n")
        }
    }
}

fn units(stage: Stage, count: usize) -> String {
    match (stage, count) {
        (Stage::Graph, _) => "1 graph".to_owned(),
        (Stage::Preview, _) => "plan and profile".to_owned(),
        (Stage::Things, 0 | 1) => "shapes alone".to_owned(),
        (Stage::Things, _) => format!("shapes, {} chunks", count - 1),
        (_, 1) => "1 chunk".to_owned(),
        _ => format!("{count} chunks"),
    }
}

#[cfg(test)]
mod tests {
    use plume::pipeline::{StageStatus, State};
    use plume::store::Stage;

    use super::without_wall;

    #[test]
    fn chunks_without_a_wall_are_explained() {
        let mesh =
            |state, done| StageStatus { stage: Stage::Mesh, state, done, total: None, outdated: 0, damaged: vec![] };
        assert_eq!(without_wall(&[mesh(State::Done, 6)], 6), "");
        assert_eq!(without_wall(&[mesh(State::Partial, 6)], 4), "");
        let said = without_wall(&[mesh(State::Done, 6)], 4);
        assert_eq!(said, "  note      2 chunks of the mesh are all rock or all air, and have nothing to texture\n");
    }
}
