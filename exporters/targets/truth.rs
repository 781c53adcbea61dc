//! Target `truth`: ground truth for robots, from the same triangles as the packages of simulators.
//!
//! ```text
//! floor.npz         every cell of the floor, also those over each other
//! map_<n>.png       an occupancy map for each storey that a robot reaches from the start poses
//! map_<n>.yaml      its resolution and origin, as the map server of ROS reads them
//! elevation_<n>.tif the numbers of the floor of that storey as a raster
//! elevation_<n>.mcap the same as messages of grid_map, for ROS 2
//! occupancy.bt      which cells of a cubic grid are occupied, free or unknown, as an OctoMap
//! voxels.npz        the same with labels, as arrays
//! distance.npz      how far the surface is from the centres of these cells
//! cloud.*           points on the surface
//! network.graphml   stations and passages each way, and whether a robot gets through
//! survey.svx        the same as a cave survey
//! geodesic.npz      how far it is for the robot from the start and to goals
//! episodes.json.gz  starts and goals with shortest paths, as Habitat has them
//! tasks.csv         the same as a table
//! search.csv        things to be searched for
//! coverage.json     places from which everything is seen
//! labels.json       what the labels stand for
//! truth.json        what is where
//! README.md
//! ```
//! Gravel is left out: nothing collides with it. Chunks are loaded one at a time, and no triangle is kept. Voxels, distances and clouds
//! are made on the disk. The floor is in memory, because storeys and shortest ways are about all of it.

use std::path::Path;

use minijinja::context;
use plume_truth::robot::{self, Known};
use plume_truth::{Floor, Robot, Scout, Storeys, Voxels};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::error::ExportError;
use crate::frame::Axes;
use crate::labels::Labels;
use crate::package::Package;
use crate::scene::Scene;
use crate::surface::FloorBuilder;
use crate::{Build, Open, Summary, Target, TargetRow, template};
use floors::Floors;
use table::{Entry, FRAME, Table};
use tasks::Tasks;
use topology::Topology;
use world::World;

mod cloud;
mod floors;
mod grids;
mod habitat;
mod layer;
mod sheet;
mod table;
mod tasks;
mod topology;
mod world;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "truth",
    summary: "ground truth for robots: floor, occupancy maps, OctoMap, distances, point clouds, elevation, with labels; network, survey, geodesics and tasks",
    revision: 2,
    opened_by: "NumPy, Nav2, grid_map for ROS 2, OctoMap, PCL, Open3D, CloudCompare, PDAL, GDAL, QGIS, networkx, Survex and Habitat",
    contents: "floor height, headroom, slope, step and roughness per cell as NumPy arrays, as GeoTIFF and as messages of grid_map; PNG and YAML of an occupancy map per storey; an OctoMap; labels and signed distances of voxels; labelled points as PCD, PLY and LAS; for a robot, the network of passages as GraphML and Survex, geodesics, PointNav episodes, lists to search for, coverage",
    tested_by: "NumPy, Pillow and PyYAML by the formulas of Nav2, the OctoMap library, pypcd4, plyfile, laspy, rasterio, mcap-ros2-support, networkx, Survex and SciPy, against rays through the triangles of target `ply` (trimesh) and distances from them (libigl)",
    checks: &["truth"],
    images: &[],
    is_single_file: false,
    has_pieces: false,
    bundles: &[],
    settings: plume_registry::settings_schema::<TruthSettings>,
    build: Build::Plain(|table| Ok(Box::new(Truth(serde_json::from_value(table)?)))),
};

/// A part of the package that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// `floor.npz`.
    Floor,
    /// `map_<n>.png` and `map_<n>.yaml`.
    Maps,
    /// `elevation_<n>.tif`.
    Elevation,
    /// `elevation_<n>.mcap`.
    GridMap,
    /// `occupancy.bt`.
    Occupancy,
    /// `voxels.npz`.
    Voxels,
    /// `distance.npz`.
    Distance,
    /// `cloud.pcd`.
    Pcd,
    /// `cloud.ply`.
    Ply,
    /// `cloud.las`.
    Las,
    /// `network.graphml`.
    Network,
    /// `survey.svx`.
    Survey,
    /// `geodesic.npz`.
    Geodesic,
    /// `episodes.json.gz` and `tasks.csv`.
    Episodes,
    /// `search.csv`.
    Search,
    /// `coverage.json`.
    Coverage,
}

impl Part {
    /// Those that need the floor.
    const OF_FLOOR: [Self; 10] = [
        Self::Floor,
        Self::Maps,
        Self::Elevation,
        Self::GridMap,
        Self::Network,
        Self::Survey,
        Self::Geodesic,
        Self::Episodes,
        Self::Search,
        Self::Coverage,
    ];
    /// Those that need to know where a robot gets from its start.
    const OF_TASKS: [Self; 4] = [Self::Geodesic, Self::Episodes, Self::Search, Self::Coverage];
    /// Those that need the states of voxels.
    const OF_STATES: [Self; 2] = [Self::Occupancy, Self::Voxels];
    /// Those that need points on the surface.
    const OF_CLOUD: [Self; 3] = [Self::Pcd, Self::Ply, Self::Las];
}

/// Settings of target `truth`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct TruthSettings {
    /// What to write.
    pub files: Vec<Part>,
    /// Side of a cell of the floor in metres.
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
    /// Side of a voxel in metres: of the OctoMap, of labels and of distances.
    #[schemars(range(min = 0.02, max = 1.0))]
    pub voxel_m: f64,
    /// How far from the surface distances are told, in metres.
    #[schemars(range(min = 0.05, max = 5.0))]
    pub reach_m: f64,
    /// Points of the clouds per square metre of surface.
    #[schemars(range(min = 1.0, max = 10000.0))]
    pub points_per_m2: f64,
    /// Robot of the network, of geodesics and of tasks: one of `plume list robots`.
    #[schemars(schema_with = "robot::name_schema")]
    pub robot: Known,
    /// Number of goals of geodesics and episodes.
    #[schemars(range(min = 0, max = 1000))]
    pub goals: u32,
    /// Places of goals in metres, instead of those far from the start and from each other.
    pub goals_at: Vec<[f64; 3]>,
    /// Number of episodes, each to one of the goals.
    #[schemars(range(min = 0, max = 100000))]
    pub episodes: u32,
    /// Radius of the goals of episodes in metres.
    #[schemars(range(min = 0.01, max = 10.0))]
    pub goal_radius_m: f64,
    /// How far a view of the coverage reaches, in metres.
    #[schemars(range(min = 0.5, max = 100.0))]
    pub view_range_m: f64,
    /// Height of its eye over the floor in metres.
    #[schemars(range(min = 0.05, max = 10.0))]
    pub view_height_m: f64,
    /// Standard deviation of lengths in the survey, in metres; 0 measures without errors.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub tape_sd_m: f64,
    /// Standard deviation of its compass and clinometer, in degrees.
    #[schemars(range(min = 0.0, max = 30.0))]
    pub angle_sd_deg: f64,
}

impl Default for TruthSettings {
    fn default() -> Self {
        let others = Part::OF_CLOUD.into_iter().chain([Part::Network, Part::Survey]).chain(Part::OF_TASKS);
        let of_floor = [Part::Floor, Part::Maps, Part::Elevation, Part::GridMap];
        let files = of_floor.into_iter().chain([Part::Occupancy, Part::Voxels, Part::Distance]);
        Self {
            files: files.chain(others).collect(),
            cell_m: 0.05,
            height_m: 0.6,
            step_m: 0.1,
            slope_deg: 30.0,
            least_area_m2: 1.0,
            voxel_m: 0.1,
            reach_m: 0.5,
            points_per_m2: 100.0,
            robot: Known(&robot::ROBOTS[0]),
            goals: 4,
            goals_at: Vec::new(),
            episodes: 50,
            goal_radius_m: 0.2,
            view_range_m: 5.0,
            view_height_m: 0.5,
            tape_sd_m: 0.0,
            angle_sd_deg: 0.0,
        }
    }
}

/// The target.
pub struct Truth(
    /// Its settings.
    pub TruthSettings,
);

impl Target for Truth {
    fn export(&self, scene: &Scene, out: &mut dyn Package) -> Result<Summary, ExportError> {
        scene.check()?;
        let (labels, scratch, mut table) = (Labels::of(scene)?, out.scratch()?, Table::default());
        let world = World::of(scene, &self.0, &labels, scratch.path())?;
        if let Some(states) = world.states {
            grids::write_states(states, &self.0, scratch.path(), &mut table, out)?;
        }
        if let Some(distances) = world.distances {
            grids::write_distances(distances, &self.0, scratch.path(), &mut table, out)?;
        }
        if let Some(cloud) = world.cloud {
            cloud.write(scene, &self.0.files, &mut table, out)?;
        }
        let (mut storeys, mut network) = (Vec::new(), None);
        if let Some(floor) = world.floor.map(FloorBuilder::finish) {
            let starts: Vec<[f64; 3]> = scene.spawns.iter().map(|pose| pose.translation.vector.into()).collect();
            let reached = Storeys::reached(&floor, &self.robot(), &starts);
            let floors = Floors { floor: &floor, storeys: &reached, settings: &self.0 };
            storeys = floors.write(scratch.path(), &mut table, out)?;
            network = Some(self.write_journeys(scene, &floor, scratch.path(), &mut table, out)?);
        }
        out.json("labels.json", &described(&labels, scene))?;
        table.add(Entry::new("labels.json", "what the labels of voxels and points stand for", "1"));
        let TruthSettings { height_m, step_m, slope_deg, reach_m, robot, .. } = self.0;
        let told = json!({
            "generator": scene.generator,
            "frame": FRAME,
            "robot": { "height_m": height_m, "step_m": step_m, "slope_deg": slope_deg },
            "reach_m": reach_m,
            "storeys": storeys,
            "journeys": { "robot": robot.0.name, "settings": robot.0.settings },
            "network": network,
            "sought": scene.sought,
            "files": table,
        });
        out.json("truth.json", &told)?;
        let values = context! {
            name => &scene.name,
            description => &scene.description,
            generator => &scene.generator,
            settings => minijinja::value::Serde(&self.0),
            storeys => storeys.len(),
        };
        let readme = include_str!("../templates/truth/README.md.jinja");
        out.text("README.md", &template::fill("README.md", readme, &values))?;
        let open = "python -c \"import json; print(json.load(open('truth.json')))\"".to_owned();
        Ok(Summary { visual_triangles: world.triangles, collision_triangles: 0, open: Open::Command(open) })
    }

    fn axes(&self) -> Axes {
        Axes::SCENE
    }
}

impl Truth {
    /// Writes what has to do with the network and with the robot that gets through it; returns what is told of the network.
    fn write_journeys(
        &self,
        scene: &Scene,
        floor: &Floor,
        scratch: &Path,
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<Value, ExportError> {
        let wants = |part: Part| self.0.files.contains(&part);
        let profile = self.0.robot.0.settings.profile(scene.friction.floor);
        // One for all, as it remembers every place that it has looked at.
        let mut scout = Scout::new(floor, &profile);
        let topology = Topology { scene, floor, settings: &self.0 };
        if wants(Part::Network) {
            let start_m = scene.spawns[0].translation.vector.into();
            let certificate = scout.certify(&scene.network.ways(), start_m);
            topology.write_network(&certificate, table, out)?;
        }
        if wants(Part::Survey) {
            topology.write_survey(table, out)?;
        }
        if Part::OF_TASKS.into_iter().any(wants) {
            let tasks = Tasks::of(scene, &self.0, floor, &mut scout);
            self.write_tasks(&tasks, &mut scout, scratch, table, out)?;
        }
        Ok(topology.summary())
    }

    fn write_tasks(
        &self,
        tasks: &Tasks,
        scout: &mut Scout,
        scratch: &Path,
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let wants = |part: Part| self.0.files.contains(&part);
        if wants(Part::Geodesic) {
            tasks.write_geodesic(scratch, table, out)?;
        }
        if wants(Part::Episodes) {
            tasks.write_episodes(scout, table, out)?;
        }
        if wants(Part::Search) {
            tasks.write_search(table, out)?;
        }
        if wants(Part::Coverage) {
            tasks.write_coverage(table, out)?;
        }
        Ok(())
    }

    fn robot(&self) -> Robot {
        let TruthSettings { height_m, step_m, slope_deg, .. } = self.0;
        Robot { height_m: height_m as f32, step_m: step_m as f32, slope_rad: slope_deg.to_radians() as f32 }
    }
}

/// What labels stand for, and the friction of that.
fn described(labels: &Labels, scene: &Scene) -> Value {
    let labels: Vec<_> = labels
        .all()
        .map(|label| {
            json!({
                "label": label.number,
                "name": label.name,
                "zone": label.zone.map(|zone| zone.name()),
                "friction": label.zone.map(|zone| scene.friction.of(zone)),
            })
        })
        .collect();
    json!({ "generator": scene.generator, "unknown": Voxels::UNKNOWN, "free": Voxels::FREE, "labels": labels })
}
