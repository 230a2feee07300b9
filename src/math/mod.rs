//! Small mathematics shared by every room: packing, colour, bounds, statistics.

pub mod bvh;
pub mod colour;
pub mod eigen;
pub mod hashing;
pub mod kd_tree;
pub mod marching_cubes_table;
pub mod packing;
pub mod quads;
pub mod sah;
pub mod sampling;
pub mod sh;
pub mod sh_rotation;
pub mod slab;
pub mod special;
pub mod stats;
pub mod wide_bvh;
