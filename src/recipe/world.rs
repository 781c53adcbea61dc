//! Light, friction and gravity: what a simulator needs in addition to the rock.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The world around the rock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WorldSettings {
    /// Hang lamps along the passages. Without them robots need their own lights.
    pub lights: bool,
    /// Distance between lamps along the passages, m.
    #[schemars(range(min = 2.0, max = 100.0))]
    pub light_spacing_m: f64,
    /// Coulomb friction coefficient of rubber on the floor: about 0.8 on dry rock, 0.5 on wet limestone.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub friction: f64,
    /// Coulomb friction coefficient of walls and ceilings, in packages whose collision shapes have one for each zone: most of
    /// those with convex pieces. In all others `friction` is that of all rock.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub wall_friction: f64,
    /// Gravity, m/s²: Earth 9.81, Mars 3.71, Moon 1.62.
    #[schemars(range(min = 0.0, max = 30.0))]
    pub gravity: f64,
    /// Robots that must be sure to reach every station from the first start pose and to come back, such as ["husky"]: a
    /// finished cave in which one is not is refused. `plume list robots` lists them.
    #[schemars(schema_with = "plume_truth::robot::names_schema")]
    pub certify: Vec<String>,
    /// Number of start poses to find, spread over the cave.
    #[schemars(range(min = 1, max = 64))]
    pub spawns: usize,
}

impl Default for WorldSettings {
    fn default() -> Self {
        Self {
            lights: true,
            light_spacing_m: 9.0,
            friction: 0.8,
            wall_friction: 0.8,
            gravity: 9.81,
            certify: Vec::new(),
            spawns: 8,
        }
    }
}
