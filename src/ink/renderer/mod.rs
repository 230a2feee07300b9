//! The two stages on the device (Coconu, Deussen, Hege 2006, section 4): attributes into several
//! targets at once, then lines, strokes and washes in image space.

mod frame;
mod looks;
mod order;
mod pipelines;
mod shown;
mod stage1;
mod stage2;
mod styles;
mod sun;
mod targets;
mod uploads;

pub use frame::{Drawing, InkRenderer, InkScene};
