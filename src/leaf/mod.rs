//! Leaves: their appearance and their light.
//!
//! After L. Wang, W. Wang, J. Dorsey, X. Yang, B. Guo, H.-Y. Shum 2005, Real-Time Rendering of
//! Plant Leaves. `docs/leaf.md` has the equations of the appearance, `docs/light.md` those of the
//! light, and both what was decided where the paper is silent.

pub mod appearance;
pub mod checkpoint;
pub mod cutouts;
pub mod directional;
pub mod directions;
pub mod edit;
pub mod environment;
pub mod files;
pub mod film;
pub mod fit;
pub mod gloss_rays;
pub mod gloss_view;
pub mod glossy;
pub mod import;
pub mod lamp;
pub mod lamp_maps;
pub mod lamp_transfer;
pub mod leaving;
pub mod level_choice;
pub mod levels;
pub mod light;
pub mod light_file;
pub mod lit;
pub mod lit_lamps;
mod lit_materials;
pub mod lobe;
pub mod lod;
pub mod lvc;
pub mod maps;
pub mod matrix;
pub mod optics;
pub mod picture;
pub mod prt;
pub mod radiance_map;
pub mod rays;
pub mod receivers;
pub mod refine;
pub mod runs;
pub mod shadow_map;
pub mod shape;
pub mod sky;
pub mod slab_table;
pub mod species;
pub mod storage_error;
pub mod trace;
pub mod truth;
pub mod venation;
pub mod wear;

pub use appearance::{Face, LeafMaterial, Mode, Sampler, Side, SideOptics};
pub use maps::SideMaps;
pub use slab_table::SlabTable;
pub use species::LeafSpecies;
