//! Every number of a style swept on its own: which of them are axes, how far they go, and that
//! none of them leaps.

use umbrage::gpu::{Gpu, GpuOptions};
use umbrage::ink::style::Style;

use crate::fixture;
use crate::ink_way::{Tree, leap, way};

/// Everything that a style can have, at half its strength.
fn everything() -> Style {
    Style::parse(
        "format_version = 1\ndescription = \"everything\"\n\
         [leaves]\ndisplacement = 0.4\norientation = 0.4\nfacing = 0.4\nsize = 1.0\nshape = 0.6\n\
         kept = 0.8\nswirl = 0.3\nelongation = 1.5\n\
         [contour]\nstrength = 0.6\nthreshold = 0.03\ndetail = 2.0\n\
         [silhouette]\nstrength = 0.5\n[hatching]\nstrength = 0.5\n\
         [shading]\nstrength = 0.7\ncolour = 0.6\nsteps = 4\nhardness = 0.4\ncrown = 0.5\n\
         shadow = 0.5\nshadow_texels = 192\nflat = 0.5\nvariation = 0.3\nbristles = 0.3\n\
         [edges]\nstrength = 0.3\nambient = 0.5\n[wash]\nstrength = 0.4\n",
    )
    .unwrap()
}

/// An axis: part, name, how far it is swept.
type Axis = (&'static str, &'static str, f64, f64);

/// Axes that go by equal steps.
const EVEN: [Axis; 50] = [
    ("leaves", "displacement", 0.0, 1.0),
    ("leaves", "orientation", 0.0, 1.0),
    ("leaves", "facing", 0.0, 1.0),
    ("leaves", "shape", 0.0, 1.0),
    ("leaves", "swirl", 0.0, 1.0),
    ("leaves", "enlarge", 0.0, 1.0),
    ("contour", "strength", 0.0, 1.0),
    ("contour", "width", 0.5, 4.0),
    ("contour", "detail", 0.0, 10.0),
    ("contour", "detail_power", 0.1, 8.0),
    ("silhouette", "strength", 0.0, 1.0),
    ("silhouette", "width", 2.0, 24.0),
    ("hatching", "strength", 0.0, 1.0),
    ("hatching", "packing", 0.0, 1.0),
    ("hatching", "white", 0.2, 1.0),
    ("shading", "strength", 0.0, 1.0),
    ("shading", "colour", 0.0, 1.0),
    ("shading", "steps", 1.0, 8.0),
    ("shading", "hardness", 0.0, 1.0),
    ("shading", "crown", 0.0, 1.0),
    ("shading", "ambient", 0.0, 1.0),
    ("shading", "depth", 0.0, 1.0),
    ("shading", "wrap", 0.0, 1.0),
    ("shading", "shadow", 0.0, 1.0),
    ("shading", "shadow_radius", 1.0, 8.0),
    ("shading", "exposure", 0.5, 3.0),
    ("shading", "sun", 0.0, 2.0),
    ("shading", "sky", 0.0, 2.0),
    ("shading", "flat", 0.0, 1.0),
    ("shading", "variation", 0.0, 1.0),
    ("shading", "bristles", 0.0, 1.0),
    ("edges", "strength", 0.0, 1.0),
    ("edges", "threshold", 0.0, 0.5),
    ("edges", "softness", 0.02, 1.0),
    ("edges", "width", 0.5, 4.0),
    ("edges", "ambient", 0.0, 1.0),
    ("wash", "strength", 0.0, 1.0),
    ("wash", "softness", 0.5, 8.0),
    ("wash", "wobble", 0.0, 8.0),
    ("wash", "feather", 0.25, 8.0),
    ("wash", "darkening", 0.0, 3.0),
    ("wash", "edge_width", 0.25, 8.0),
    ("wash", "density", 0.1, 2.0),
    ("wash", "pigment", 0.0, 1.0),
    ("wash", "grain", 0.0, 1.0),
    ("wash", "middle", 0.0, 1.0),
    ("wash", "dark", 0.0, 1.0),
    ("paper", "colour", 0.0, 1.0),
    ("paper", "ink", 0.0, 1.0),
    ("hatching", "gamma", 0.5, 2.0),
];

/// Sizes and shares, that go by equal ratios: a step means as much at the small end.
const RATIOS: [Axis; 10] = [
    ("leaves", "size", 0.5, 2.0),
    ("leaves", "elongation", 0.5, 4.0),
    ("leaves", "kept", 0.1, 1.0),
    ("leaves", "lod", 16.0, 64.0),
    ("contour", "mapping", 2.0, 50.0),
    // At 0 everything that slants is a line: an end, beside the way.
    ("contour", "threshold", 0.002, 0.2),
    ("contour", "threshold_wood", 0.002, 0.2),
    ("silhouette", "length", 32.0, 256.0),
    ("silhouette", "aspect", 0.25, 4.0),
    ("hatching", "scale", 0.25, 2.0),
];

/// Numbers with nothing between, and why.
const STEPS: [(&str, &str, &str); 8] = [
    (
        "leaves",
        "cluster_radius",
        "other clusters are another drawing; no way goes over it",
    ),
    (
        "bodies",
        "cluster_radius",
        "other clusters are another drawing, and no bodies fade",
    ),
    (
        "hatching",
        "stroke_width",
        "strokes are placed one after the other: another drawing",
    ),
    (
        "shading",
        "shadow_pixels",
        "the shadow's map has whole texels",
    ),
    ("hatching", "stroke_length", "the same"),
    ("hatching", "stroke_jitter", "the same"),
    ("hatching", "crossing", "the same"),
    ("hatching", "cross_angle", "the same"),
];

fn sweep((part, name, low, high): Axis, steps: u32) -> Vec<Style> {
    let base = toml::Table::try_from(everything()).unwrap();
    let ratios = RATIOS.iter().any(|a| (a.0, a.1) == (part, name));
    let one = |k: u32| {
        let mut table = base.clone();
        let share = f64::from(k) / f64::from(steps);
        let value = if ratios {
            low * (high / low).powf(share)
        } else {
            low + (high - low) * share
        };
        let at = &mut table[part].as_table_mut().unwrap()[name];
        *at = match at {
            toml::Value::Array(three) => vec![value; three.len()].into(),
            _ => value.into(),
        };
        table.try_into::<Style>().unwrap()
    };
    (0..=steps).map(one).collect()
}

fn axes() -> impl Iterator<Item = Axis> {
    EVEN.into_iter().chain(RATIOS)
}

#[test]
fn axes_of_leaves_and_light_have_no_leaps() {
    let gpu = fixture::gpu();
    let mut tree = Tree::new(&gpu, 200);
    for axis in axes().filter(|a| ["facing", "shape", "kept", "shadow"].contains(&a.1)) {
        let found = leap(&tree.steps(&sweep(axis, 8), 32));
        assert!(found <= 1.0, "{}.{}: {found} of a step", axis.0, axis.1);
    }
}

#[test]
fn every_number_of_a_style_is_swept_or_has_nothing_between() {
    let table = toml::Table::try_from(everything()).unwrap();
    for (part, keys) in table.iter().filter_map(|(p, v)| Some((p, v.as_table()?))) {
        for (name, value) in keys {
            let first = value.as_array().map_or(Some(value), |a| a.first());
            if !first.is_some_and(toml::Value::is_float) {
                continue;
            }
            let swept = axes().filter(|a| a.0 == part && a.1 == name).count();
            let steps = STEPS.iter().filter(|s| s.0 == part && s.1 == name).count();
            assert_eq!(swept + steps, 1, "{part}.{name}");
        }
    }
}

/// Sweeps in 100 steps. Those alone whose names begin with one of the words of `UMBRAGE_AXES`, if
/// it is set.
#[test]
#[ignore = "six minutes on two cores: 60 axes and five ways in 100 steps; prints what docs/ink.md has"]
fn every_axis_in_100_steps() {
    // The layer sees the same passes in the short tests.
    let gpu = Gpu::new(&GpuOptions::default()).unwrap();
    let mut tree = Tree::new(&gpu, 600);
    let chosen = std::env::var("UMBRAGE_AXES").unwrap_or_default();
    let chosen =
        |name: &str| chosen.split_whitespace().any(|w| name.starts_with(w)) || chosen.is_empty();
    let to = [
        "silhouette-hatching",
        "van-gogh",
        "toon",
        "watercolour",
        "minimal",
    ];
    let ways = to.map(|to| (format!("photo to {to}"), way("photo", to, 100)));
    let sweeps = axes().map(|a| (format!("{}.{}", a.0, a.1), sweep(a, 100)));
    let mut over = Vec::new();
    for (name, styles) in sweeps.chain(ways).filter(|s| chosen(&s.0)) {
        let steps = tree.steps(&styles, 96);
        let mut sorted = steps.clone();
        sorted.sort_by(f64::total_cmp);
        let (median, most) = (sorted[50], sorted[99]);
        let at = steps.iter().position(|s| *s == most).unwrap();
        println!(
            "{name}: median {median:.5}, largest {most:.5} at {at}, {:.2} of the limit",
            leap(&steps)
        );
        if leap(&steps) > 1.0 {
            over.push(name);
        }
    }
    assert!(over.is_empty(), "{over:?}");
}
