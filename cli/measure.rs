//! `plume measure`: how a graph compares with real caves, and whether a cave's mesh and convex pieces are sound.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::access::{Access, Outside, Threads};
use super::fault::CliError;
use super::graph::parts;
use super::likeness;
use super::progress::Console;
use plume::cave::{self, Input};
use plume::mesh::PieceReport;
use plume::mesh::measure::{Report, weld};
use plume::pipeline::Pipeline;
use plume::recipe::Recipe;
use plume::store::{self, CaveFolder, Stage};
use plume_graph::Graph;
use plume_graph::clearance::RockReport;
use plume_graph::realism::{Likeness, Verdict};
use plume_survey::{Import, Parts};

/// Compares a graph with real caves. For a cave folder, also welds its chunks, if any, checks the resulting mesh and
/// measures the convex pieces.
#[derive(Args)]
pub struct Measure {
    /// A graph or cave survey (see `plume list formats`), or a cave folder
    #[arg(value_name = "GRAPH|CAVE_DIR")]
    path: PathBuf,
    /// What to do with disconnected parts of the graph
    #[arg(long, value_name = "refuse|join|keep|longest", default_value = "keep", value_parser = parts)]
    parts: Parts,
    /// List pairs of passages with less rock than this between them (0 to 100 metres), unless a short path connects them
    #[arg(long, value_name = "M", default_value_t = 0.5, value_parser = rock_m)]
    rock: f64,
    /// Fail unless the graph is like that of a real cave
    #[arg(long)]
    gate: bool,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    outside: Outside,
}

impl Measure {
    /// What it may use.
    pub fn access(&self) -> Access {
        Access { threads: Access::from(self.threads).threads, ..self.outside.into() }
    }

    /// Prints the report on stdout.
    ///
    /// # Errors
    /// If there is nothing to measure, the mesh is not clean, or the realism gate rejects the graph.
    pub fn run(&self, console: &Console) -> Result<(), CliError> {
        let file = if self.path.is_dir() { self.path.join(store::GRAPH) } else { self.path.clone() };
        let folder = self.path.is_dir().then(|| self.folder()).transpose()?;
        if folder.as_ref().map_or(Ok(false), cave::is_graph_edited)? {
            console.note(&format!("  changed   {}", cave::GRAPH_EDITED));
        }
        let Import { graph, recipe, .. } = console.disk().graph(&file, self.parts)?;
        let likeness = self.judged(&graph)?;
        let recipe = Recipe::from_json(recipe.unwrap_or_else(|| json!({})), &file, &[])?;
        let rock = RockReport::of(&graph, recipe.passage().passage_size(), self.rock);
        let mesh = folder.map_or(Ok(None), |folder| self.mesh(&folder, console))?;
        console.result(&said(console, &likeness, &graph, &rock, mesh.as_ref().map(|(_, report)| report)))?;
        if mesh.is_some_and(|(is_clean, _)| !is_clean) {
            return Err(CliError::Failed("the mesh is not clean".into()));
        }
        if self.gate && likeness.verdict != Verdict::Real {
            return Err(CliError::Failed(likeness::complaint(&likeness)));
        }
        Ok(())
    }

    fn folder(&self) -> Result<CaveFolder, CliError> {
        if !CaveFolder::is_at(&self.path) {
            return Err(CliError::Usage {
                message: format!("{}: does not contain a cave", self.path.display()),
                hint: "name a graph, or a folder made by `plume generate -o`".into(),
            });
        }
        Ok(CaveFolder::open(&self.path)?)
    }

    fn judged(&self, graph: &Graph) -> Result<Likeness, CliError> {
        Likeness::of(graph).ok_or_else(|| CliError::Usage {
            message: format!("{}: has no passages to measure", self.path.display()),
            hint: "a graph needs at least two stations and a passage between them".into(),
        })
    }

    /// The reports on the mesh and its convex pieces, and whether the mesh is clean; `None` without a mesh.
    fn mesh(&self, folder: &CaveFolder, console: &Console) -> Result<Option<(bool, Value)>, CliError> {
        let walls = folder.units(Stage::Mesh).into_iter().filter(|unit| !unit.files.is_empty());
        let meshes = walls.map(|unit| store::read_mesh(folder, &unit.name)).collect::<Result<Vec<_>, _>>()?;
        if meshes.is_empty() {
            return Ok(None);
        }
        let report = Report::of(&weld(&meshes));
        let mut json = serde_json::to_value(&report).expect("a report is plain data");
        if !folder.units(Stage::Pieces).is_empty() {
            append(&mut json, &self.pieces(folder, console)?);
        }
        Ok(Some((report.is_clean(), json)))
    }

    /// Measures the convex pieces.
    fn pieces(&self, folder: &CaveFolder, console: &Console) -> Result<PieceReport, CliError> {
        let Input { recipe, graph, .. } = Input::read(Some(&self.path), &[], console.disk())?;
        let pipeline = Pipeline::plan(&recipe, graph, folder, console)?;
        Ok(PieceReport::of(&pipeline.measure_pieces()?))
    }
}

/// The upper limit is there because with more rock most passages are neighbours, and the number of pairs is quadratic.
fn rock_m(text: &str) -> Result<f64, String> {
    let rock_m = text.parse().ok().filter(|rock_m| (0.0..=100.0).contains(rock_m));
    rock_m.ok_or_else(|| "must be a number from 0 to 100".to_owned())
}

/// Both reports, as text or JSON.
fn said(console: &Console, likeness: &Likeness, graph: &Graph, rock: &RockReport, mesh: Option<&Value>) -> String {
    let mesh = mesh.and_then(Value::as_object);
    if console.is_json() {
        let mut all = json!({"graph": likeness::json(likeness, graph), "rock": rock});
        if let (Some(all), Some(mesh)) = (all.as_object_mut(), mesh) {
            all.extend(mesh.clone());
        }
        return format!("{all:#}\n");
    }
    let lines = mesh.into_iter().flatten().map(|(key, value)| format!("  {key:28} {value}\n"));
    let lines: String = lines.collect();
    let mesh = if lines.is_empty() { lines } else { format!("\nmesh\n{lines}{}", genus_text(graph)) };
    format!("{}{}{mesh}", likeness::text(likeness, graph), rock_text(rock, graph))
}

/// Why the genus of the mesh need not be the number of loops of the graph.
fn genus_text(graph: &Graph) -> String {
    format!(
        "the genus counts the handles of the wall: one for each of the {} loops of the graph, and one more wherever passages \
         break through into each other; a loop so tight that no rock is left inside it has none\n",
        graph.loops()
    )
}

/// How much rock is left between passages, and where it is thinnest.
fn rock_text(rock: &RockReport, graph: &Graph) -> String {
    let asked = rock.rock_asked_m;
    let Some(thinnest) = rock.thinnest.first() else {
        return format!("rock: at least {asked} m between passages\n");
    };
    let ids = thinnest.passages.map(|passage| passage.map(|node| graph[node].id.to_string()).join("-"));
    let at = thinnest.place;
    format!(
        "rock: less than {asked} m in {} places ({} between levels), of which {} may break through ({} between levels); \
         least at {:.1} {:.1} {:.1}, {:.2} m between passages {}\n",
        rock.thin_places,
        rock.thin_between_levels,
        rock.breakthroughs,
        rock.breakthroughs_between_levels,
        at.x,
        at.y,
        at.z,
        thinnest.rock_m,
        ids.join(" and ")
    )
}

fn append(report: &mut Value, more: &PieceReport) {
    let more = serde_json::to_value(more).expect("a report is plain data");
    if let (Some(report), Value::Object(more)) = (report.as_object_mut(), more) {
        report.extend(more);
    }
}
