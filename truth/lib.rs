//! Ground truth of a world of triangles: where its floor is, where a robot can go from its start, and maps of that.
//!
//! [`Columns`] takes triangles in any order and finds what the vertical lines through the cells of a grid cross; so all that
//! follows is exact at the centres of cells, and the grid does not depend on how the world is divided into chunks. The air in
//! each column makes the cells of a multi-level surface map ([`Floor`], after Triebel, Pfaff and Burgard 2006), which has as many
//! floors over each other as there are. [`Storeys`] divides what a robot reaches into parts that do not overlap on the map, and
//! [`OccupancyMap`] draws one of them.
//!
//! [`Voxels`] and [`Distances`] tell of the cubes of a grid what passes through them, and how far their centres are from that; both
//! hold what they say of the grid and no triangles. [`Grid`] makes them part by part, square by square. [`samples`] spreads points over the surface.
//!
//! [`Certificate`] tells where a robot gets on a floor and what stops it, and [`Route`] is a path for it. [`Territory`] is where it
//! surely gets and comes back from, with the lengths of its ways; [`Episode`]s lead through it, and from [`views`] it sees all of it.
//! [`robot`] is a table of robots. [`Room`] is what is around a station of a survey.
//!
//! Not promised of floors and maps: anything between the centres of two cells, such as a pole that is thinner than a cell. [`Thin`]
//! holds that for drones, which must not touch it.
//!
//! ```
//! use plume_truth::{Columns, Floor, OccupancyMap, Robot, State, Storeys};
//!
//! // A room of 2 m by 2 m by 1 m, whose walls face inwards.
//! let corner = |n: usize| [0, 1, 2].map(|axis| if n >> axis & 1 == 1 { [2.0, 2.0, 1.0][axis] } else { 0.0 });
//! let corners: Vec<[f32; 3]> = (0..8).map(corner).collect();
//! let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
//! let mut columns = Columns::new(0.1);
//! for [a, b, c, d] in sides {
//!     columns.add(&corners, &[a, b, c, a, c, d]);
//! }
//! let floor = Floor::new(columns);
//! assert_eq!(floor.cells().len(), 20 * 20);
//!
//! let robot = Robot { height_m: 0.5, step_m: 0.1, slope_rad: 0.5 };
//! let storeys = Storeys::reached(&floor, &robot, &[[1.0, 1.0, 0.0]]);
//! let map = OccupancyMap::of(&floor, &storeys, 0);
//! assert_eq!(map.count(State::Free), 20 * 20);
//! ```

mod air;
mod blocks;
mod by_state;
mod certificate;
mod clearance;
mod columns;
mod distances;
mod episodes;
mod floor;
mod grid;
mod ground;
mod inside;
mod lattice;
mod map;
pub mod robot;
mod room;
mod route;
mod samples;
mod scout;
mod search;
mod stance;
mod storeys;
mod territory;
mod thin;
mod vector;
mod vehicle;
mod views;
mod voxels;
mod window;

pub use blocks::{Block, CELLS, SIDE};
pub use certificate::{Certificate, Network, Passage, Reach, Through, Verdict};
pub use columns::{Columns, Gap};
pub use distances::Distances;
pub use episodes::Episode;
pub use floor::{Floor, Relief, Robot};
pub use grid::{Grid, Stack, Told};
pub use inside::Inside;
pub use map::{OccupancyMap, State};
pub use room::Room;
pub use route::{Route, Waypoint};
pub use samples::{Sample, samples};
pub use scout::Scout;
pub use search::Pose;
pub use storeys::Storeys;
pub use territory::{Geodesic, Territory};
pub use thin::Thin;
pub use vehicle::{Cause, Class, Drone, Fault, Profile, Vehicle};
pub use views::{Eye, View, views};
pub use voxels::Voxels;
