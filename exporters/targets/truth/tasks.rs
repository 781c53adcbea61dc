//! The files of what there is to do for a robot: lengths of its ways, episodes, what to search for, and where to look around.

use std::path::Path;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plume_graph::rng::Rng;
use plume_graph::seed;
use plume_truth::{Episode, Eye, Floor, Geodesic, Scout, Territory, View, views};
use serde_json::json;

use super::TruthSettings;
use super::habitat;
use super::table::{Entry, FRAME, Table};
use crate::error::ExportError;
use crate::format::npy::Archive;
use crate::package::Package;
use crate::scene::{Instance, Scene};

/// Height over the floor of what has to be seen of a place, in metres: more than gravel, less than what lies about.
const SIGHT_M: f64 = 0.1;

/// A robot in the scene.
pub struct Tasks<'a> {
    scene: &'a Scene<'a>,
    settings: &'a TruthSettings,
    floor: &'a Floor,
    territory: Territory,
    from_start: Geodesic,
    /// Places, and the lengths of the ways there.
    goals: Vec<(usize, Geodesic)>,
}

/// An episode, with what is said of it.
pub struct Task {
    /// The episode.
    pub episode: Episode,
    /// Its goal in metres.
    pub goal_m: [f64; 3],
    /// Length of its path in metres.
    pub geodesic_m: f64,
    /// That of the straight line.
    pub euclidean_m: f64,
}

impl Task {
    /// By how much longer the path is than the straight line.
    pub fn difficulty(&self) -> &'static str {
        match self.geodesic_m / self.euclidean_m {
            ..1.2 => "easy",
            ..1.7 => "medium",
            _ => "hard",
        }
    }

    /// Where the robot starts.
    pub fn start(&self) -> Isometry3<f64> {
        let start = &self.episode.start;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start.heading_rad);
        Isometry3::from_parts(Vector3::from(start.position_m).into(), turn)
    }
}

impl<'a> Tasks<'a> {
    /// What a robot has to do that starts at the first start pose.
    pub fn of(scene: &'a Scene, settings: &'a TruthSettings, floor: &'a Floor, scout: &mut Scout) -> Self {
        let territory = Territory::of(scout, scene.spawns[0].translation.vector.into());
        let from_start = territory.from_start();
        let goals = match settings.goals_at.as_slice() {
            [] => territory.goals(&from_start, settings.goals as usize),
            wanted => {
                let places = wanted.iter().filter_map(|at_m| territory.nearest(*at_m));
                places.map(|place| (place, territory.to(place))).collect()
            }
        };
        Self { scene, settings, floor, territory, from_start, goals }
    }

    /// Writes `geodesic.npz`.
    pub fn write_geodesic(&self, scratch: &Path, table: &mut Table, out: &mut dyn Package) -> Result<(), ExportError> {
        let (cells, at_m) = (self.territory.cells(), self.territory.at_m());
        out.write_by(scratch, "geodesic.npz", |file| {
            let mut archive = Archive::new(file);
            archive.add("cell_m", &[], [self.floor.cell_m()])?;
            archive.add("cell", &[cells.len()], cells.iter().map(|cell| *cell as i32))?;
            archive.add("position", &[cells.len(), 3], at_m.iter().flatten().map(|along_m| *along_m as f32))?;
            archive.add("from_start", &[cells.len()], self.lengths_m(&self.from_start))?;
            archive.add("goal", &[self.goals.len()], self.goals.iter().map(|(place, _)| *place as i32))?;
            let to_goals = self.goals.iter().flat_map(|(_, geodesic)| self.lengths_m(geodesic));
            archive.add("to_goal", &[self.goals.len(), cells.len()], to_goals)?;
            Ok(archive.finish()?)
        })?;
        let content = "lengths of the shortest ways of the robot, from the start and to goals, at cells of the floor";
        table.add(Entry::of_cells("geodesic.npz", content, "m", self.floor.cell_m()));
        Ok(())
    }

    /// Writes `episodes.json.gz` and `tasks.csv`.
    pub fn write_episodes(
        &self,
        scout: &mut Scout,
        table: &mut Table,
        out: &mut dyn Package,
    ) -> Result<(), ExportError> {
        let tasks = self.tasks(scout);
        habitat::write(self.scene, self.settings, &tasks, out)?;
        table.add(Entry::of_frame(habitat::PATH, "episodes in the layout of Habitat's PointNav", "m", habitat::FRAME));
        out.write("tasks.csv", |file| {
            writeln!(
                file,
                "episode,goal,start_x_m,start_y_m,start_z_m,start_heading_deg,goal_x_m,goal_y_m,goal_z_m,geodesic_m,\
                 euclidean_m,difficulty"
            )?;
            for (number, task) in tasks.iter().enumerate() {
                let ([x, y, z], [goal_x, goal_y, goal_z]) = (task.episode.start.position_m, task.goal_m);
                let heading_deg = task.episode.start.heading_rad.to_degrees();
                let Task { episode, geodesic_m, euclidean_m, .. } = task;
                writeln!(
                    file,
                    "{number},{},{x:.3},{y:.3},{z:.3},{heading_deg:.1},{goal_x:.3},{goal_y:.3},{goal_z:.3},\
                     {geodesic_m:.3},{euclidean_m:.3},{}",
                    episode.goal,
                    task.difficulty()
                )?;
            }
            Ok(())
        })?;
        table.add(Entry::new("tasks.csv", "the same episodes as a table", "m, deg"));
        Ok(())
    }

    /// Writes `search.csv`.
    pub fn write_search(&self, table: &mut Table, out: &mut dyn Package) -> Result<(), ExportError> {
        let things = self.sought()?;
        out.write("search.csv", |file| {
            writeln!(file, "id,class,x_m,y_m,z_m,cell,cell_x_m,cell_y_m,cell_z_m,away_m,from_start_m")?;
            for Instance { id, class, pose, .. } in &things {
                let at = pose.translation.vector;
                write!(file, "{id:016x},{class},{:.3},{:.3},{:.3}", at.x, at.y, at.z)?;
                let Some(place) = self.territory.nearest(at.into()) else {
                    writeln!(file, ",,,,,,")?;
                    continue;
                };
                let ([x, y, z], cell) = (self.territory.at_m()[place], self.territory.cells()[place]);
                let (away_m, length_m) = ((at - Vector3::new(x, y, z)).norm(), self.from_start.length_m(place));
                writeln!(file, ",{cell},{x:.3},{y:.3},{z:.3},{away_m:.3},{length_m:.3}")?;
            }
            Ok(())
        })?;
        table.add(Entry::new(
            "search.csv",
            "things to be searched for, and the nearest cells that the robot reaches",
            "m",
        ));
        Ok(())
    }

    /// Writes `coverage.json`.
    pub fn write_coverage(&self, table: &mut Table, out: &mut dyn Package) -> Result<(), ExportError> {
        let TruthSettings { view_range_m: range_m, view_height_m: height_m, .. } = *self.settings;
        let found = views(self.floor, &self.territory, &self.from_start, Eye { height_m, range_m, sight_m: SIGHT_M });
        let view = |View { place, sees }: &View| {
            json!({
                "cell": self.territory.cells()[*place],
                "position": self.territory.at_m()[*place].map(rounded),
                "from_start_m": rounded(self.from_start.length_m(*place)),
                "sees": sees,
            })
        };
        let told = json!({
            "generator": self.scene.generator,
            "frame": FRAME,
            "robot": self.settings.robot,
            "range_m": range_m,
            "height_m": height_m,
            "sight_m": SIGHT_M,
            "cells": self.territory.cells().len(),
            "views": found.iter().map(view).collect::<Vec<_>>(),
        });
        out.json("coverage.json", &told)?;
        let content = "places from which everything that the robot reaches is seen, in the order of a walk";
        table.add(Entry::new("coverage.json", content, "m"));
        Ok(())
    }

    /// The lengths of the ways to all places.
    fn lengths_m(&self, geodesic: &Geodesic) -> impl Iterator<Item = f32> {
        (0..self.territory.cells().len()).map(move |place| geodesic.length_m(place) as f32)
    }

    fn tasks(&self, scout: &mut Scout) -> Vec<Task> {
        let mut random = Rng::new(seed::stream(self.scene.seed, "episodes", 0));
        let count = self.settings.episodes as usize;
        let episodes = Episode::of(scout, &self.territory, &self.goals, count, &mut |end| random.index(end));
        let task = |episode: Episode| {
            let goal_m = self.territory.at_m()[self.goals[episode.goal].0];
            let straight = Vector3::from(goal_m) - Vector3::from(episode.start.position_m);
            // A path on the level may be shorter than the line to where it ends by what is rounded.
            let euclidean_m = straight.norm();
            Task { geodesic_m: episode.route.length_m().max(euclidean_m), euclidean_m, goal_m, episode }
        };
        episodes.into_iter().map(task).collect()
    }

    /// The things to be searched for.
    fn sought(&self) -> Result<Vec<Instance>, ExportError> {
        let mut things = Vec::new();
        for index in 0..self.scene.chunks.len() {
            let all = self.scene.instances(index)?.into_iter();
            things.extend(all.filter(|thing| self.scene.sought.contains(&thing.class)));
        }
        Ok(things)
    }
}

/// To a ten-thousandth.
pub fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
