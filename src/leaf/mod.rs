//! Leaves: their appearance and their light.
//!
//! After L. Wang, W. Wang, J. Dorsey, X. Yang, B. Guo, H.-Y. Shum 2005, Real-Time Rendering of
//! Plant Leaves. `docs/leaf.md` has the equations of the appearance and what was decided where
//! the paper is silent.

pub mod appearance;
pub mod edit;
pub mod files;
pub mod fit;
pub mod glossy;
pub mod import;
pub mod maps;
pub mod picture;
pub mod slab_table;
pub mod species;
pub mod venation;

pub use appearance::{Face, LeafMaterial, Mode, Sampler, Side, SideOptics};
pub use maps::SideMaps;
pub use slab_table::SlabTable;
pub use species::LeafSpecies;
