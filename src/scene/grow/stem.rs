//! Stems: what the skeleton is made of.

use glam::DVec3;

use super::frame::Frame;

/// The bare structure of a plant: stems with parents before children.
#[derive(Debug, Clone, Default)]
pub struct Skeleton {
    /// All stems; the first is a trunk.
    pub stems: Vec<Stem>,
    /// Highest branching order that occurs.
    pub max_order: u8,
}

/// One stem: a polyline with a radius.
#[derive(Debug, Clone)]
pub struct Stem {
    /// Branching order: 0 trunk, 1 limb, ...; a fork keeps the order.
    pub order: u8,
    /// The stem it grows from and where on it, 0 base to 1 tip; `None` for trunks.
    pub parent: Option<(usize, f64)>,
    /// True when it is a fork of a parent of the same order.
    pub is_fork: bool,
    /// Length along the axis, metres.
    pub length: f64,
    /// Position along the stem of each section: 0 at the base, 1 at the tip, increasing. Forks
    /// keep the fraction of the whole stem, so theirs start above 0.
    pub fractions: Vec<f64>,
    /// Axis, metres.
    pub points: Vec<DVec3>,
    /// Radius at each point, metres; never grows towards the tip.
    pub radii: Vec<f64>,
    pub(super) frames: Vec<Frame>,
    /// Bark texture coordinate along the stem at its base, so that forks continue it.
    pub(super) bark_offset: f64,
    /// Times the bark texture goes round the stem.
    pub(super) bark_repeats: f64,
}

/// A place on a stem.
#[derive(Debug, Clone, Copy)]
pub(super) struct StemPoint {
    pub(super) position: DVec3,
    pub(super) frame: Frame,
    pub(super) radius: f64,
}

impl Stem {
    /// First fraction: 0 except for forks.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.fractions[0]
    }

    /// The stem at a fraction between its start and 1, on the straight line between sections.
    pub(super) fn at(&self, fraction: f64) -> StemPoint {
        let last = self.fractions.len() - 1;
        let above = self
            .fractions
            .partition_point(|&f| f <= fraction)
            .clamp(1, last);
        let below = above - 1;
        let span = self.fractions[above] - self.fractions[below];
        let t = ((fraction - self.fractions[below]) / span).clamp(0.0, 1.0);
        let z = self.frames[below]
            .z
            .lerp(self.frames[above].z, t)
            .normalize();
        StemPoint {
            position: self.points[below].lerp(self.points[above], t),
            frame: self.frames[below].transported(z),
            radius: self.radii[below] + (self.radii[above] - self.radii[below]) * t,
        }
    }
}
