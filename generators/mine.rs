//! A mine worked by room and pillar: parallel drifts, cross-cuts between them, levels joined by a ramp or a shaft.
//!
//! Every level starts at the same point of the plan: a cross-cut to the north opens the drifts, which are driven
//! eastwards bay by bay, and at the end of each bay cross-cuts join them. Ramps wind down in a square to the
//! south-west, where no level has passages. The layout is the textbook one (Hustrulid & Bullock: "Underground Mining
//! Methods", 2001), without ventilation, ore passes or surface access.
//!
//! Promised: exactly the asked number of nodes, one component, at most four passages at a node, axes within the jitter.

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GenerateError, Generator};
use plume_graph::Outside;
use plume_graph::rng::Rng;
use plume_graph::seed;
use plume_graph::{Graph, Node, Section, Shape, StationId, millimetres};

/// Probability that a drift stops at the end of a bay, relative to the probability that a cross-cut is omitted.
const STOPS_PER_SKIP: f64 = 0.1;
/// Shortest side of a ramp's square, in widths of a drift.
const RAMP_SIDE: f64 = 4.0;

const EAST: Vector3<f64> = Vector3::new(1.0, 0.0, 0.0);
const NORTH: Vector3<f64> = Vector3::new(0.0, 1.0, 0.0);
const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -1.0);

/// What joins two levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Access {
    /// An inclined drift that winds down in a square, passable for vehicles.
    #[default]
    Ramp,
    /// A vertical shaft.
    Shaft,
}

/// Settings of the mine generator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields, rename_all = "snake_case")]
pub struct Mine {
    /// Number of nodes (stations on the centreline); drifts are driven until they are used up.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub nodes: u32,
    /// Number of levels, one below another.
    #[schemars(range(min = 1, max = 50))]
    pub levels: u32,
    /// Vertical distance between levels, in metres.
    #[schemars(range(min = 4.0, max = 100.0))]
    pub level_spacing_m: f64,
    /// What joins the levels: `ramp` or `shaft`.
    pub access: Access,
    /// Maximum inclination of a ramp, in degrees; haulage declines are driven at 1 in 7, about 8 degrees.
    #[schemars(range(min = 3.0, max = 30.0))]
    pub ramp_max_deg: f64,
    /// Number of parallel drifts on a level.
    #[schemars(range(min = 1, max = 50))]
    pub drifts: u32,
    /// Distance between parallel drifts, centre to centre, in metres.
    #[schemars(range(min = 3.0, max = 200.0))]
    pub drift_spacing_m: f64,
    /// Distance between cross-cuts, centre to centre, in metres.
    #[schemars(range(min = 3.0, max = 200.0))]
    pub crosscut_interval_m: f64,
    /// Maximum distance between stations in metres; shortened so that a whole number fits between cross-cuts.
    #[schemars(range(min = 1.0, max = 50.0))]
    pub station_spacing_m: f64,
    /// Width of drifts, cross-cuts and ramps, in metres.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub drift_width_m: f64,
    /// Height of drifts, cross-cuts and ramps, in metres.
    #[schemars(range(min = 1.0, max = 20.0))]
    pub drift_height_m: f64,
    /// Probability that a cross-cut is omitted; drifts stop early with a tenth of it.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub irregularity: f64,
    /// Jitter: maximum distance of a station from its place in the layout, along each horizontal axis, in metres.
    #[schemars(range(min = 0.0, max = 0.4))]
    pub jitter_m: f64,
}

impl Default for Mine {
    fn default() -> Self {
        Self {
            nodes: 200,
            levels: 1,
            level_spacing_m: 15.0,
            access: Access::Ramp,
            ramp_max_deg: 8.0,
            drifts: 5,
            drift_spacing_m: 20.0,
            crosscut_interval_m: 24.0,
            station_spacing_m: 6.0,
            drift_width_m: 4.5,
            drift_height_m: 4.0,
            irregularity: 0.2,
            jitter_m: 0.15,
        }
    }
}

impl Generator for Mine {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        self.check_rock()?;
        let shares = self.shares()?;
        let mut survey = Survey::new(self, Rng::new(seed::stream(seed, "mine", 0)));
        let mut first = survey.place(None, Point3::origin(), 0);
        for (level, share) in shares.into_iter().enumerate() {
            if level > 0 {
                first = survey.descend(first);
            }
            survey.open_level(first, share);
        }
        Ok(survey.into_graph())
    }
}

impl Mine {
    /// Parallel passages need rock between them.
    fn check_rock(&self) -> Result<(), GenerateError> {
        let narrow = |name: &str, found: f64, least: f64| {
            (found < least).then(|| {
                GenerateError::new(
                    format!("`{name}` is {found} m, which leaves no pillar"),
                    format!("it must be at least {least} m with these drifts"),
                )
            })
        };
        let width = 2.0 * self.drift_width_m;
        let fault = narrow("drift_spacing_m", self.drift_spacing_m, width)
            .or_else(|| narrow("crosscut_interval_m", self.crosscut_interval_m, width))
            .or_else(|| {
                let height = 1.5 * self.drift_height_m;
                narrow("level_spacing_m", self.level_spacing_m, height)
            });
        fault.map_or(Ok(()), Err)
    }

    /// Nodes of each level in addition to its first one and the way down to it.
    fn shares(&self) -> Result<Vec<u32>, GenerateError> {
        let descent = self.descent().len() as u32;
        let per_level = 1 + descent;
        // There is no way down from the last level.
        let Some(left) = (self.nodes + descent - 1).checked_sub(per_level * self.levels) else {
            return Err(GenerateError::new(
                format!("no room for {} levels in {} nodes", self.levels, self.nodes),
                format!("a level and its way down need {per_level} nodes; ask for more nodes or fewer levels"),
            ));
        };
        let share = |level| 1 + left / self.levels + u32::from(level < left % self.levels);
        Ok((0..self.levels).map(share).collect())
    }

    /// The steps from the first station of a level to that of the next.
    fn descent(&self) -> Vec<Vector3<f64>> {
        match self.access {
            Access::Shaft => {
                let steps = self.steps(self.level_spacing_m);
                vec![DOWN * (self.level_spacing_m / steps as f64); steps]
            }
            Access::Ramp => {
                let slope = libm::tan(self.ramp_max_deg.to_radians());
                let gentle = 0.25 * self.level_spacing_m / slope;
                let side = gentle.max(RAMP_SIDE * self.drift_width_m);
                let steps = self.steps(side);
                let (along, down) = (side / steps as f64, 0.25 * self.level_spacing_m / steps as f64);
                [-EAST, -NORTH, EAST, NORTH]
                    .into_iter()
                    .flat_map(|way| vec![way * along + DOWN * down; steps])
                    .collect()
            }
        }
    }

    /// Number of steps between stations in a distance.
    fn steps(&self, distance_m: f64) -> usize {
        (distance_m / self.station_spacing_m).ceil().max(1.0) as usize
    }
}

/// A mine under construction.
struct Survey<'a> {
    mine: &'a Mine,
    rng: Rng,
    nodes: Vec<Node>,
    edges: Vec<[StationId; 2]>,
    /// Where each node would be without jitter.
    layout: Vec<Point3<f64>>,
    /// Nodes left on this level.
    left: u32,
}

impl<'a> Survey<'a> {
    fn new(mine: &'a Mine, rng: Rng) -> Self {
        Self { mine, rng, nodes: Vec::new(), edges: Vec::new(), layout: Vec::new(), left: 0 }
    }

    /// Adds a station exactly at its place in the layout.
    fn place(&mut self, parent: Option<StationId>, at: Point3<f64>, level: u32) -> StationId {
        let station = StationId::new(self.nodes.len());
        self.layout.push(at);
        self.edges.extend(parent.map(|parent| [parent, station]));
        self.nodes.push(Node {
            id: station.index() as u64,
            parent,
            position: at.map(millimetres),
            radius: 0.0,
            active: false,
            level,
            section: Some(Section {
                width_m: millimetres(self.mine.drift_width_m),
                height_m: millimetres(self.mine.drift_height_m),
                shape: Shape::Drift,
            }),
            name: None,
        });
        station
    }

    /// Adds a station near its place in the layout, if the level has nodes left.
    fn drive(&mut self, from: StationId, step: Vector3<f64>) -> Option<StationId> {
        self.left = self.left.checked_sub(1)?;
        let level = self.nodes[from.index()].level;
        let station = self.place(Some(from), self.layout[from.index()] + step, level);
        let jitter = self.mine.jitter_m;
        let mut off = || self.rng.between(-jitter, jitter);
        let aside = Vector3::new(off(), off(), 0.0);
        let position = self.layout[station.index()] + aside;
        self.nodes[station.index()].position = position.map(millimetres);
        Some(station)
    }

    /// Drives a passage of this length in even steps; the last station, or `None` if the level ran out of nodes.
    fn drive_on(&mut self, from: StationId, way: Vector3<f64>, steps: usize) -> Option<StationId> {
        (0..steps).try_fold(from, |tip, _| self.drive(tip, way / steps as f64))
    }

    /// The way down from the first station of a level to that of the next. Ramps and shafts are straight.
    fn descend(&mut self, from: StationId) -> StationId {
        let level = self.nodes[from.index()].level + 1;
        self.mine
            .descent()
            .into_iter()
            .fold(from, |tip, step| self.place(Some(tip), self.layout[tip.index()] + step, level))
    }

    /// Drives a level with this many nodes.
    fn open_level(&mut self, first: StationId, nodes: u32) {
        self.left = nodes;
        let mut drifts = vec![first];
        while drifts.len() < self.mine.drifts as usize {
            let last = drifts[drifts.len() - 1];
            let Some(next) = self.cross(last) else { return };
            drifts.push(next);
        }
        let mut faces: Vec<Option<StationId>> = drifts.into_iter().map(Some).collect();
        while self.advance(&mut faces).is_some() {}
    }

    /// Drives the passage from one drift to the start of the next one north.
    fn cross(&mut self, from: StationId) -> Option<StationId> {
        let spacing = self.mine.drift_spacing_m;
        self.drive_on(from, NORTH * spacing, self.mine.steps(spacing))
    }

    /// Drives every open drift by one bay and joins neighbours; `None` if the level ran out of nodes.
    fn advance(&mut self, faces: &mut [Option<StationId>]) -> Option<()> {
        let interval = self.mine.crosscut_interval_m;
        let steps = self.mine.steps(interval);
        self.stop_some(faces);
        for face in faces.iter_mut().flatten() {
            *face = self.drive_on(*face, EAST * interval, steps)?;
        }
        for pair in faces.windows(2) {
            let &[Some(south), Some(north)] = pair else {
                continue;
            };
            if !self.rng.chance(self.mine.irregularity) {
                self.join(south, north)?;
            }
        }
        Some(())
    }

    /// Stops some drifts, never the last one.
    fn stop_some(&mut self, faces: &mut [Option<StationId>]) {
        let mut open = faces.iter().flatten().count();
        for face in faces.iter_mut() {
            let stops = self.rng.chance(STOPS_PER_SKIP * self.mine.irregularity);
            if stops && face.is_some() && open > 1 {
                *face = None;
                open -= 1;
            }
        }
    }

    /// Drives a cross-cut between two faces.
    fn join(&mut self, south: StationId, north: StationId) -> Option<()> {
        let spacing = self.mine.drift_spacing_m;
        let steps = self.mine.steps(spacing);
        let inner = NORTH * (spacing * (steps - 1) as f64 / steps as f64);
        let tip = self.drive_on(south, inner, steps - 1)?;
        self.edges.push([tip, north]);
        Some(())
    }

    fn into_graph(self) -> Graph {
        let mut graph = Graph::new(self.nodes, self.edges).with_reaches();
        let degrees = graph.degrees();
        graph.nodes.iter_mut().zip(degrees).for_each(|(node, degree)| node.active = degree == 1);
        graph
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plume_graph::NoOutside;

    fn perfect() -> Mine {
        Mine { irregularity: 0.0, jitter_m: 0.0, ..Default::default() }
    }

    #[test]
    fn without_irregularity_every_pillar_stands() {
        let mine = Mine { nodes: 17 + 5 * (5 * 4 + 4 * 3), ..perfect() };
        let graph = mine.generate(1, &NoOutside).expect("one level fits");
        assert_eq!(graph.loops(), 5 * 4);
    }

    #[test]
    fn ramps_keep_their_inclination_and_shafts_are_vertical() {
        for (access, steepest) in [(Access::Ramp, 8.0), (Access::Shaft, 90.0)] {
            let mine = Mine { levels: 3, access, ..Default::default() };
            let graph = mine.generate(5, &NoOutside).expect("three levels fit");
            let [_, _, height_m] = graph.bounds().expect("it has nodes").size();
            assert_eq!(height_m, 2.0 * mine.level_spacing_m);
            for &[a, b] in &graph.edges {
                let way = graph[b].position - graph[a].position;
                let slope = libm::atan2(way.z.abs(), way.xy().norm()).to_degrees();
                let level = slope == 0.0;
                let inclined = slope <= steepest + 0.05 && slope > 5.0;
                assert!(level || inclined, "{access:?} {slope}");
            }
        }
    }

    #[test]
    fn too_many_levels_are_refused_with_the_number_of_nodes_they_need() {
        let mine = Mine { nodes: 20, levels: 2, ..Default::default() };
        let error = mine.generate(1, &NoOutside).expect_err("the ramp alone takes more");
        assert_eq!(error.message, "no room for 2 levels in 20 nodes");
    }

    #[test]
    fn drifts_too_near_each_other_are_refused() {
        let mine = Mine { drift_spacing_m: 5.0, ..Default::default() };
        let error = mine.generate(1, &NoOutside).expect_err("9 m are needed");
        assert!(error.message.contains("drift_spacing_m"), "{error}");
    }
}
