//! The drawn leaf: midrib, side veins and mottling on the leaf's green.
//!
//! v runs from the tip (0) to the base (1), u across with the midrib at one half, as the leaf
//! templates lay out their texture coordinates. The outline is the mesh's, so alpha is 1.

use super::noise::{blend, draw, fractal};
use super::parameters::LeafShape;

/// Width and height in pixels.
pub(super) const SIZE: [u32; 2] = [256, 256];

struct Look {
    green: [f32; 3],
    dark: [f32; 3],
    vein: [f32; 3],
    /// Side veins over the length.
    veins: f32,
    /// How far a side vein runs towards the tip per distance from the midrib.
    slant: f32,
}

/// sRGB pixels of a leaf.
pub(super) fn pixels(shape: LeafShape) -> Vec<u8> {
    match shape {
        LeafShape::NeedleSpray => draw(SIZE, needle),
        LeafShape::Ovate => draw(SIZE, |u, v| blade(u, v, &OVATE)),
        LeafShape::Cordate => draw(SIZE, |u, v| blade(u, v, &CORDATE)),
        LeafShape::Elliptic => draw(SIZE, |u, v| blade(u, v, &ELLIPTIC)),
    }
}

const OVATE: Look = Look {
    green: [0.36, 0.50, 0.17],
    dark: [0.25, 0.40, 0.12],
    vein: [0.58, 0.66, 0.34],
    veins: 8.0,
    slant: 0.85,
};
const CORDATE: Look = Look {
    green: [0.42, 0.57, 0.20],
    dark: [0.30, 0.46, 0.14],
    vein: [0.66, 0.74, 0.42],
    veins: 6.0,
    slant: 1.05,
};
const ELLIPTIC: Look = Look {
    green: [0.33, 0.46, 0.21],
    dark: [0.23, 0.36, 0.15],
    vein: [0.50, 0.60, 0.34],
    veins: 9.0,
    slant: 0.7,
};

fn blade(u: f32, v: f32, look: &Look) -> [f32; 3] {
    let (s, w) = (1.0 - v, (u - 0.5).abs());
    let mottle = fractal(u, v, [6, 6], 11);
    let fine = fractal(u, v, [28, 28], 23);
    let mut c = blend(look.dark, look.green, 0.15 + 0.9 * mottle);
    c = blend(c, look.dark, 0.35 * (fine - 0.45).max(0.0));
    // side veins bend towards the tip and fade out before the edge
    let phase =
        (s - look.slant * w + 0.5 * w * w) * look.veins + 0.25 * if u > 0.5 { 1.0 } else { 0.0 };
    let off = (phase - (phase + 0.5).floor()).abs() / look.veins;
    let thin = 0.009 * (1.0 - 1.6 * w).max(0.15);
    let side = line(off, thin) * (1.0 - 1.5 * w).clamp(0.0, 1.0);
    // between the veins the blade bulges and catches more light
    c = blend(
        c,
        look.green,
        0.35 * (off * look.veins * 2.0).clamp(0.0, 1.0),
    );
    c = blend(c, look.vein, 0.55 * side);
    let midrib = line(w, 0.007 + 0.012 * (1.0 - s));
    blend(c, look.vein, 0.85 * midrib)
}

fn line(distance: f32, half_width: f32) -> f32 {
    (1.6 - distance / half_width).clamp(0.0, 1.0)
}

/// Needles: u from the shoot (0) to the tip (1), each v another needle.
fn needle(u: f32, v: f32) -> [f32; 3] {
    let tone = fractal(u, v, [2, 24], 31);
    let dark = [0.13, 0.25, 0.13];
    let green = [0.27, 0.41, 0.21];
    let c = blend(dark, green, 0.25 + 0.8 * tone * (0.45 + 0.55 * u));
    // the shoot itself is brown
    blend([0.42, 0.32, 0.20], c, (u - 0.03) / 0.08)
}
