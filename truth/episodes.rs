//! Tasks to get from a place to a goal.

use super::route::Route;
use super::scout::Scout;
use super::search::Pose;
use super::territory::{Geodesic, Territory};
use super::vehicle::Class;

/// Shortest way from a start to its goal, in metres: what is nearer is no task.
const LEAST_M: f64 = 1.0;
/// How often a start is drawn before there is none.
const DRAWS: usize = 100;

/// A start, and the way from there to a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Number of the goal.
    pub goal: usize,
    /// Where the robot starts, and which way it faces.
    pub start: Pose,
    /// Its shortest path to the goal, smoothed: every pose of it is sure.
    pub route: Route,
}

impl Episode {
    /// As many episodes as that, to each of the goals in turn; fewer if too few places are a metre from their goals.
    ///
    /// Starts are drawn evenly from the territory, and then a direction from those in which the robot surely stands there.
    /// `draw` gives a whole number below another, which is not 0.
    pub fn of(
        scout: &mut Scout,
        territory: &Territory,
        goals: &[(usize, Geodesic)],
        count: usize,
        draw: &mut dyn FnMut(usize) -> usize,
    ) -> Vec<Self> {
        let goals = goals.iter().enumerate().cycle().take(if goals.is_empty() { 0 } else { count });
        let mut episodes = Vec::new();
        for (goal, (_, to_goal)) in goals {
            let mut starts = (0..DRAWS).map(|_| draw(territory.cells().len()));
            let Some(place) = starts.find(|place| to_goal.length_m(*place) >= LEAST_M) else { continue };
            let states = territory.states_at(place);
            let state = states.start + draw(states.len()) as u32;
            let route = Route::along(scout, &territory.way(to_goal, state), Class::Go);
            episodes.push(Self { goal, start: territory.pose(scout, state), route });
        }
        episodes
    }
}
