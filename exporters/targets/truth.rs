//! Target `truth`: ground truth for navigation, from the same triangles as the packages of simulators.
//!
//! ```text
//! floor.npz         every cell of the floor, also those over each other
//! map_<n>.png       an occupancy map for each storey that a robot reaches from the start poses
//! map_<n>.yaml      its resolution and origin, as the map server of ROS reads them
//! storeys.json      what is where
//! README.md
//! ```
//! Gravel is left out: nothing collides with it.

use minijinja::context;
use plume_truth::{Columns, Floor, OccupancyMap, Relief, Robot, State, Storeys};
use png::{BitDepth, ColorType, Encoder};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::format::npy::Archive;
use crate::frame::Axes;
use crate::package::{Package, pretty};
use crate::scene::{Content, Scene};
use crate::{Build, Summary, Target, TargetRow, template};

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "truth",
    summary: "ground truth for navigation: the floor as arrays, occupancy maps by storey",
    revision: 0,
    opened_by: "NumPy, the map server of ROS 2 (Nav2), image viewers",
    contents: "floor height, headroom, slope, step and roughness per cell as NumPy arrays; PNG and YAML of an occupancy map per storey",
    tested_by: "NumPy, Pillow and PyYAML by the formulas of Nav2, against rays through the triangles of target `ply` (trimesh)",
    checks: &["truth"],
    images: &[],
    is_single_file: false,
    has_pieces: false,
    bundles: &[],
    settings: || schemars::schema_for!(TruthSettings),
    build: Build::Plain(|table| Ok(Box::new(Truth(serde_json::from_value(table)?)))),
};

/// Settings of target `truth`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TruthSettings {
    /// Side of a cell in metres.
    #[schemars(range(min = 0.02, max = 1.0))]
    pub cell_m: f64,
    /// Height of the robot of the maps in metres.
    #[schemars(range(min = 0.05, max = 10.0))]
    pub height_m: f64,
    /// Highest step that it climbs, in metres.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub step_m: f64,
    /// Steepest floor on which it stands, in degrees.
    #[schemars(range(min = 0.0, max = 60.0))]
    pub slope_deg: f64,
    /// Least area of a storey that gets a map, in square metres.
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub least_area_m2: f64,
}

impl Default for TruthSettings {
    fn default() -> Self {
        Self { cell_m: 0.05, height_m: 0.6, step_m: 0.1, slope_deg: 30.0, least_area_m2: 1.0 }
    }
}

/// The target.
pub struct Truth(
    /// Its settings.
    pub TruthSettings,
);

/// What is known about a storey.
#[derive(Serialize)]
struct Storey {
    /// Its number in `floor.npz`.
    storey: u16,
    area_m2: f64,
    /// Lowest and highest floor.
    floor_m: [f32; 2],
    map: String,
}

impl Target for Truth {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (floor, triangles) = self.floor(scene)?;
        let starts: Vec<[f64; 3]> = scene.spawns.iter().map(|pose| pose.translation.vector.into()).collect();
        let storeys = Storeys::reached(&floor, &self.robot(), &starts);
        let bytes = archive(&floor, &storeys)?;
        out.write("floor.npz", |file| Ok(file.write_all(&bytes)?))?;
        let mapped = self.write_maps(&floor, &storeys, out)?;
        let table = serde_json::json!({
            "generator": scene.generator,
            "frame": "right-handed, Z up, metres",
            "cell_m": self.0.cell_m,
            "robot": { "height_m": self.0.height_m, "step_m": self.0.step_m, "slope_deg": self.0.slope_deg },
            "storeys": mapped,
        });
        out.text("storeys.json", &pretty(&table)?)?;
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            least_area_m2 => self.0.least_area_m2,
            height_m => self.0.height_m,
            step_m => self.0.step_m,
            slope_deg => self.0.slope_deg,
            cells => floor.cells().len(),
            maps => mapped.len(),
        };
        let readme = include_str!("../templates/truth/README.md.jinja");
        out.text("README.md", &template::fill("README.md", readme, &values))?;
        let open = "python -c \"import numpy; print(numpy.load('floor.npz')['z'])\"".to_owned();
        Ok(Summary { visual_triangles: triangles, collision_triangles: 0, open })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

impl Truth {
    fn robot(&self) -> Robot {
        let TruthSettings { height_m, step_m, slope_deg, .. } = self.0;
        Robot { height_m: height_m as f32, step_m: step_m as f32, slope_rad: slope_deg.to_radians() as f32 }
    }

    /// The floor of all chunks, and the number of their triangles, gravel included.
    fn floor(&self, scene: &Scene) -> Result<(Floor, u64), ExportError> {
        let (mut columns, mut triangles) = (Columns::new(self.0.cell_m), 0);
        for index in 0..scene.chunks.len() {
            let chunk = scene.chunk(index)?;
            triangles += chunk.visual.triangles();
            if !matches!(chunk.content, Content::Gravel { .. }) {
                columns.add(&chunk.visual.positions, &chunk.visual.indices);
            }
        }
        Ok((Floor::new(columns), triangles))
    }

    /// Writes a map of each storey that is not too small.
    fn write_maps(&self, floor: &Floor, storeys: &Storeys, out: &mut dyn Package) -> Result<Vec<Storey>, ExportError> {
        let mut mapped = Vec::new();
        for (storey, cells) in (0..).zip(&storeys.sizes) {
            let area_m2 = *cells as f64 * self.0.cell_m * self.0.cell_m;
            if area_m2 < self.0.least_area_m2 {
                continue;
            }
            let map = OccupancyMap::of(floor, storeys, storey);
            let name = format!("map_{}", mapped.len());
            out.write(&format!("{name}.png"), |file| write_image(file, &map))?;
            out.text(&format!("{name}.yaml"), &yaml(&name, &map))?;
            mapped.push(Storey { storey, area_m2, floor_m: map.floor_m, map: format!("{name}.yaml") });
        }
        Ok(mapped)
    }
}

/// The arrays of `floor.npz`.
fn archive(floor: &Floor, storeys: &Storeys) -> Result<Vec<u8>, ExportError> {
    let cells = floor.cells();
    let count = [cells.len()];
    let of = |value: fn(&Relief) -> f32| floor.reliefs().iter().map(value).collect::<Vec<f32>>();
    let indices: Vec<i32> = cells.iter().flat_map(|gap| gap.cell).collect();
    let storeys: Vec<i16> = storeys.of.iter().map(|storey| storey.map_or(-1, |storey| storey as i16)).collect();
    let mut archive = Archive::default();
    archive.add("cell_m", &[], &[floor.cell_m()])?;
    archive.add("cell", &[cells.len(), 2], &indices)?;
    archive.add("z", &count, &cells.iter().map(|gap| gap.floor_m).collect::<Vec<f32>>())?;
    archive.add("headroom", &count, &cells.iter().map(|gap| gap.height_m()).collect::<Vec<f32>>())?;
    archive.add("slope", &count, &of(|relief| relief.slope_rad))?;
    archive.add("step", &count, &of(|relief| relief.step_m))?;
    archive.add("roughness", &count, &of(|relief| relief.roughness_m))?;
    archive.add("storey", &count, &storeys)?;
    Ok(archive.finish()?)
}

/// A map in the greys that the map server of ROS writes and reads, its first row at the top.
fn write_image(file: &mut dyn std::io::Write, map: &OccupancyMap) -> Result<(), ExportError> {
    let [width, height] = map.size;
    let grey = |state: &State| match state {
        State::Free => 254,
        State::Occupied => 0,
        State::Unknown => 205,
    };
    let pixels: Vec<u8> = map.cells.chunks_exact(width).rev().flatten().map(grey).collect();
    let mut encoder = Encoder::new(file, width as u32, height as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(std::io::Error::from)?;
    writer.write_image_data(&pixels).map_err(std::io::Error::from)?;
    Ok(writer.finish().map_err(std::io::Error::from)?)
}

/// What the map server needs to know about an image. With its default threshold for free cells, the grey of unknown ones would
/// be free.
fn yaml(name: &str, map: &OccupancyMap) -> String {
    let OccupancyMap { cell_m, origin_m: [x, y], .. } = map;
    format!(
        "image: {name}.png\nmode: trinary\nresolution: {cell_m}\norigin: [{x}, {y}, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
}
