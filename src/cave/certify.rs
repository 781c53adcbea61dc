//! Certificates: where a robot gets in a finished cave, and what stops it.

use std::path::Path;

use plume_exporters::frame::milli;
use plume_exporters::scene::Scene;
use plume_exporters::surface;
use plume_graph::{Graph, StationId};
use plume_truth::robot::{self, ROBOTS, RobotSettings};
use plume_truth::{Cause, Certificate, Class, Fault, Floor, Reach, Route, Through, Verdict, Waypoint};
use serde_json::{Value, json};

use super::{Cave, CaveError, read};
use crate::pipeline::{self, Observer};
use crate::preview::{Judgement, MAP, judged};
use crate::recipe::{self, Recipe};

/// Side of a cell of the floor in metres.
const CELL_M: f64 = 0.05;

/// A robot with its name.
#[derive(Clone, Debug)]
pub struct NamedRobot {
    /// The name of its row, or of its file without extension.
    pub name: String,
    /// What it measures.
    pub settings: RobotSettings,
}

/// A certificate of a cave.
pub struct Certified<'a> {
    robot: &'a NamedRobot,
    pub(super) recipe: &'a Recipe,
    pub(super) graph: &'a Graph,
    generator: &'a str,
    /// What was found.
    pub certificate: Certificate,
}

/// The robot called `name`, or that of a TOML file.
///
/// # Errors
/// An unknown name, a file that cannot be read, every fault in it.
pub fn named_robot(name: &str) -> Result<NamedRobot, CaveError> {
    let path = Path::new(name);
    if path.extension().is_none_or(|extension| extension != "toml") {
        let names = ROBOTS.iter().map(|row| row.name);
        let row = robot::robot(name).ok_or_else(|| CaveError::unknown("robot", name, names))?;
        return Ok(NamedRobot { name: row.name.to_owned(), settings: row.settings.clone() });
    }
    let text = read(path)?;
    // A drone is what has a radius; everything else drives or walks.
    let settings = match recipe::has_key(&text, path, "radius_m")? {
        true => RobotSettings::Drone(recipe::from_toml(&text, path)?),
        false => RobotSettings::Vehicle(recipe::from_toml(&text, path)?),
    };
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    Ok(NamedRobot { name: stem.unwrap_or_default(), settings })
}

impl Cave {
    /// The floor of its exported surface, and where its first start pose is on it.
    ///
    /// # Errors
    /// If a chunk cannot be read; if work was stopped.
    pub(super) fn floor(&self, scene: &Scene) -> Result<(Floor, [f64; 3]), CaveError> {
        Ok((surface::floor(scene, CELL_M)?, scene.spawns[0].translation.vector.into()))
    }

    /// Holds it to the robots of its recipe.
    ///
    /// # Errors
    /// [`CaveError::Failed`] if one of them is not sure to reach every station and to come back; as [`certify`](Self::certify).
    pub(super) fn hold_to_certificates(&self, observer: &dyn Observer) -> Result<(), CaveError> {
        let names = &self.recipe.world().certify;
        if names.is_empty() {
            return Ok(());
        }
        let chunks = self.chunks(observer.stop());
        let scene = self.scene(&chunks);
        let (floor, start_m) = self.floor(&scene)?;
        names.iter().try_for_each(|name| self.certified(&scene, &floor, start_m, &named_robot(name)?).refuse_doubt())
    }

    /// Certifies a robot that starts at the first start pose.
    ///
    /// # Errors
    /// If a chunk cannot be read; if work was stopped.
    pub fn certify<'a>(&'a self, scene: &'a Scene, robot: &'a NamedRobot) -> Result<Certified<'a>, CaveError> {
        let (floor, start_m) = self.floor(scene)?;
        Ok(self.certified(scene, &floor, start_m, robot))
    }

    fn certified<'a>(
        &'a self,
        scene: &'a Scene,
        floor: &Floor,
        start_m: [f64; 3],
        robot: &'a NamedRobot,
    ) -> Certified<'a> {
        let profile = robot.settings.profile(scene.friction.floor);
        let certificate = Certificate::of(floor, &profile, &scene.network.ways(), start_m);
        Certified { robot, recipe: &self.recipe, graph: &self.graph, generator: &scene.generator, certificate }
    }
}

impl Certified<'_> {
    /// A plan of it as a PNG: passages by their worse direction, the path to the furthest station, and what stops the robot,
    /// numbered as in [`stops`](Self::stops).
    pub fn plan(&self) -> Vec<u8> {
        let Certificate { passages, furthest, .. } = &self.certificate;
        let route = furthest.as_ref().map(|(_, route)| route.waypoints.iter().map(|one| one.position_m).collect());
        let judgement = Judgement {
            what: format!("certificate for {}", self.robot.name),
            passages: passages.iter().map(|through| worse(through) as usize).collect(),
            names: [Class::Go, Class::Marginal, Class::NoGo].map(Class::name),
            route: route.unwrap_or_default(),
            places: self.stops().map(|(_, _, at_m)| at_m).collect(),
        };
        let field = pipeline::field(self.recipe, self.graph);
        judged(&pipeline::subject(self.recipe, self.graph, &field), &judgement, MAP)
    }

    /// What keeps the robot from simply getting through passages: the number of the passage, what it is, and where, in metres.
    pub fn stops(&self) -> impl Iterator<Item = (usize, Fault, [f64; 3])> {
        let passages = self.certificate.passages.iter().enumerate();
        passages.filter_map(|(number, through)| {
            let Through { there, back, .. } = through;
            let worse = if back.class > there.class { back } else { there };
            let (fault, at_m) = worse.fault?;
            Some((number, fault, at_m))
        })
    }

    /// Number of stations that the robot surely reaches and leaves again.
    fn sure(&self) -> usize {
        self.certificate.stations.iter().filter(|reach| reach.is_sure()).count()
    }

    /// A passage by its stations.
    fn passage(&self, number: usize) -> String {
        self.graph.edges[number].map(|end| self.graph[end].id.to_string()).join("..")
    }

    fn refuse_doubt(&self) -> Result<(), CaveError> {
        let (sure, all) = (self.sure(), self.certificate.stations.len());
        if sure == all {
            return Ok(());
        }
        let name = &self.robot.name;
        let first = self.stops().next();
        let first =
            first.map(|(number, fault, at_m)| format!("; first {}: {}", self.passage(number), said(&fault, at_m)));
        let first = first.unwrap_or_default();
        Err(CaveError::Failed(format!(
            "world.certify: {name} is sure of {sure} of {all} stations{first}; change the seed or the passages, or see `plume certify`"
        )))
    }

    /// Everything in a few lines.
    pub fn text(&self) -> String {
        let Certificate { floor_m2, reached_m2, stations, passages, furthest } = &self.certificate;
        let share = 100.0 * reached_m2 / floor_m2;
        let mut lines = vec![
            format!("{}: {:.0} m² of floor, of which its middle is sure of {share:.0} %", self.robot.name, floor_m2),
            format!("stations: {} of {} reached and left again", self.sure(), stations.len()),
        ];
        let count = |class: Class| passages.iter().filter(|through| worse(through) == class).count();
        let [go, marginal, no_go] = [Class::Go, Class::Marginal, Class::NoGo].map(count);
        lines.push(format!("passages: {go} go, {marginal} marginal, {no_go} no-go"));
        if let Some(widest_m) = passages.iter().map(|through| through.widest_m).reduce(f64::min) {
            lines.push(format!("narrowest passage: {widest_m:.2} m"));
        }
        if let Some((number, route)) = furthest {
            lines.push(format!(
                "furthest station: {}, {:.1} m from the start",
                self.graph.nodes[*number].id,
                route.length_m()
            ));
        }
        lines.extend(self.stops().zip(1..).map(|((number, fault, at_m), place)| {
            let class = worse(&passages[number]).name();
            format!("{place:3}  {} {class}: {}", self.passage(number), said(&fault, at_m))
        }));
        lines.join("\n") + "\n"
    }

    /// Everything, with ids of stations as in the graph; metres and degrees.
    pub fn json(&self) -> Value {
        let Certificate { floor_m2, reached_m2, stations, passages, furthest } = &self.certificate;
        let id = |number: usize| self.graph.nodes[number].id;
        let name = |class: Option<Class>| class.map_or("none", Class::name);
        let station = |(number, reach): (usize, &Reach)| {
            json!({
                "id": id(number), "there": name(reach.there), "back": name(reach.back), "length_m": milli(reach.length_m),
            })
        };
        let passage = |(ends, through): (&[StationId; 2], &Through)| {
            json!({
                "from": self.graph[ends[0]].id, "to": self.graph[ends[1]].id, "widest_m": milli(through.widest_m),
                "there": verdict(&through.there), "back": verdict(&through.back),
            })
        };
        let route = furthest.as_ref().map(
            |(number, route)| json!({"to": id(*number), "length_m": milli(route.length_m()), "path": path(route)}),
        );
        json!({
            "generator": self.generator,
            "robot": { "name": self.robot.name, "settings": self.robot.settings },
            "frame": "right-handed, Z up, metres",
            "path": ["x_m", "y_m", "z_m", "heading_deg", "climb_deg", "lean_deg"],
            "floor": { "area_m2": milli(*floor_m2), "reached_m2": milli(*reached_m2), "share": milli(reached_m2 / floor_m2) },
            "stations": stations.iter().enumerate().map(station).collect::<Value>(),
            "passages": self.graph.edges.iter().zip(passages).map(passage).collect::<Value>(),
            "route": route,
        })
    }
}

/// The class of the worse direction.
fn worse(through: &Through) -> Class {
    through.there.class.max(through.back.class)
}

/// A fault and where it is in words.
fn said(fault: &Fault, [x, y, z]: [f64; 3]) -> String {
    let (name, [value, limit]) = (fault.cause.name(), fault.at_edge());
    let what = match fault.cause {
        Cause::NoFloor => "no floor".to_owned(),
        cause if cause.is_angle() => format!("{name} {value:.0}°, limit {limit:.0}°"),
        _ => format!("{name} {value:.2} m, limit {limit:.2} m"),
    };
    format!("{what} at {x:.2} {y:.2} {z:.2}")
}

fn verdict(verdict: &Verdict) -> Value {
    let Verdict { class, fault, route } = verdict;
    let fault = fault.as_ref().map(|(fault, at)| {
        let unit = if fault.cause.is_angle() { "deg" } else { "m" };
        let [value, limit] = fault.at_edge().map(milli);
        json!({"cause": fault.cause.name(), "unit": unit, "value": value, "limit": limit, "at": at.map(milli)})
    });
    json!({ "class": class.name(), "stopped_by": fault, "path": path(route) })
}

/// Positions, headings, climbs and leans.
fn path(route: &Route) -> Value {
    let pose = |waypoint: &Waypoint| {
        let [x, y, z] = waypoint.position_m.map(milli);
        let turns = [waypoint.heading_rad, waypoint.climb_rad, waypoint.lean_rad];
        let [heading, climb, lean] = turns.map(|turn| milli(turn.to_degrees()));
        json!([x, y, z, heading, climb, lean])
    };
    route.waypoints.iter().map(pose).collect()
}
