//! Leaves the program knows: measured colours, with drawn maps.
//!
//! Reflectance and transmittance are linear sRGB of hemispherical spectra (Noda et al. 2013, ERDP
//! 2013-02.1.1; LOPEX93; UC Davis), which contain the reflection of the surface, about 0.035.

use std::sync::Arc;

use super::appearance::{Face, LeafMaterial, Mode, Side, USUAL_GLOSS};
use super::venation::{self, Drawn, Look};
use crate::{Error, Result};

/// Width and height of drawn maps, texels.
pub const DRAWN_SIZE: [u32; 2] = [512, 512];

/// A measured leaf.
#[derive(Debug, Clone, Copy)]
pub struct LeafSpecies {
    /// Name on the command line.
    pub name: &'static str,
    /// One line for a list.
    pub what: &'static str,
    /// Reflectance of the upper side, surface included.
    pub upper: [f64; 3],
    /// Reflectance of the lower side; `None`: not measured, assumed as much brighter than the
    /// upper as goldenrod's is.
    pub lower: Option<[f64; 3]>,
    /// Transmittance.
    pub through: [f64; 3],
    /// Thickness, millimetres: a scale.
    pub thickness_mm: f64,
    /// Roughness m of the upper and the lower side.
    pub roughness: [f32; 2],
    /// How its maps are drawn.
    pub look: Look,
}

/// Lower over upper reflectance of goldenrod, the one broad leaf of ordinary build measured from
/// both sides (birch's lower side is unusually pale).
const LOWER_OVER_UPPER: [f64; 3] = [1.40, 1.28, 1.77];

/// All of them.
pub const SPECIES: &[LeafSpecies] = &[
    LeafSpecies {
        name: "birch",
        what: "Betula ermanii, first flush, both sides (Noda)",
        upper: [0.0529, 0.0741, 0.0379],
        lower: Some([0.1383, 0.1699, 0.0719]),
        through: [0.0583, 0.0835, 0.0071],
        thickness_mm: 0.17,
        roughness: [0.30, 0.55],
        look: Look::SERRATE,
    },
    LeafSpecies {
        name: "birch-autumn",
        what: "Betula ermanii, senesced, upper side (Noda)",
        upper: [0.4297, 0.2589, 0.0380],
        lower: None,
        through: [0.4210, 0.2472, 0.0038],
        thickness_mm: 0.15,
        roughness: [0.40, 0.60],
        look: Look::SENESCED,
    },
    LeafSpecies {
        name: "goldenrod",
        what: "Solidago altissima, upper leaf, both sides (Noda)",
        upper: [0.1207, 0.1581, 0.0469],
        lower: Some([0.1689, 0.2031, 0.0828]),
        through: [0.1723, 0.2025, 0.0402],
        thickness_mm: 0.20,
        roughness: [0.35, 0.50],
        look: Look::LANCE,
    },
    LeafSpecies {
        name: "walnut",
        what: "Juglans regia (LOPEX93 0091)",
        upper: [0.0612, 0.0857, 0.0508],
        lower: None,
        through: [0.0642, 0.1016, 0.0031],
        thickness_mm: 0.20,
        roughness: [0.28, 0.45],
        look: Look::OVATE,
    },
    LeafSpecies {
        name: "soybean",
        what: "Glycine max (LOPEX93 0116)",
        upper: [0.0648, 0.1024, 0.0389],
        lower: None,
        through: [0.0858, 0.1259, 0.0020],
        thickness_mm: 0.18,
        roughness: [0.40, 0.55],
        look: Look::OVATE,
    },
    LeafSpecies {
        name: "maize",
        what: "Zea mays (LOPEX93 0041)",
        upper: [0.0993, 0.1262, 0.0583],
        lower: None,
        through: [0.0248, 0.0503, 0.0020],
        thickness_mm: 0.20,
        roughness: [0.40, 0.45],
        look: Look::PARALLEL,
    },
    LeafSpecies {
        name: "lettuce",
        what: "Lactuca sativa (LOPEX93 0021)",
        upper: [0.1189, 0.1585, 0.0585],
        lower: None,
        through: [0.0682, 0.0994, 0.0020],
        thickness_mm: 0.35,
        roughness: [0.35, 0.45],
        look: Look::CORDATE,
    },
    LeafSpecies {
        name: "maple",
        what: "Acer macrophyllum (Helios library)",
        upper: [0.1010, 0.1208, 0.0767],
        lower: None,
        through: [0.0984, 0.1361, 0.0146],
        thickness_mm: 0.18,
        roughness: [0.32, 0.50],
        look: Look::CORDATE,
    },
    LeafSpecies {
        name: "vine",
        what: "Vitis vinifera (Helios library)",
        upper: [0.0877, 0.0989, 0.0591],
        lower: None,
        through: [0.0555, 0.0720, 0.0067],
        thickness_mm: 0.22,
        roughness: [0.30, 0.60],
        look: Look::CORDATE,
    },
    LeafSpecies {
        name: "privet",
        what: "an evergreen's elliptic leaf: vine's colours, glossier and thicker",
        upper: [0.0877, 0.0989, 0.0591],
        lower: None,
        through: [0.0555, 0.0720, 0.0067],
        thickness_mm: 0.35,
        roughness: [0.18, 0.40],
        look: Look::ELLIPTIC,
    },
    LeafSpecies {
        name: "needle",
        what: "a spruce needle: maize's colours at twice its thickness",
        upper: [0.0850, 0.1070, 0.0560],
        lower: Some([0.0950, 0.1170, 0.0660]),
        through: [0.0040, 0.0060, 0.0010],
        thickness_mm: 0.80,
        roughness: [0.35, 0.45],
        look: Look::NEEDLE,
    },
];

impl LeafSpecies {
    /// The species of that name.
    ///
    /// # Errors
    /// Lists the names.
    pub fn parse(name: &str) -> Result<&'static Self> {
        SPECIES
            .iter()
            .find(|s| s.name.eq_ignore_ascii_case(name))
            .ok_or_else(|| {
                let known: Vec<&str> = SPECIES.iter().map(|s| s.name).collect();
                Error::usage(format!(
                    "{name:?} is neither a leaf file (.toml) nor one of the leaves {}",
                    known.join(", ")
                ))
            })
    }

    /// The leaves of a plant of the generator (`scene::grow::Species`), by its name.
    #[must_use]
    pub fn of_plant(plant: &str) -> Option<&'static Self> {
        let name = match plant {
            "broadleaf" => "walnut",
            "lime" => "goldenrod",
            "shrub" => "privet",
            "conifer" => "needle",
            _ => return None,
        };
        SPECIES.iter().find(|s| s.name == name)
    }

    /// Reflectance of a side, surface included.
    #[must_use]
    pub fn reflectance(&self, face: Face) -> [f64; 3] {
        match (face, self.lower) {
            (Face::Upper, _) => self.upper,
            (Face::Lower, Some(lower)) => lower,
            (Face::Lower, None) => std::array::from_fn(|c| {
                // What comes back may not exceed what did not go through.
                (self.upper[c] * LOWER_OVER_UPPER[c]).min(0.97 - self.through[c])
            }),
        }
    }

    /// Diffuse reflectance: without the surface's share, which the glossy lobe gives back.
    #[must_use]
    pub fn diffuse(&self, face: Face) -> [f64; 3] {
        self.reflectance(face)
            .map(|r| (r - f64::from(USUAL_GLOSS)).max(0.0025))
    }

    /// The leaf without maps.
    #[must_use]
    pub fn plain(&self) -> LeafMaterial {
        let side = |face: Face, roughness: f32| {
            let (mut side, _) =
                Side::of_albedo(self.diffuse(face), self.through, self.thickness_mm);
            side.rho_s = [USUAL_GLOSS; 3];
            side.m = roughness;
            side
        };
        LeafMaterial {
            name: self.name.to_owned(),
            thickness_mm: self.thickness_mm,
            mode: Mode::Exact,
            upper: side(Face::Upper, self.roughness[0]),
            lower: side(Face::Lower, self.roughness[1]),
            mask: None,
        }
    }

    /// The leaf with drawn maps, whose means over the leaf are the measured colours.
    #[must_use]
    pub fn drawn(&self, size: [u32; 2]) -> LeafMaterial {
        let mut leaf = self.plain();
        let Drawn { mask, sides } = venation::draw(&self.look, size, self.roughness, USUAL_GLOSS);
        leaf.mask = Some(Arc::from(mask));
        for (face, maps) in Face::ALL.into_iter().zip(sides) {
            leaf.side_mut(face).maps = Some(Arc::new(maps));
        }
        for face in Face::ALL {
            self.level(&mut leaf, face);
        }
        leaf
    }

    /// Shifts thickness and gamma so that the means are the measured colours again: transmittance
    /// is convex in thickness, so a leaf with veins lets more through than its mean thickness.
    fn level(&self, leaf: &mut LeafMaterial, face: Face) {
        let green = |leaf: &LeafMaterial| f64::from(leaf.optics(face).rho_t[1]);
        for _ in 0..4 {
            let ratio = green(leaf) / self.through[1];
            // T ~ exp(-Delta): the shift in units of the thickness.
            let side = leaf.side_mut(face);
            let delta = side.sigma_t(1) * self.thickness_mm;
            let shift = (ratio.ln() / delta) as f32;
            if let Some(maps) = side.maps.as_mut().map(Arc::make_mut) {
                for texel in &mut maps.gamma_delta {
                    texel[3] = (texel[3] + shift).max(-0.95);
                }
            }
        }
        let wanted = self.diffuse(face);
        // Where gamma is limited by energy one scaling is not enough.
        for _ in 0..4 {
            let found = leaf.optics(face).rho_d;
            if let Some(maps) = leaf.side_mut(face).maps.as_mut().map(Arc::make_mut) {
                for texel in &mut maps.gamma_delta {
                    for c in 0..3 {
                        texel[c] *= wanted[c] as f32 / found[c].max(1e-6);
                    }
                }
            }
        }
    }
}
