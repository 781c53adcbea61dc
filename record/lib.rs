//! Recorded sensor runs through a resolved scene, without a simulator: what cameras, lidars, an inertial unit and wheels on a body
//! measure along a path.
//!
//! [`Trajectory`](trajectory::Trajectory) makes the path of a file smooth, so that what the IMU feels follows from it analytically.
//! [`World`](world::World) holds the triangles that targets export, and finds what a ray meets: everything that a camera or a lidar
//! tells of a surface comes from that, to the exactness of the mesh. [`Rig`](rig::Rig) is the body. [`record()`] writes all of it in
//! one or several [layouts](layout::LAYOUTS).
//!
//! Promised: the same scene, path, rig and seed give the same bytes, for any number of threads. Not promised: anything that a
//! sensor does and the modules of this crate do not name, such as motion blur or light between walls.
//!
//! Knows scenes, and has never heard of a cave.

mod camera;
mod error;
mod exposure;
pub mod inertial;
pub mod layout;
mod layouts;
pub mod lens;
mod library;
pub mod lidar;
mod light;
mod maps;
mod noise;
pub mod picture;
pub mod rig;
mod run;
pub mod trajectory;
pub mod world;

pub use error::RecordError;
pub use run::{Order, Recording, Watch, record};
