//! The way from one style to another: every number of a style between those of two (Coconu,
//! Deussen, Hege 2006, section 3: a continuous palette from photographs to sketches).

use toml::{Table, Value};

use super::style::{Contour, Edges, Hatching, Silhouette, Style, Wash};

/// The style at `share` (0 to 1) of the way between two: every number is interpolated, the share of
/// leaves by equal ratios.
///
/// What a style has switched off, by a strength of 0, it takes from the other, so that things fade
/// in where they belong instead of wandering there. What is no number (seeds, switches, texels of
/// maps, the radius of clusters, how strokes are placed) is the second style's as soon as the way has begun, unless that one
/// has no use for it.
///
/// # Errors
/// Two styles with nothing between: lines by linear depths in one and by mapped depths in the
/// other.
pub fn between(from: &Style, to: &Style, share: f32) -> Result<Style, String> {
    if share <= 0.0 {
        return Ok(from.clone());
    }
    if share >= 1.0 {
        return Ok(to.clone());
    }
    let (mut a, mut b) = (from.clone(), to.clone());
    fill(&mut a, &b);
    fill(&mut b, &a);
    if !uses_clusters(to) {
        b.leaves.cluster_radius = from.leaves.cluster_radius;
        b.leaves.first_fit = from.leaves.first_fit;
    }
    // Not a number that has anything between: other clusters are other drawings.
    a.leaves.cluster_radius = b.leaves.cluster_radius;
    // Nor is the size of a map.
    a.shading.shadow_pixels = b.shading.shadow_pixels;
    // Nor have strokes, which are placed one after the other.
    a.hatching = Hatching {
        stroke_width: b.hatching.stroke_width,
        stroke_length: b.hatching.stroke_length,
        stroke_jitter: b.hatching.stroke_jitter,
        crossing: b.hatching.crossing,
        cross_angle: b.hatching.cross_angle,
        ..a.hatching
    };
    if (a.contour.mapping > 0.0) != (b.contour.mapping > 0.0) {
        return Err(format!(
            "contour.mapping is {} and {}: there is no way between linear and mapped depths",
            a.contour.mapping, b.contour.mapping
        ));
    }
    let table = |style: &Style| Table::try_from(style).map_err(|e| e.to_string());
    let mut mixed = table(&b)?;
    mix(&table(&a)?, &mut mixed, share);
    mixed.insert(
        "description".into(),
        Value::String(format!(
            "{:.0} % of the way from `{}` to `{}`",
            100.0 * share,
            from.description,
            to.description
        )),
    );
    let mut mixed = mixed.try_into::<Style>().map_err(|e| e.to_string())?;
    mixed.leaves.kept = kept(a.leaves.kept, b.leaves.kept, share);
    Ok(mixed)
}

/// The share of leaves goes by equal ratios: those that are left grow with its root, so that equal
/// steps would change the more the fewer there are. From or to none there are no ratios.
fn kept(from: f32, to: f32, share: f32) -> f32 {
    if from > 0.0 && to > 0.0 {
        from * (to / from).powf(share)
    } else {
        from + (to - from) * share
    }
}

/// Gives a style what it has switched off and the other has not.
fn fill(a: &mut Style, b: &Style) {
    let lines = |s: &Style| s.contour.strength > 0.0 || s.silhouette.strength > 0.0;
    if !lines(a) {
        let strength = a.contour.strength;
        a.contour = Contour {
            strength,
            ..b.contour
        };
    }
    if a.silhouette.strength == 0.0 {
        let strength = 0.0;
        a.silhouette = Silhouette {
            strength,
            ..b.silhouette.clone()
        };
    }
    if a.hatching.strength == 0.0 {
        let strength = 0.0;
        a.hatching = Hatching {
            strength,
            ..b.hatching.clone()
        };
    }
    if a.edges.strength == 0.0 {
        let strength = 0.0;
        a.edges = Edges {
            strength,
            ..b.edges
        };
    }
    if a.wash.strength == 0.0 {
        let strength = 0.0;
        a.wash = Wash { strength, ..b.wash };
    }
    let (g, other) = (&mut a.shading, &b.shading);
    if g.steps == 0.0 && other.steps > 0.0 {
        (g.steps, g.hardness) = (other.steps, 0.0);
    }
    if g.strength == 0.0 {
        (g.exposure, g.sun, g.sky) = (other.exposure, other.sun, other.sky);
        (g.steps, g.hardness) = (other.steps, other.hardness);
    }
    let paints = |s: &Style| s.shading.colour > 0.0 || s.wash.strength > 0.0;
    if !paints(a) {
        let g = &mut a.shading;
        (g.flat, g.variation, g.bristles) =
            (b.shading.flat, b.shading.variation, b.shading.bristles);
    }
}

/// Whether anything in a picture of the style depends on its clusters.
fn uses_clusters(style: &Style) -> bool {
    let l = &style.leaves;
    let lines = style.contour.strength > 0.0 && style.contour.detail > 0.0;
    let round = style.shading.crown < 1.0;
    l.displacement > 0.0
        || l.orientation > 0.0
        || l.swirl > 0.0
        || style.hatching.strength > 0.0
        || style.silhouette.strength > 0.0
        || lines
        || round
}

/// Numbers of `to` become those between: `share` of the way from `from`.
fn mix(from: &Table, to: &mut Table, share: f32) {
    for (key, value) in to.iter_mut() {
        if let Some(other) = from.get(key) {
            mix_value(other, value, share);
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the numbers of styles were f32 before they came into the table"
)]
fn mix_value(from: &Value, to: &mut Value, share: f32) {
    match (from, to) {
        (Value::Table(a), Value::Table(b)) => mix(a, b, share),
        // Lists of strokes have nothing between.
        (Value::Array(_), Value::Array(b)) if b.iter().any(Value::is_array) => {}
        (Value::Array(a), Value::Array(b)) => {
            for (a, b) in a.iter().zip(b) {
                mix_value(a, b, share);
            }
        }
        (Value::Float(a), Value::Float(b)) => {
            let (x, y) = (*a as f32, *b as f32);
            *b = f64::from(x + (y - x) * share);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::style::PRESETS;

    #[test]
    fn between_any_two_presets_lies_a_style_and_the_ends_are_theirs() {
        for (a, _) in PRESETS {
            for (b, _) in PRESETS {
                let (a, b) = (Style::named(a).unwrap(), Style::named(b).unwrap());
                assert_eq!(between(&a, &b, 0.0).unwrap(), a);
                assert_eq!(between(&a, &b, 1.0).unwrap(), b);
                for share in [0.001, 0.3, 0.999] {
                    between(&a, &b, share).unwrap().check().unwrap();
                }
            }
        }
    }

    #[test]
    fn what_one_style_has_not_fades_in_with_the_others_numbers() {
        let (photo, ink) = ("photo", "silhouette-hatching");
        let (photo, ink) = (Style::named(photo).unwrap(), Style::named(ink).unwrap());
        let some = between(&photo, &ink, 0.25).unwrap();
        assert_eq!(some.contour.threshold, ink.contour.threshold);
        assert_eq!(some.contour.strength, 0.25 * ink.contour.strength);
        assert_eq!(some.hatching.white, ink.hatching.white);
        assert_eq!(some.shading.exposure, photo.shading.exposure);
        assert_eq!(some.shading.strength, 0.75 * photo.shading.strength);
        let kept = ink.leaves.kept.powf(0.25);
        assert!((some.leaves.kept - kept).abs() < 1e-6 && kept < 1.0);
        let shape = 1.0 + (ink.leaves.shape - 1.0) * 0.25;
        assert_eq!(some.leaves.shape, shape);
        let toon = between(&photo, &Style::named("toon").unwrap(), 0.5).unwrap();
        assert_eq!((toon.shading.steps, toon.shading.hardness), (3.0, 0.5));
    }

    #[test]
    fn mapped_and_linear_depths_have_nothing_between() {
        let ink = Style::named("outline").unwrap();
        let mut mapped = ink.clone();
        mapped.contour.mapping = 11.0;
        let error = between(&ink, &mapped, 0.5).unwrap_err();
        assert!(error.contains("contour.mapping is 0 and 11"), "{error}");
        // Without lines a style takes the other's.
        let photo = Style::named("photo").unwrap();
        let some = between(&photo, &mapped, 0.5).unwrap();
        assert_eq!(some.contour.mapping, 11.0);
    }
}
