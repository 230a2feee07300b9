//! The parameter table of a plant, in the paper's own terms.
//!
//! Weber and Penn 1995, appendix "Parameter list"; `n` in `nCurve` is the index of [`Level`].
//! Angles are degrees, lengths metres, everything else is a ratio. What the paper does not have
//! is marked "addition".

use super::shape::Shape;
use crate::{Error, Result};

/// Everything that makes a species.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// `Shape`: lengths of the limbs over the height of the crown.
    pub shape: Shape,
    /// `BaseSize`: share of the trunk below the first limb, \[0, 0.9\].
    pub base_size: f64,
    /// `Scale`: height of the trunk, (0, 200] metres.
    pub scale: f64,
    /// `ScaleV`: its variation, \[0, `scale` / 2\] metres.
    pub scale_v: f64,
    /// `Ratio`: trunk radius over trunk length, (0, 0.2].
    pub ratio: f64,
    /// `RatioPower`: how fast children get thinner than their parent, \[0.5, 4\].
    pub ratio_power: f64,
    /// `Lobes`: number of root buttresses, \[0, 16\].
    pub lobes: u32,
    /// `LobeDepth`: their depth over the radius, \[0, 0.5\]. Decided: it fades with the flare.
    pub lobe_depth: f64,
    /// `Flare`: how much wider the trunk is at the ground, \[0, 3\].
    pub flare: f64,
    /// `Levels`: number of branching orders, \[2, 4\].
    pub levels: u8,
    /// Addition: stems that rise from the ground, \[1, 64\]; more than one makes a shrub.
    pub trunks: u32,
    /// Addition: radius of the ring on which several trunks rise, \[0, 5\] metres.
    pub trunk_spread: f64,
    /// `Prune*`: envelope that limits the crown.
    pub prune: Prune,
    /// One row per branching order; rows at `levels` and above are not read.
    pub level: [Level; 4],
    /// `Leaves*`.
    pub leaf: LeafParameters,
    /// Addition: look of the bark.
    pub bark: BarkStyle,
}

/// One branching order of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// `nDownAngle`: angle to the parent, \[0, 180\].
    pub down_angle: f64,
    /// `nDownAngleV`: variation; negative: the angle falls from the base to the top of the parent.
    pub down_angle_v: f64,
    /// `nRotate`: turn about the parent from one child to the next; negative: the children stand
    /// in two rows, left and right.
    pub rotate: f64,
    /// `nRotateV`: its variation.
    pub rotate_v: f64,
    /// `nBranches`: children on a full-length parent, \[0, 500\] (row of the children).
    pub branches: f64,
    /// Addition: children per whorl, \[1, 16\]; 1 sets them singly.
    pub whorl: u32,
    /// Addition: bare share of the parent's base, \[0, 0.9\] (for limbs see `base_size`).
    pub bare: f64,
    /// `nLength`: length over the parent's, (0, 2].
    pub length: f64,
    /// `nLengthV`: variation of `length`, \[0, 1\].
    pub length_v: f64,
    /// `nTaper`: 0 cylinder to 1 cone. The paper's blunt ends above 1 are not used.
    pub taper: f64,
    /// `nSegSplits`: forks per segment, \[0, 2\].
    pub seg_splits: f64,
    /// Addition: share of the stem below which it does not fork, \[0, 1\].
    pub split_from: f64,
    /// `nSplitAngle`: angle of a fork.
    pub split_angle: f64,
    /// `nSplitAngleV`: its variation.
    pub split_angle_v: f64,
    /// `nCurveRes`: segments, \[1, 64\].
    pub curve_res: u32,
    /// `nCurve`: bend over the stem (first half of it if `curve_back` is set); positive bends
    /// away from the parent's tip.
    pub curve: f64,
    /// `nCurveBack`: bend over the second half.
    pub curve_back: f64,
    /// `nCurveV`: variation of the bend, in both directions.
    pub curve_v: f64,
    /// `AttractionUp`, one per order: degrees by which a level stem turns up (negative: down).
    pub attraction_up: f64,
}

impl Level {
    /// A straight, unbranched stem, to be changed by the tables.
    pub const PLAIN: Self = Self {
        down_angle: 0.0,
        down_angle_v: 0.0,
        rotate: 137.5,
        rotate_v: 0.0,
        branches: 0.0,
        whorl: 1,
        bare: 0.0,
        length: 1.0,
        length_v: 0.0,
        taper: 1.0,
        seg_splits: 0.0,
        split_from: 0.0,
        split_angle: 0.0,
        split_angle_v: 0.0,
        curve_res: 4,
        curve: 0.0,
        curve_back: 0.0,
        curve_v: 0.0,
        attraction_up: 0.0,
    };
}

/// The pruning envelope (paper, section 4.6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prune {
    /// `PruneRatio`: 0 off to 1 fully applied.
    pub ratio: f64,
    /// `PruneWidth`: largest radius of the envelope over the plant's height, (0, 2].
    pub width: f64,
    /// `PruneWidthPeak`: height of the largest radius, from the top, as a share of the crown.
    pub width_peak: f64,
    /// `PrunePowerLow`: curvature below the peak, (0, 4].
    pub power_low: f64,
    /// `PrunePowerHigh`: curvature above the peak, (0, 4].
    pub power_high: f64,
}

/// Leaves of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafParameters {
    /// `Leaves`: leaves of the whole plant at its natural density.
    pub count: u32,
    /// `LeafShape`.
    pub shape: LeafShape,
    /// `LeafScale`: length with its petiole at the natural density, (0, 2] metres.
    pub scale: f64,
    /// `LeafScaleX`: width over the template's own, \[0.2, 3\].
    pub scale_x: f64,
    /// `LeafBend`: how far leaves turn to the light, \[0, 1\].
    pub bend: f64,
    /// Addition: how far tips hang, \[0, 1\].
    pub droop: f64,
    /// `nDownAngle` of leaves: angle to the twig.
    pub down_angle: f64,
    /// `nDownAngleV` of leaves.
    pub down_angle_v: f64,
    /// `nRotate` of leaves: phyllotaxis, 180 two-ranked, 137.5 spiral.
    pub rotate: f64,
    /// `nRotateV` of leaves.
    pub rotate_v: f64,
    /// Addition: fraction of a stem of each order from which it bears leaves; 1: none.
    pub bearing: [f64; 4],
    /// Addition: how much shade inside the crown thins leaves, \[0, 1\].
    pub shade: f64,
    /// Addition: average leaves per twig, from which thinly leaved plants get fewer twigs.
    pub per_twig: f64,
}

/// Outline of a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafShape {
    /// Egg-shaped with a pointed tip (beech).
    Ovate,
    /// Heart-shaped with a drawn-out tip (lime).
    Cordate,
    /// Narrow ellipse (privet).
    Elliptic,
    /// A flat spray of needles along a piece of shoot (spruce); one spray counts as a leaf.
    NeedleSpray,
}

/// Pattern of the bark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BarkStyle {
    /// Long ridges and dark furrows (oak).
    Furrowed,
    /// Shallow, narrow ridges (lime).
    Fissured,
    /// Thin reddish scales (spruce).
    Scaly,
    /// Smooth with lenticels.
    Smooth,
}

impl Parameters {
    /// Refuses values outside the ranges stated at the fields.
    pub fn check(&self) -> Result<()> {
        inside("BaseSize", self.base_size, 0.0, 0.9)?;
        inside("Scale", self.scale, 1e-3, 200.0)?;
        inside("ScaleV", self.scale_v, 0.0, 0.5 * self.scale)?;
        inside("Ratio", self.ratio, 1e-4, 0.2)?;
        inside("RatioPower", self.ratio_power, 0.5, 4.0)?;
        inside("Lobes", f64::from(self.lobes), 0.0, 16.0)?;
        inside("LobeDepth", self.lobe_depth, 0.0, 0.5)?;
        inside("Flare", self.flare, 0.0, 3.0)?;
        inside("Levels", f64::from(self.levels), 2.0, 4.0)?;
        inside("Trunks", f64::from(self.trunks), 1.0, 64.0)?;
        inside("TrunkSpread", self.trunk_spread, 0.0, 5.0)?;
        self.prune.check()?;
        for (n, level) in self.level.iter().enumerate().take(usize::from(self.levels)) {
            level.check(n)?;
        }
        self.leaf.check()
    }
}

impl Level {
    fn check(&self, n: usize) -> Result<()> {
        let check = |name: &str, value, low, high| inside(&format!("{n}{name}"), value, low, high);
        check("DownAngle", self.down_angle, 0.0, 180.0)?;
        check("DownAngleV", self.down_angle_v, -180.0, 180.0)?;
        check("Rotate", self.rotate, -360.0, 360.0)?;
        check("RotateV", self.rotate_v, 0.0, 360.0)?;
        check("Branches", self.branches, 0.0, 500.0)?;
        check("Whorl", f64::from(self.whorl), 1.0, 16.0)?;
        check("Bare", self.bare, 0.0, 0.9)?;
        check("Length", self.length, 1e-3, 2.0)?;
        check("LengthV", self.length_v, 0.0, 1.0)?;
        check("Taper", self.taper, 0.0, 1.0)?;
        check("SegSplits", self.seg_splits, 0.0, 2.0)?;
        check("SplitFrom", self.split_from, 0.0, 1.0)?;
        check("SplitAngle", self.split_angle, 0.0, 180.0)?;
        check("SplitAngleV", self.split_angle_v, 0.0, 180.0)?;
        check("CurveRes", f64::from(self.curve_res), 1.0, 64.0)?;
        check("Curve", self.curve, -720.0, 720.0)?;
        check("CurveBack", self.curve_back, -720.0, 720.0)?;
        check("CurveV", self.curve_v, 0.0, 720.0)?;
        check("AttractionUp", self.attraction_up, -360.0, 360.0)
    }
}

impl Prune {
    /// No pruning.
    pub const OFF: Self = Self {
        ratio: 0.0,
        width: 1.0,
        width_peak: 0.5,
        power_low: 0.5,
        power_high: 0.5,
    };

    fn check(&self) -> Result<()> {
        inside("PruneRatio", self.ratio, 0.0, 1.0)?;
        inside("PruneWidth", self.width, 1e-3, 2.0)?;
        inside("PruneWidthPeak", self.width_peak, 0.01, 0.99)?;
        inside("PrunePowerLow", self.power_low, 0.01, 4.0)?;
        inside("PrunePowerHigh", self.power_high, 0.01, 4.0)
    }
}

impl LeafParameters {
    fn check(&self) -> Result<()> {
        inside("LeafScale", self.scale, 1e-4, 2.0)?;
        inside("LeafScaleX", self.scale_x, 0.2, 3.0)?;
        inside("LeafBend", self.bend, 0.0, 1.0)?;
        inside("LeafDroop", self.droop, 0.0, 1.0)?;
        inside("LeafDownAngle", self.down_angle, 0.0, 180.0)?;
        inside("LeafDownAngleV", self.down_angle_v, 0.0, 90.0)?;
        inside("LeafRotate", self.rotate, 0.0, 360.0)?;
        inside("LeafRotateV", self.rotate_v, 0.0, 360.0)?;
        for fraction in self.bearing {
            inside("LeafBearing", fraction, 0.0, 1.0)?;
        }
        inside("LeafShade", self.shade, 0.0, 1.0)?;
        inside("LeavesPerTwig", self.per_twig, 0.1, 1000.0)
    }
}

/// An error unless `low <= value <= high`; NaN is refused.
pub(super) fn inside(name: &str, value: f64, low: f64, high: f64) -> Result<()> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(Error::usage(format!(
            "{name} is {value}, outside [{low}, {high}]"
        )))
    }
}
