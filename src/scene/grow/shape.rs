//! Crown shapes (Weber and Penn 1995, section 4.3, `ShapeRatio`).

use super::portable::sin_cos;

/// How long first-order branches are, by their height in the crown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Longest at the base of the crown, a fifth at the top.
    Conical,
    /// Longest in the middle.
    Spherical,
    /// Longest at the base, rounded to the top.
    Hemispherical,
    /// All equal.
    Cylindrical,
    /// From one at the base to a half at the top.
    TaperedCylindrical,
    /// Nil at the base and the top, longest at 70 % of the way down.
    Flame,
    /// Longest at the top.
    InverseConical,
    /// Like flame, from a half up to one.
    TendFlame,
}

impl Shape {
    /// Relative length of a branch; `ratio` is 1 at the base of the crown and 0 at its top.
    #[must_use]
    pub fn ratio(self, ratio: f64) -> f64 {
        let r = ratio.clamp(0.0, 1.0);
        match self {
            Self::Conical => 0.2 + 0.8 * r,
            Self::Spherical => 0.2 + 0.8 * sin_cos(std::f64::consts::PI * r).0,
            Self::Hemispherical => 0.2 + 0.8 * sin_cos(std::f64::consts::FRAC_PI_2 * r).0,
            Self::Cylindrical => 1.0,
            Self::TaperedCylindrical => 0.5 + 0.5 * r,
            Self::Flame if r <= 0.7 => r / 0.7,
            Self::Flame => (1.0 - r) / 0.3,
            Self::InverseConical => 1.0 - 0.8 * r,
            Self::TendFlame if r <= 0.7 => 0.5 + 0.5 * r / 0.7,
            Self::TendFlame => 0.5 + 0.5 * (1.0 - r) / 0.3,
        }
    }
}
