//! Papers by their names; distances that depths are compared in.

use super::style::Depth;

/// Width and height, millimetres, of a paper by its name (upright), or `WIDTHxHEIGHT`.
///
/// # Errors
/// The names that there are.
pub fn paper_size(text: &str) -> Result<[f64; 2], String> {
    let named = match text.to_ascii_lowercase().as_str() {
        "a6" => Some([105.0, 148.0]),
        "a5" => Some([148.0, 210.0]),
        "a4" => Some([210.0, 297.0]),
        "a3" => Some([297.0, 420.0]),
        "a2" => Some([420.0, 594.0]),
        "a1" => Some([594.0, 841.0]),
        "a0" => Some([841.0, 1189.0]),
        "letter" => Some([215.9, 279.4]),
        "tabloid" => Some([279.4, 431.8]),
        _ => None,
    };
    let turned = text
        .strip_suffix("-landscape")
        .and_then(|upright| paper_size(upright).ok())
        .map(|[w, h]| [h, w]);
    let given = || {
        let (w, h) = text.split_once('x')?;
        let size = [w.trim().parse::<f64>().ok()?, h.trim().parse::<f64>().ok()?];
        size.iter()
            .all(|s| (10.0..=5000.0).contains(s))
            .then_some(size)
    };
    named.or(turned).or_else(given).ok_or_else(|| {
        "expected a6 to a0, letter, tabloid (with -landscape: turned) or WIDTHxHEIGHT in millimetres, 10 to 5000".into()
    })
}

impl Depth {
    /// Nearest and farthest eye depth that count as z0 and z1, metres, where the plants' are
    /// `plants`.
    #[must_use]
    pub fn metres(&self, plants: [f32; 2]) -> [f32; 2] {
        if self.fitted {
            return plants;
        }
        let unit = if self.relative {
            0.1 * f64::from(plants[1] - plants[0])
        } else {
            1.0
        };
        [self.near, self.far].map(|z| (z * unit) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_compared_between_plants_metres_or_tenths_of_the_plants_depth() {
        let depth = |fitted, relative| Depth {
            fitted,
            relative,
            near: 2.0,
            far: 22.0,
            ..Depth::default()
        };
        let plants = [50.0, 90.0];
        assert_eq!(depth(true, false).metres(plants), plants);
        assert_eq!(depth(false, false).metres(plants), [2.0, 22.0]);
        assert_eq!(depth(false, true).metres(plants), [8.0, 88.0]);
    }

    #[test]
    fn papers_have_their_names_and_any_size() {
        assert_eq!(paper_size("A4"), Ok([210.0, 297.0]));
        assert_eq!(paper_size("a3-landscape"), Ok([420.0, 297.0]));
        assert_eq!(paper_size("100x80.5"), Ok([100.0, 80.5]));
        for wrong in ["a9", "0x5", "nanx20", "", "-landscape"] {
            assert!(paper_size(wrong).unwrap_err().contains("letter"), "{wrong}");
        }
    }
}
