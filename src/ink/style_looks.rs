//! The parts of a style that make looks beside lines and hatching: light, edges, washes.

use serde::{Deserialize, Serialize};

/// Light on leaves and wood.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shading {
    /// Share of shading under the lines, 0 to 1.
    pub strength: f32,
    /// Share of the model's colours, 0 to 1.
    pub colour: f32,
    /// Steps of tone, 1 to 64; 0: smooth.
    pub steps: f32,
    /// From smooth tones (0) to those steps (1).
    pub hardness: f32,
    /// From the clusters' normals (0) to those of the crown (1).
    pub crown: f32,
    /// Light from all around, 0 to 1.
    pub ambient: f32,
    /// How far the crown darkens leaves within, 0 to 1.
    pub depth: f32,
    /// How far sunlight reaches round a surface: Lambert's cosine (0) to half round (1).
    pub wrap: f32,
    /// Share of the sun that the plant's shadow on itself takes, 0 to 1; hatching darkens with it.
    pub shadow: f32,
    /// Texels along an edge of the shadow's map, 64 to 8192: finer shadows for memory and time.
    pub shadow_texels: u32,
    /// Pixels of the first view that a texel of the map spans at least, 0 to 8: what is finer than
    /// the picture is not drawn. The filter keeps its width, `shadow_radius` texels of the whole map.
    /// 0: always all texels.
    pub shadow_pixels: f32,
    /// Radius of the shadow's filter, texels, 1 to 8.
    pub shadow_radius: f32,
    /// Factor on the light under the lines, 0.1 to 10.
    pub exposure: f32,
    /// Linear colour of sunlight, 0 to 4 each.
    pub sun: [f32; 3],
    /// Linear colour of the light from all around, 0 to 4 each.
    pub sky: [f32; 3],
    /// From the leaves' textures (0) to one colour a leaf (1).
    pub flat: f32,
    /// Differences of colour from leaf to leaf, 0 to 1.
    pub variation: f32,
    /// Streaks of a brush along leaves, 0 to 1.
    pub bristles: f32,
}

impl Default for Shading {
    fn default() -> Self {
        Self {
            strength: 0.0,
            colour: 0.0,
            steps: 0.0,
            hardness: 1.0,
            crown: 0.5,
            ambient: 0.25,
            depth: 0.7,
            wrap: 1.0,
            shadow: 0.0,
            shadow_texels: 1024,
            shadow_pixels: 1.0,
            shadow_radius: 2.5,
            exposure: 1.0,
            sun: [1.0; 3],
            sky: [1.0; 3],
            flat: 0.0,
            variation: 0.0,
            bristles: 0.0,
        }
    }
}

impl Shading {
    /// Whether the light under the lines is anything but the tone.
    #[must_use]
    pub fn is_tinted(&self) -> bool {
        self.sun != [1.0; 3] || self.sky != [1.0; 3]
    }
}

/// Lines where normals turn (Luft, Balzer, Deussen 2007, figure 7). The normals are those of
/// shading: `leaves.orientation` and `shading.crown` say whose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Edges {
    /// Strength, 0 (none) to 1.
    pub strength: f32,
    /// Gradient of the normal at which lines begin, 0 to 1; 1 is between opposite normals.
    pub threshold: f32,
    /// Over which they become full, 0.001 to 1.
    pub softness: f32,
    /// Width, pixels, 0.25 to 8.
    pub width: f32,
    /// How far normals are shortened by the ambient coefficient, 0 to 1: quiets what lies deep.
    pub ambient: f32,
}

impl Default for Edges {
    fn default() -> Self {
        Self {
            strength: 0.0,
            threshold: 0.1,
            softness: 0.2,
            width: 1.0,
            ambient: 0.0,
        }
    }
}

/// A wash of transparent paint under the lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wash {
    /// Share of the wash in what is under the lines, 0 (none) to 1.
    pub strength: f32,
    /// How far colours run on wet paper, pixels (standard deviation), 0.2 to 16.
    pub softness: f32,
    /// How far edges wander, pixels, 0 to 16.
    pub wobble: f32,
    /// Width of the border of a layer, pixels, 0.25 to 16.
    pub feather: f32,
    /// Pigment that gathers at edges, densities of a layer, 0 to 4.
    pub darkening: f32,
    /// How far in, pixels, 0.25 to 32.
    pub edge_width: f32,
    /// Optical density of a layer, 0.01 to 4.
    pub density: f32,
    /// Unevenness of the pigment, 0 to 1.
    pub pigment: f32,
    /// Grain of the paper in it, 0 to 1.
    pub grain: f32,
    /// Tone below which a second layer lies, 0 to 1.
    pub middle: f32,
    /// Tone below which a third one lies, 0 to 1.
    pub dark: f32,
}

impl Default for Wash {
    fn default() -> Self {
        Self {
            strength: 0.0,
            softness: 4.0,
            wobble: 2.5,
            feather: 1.0,
            darkening: 0.8,
            edge_width: 2.5,
            density: 0.5,
            pigment: 0.35,
            grain: 0.25,
            middle: 0.5,
            dark: 0.25,
        }
    }
}

/// A number of a style: name, value, least, most.
pub(super) type Number = (&'static str, f32, f32, f32);

/// The numbers of this file's parts.
pub(super) fn numbers(g: &Shading, e: &Edges, w: &Wash) -> Vec<Number> {
    let mut numbers = vec![
        ("shading.strength", g.strength, 0.0, 1.0),
        ("shading.colour", g.colour, 0.0, 1.0),
        ("shading.steps", g.steps, 0.0, 64.0),
        ("shading.hardness", g.hardness, 0.0, 1.0),
        ("shading.crown", g.crown, 0.0, 1.0),
        ("shading.ambient", g.ambient, 0.0, 1.0),
        ("shading.depth", g.depth, 0.0, 1.0),
        ("shading.wrap", g.wrap, 0.0, 1.0),
        ("shading.shadow", g.shadow, 0.0, 1.0),
        (
            "shading.shadow_texels",
            g.shadow_texels as f32,
            64.0,
            8192.0,
        ),
        ("shading.shadow_pixels", g.shadow_pixels, 0.0, 8.0),
        ("shading.shadow_radius", g.shadow_radius, 1.0, 8.0),
        ("shading.exposure", g.exposure, 0.1, 10.0),
        ("shading.flat", g.flat, 0.0, 1.0),
        ("shading.variation", g.variation, 0.0, 1.0),
        ("shading.bristles", g.bristles, 0.0, 1.0),
        ("edges.strength", e.strength, 0.0, 1.0),
        ("edges.threshold", e.threshold, 0.0, 1.0),
        ("edges.softness", e.softness, 0.001, 1.0),
        ("edges.width", e.width, 0.25, 8.0),
        ("edges.ambient", e.ambient, 0.0, 1.0),
        ("wash.strength", w.strength, 0.0, 1.0),
        ("wash.softness", w.softness, 0.2, 16.0),
        ("wash.wobble", w.wobble, 0.0, 16.0),
        ("wash.feather", w.feather, 0.25, 16.0),
        ("wash.darkening", w.darkening, 0.0, 4.0),
        ("wash.edge_width", w.edge_width, 0.25, 32.0),
        ("wash.density", w.density, 0.01, 4.0),
        ("wash.pigment", w.pigment, 0.0, 1.0),
        ("wash.grain", w.grain, 0.0, 1.0),
        ("wash.middle", w.middle, 0.0, 1.0),
        ("wash.dark", w.dark, 0.0, 1.0),
    ];
    numbers.extend(g.sun.map(|v| ("shading.sun", v, 0.0, 4.0)));
    numbers.extend(g.sky.map(|v| ("shading.sky", v, 0.0, 4.0)));
    numbers
}
