//! A summary of what was made, in a few lines or as JSON.

use std::fs;
use std::ops::Add;
use std::path::Path;
use std::time::Instant;

use cpu_time::ProcessTime;
use serde_json::{Map, Value, json};

use super::fault::CliError;
use super::progress::Console;
use plume::cave::{Exported, Order};
use plume::pipeline::Pipeline;
use plume::store::{CaveFolder, Facts, Stage, Unit, WHOLE_CAVE};
use plume_exporters::Open;
use plume_exporters::frame::milli;
use plume_graph::Graph;

/// Numbers gathered while the stages run.
pub struct Summary {
    wall: Instant,
    cpu: ProcessTime,
    lines: Vec<String>,
    json: Map<String, Value>,
}

impl Summary {
    /// Starts the clocks.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: ProcessTime::now(), lines: Vec::new(), json: Map::new() }
    }

    /// A stage is done.
    pub fn stage_done(&mut self, stage: Stage, pipeline: &Pipeline) {
        match stage {
            Stage::Graph => self.graph(pipeline.graph()),
            Stage::Preview => self.preview(&pipeline.units(Stage::Preview)),
            Stage::Mesh => self.mesh(&pipeline.walls()),
            Stage::Things => self.things(&pipeline.units(Stage::Things)),
            Stage::Texture => self.texture(&pipeline.units(Stage::Texture)),
            Stage::Pieces => self.pieces(&pipeline.units(Stage::Pieces)),
        }
    }

    fn graph(&mut self, graph: &Graph) {
        let (nodes, loops, length_m) = (graph.nodes.len(), graph.loops(), graph.length_m());
        let numbers = json!({"nodes": nodes, "loops": loops, "length_m": milli(length_m)});
        self.stage("graph", &format!("{nodes} nodes  {loops} loops  {length_m:.0} m"), numbers);
    }

    fn preview(&mut self, units: &[Unit]) {
        let maps: Vec<&str> = units.iter().flat_map(|unit| &unit.files).map(|file| file.path.as_str()).collect();
        self.stage("preview", &maps.join("  "), json!({"files": maps}));
    }

    fn mesh(&mut self, walls: &[Unit]) {
        let facts =
            || walls.iter().filter_map(|unit| if let Facts::Mesh(facts) = unit.facts { Some(facts) } else { None });
        let triangles: usize = facts().map(|facts| facts.triangles).sum();
        let collision: usize = facts().filter_map(|facts| facts.collision_triangles).sum();
        let area_m2 = facts().filter_map(|facts| facts.area_m2).fold(0.0, f64::add);
        let chunks = walls.len();
        let numbers = json!({
            "chunks": chunks, "triangles": triangles, "collision_triangles": collision, "area_m2": milli(area_m2)
        });
        let text = format!("{chunks} chunks  {triangles} triangles  {area_m2:.0} m²");
        self.stage("mesh", &text, numbers);
    }

    fn things(&mut self, units: &[Unit]) {
        let count = |unit: &Unit| if let Facts::Things(facts) = &unit.facts { facts.things } else { 0 };
        let (whole, chunks): (Vec<&Unit>, Vec<&Unit>) = units.iter().partition(|unit| unit.name == WHOLE_CAVE);
        let sum = |units: &[&Unit]| units.iter().map(|unit| count(unit)).sum::<usize>();
        let (shapes, things) = (sum(&whole), sum(&chunks));
        let text = format!("{things} things of {shapes} shapes");
        self.stage("things", &text, json!({"things": things, "shapes": shapes}));
    }

    fn texture(&mut self, units: &[Unit]) {
        let bytes: u64 = units.iter().flat_map(|unit| &unit.files).map(|file| file.bytes).sum();
        let density = |unit: &Unit| if let Facts::Texture(facts) = &unit.facts { facts.texels_per_m } else { None };
        let density = units.iter().filter_map(density).fold(f64::INFINITY, f64::min);
        let numbers = json!({"bytes": bytes, "texels_per_m": density});
        self.stage("texture", &format!("{:.0} MB  at least {density:.0} texels/m", megabytes(bytes)), numbers);
    }

    fn pieces(&mut self, units: &[Unit]) {
        let count = |unit: &Unit| if let Facts::Pieces(facts) = unit.facts { facts.pieces } else { 0 };
        let pieces: usize = units.iter().map(count).sum();
        self.stage("pieces", &format!("{pieces} convex pieces"), json!({"pieces": pieces}));
    }

    /// A package was written.
    pub fn package(&mut self, order: &Order, exported: &Exported) {
        let (path, open) = (&order.place.path, exported.summary.open.text());
        let (count, bytes) = (exported.files.0.len(), exported.files.bytes());
        // Packages are written in parallel, so each reports its own time.
        let cpu_s = exported.cpu.as_secs_f64();
        let numbers =
            json!({"path": path.to_string_lossy(), "files": count, "bytes": bytes, "open": open, "cpu_s": cpu_s});
        let text = format!("{}  {count} files  {:.0} MB", path.display(), megabytes(bytes));
        self.row(&order.wanted.choice.name(), &text, cpu_s, numbers);
        self.lines.push(format!("  {:9} {}", "to open:", opening(path, &exported.summary.open)));
    }

    /// An intact package of the same cave was there already.
    pub fn kept(&mut self, order: &Order) {
        let (name, path) = (order.wanted.choice.name(), &order.place.path);
        self.lines.push(format!("  {name:9} {}  already up to date", path.display()));
        self.json.insert(name, json!({"path": path.to_string_lossy(), "kept": true}));
    }

    /// A cave folder was made.
    pub fn place(&mut self, what: &str, path: &Path, folder: &CaveFolder) {
        let stages = [Stage::Graph, Stage::Preview, Stage::Mesh, Stage::Things, Stage::Texture, Stage::Pieces];
        let units = stages.into_iter().flat_map(|stage| folder.units(stage));
        let files: usize = units.map(|unit| unit.files.len()).sum();
        self.stage(
            what,
            &format!("{}  {files} files", path.display()),
            json!({"path": path.to_string_lossy(), "files": files}),
        );
    }

    /// Prints it all.
    ///
    /// # Errors
    /// Those of standard output.
    pub fn print(mut self, console: &Console) -> Result<(), CliError> {
        let wall_s = self.wall.elapsed().as_secs_f64();
        self.json.insert("wall_s".into(), json!(wall_s));
        self.json.insert("peak_memory_bytes".into(), json!(peak_memory_bytes()));
        if console.is_json() {
            return console.result(&format!("{:#}\n", Value::Object(self.json)));
        }
        self.lines.iter().for_each(|line| console.note(line));
        let memory = peak_memory_bytes().map(|bytes| format!("  peak {:.0} MB", megabytes(bytes)));
        console.note(&format!("  done      {wall_s:.1} s{}", memory.unwrap_or_default()));
        Ok(())
    }

    fn stage(&mut self, name: &str, text: &str, mut numbers: Value) {
        let cpu_s = self.cpu.elapsed().as_secs_f64();
        self.cpu = ProcessTime::now();
        numbers["cpu_s"] = json!(cpu_s);
        self.row(name, text, cpu_s, numbers);
    }

    fn row(&mut self, name: &str, text: &str, cpu_s: f64, numbers: Value) {
        self.json.insert(name.to_owned(), numbers);
        self.lines.push(format!("  {name:9} {text}  {cpu_s:.1} CPU s"));
    }
}

/// How to open a package from where the user stands.
fn opening(package: &Path, open: &Open) -> String {
    match open {
        Open::Command(command) => format!("cd {} && {command}", shell_word(&package.to_string_lossy())),
        Open::Words(words) => words.clone(),
    }
}

/// A word as shells take it, in quotes if it needs them.
fn shell_word(text: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "/._-+,:@".contains(letter);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text.to_owned(),
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Peak memory of the process, where the system reports it (Linux).
fn peak_memory_bytes() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use plume_exporters::Open;

    use super::opening;

    #[test]
    fn a_command_to_open_a_package_works_from_where_the_user_is() {
        let command = Open::Command("gz sim cave.sdf".to_owned());
        assert_eq!(opening(Path::new("out/gazebo"), &command), "cd out/gazebo && gz sim cave.sdf");
        assert_eq!(opening(Path::new("my cave's"), &command), r"cd 'my cave'\''s' && gz sim cave.sdf");
        let words = Open::Words("open cave.obj".to_owned());
        assert_eq!(opening(Path::new("out/obj"), &words), "open cave.obj");
    }
}
