//! Several styles in one picture (Coconu, Deussen, Hege 2006, section 8): which part of a scene is
//! drawn in which, by object, by material, by distance or by a mask.

mod file;
mod plan;
mod regions;
mod rule;

pub use file::{MIXES, short};
pub use plan::{MixPlan, PlannedImage};
pub use regions::Regions;
pub use rule::{Mask, Mix, Part, Span};
