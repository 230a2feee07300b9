//! What a picture in several styles takes: attributes that any of them needs, and the passes of
//! each.

use super::rule::Mix;
use crate::gpu::Format;
use crate::ink::plan::{Attribute, InkPlan, PASSES, SHARED};

/// The pass of stage 1.
const STAGE_1: &str = PASSES[SHARED - 2];
/// Colour and tone on wet paper.
const WET: [(&str, &str); 4] = [
    ("ink colour across", "ink soften across"),
    ("ink tone across", "ink soften across"),
    ("ink colour", "ink soften down"),
    ("ink tone", "ink soften down"),
];

/// An image that the two stages write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlannedImage {
    /// Its name.
    pub name: &'static str,
    /// The pass that writes it.
    pub pass: &'static str,
    /// Bytes of a pixel.
    pub bytes: u64,
}

/// The plan of a mix. Stage 1 runs once for all styles; each further style adds its own passes of
/// stage 2.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MixPlan {
    /// Plans of the styles.
    pub styles: Vec<InkPlan>,
    names: Vec<String>,
    masked: bool,
}

impl MixPlan {
    /// The plan of `mix`.
    #[must_use]
    pub fn new(mix: &Mix) -> Self {
        Self {
            styles: mix.styles.iter().map(InkPlan::new).collect(),
            names: mix.names.clone(),
            masked: mix.parts.iter().any(|p| p.is_masked()),
        }
    }

    /// Whether there are several styles.
    #[must_use]
    pub fn is_mixed(&self) -> bool {
        self.styles.len() > 1
    }

    /// Whether any style has what `has` asks for.
    #[must_use]
    pub fn any(&self, has: impl Fn(&InkPlan) -> bool) -> bool {
        self.styles.iter().any(has)
    }

    /// Attributes of stage 1, in the order of its targets: what any style needs; of several styles
    /// also the ids, which say whose a pixel is.
    #[must_use]
    pub fn attributes(&self) -> Vec<Attribute> {
        let wanted = |a: &Attribute| {
            let owner = self.is_mixed() && *a == Attribute::Ids;
            owner || self.any(|s| s.attributes().contains(a))
        };
        Attribute::ALL.into_iter().filter(wanted).collect()
    }

    /// Name of a pass of a style: in a mix with the style's.
    #[must_use]
    pub fn label(&self, pass: &str, style: usize) -> String {
        if self.is_mixed() {
            format!("{pass}, {}", self.names[style])
        } else {
            pass.to_owned()
        }
    }

    /// Passes in their order: every kind for all styles that have it before the next kind, since
    /// a pass reads what others left around its pixels.
    #[must_use]
    pub fn passes(&self) -> Vec<String> {
        let has = |pass: &&&str| self.any(|s| s.passes().contains(*pass));
        let shared = PASSES[..SHARED].iter().filter(has);
        let mut out: Vec<String> = shared.map(|&pass| pass.to_owned()).collect();
        for pass in &PASSES[SHARED..] {
            let styles = (0..).zip(&self.styles);
            let has = styles.filter(|(_, plan)| plan.passes().contains(pass));
            out.extend(has.map(|(k, _)| self.label(pass, k)));
        }
        out
    }

    /// Images of the two stages, without the sun's map, whose size is not the picture's.
    #[must_use]
    pub fn images(&self) -> Vec<PlannedImage> {
        let image = |name, pass, bytes| PlannedImage { name, pass, bytes };
        let mut out: Vec<PlannedImage> = self
            .attributes()
            .into_iter()
            .map(|a| image(a.label(), STAGE_1, a.format().bytes()))
            .collect();
        out.push(image("ink depth test", STAGE_1, Format::Depth32.bytes()));
        let float = Format::R32Float.bytes();
        if self.any(|s| s.contour) {
            out.push(image("ink contour", "ink contour", float));
            out.push(image("ink lines", "ink clean", float));
        }
        if self.any(|s| s.silhouette) {
            out.push(image("ink silhouette", "ink silhouette", float));
        }
        let half = Format::Rgba16Float.bytes();
        if self.any(|s| s.light) {
            out.push(image("ink light", "ink light", half));
        }
        for style in &self.styles {
            if style.edges {
                out.push(image("ink edges", "ink edges", float));
            }
            if style.wash {
                for (name, pass) in WET {
                    out.push(image(name, pass, half));
                }
                out.push(image("ink wash", "ink wash", half));
            }
        }
        if self.masked {
            out.push(image("ink masks", "upload", 4));
        }
        out.push(image(
            "ink picture",
            "ink compose",
            Format::Rgba16Float.bytes(),
        ));
        out
    }

    /// Bytes of the images of stage 1 and 2 for a picture of `size` pixels.
    #[must_use]
    pub fn bytes(&self, [width, height]: [u32; 2]) -> u64 {
        let per_pixel: u64 = self.images().iter().map(|i| i.bytes).sum();
        per_pixel * u64::from(width) * u64::from(height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::style::Style;

    fn mix(names: &[&str]) -> Mix {
        let styles: Vec<Style> = names.iter().map(|n| Style::named(n).unwrap()).collect();
        Mix {
            styles,
            names: names.iter().map(|n| (*n).to_owned()).collect(),
            parts: Vec::new(),
        }
    }

    #[test]
    fn a_mix_needs_what_its_styles_need_and_a_further_style_adds_its_own_passes() {
        let plan = |names: &[&str]| MixPlan::new(&mix(names));
        let (lines, strokes) = (plan(&["outline"]), plan(&["silhouette-hatching"]));
        let both = plan(&["outline", "silhouette-hatching"]);
        let mut union = [lines.attributes(), strokes.attributes()].concat();
        union.sort();
        union.dedup();
        assert_eq!(both.attributes(), union);
        assert!(both.bytes([10, 10]) >= lines.bytes([10, 10]).max(strokes.bytes([10, 10])));
        let size = [10, 10];
        assert!(both.bytes(size) < lines.bytes(size) + strokes.bytes(size));
        let expected = [
            "ink sun",
            "ink stage 1",
            "ink light",
            "ink contour, outline",
            "ink contour, silhouette-hatching",
            "ink clean, outline",
            "ink clean, silhouette-hatching",
            "ink silhouette, silhouette-hatching",
            "ink compose, outline",
            "ink compose, silhouette-hatching",
        ];
        assert_eq!(both.passes(), expected);
        let alone = MixPlan::new(&Mix::single(Style::named("outline").unwrap()));
        assert_eq!(alone.bytes(size), alone.styles[0].bytes(size));
        // Alone, without the first stage: what it added.
        assert_eq!(
            both.passes().len(),
            lines.passes().len() + strokes.passes().len() - 1
        );
    }

    #[test]
    fn of_several_styles_the_ids_say_whose_a_pixel_is() {
        let mut bare = mix(&["outline", "full"]);
        for style in &mut bare.styles {
            (style.contour.strength, style.silhouette.strength) = (0.0, 0.0);
        }
        assert!(MixPlan::new(&bare).attributes().contains(&Attribute::Ids));
        bare.styles.truncate(1);
        assert_eq!(MixPlan::new(&bare).attributes(), [Attribute::Depth]);
    }
}
