//! From measured reflectance and transmittance to the model (Wang et al. 2005, section 4).

mod maps;
mod newton;
mod paper;
mod thickness;

pub use maps::{FitInput, FitOptions, Fitted, Residual, SideImages, fit};
pub use newton::{FLOOR, Slab, Solution, clamp, invert, solve};
pub use paper::{PaperFailure, paper_iteration};
pub use thickness::{Channel, exact_thickness, paper_thickness, searched_thickness};
