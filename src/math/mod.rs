//! Small mathematics shared by every room: packing, colour, bounds, statistics.

pub mod marching_cubes_table;
