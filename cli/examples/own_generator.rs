//! The `plume` command with a generator of its own: a ramp that winds down around a shaft.
//!
//! Its settings, with their ranges and descriptions, show in `plume new`, in the schema for editors and in error messages.
//!
//! ```text
//! cargo run --release --example own_generator -- list generators
//! cargo run --release --example own_generator -- export --set graph.generator=spiral --target obj --output spiral
//! ```

use std::error::Error;
use std::process::ExitCode;

use plume::generators::{GENERATORS, GeneratorRow};
use plume::graph::centreline::{CentrelineBuilder, Vertex};
use plume::graph::rng::Rng;
use plume::graph::section::{Section, Shape};
use plume::graph::{GenerateError, Generator, Graph, Outside, seed};
use plume::registry::RegisterError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the generator.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct Spiral {
    /// Number of turns around the shaft.
    #[schemars(range(min = 1, max = 50))]
    turns: u32,
    /// Radius of a turn, in metres.
    #[schemars(range(min = 8.0, max = 100.0))]
    radius_m: f64,
    /// Width of the ramp, in metres.
    #[schemars(range(min = 2.0, max = 10.0))]
    width_m: f64,
}

impl Default for Spiral {
    fn default() -> Self {
        Self { turns: 3, radius_m: 12.0, width_m: 4.0 }
    }
}

/// Stations in one turn.
const STATIONS: u32 = 16;
/// Rock between two turns, in widths of the ramp.
const ROCK: f64 = 1.5;

impl Generator for Spiral {
    fn generate(&self, seed: u64, _: &dyn Outside) -> Result<Graph, GenerateError> {
        if self.width_m > self.radius_m {
            return Err(GenerateError::new("the ramp is wider than its turns", "lower `width_m`, or raise `radius_m`"));
        }
        let mut rng = Rng::new(seed::stream(seed, "spiral", 0));
        let first_bearing = rng.between(0.0, std::f64::consts::TAU);
        let section = Section { width_m: self.width_m, height_m: self.width_m, shape: Shape::Drift };
        let mut centreline = CentrelineBuilder::default();
        let mut previous = None;
        for station in 0..=self.turns * STATIONS {
            let turned = f64::from(station) / f64::from(STATIONS);
            let bearing = first_bearing + turned * std::f64::consts::TAU;
            let depth_m = turned * (1.0 + ROCK) * self.width_m;
            // Not the functions of `f64`: theirs differ from one platform to another.
            let position = [self.radius_m * libm::cos(bearing), self.radius_m * libm::sin(bearing), -depth_m].into();
            let vertex = centreline.add(Vertex { position, section: Some(section), level: 0 });
            if let Some(previous) = previous.replace(vertex) {
                centreline.join(previous, vertex);
            }
        }
        Ok(centreline.into_graph())
    }
}

/// Before any recipe is read.
pub fn register() -> Result<(), RegisterError> {
    GENERATORS.register(GeneratorRow::new::<Spiral>("spiral", "a ramp that winds down around a shaft"))
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    register()?;
    Ok(plume_cli::run(std::env::args_os(), &plume_cli::Host::Binary).into())
}
