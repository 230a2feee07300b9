//! A mix: styles, and the rule that says where each of them is.

use regex::Regex;

use crate::abi::INK_STYLES;
use crate::ink::style::Style;
use crate::scene::textures::Rgba8;

/// Parts of one mix at most: a bit of a word each.
pub(super) const PARTS: usize = 32;

/// Styles and where they are. The first style is the default: what no part claims, and what shows
/// nothing, is drawn in it.
#[derive(Debug, Clone)]
pub struct Mix {
    /// One to eight styles.
    pub styles: Vec<Style>,
    /// Their names, for passes and messages.
    pub names: Vec<String>,
    /// Parts in the order in which they are tried: the first that claims a thing has it.
    pub parts: Vec<Part>,
}

/// A part of a picture that has its own style: what meets all of its conditions.
#[derive(Debug, Clone)]
pub struct Part {
    /// Number of its style.
    pub style: usize,
    /// Names of its objects.
    pub objects: Option<Regex>,
    /// Names of its materials.
    pub materials: Option<Regex>,
    /// How far away it is.
    pub distance: Option<Span>,
    /// Where in the picture it is: left, top, right and bottom in shares of the picture.
    pub window: Option<[f32; 4]>,
    /// The same by an image.
    pub mask: Option<Mask>,
}

/// A range of distances, measured along the direction of view as the depths of contours are.
/// The near end is part of it, the far end is not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Span {
    /// Metres.
    Metres([f32; 2]),
    /// Shares of the range of distances of what is drawn: 0 is its nearest point, 1 its farthest.
    /// 0 and less, 1 and more reach to the end of the world.
    Share([f32; 2]),
}

/// An image over the picture, and which of its values are part.
#[derive(Debug, Clone)]
pub struct Mask {
    /// File, for messages.
    pub name: String,
    /// The image.
    pub image: Rgba8,
    /// Least and largest brightness that is part, 0 to 1.
    pub values: [f32; 2],
}

impl Mix {
    /// One style everywhere.
    #[must_use]
    pub fn single(style: Style) -> Self {
        Self {
            styles: vec![style],
            names: vec![String::new()],
            parts: Vec::new(),
        }
    }

    /// Whether there are several styles.
    #[must_use]
    pub fn is_mixed(&self) -> bool {
        self.styles.len() > 1
    }

    /// Whether which style a thing has can change with the view.
    #[must_use]
    pub fn follows_view(&self) -> bool {
        let follows = |p: &Part| p.distance.is_some() || p.is_masked();
        self.parts.iter().any(follows)
    }

    /// Number of a style in the list; it is added if it is not there yet.
    ///
    /// # Errors
    /// There would be more than [`INK_STYLES`].
    pub(super) fn add(&mut self, name: &str, style: Style) -> Result<usize, String> {
        if let Some(known) = self.styles.iter().position(|s| *s == style) {
            return Ok(known);
        }
        if self.styles.len() == INK_STYLES as usize {
            return Err(format!(
                "style `{name}` is one too many: a picture has at most {INK_STYLES}"
            ));
        }
        let mut name = name.to_owned();
        while self.names.contains(&name) {
            // Two files of one stem: passes are told apart by their names.
            name.push('\'');
        }
        self.styles.push(style);
        self.names.push(name);
        Ok(self.styles.len() - 1)
    }

    /// Whether the parts can be told apart.
    ///
    /// # Errors
    /// Too many; two that are alike but for distances that overlap.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.parts.len() > PARTS {
            let count = self.parts.len();
            return Err(format!("{count} parts: expected at most {PARTS}"));
        }
        let own = |s: &Style| s.bodies.smooth || s.leaves.outline.is_some();
        if let Some(k) = self.styles.iter().position(own).filter(|_| self.is_mixed()) {
            return Err(format!(
                "style `{}`: smooth bodies and outlines of files are not drawn beside other styles",
                self.names[k]
            ));
        }
        for (j, later) in self.parts.iter().enumerate() {
            for (i, earlier) in self.parts[..j].iter().enumerate() {
                if let Some(both) = earlier.overlap(later) {
                    return Err(format!(
                        "part {}: its distances {both} overlap those of part {}",
                        j + 1,
                        i + 1
                    ));
                }
            }
        }
        Ok(())
    }
}

impl Part {
    /// Whether it depends on the place in the picture.
    pub(super) fn is_masked(&self) -> bool {
        self.window.is_some() || self.mask.is_some()
    }

    /// Whether it may be at a pixel of a picture of `size`.
    pub(super) fn is_at(&self, [x, y]: [u32; 2], size: [u32; 2]) -> bool {
        let share = |at: u32, size: u32| (at as f32 + 0.5) / size as f32;
        let (across, down) = (share(x, size[0]), share(y, size[1]));
        let inside = |[left, top, right, bottom]: [f32; 4]| {
            across >= left && across < right && down >= top && down < bottom
        };
        let mask = self.mask.as_ref();
        self.window.is_none_or(inside) && mask.is_none_or(|m| m.holds(m.value([x, y], size)))
    }

    /// The later part's distances, if they overlap and nothing else tells the two apart.
    fn overlap(&self, later: &Self) -> Option<String> {
        let text = |r: &Option<Regex>| r.as_ref().map(|r| r.as_str().to_owned());
        let mask = |m: &Option<Mask>| m.as_ref().map(|m| (m.name.clone(), m.values));
        let same = text(&self.objects) == text(&later.objects)
            && text(&self.materials) == text(&later.materials)
            && self.window == later.window
            && mask(&self.mask) == mask(&later.mask);
        let (a, b) = match (self.distance?, later.distance?) {
            (Span::Metres(a), Span::Metres(b)) | (Span::Share(a), Span::Share(b)) => (a, b),
            // What share a metre is depends on the view.
            _ => return None,
        };
        (same && a[0] < b[1] && b[0] < a[1]).then(|| format!("{} to {}", b[0], b[1]))
    }
}

impl Span {
    /// Least and first too large eye depth, metres, where depths go from `depths[0]` to
    /// `depths[1]`.
    #[must_use]
    pub fn metres(self, depths: [f32; 2]) -> [f32; 2] {
        match self {
            Self::Metres(range) => range,
            Self::Share([low, high]) => {
                let at = |share: f32| depths[0] + share * (depths[1] - depths[0]);
                let low = if low <= 0.0 { f32::MIN } else { at(low) };
                [low, if high >= 1.0 { f32::MAX } else { at(high) }]
            }
        }
    }
}

impl Mask {
    /// Brightness at a pixel of a picture of `size`, 0 to 1: the nearest of the image's pixels.
    #[must_use]
    pub fn value(&self, [x, y]: [u32; 2], size: [u32; 2]) -> f32 {
        let of = |at: u32, size: u32, own: u32| {
            let middle = (2 * u64::from(at) + 1) * u64::from(own) / (2 * u64::from(size));
            middle.min(u64::from(own) - 1) as usize
        };
        let column = of(x, size[0], self.image.width);
        let row = of(y, size[1], self.image.height);
        let at = 4 * (row * self.image.width as usize + column);
        let [r, g, b] = [0, 1, 2].map(|c| f32::from(self.image.pixels[at + c]));
        // Weights of Rec. 709; grey images have their own value to a rounding.
        let grey = if r == g && g == b {
            r
        } else {
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        grey / 255.0
    }

    /// Whether the image has the shape of a picture of `size` to half a pixel.
    pub(super) fn fits(&self, [width, height]: [u32; 2]) -> bool {
        let [w, h] = [self.image.width, self.image.height].map(f64::from);
        let [width, height] = [width, height].map(f64::from);
        (w * height / width - h).abs() <= 0.5 || (h * width / height - w).abs() <= 0.5
    }

    /// Whether the value is part.
    pub(super) fn holds(&self, value: f32) -> bool {
        value >= self.values[0] && value <= self.values[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_reach_to_the_ends_and_metres_stay() {
        assert_eq!(Span::Metres([1.0, 2.0]).metres([5.0, 9.0]), [1.0, 2.0]);
        assert_eq!(Span::Share([0.25, 0.5]).metres([5.0, 9.0]), [6.0, 7.0]);
        let all = Span::Share([0.0, 1.0]).metres([5.0, 9.0]);
        assert_eq!(all, [f32::MIN, f32::MAX]);
    }

    #[test]
    fn masks_are_read_at_the_nearest_of_their_pixels() {
        let grey = |v: u8| [v, v, v, 255];
        let mask = Mask {
            name: "m".into(),
            image: Rgba8 {
                width: 2,
                height: 1,
                pixels: [grey(0), grey(255)].concat(),
            },
            values: [0.5, 1.0],
        };
        let row: Vec<f32> = (0..4).map(|x| mask.value([x, 1], [4, 2])).collect();
        assert_eq!(row, [0.0, 0.0, 1.0, 1.0]);
        assert!(mask.holds(1.0) && mask.holds(0.5) && !mask.holds(0.49));
        assert!(mask.fits([4, 2]) && mask.fits([101, 50]) && !mask.fits([4, 4]));
    }
}
