//! The layouts, a file each, and what they share: calibration files and point clouds.

pub mod calibration;
pub mod euroc;
pub mod kitti;
pub mod mcap;
pub mod pcd;
pub mod tum;
