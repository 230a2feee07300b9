//! One file per command.

pub mod bake;
pub mod bench;
pub mod bench_ink;
pub mod bench_light;
pub mod bench_paper;
pub mod bench_rays;
pub mod conform;
pub mod grow;
pub mod info;
mod info_ink;
pub mod ink;
mod ink_differ;
pub mod leaf;
pub mod light;
mod lit_sheet;
mod paper_differ;
mod paper_kind;
mod recipe;
mod redraw;
pub mod render;
pub mod render_ink;
pub mod render_lit;
mod render_looks;
pub mod render_paper;
pub mod settings;
pub mod style;
pub mod surface;
