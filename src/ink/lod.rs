//! Fewer, larger leaves where a plant is small (Coconu, Deussen, Hege 2006, sections 3 and 9;
//! Deussen's "drop and resize"): leaves go in a fixed random order, the rest grow by
//! `s(k) = w sqrt(n / k) + 1 - w`, and become discs.

use super::style::Style;

/// Least share of the leaves that is kept however small a plant is.
const LEAST: f32 = 1e-3;

/// What of a style depends on how large leaves are in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// Share of the leaves that is drawn.
    pub kept: f32,
    /// Factor on their size.
    pub size: f32,
    /// Threshold of their shape: 1 leaf, 0 disc.
    pub shape: f32,
    /// By how much wood is thickened, pixels of the final picture: what is thinner than a pixel
    /// becomes a line of about one.
    pub wood: f32,
}

impl Detail {
    /// For a style whose median leaf, as the style draws it near, is `pixels` of the final picture
    /// wide. Leaves that are at least `leaves.lod` pixels wide are drawn as the style has them.
    #[must_use]
    pub fn new(style: &Style, pixels: f32) -> Self {
        let l = &style.leaves;
        let near = Self {
            kept: l.kept,
            size: l.size * style.enlargement(),
            shape: l.shape,
            wood: 0.0,
        };
        // Also for a leaf of no size.
        if pixels >= l.lod || l.lod.is_nan() || pixels.is_nan() {
            return near;
        }
        let ratio = (pixels / l.lod).max(LEAST.sqrt());
        Self {
            // As many as cover the same area where each is as large as asked for.
            kept: l.kept * ratio * ratio,
            size: near.size * (l.enlarge / ratio + 1.0 - l.enlarge),
            shape: l.shape * ratio,
            wood: 1.0 - ratio,
        }
    }

    /// The same for a leaf of radius `radius` metres whose style is seen with `metres` metres to a
    /// pixel of the final picture.
    #[must_use]
    pub fn seen(style: &Style, radius: f32, metres: f32) -> Self {
        let size = style.leaves.size * style.enlargement();
        Self::new(style, 2.0 * radius * size / metres)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_the_leaves_is_left_at_half_the_size_asked_for_and_grows_by_the_law() {
        let mut style = Style::named("outline").unwrap();
        style.leaves.lod = 12.0;
        let near = Detail::new(&style, 12.0);
        assert_eq!((near.kept, near.wood), (style.leaves.kept, 0.0));
        for (w, factor) in [(0.0, 1.0), (0.5, 1.5), (1.0, 2.0)] {
            style.leaves.enlarge = w;
            let near = Detail::new(&style, 100.0);
            let far = Detail::new(&style, 6.0);
            assert!((far.kept - 0.25 * near.kept).abs() < 1e-6);
            assert!((far.size - factor * near.size).abs() < 1e-5, "{w}");
            assert!((far.shape - 0.5 * near.shape).abs() < 1e-6);
        }
    }

    #[test]
    fn detail_falls_without_leaps_and_never_to_nothing() {
        let mut style = Style::named("full").unwrap();
        style.leaves.lod = 10.0;
        let mut last = Detail::new(&style, 11.0);
        for k in (0..=1100).rev() {
            let now = Detail::new(&style, 0.01 * k as f32);
            assert!(now.kept <= last.kept && now.kept >= style.leaves.kept * LEAST * 0.999);
            assert!(last.kept - now.kept < 3e-3 && now.size >= last.size);
            last = now;
        }
        style.leaves.lod = 0.0;
        assert_eq!(Detail::new(&style, 0.0).kept, style.leaves.kept);
    }
}
