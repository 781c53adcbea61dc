//! Target `truth`: ground truth for robots, from the same triangles as the packages of simulators.
//!
//! ```text
//! floor.npz         every cell of the floor, also those over each other
//! map_<n>.png       an occupancy map for each storey that a robot reaches from the start poses
//! map_<n>.yaml      its resolution and origin, as the map server of ROS reads them
//! elevation_<n>.tif the numbers of the floor of that storey as a raster
//! occupancy.bt      which cells of a cubic grid are occupied, free or unknown, as an OctoMap
//! voxels.npz        the same with labels, as arrays
//! distance.npz      how far the surface is from the centres of these cells
//! cloud.*           points on the surface
//! labels.json       what the labels stand for
//! truth.json        what is where
//! README.md
//! ```
//! Gravel is left out: nothing collides with it. Chunks are loaded one at a time, and no triangle is kept.

use minijinja::context;
use plume_truth::{Floor, Robot, Storeys, Voxels};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::error::ExportError;
use crate::frame::Axes;
use crate::labels::Labels;
use crate::package::{Package, pretty};
use crate::scene::Scene;
use crate::{Build, Summary, Target, TargetRow, template};
use floors::Floors;
use table::{Entry, FRAME, Table};
use world::World;

mod cloud;
mod floors;
mod grids;
mod table;
mod world;

/// The row of this target.
pub const ROW: TargetRow = TargetRow {
    name: "truth",
    summary: "ground truth for robots: floor, occupancy maps, OctoMap, distances, point clouds, elevation, with labels",
    revision: 1,
    opened_by: "NumPy, the map server of ROS 2 (Nav2), OctoMap, PCL, Open3D, CloudCompare, PDAL, GDAL and QGIS",
    contents: "floor height, headroom, slope, step and roughness per cell as NumPy arrays and as GeoTIFF; PNG and YAML of an occupancy map per storey; an OctoMap; labels and signed distances of voxels; labelled points as PCD, PLY and LAS",
    tested_by: "NumPy, Pillow and PyYAML by the formulas of Nav2, the OctoMap library, pypcd4, plyfile, laspy and rasterio, against rays through the triangles of target `ply` (trimesh) and distances from them (libigl)",
    checks: &["truth"],
    images: &[],
    is_single_file: false,
    has_pieces: false,
    bundles: &[],
    settings: || schemars::schema_for!(TruthSettings),
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
}

impl Part {
    /// Those that need the floor.
    const OF_FLOOR: [Self; 3] = [Self::Floor, Self::Maps, Self::Elevation];
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
}

impl Default for TruthSettings {
    fn default() -> Self {
        let clouds = Part::OF_CLOUD.into_iter();
        let files = [Part::Floor, Part::Maps, Part::Elevation, Part::Occupancy, Part::Voxels, Part::Distance];
        Self {
            files: files.into_iter().chain(clouds).collect(),
            cell_m: 0.05,
            height_m: 0.6,
            step_m: 0.1,
            slope_deg: 30.0,
            least_area_m2: 1.0,
            voxel_m: 0.1,
            reach_m: 0.5,
            points_per_m2: 100.0,
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
        if let Some(voxels) = world.voxels {
            grids::write_voxels(voxels, &self.0, &mut table, out)?;
        }
        if let Some(distances) = world.distances {
            grids::write_distances(distances, &self.0, &mut table, out)?;
        }
        if let Some(cloud) = world.cloud {
            cloud.write(scene, &self.0.files, &mut table, out)?;
        }
        // Last, when the grids are gone: the floor takes as much memory as they do.
        let mut storeys = Vec::new();
        if let Some(floor) = world.columns.map(Floor::new) {
            let starts: Vec<[f64; 3]> = scene.spawns.iter().map(|pose| pose.translation.vector.into()).collect();
            let reached = Storeys::reached(&floor, &self.robot(), &starts);
            let floors = Floors { floor: &floor, storeys: &reached, settings: &self.0 };
            storeys = floors.write(scratch.path(), &mut table, out)?;
        }
        out.text("labels.json", &pretty(&described(&labels, scene))?)?;
        table.add(Entry::new("labels.json", "what the labels of voxels and points stand for", "1"));
        let TruthSettings { height_m, step_m, slope_deg, reach_m, .. } = self.0;
        let told = json!({
            "generator": scene.generator,
            "frame": FRAME,
            "robot": { "height_m": height_m, "step_m": step_m, "slope_deg": slope_deg },
            "reach_m": reach_m,
            "storeys": storeys,
            "files": table,
        });
        out.text("truth.json", &pretty(&told)?)?;
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
        Ok(Summary { visual_triangles: world.triangles, collision_triangles: 0, open })
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
}

/// What labels stand for, and the friction of that.
fn described(labels: &Labels, scene: &Scene) -> serde_json::Value {
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
