//! CPU twins of the device kernels in f64, written to be compared with them: same helper names,
//! same loop order, no Vulkan. They take the kernels' own f32 inputs, widened.

pub mod ambient;
pub mod bins;
pub mod density;
pub mod encode;
pub mod generators;
pub mod gloss_rays;
pub mod ink;
pub mod ink_body;
pub mod ink_looks;
pub mod ink_tile;
pub mod ink_wood;
pub mod lamps;
pub mod leaf_albedo;
pub mod leaf_glossy;
pub mod lit;
pub mod lit_shadow;
pub mod lvc;
pub mod marching_cubes;
pub mod matrix;
pub mod modulate;
pub mod paper;
pub mod prt;
pub mod rays;
pub mod realign;
pub mod shade;
pub mod skylight;
pub mod subset;
pub mod trace;
pub mod truth;
