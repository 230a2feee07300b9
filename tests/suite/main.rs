//! Every integration test in one binary, so that the program is linked once.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot go on fails where it stands"
)]

mod architecture;
mod cli;
mod cli_work;
mod dependencies;
mod export;
mod export_fixture;
mod export_fresh;
mod fixture;
mod foliage_encode;
mod foliage_field;
mod foliage_gpu;
mod foliage_realign;
mod foliage_skylight;
mod foliage_surface;
mod foliage_traced;
mod golden;
mod gpu;
mod grow;
mod ink;
mod ink_axes;
mod ink_bodies;
mod ink_far;
mod ink_looks;
mod ink_mix;
mod ink_motion;
mod ink_outlines;
mod ink_strokes;
mod ink_tone;
mod ink_way;
mod ink_wood;
mod leaf_cli;
mod leaf_files;
mod leaf_fit;
mod leaf_glossy;
mod leaf_gpu;
mod leaf_slab;
mod light_errors;
mod light_gloss;
mod light_lamps;
mod light_limits;
mod light_picture;
mod light_plants;
mod light_rays;
mod light_resume;
mod light_sheet;
mod light_transfer;
mod model_fixture;
mod models;
mod models_damage;
mod paper;
mod paper_again;
mod paper_frames;
mod paper_inks;
mod paper_limits;
mod paper_lines;
mod paper_measures;
mod paper_modulation;
mod paper_pieces;
mod paper_polygons;
mod paper_round;
mod paper_sheet;
mod paper_silhouettes;
mod paper_stems;
mod paper_strokes;
mod paper_style;
mod paper_svg;
mod place;
mod properties;
mod render_frame;
mod render_plan;
mod small_model;
