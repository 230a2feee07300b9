//! The plant generator: trees and shrubs from a table of numbers and a seed.
//!
//! After Jason Weber and Joseph Penn, "Creation and Rendering of Realistic Trees",
//! SIGGRAPH 1995. A plant is a skeleton of stems ([`skeleton`]) made from one
//! [`Parameters`] table, covered with generalised cylinders and polygonal leaves.
//! The same parameters, options and seed give the same bytes on every platform.

mod bark_texture;
mod frame;
mod leaf_template;
mod leaf_texture;
mod leaves;
mod light;
pub(crate) mod noise;
mod parameters;
mod plant;
mod portable;
mod rabbit;
mod random;
mod shape;
mod skeleton;
mod species;
mod stem;
mod tables;
mod wood;

pub use parameters::{BarkStyle, LeafParameters, LeafShape, Level, Parameters, Prune};
pub use plant::{GrowOptions, MAX_LEAVES, embedded, grow, grow_with};
pub use rabbit::{RABBIT, rabbit};
pub use shape::Shape;
pub use skeleton::skeleton;
pub use species::Species;
pub use stem::{Skeleton, Stem};
