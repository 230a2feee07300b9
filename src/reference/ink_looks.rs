//! Twins of the kernels of `ink` that make looks: light with the sun's shadow, edges in normals,
//! washes.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4Swizzles};

use crate::abi::{
    INK_GRAIN_LENGTH, INK_NOISE_OCTAVES, INK_PIGMENT_LENGTH, INK_SHADOW_REACH, INK_SOFTEN_REACH,
    INK_WOBBLE_LENGTH, InkEdges, InkFrame, InkLight, InkSoften, InkWash,
};
use crate::math::sampling::{pcg, unit_interval};

/// An image of four floats a texel, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Texels<'a> {
    /// Texels across and down.
    pub size: [i64; 2],
    /// `size[0] * size[1]` of them.
    pub texels: &'a [[f32; 4]],
}

impl Texels<'_> {
    /// A texel; the nearest one outside.
    #[must_use]
    pub fn fetch(&self, x: i64, y: i64) -> DVec4 {
        let [w, h] = self.size;
        let at = y.clamp(0, h - 1) * w + x.clamp(0, w - 1);
        DVec4::from(self.texels[at as usize].map(f64::from))
    }

    /// Bilinear: `bilinear` of `ink_bilinear.glsl`.
    #[must_use]
    pub fn bilinear(&self, at: DVec2) -> DVec4 {
        let low = (at - 0.5).floor();
        let f = at - 0.5 - low;
        let (x, y) = (low.x as i64, low.y as i64);
        let top = self.fetch(x, y).lerp(self.fetch(x + 1, y), f.x);
        let bottom = self.fetch(x, y + 1).lerp(self.fetch(x + 1, y + 1), f.x);
        top.lerp(bottom, f.y)
    }
}

/// Share of the sun that a surface throws back: `sun_share` of `ink_light.glsl`.
#[must_use]
pub fn sun_share(normal: DVec3, to_sun: DVec3, wrap: f64) -> f64 {
    let c = ((normal.dot(to_sun) + wrap) / (1.0 + wrap)).clamp(0.0, 1.0);
    c.powf(1.0 + wrap)
}

/// How far the sun is hidden: `sun_hidden` of `ink_light.glsl`. `map` has the depths of a map of
/// `texels` on each side.
#[must_use]
pub fn sun_hidden(
    map: &[f32],
    (at, depth): (DVec2, f64),
    reach: f64,
    bias: f64,
    texels: u32,
) -> f64 {
    let first = (at - reach - 0.5).ceil();
    let count = ((2.0 * reach).floor() as i64 + 1).min(2 * i64::from(INK_SHADOW_REACH) + 1);
    let depth = depth.max(0.0);
    let (mut sum, mut total) = (0.0, 0.0);
    for (y, x) in (0..count).flat_map(|y| (0..count).map(move |x| (y, x))) {
        let texel = first + DVec2::new(x as f64, y as f64);
        let tent = (1.0 - (texel + 0.5 - at).abs() / reach).max(DVec2::ZERO);
        let edge = f64::from(texels);
        let inside = texel.min_element() >= 0.0 && texel.max_element() < edge;
        let caster = if inside {
            f64::from(map[(texel.y * edge + texel.x) as usize])
        } else {
            0.0
        };
        let weight = tent.x * tent.y;
        sum += weight * ((caster - depth) / bias - 1.0).clamp(0.0, 1.0);
        total += weight;
    }
    if total > 0.0 { sum / total } else { 0.0 }
}

/// Where a pixel's surface is.
#[must_use]
pub fn place(frame: &InkFrame, size: [u32; 2], (x, y): (i64, i64), depth: f64) -> DVec3 {
    let v = |a: [f32; 3]| DVec3::from(a.map(f64::from));
    let [w, h] = size.map(f64::from);
    let corner = DVec2::new(x as f64 + 0.5 - 0.5 * w, y as f64 + 0.5 - 0.5 * h);
    let across = corner.x * v(frame.right) - corner.y * v(frame.up);
    v(frame.eye) + depth * (v(frame.forward) + across / f64::from(frame.focal))
}

/// What the light of a pixel takes of its style.
#[derive(Debug, Clone, Copy)]
pub struct Lighting {
    /// Light from all around, 0 to 1.
    pub ambient: f64,
    /// How far sunlight reaches round a surface, 0 to 1.
    pub wrap: f64,
    /// Share of the sun that shadows take, 0 to 1.
    pub shadow: f64,
}

/// Light on a pixel: sun, sky, how far the sun is hidden, tone. `map`: the sun's depths where
/// shadows are wanted.
#[must_use]
pub fn light(
    push: &InkLight,
    (frame, style): (&InkFrame, &Lighting),
    (depth, surface): (f64, DVec4),
    map: Option<&[f32]>,
    pixel: (i64, i64),
) -> DVec4 {
    if depth <= 0.0 {
        return DVec4::ZERO;
    }
    let to_sun = DVec3::from(frame.to_sun.map(f64::from));
    let n = surface.xyz();
    let n = if n.length_squared() > 1e-12 {
        n.normalize()
    } else {
        to_sun
    };
    let ambient = style.ambient;
    let sun = (1.0 - ambient) * sun_share(n, to_sun, style.wrap);
    let open = (surface.w / (ambient + sun).max(1e-3)).min(1.0);
    let hidden = map.map_or(0.0, |map| {
        let columns = push.relative_to_sun.map(|c| c.map(f64::from));
        let p = place(frame, [push.width, push.height], pixel, depth);
        let at = DMat4::from_cols_array_2d(&columns) * p.extend(1.0);
        let texel = (0.5 * at.xy() + 0.5) * f64::from(push.texels);
        let (reach, bias) = (f64::from(push.reach), f64::from(push.bias));
        sun_hidden(map, (texel, at.z), reach, bias, push.texels)
    });
    let lit = open * sun * (1.0 - style.shadow * hidden);
    let sky = open * ambient;
    DVec4::new(lit, sky, hidden, lit + sky)
}

/// Line of a pixel where normals turn, 0 to 1.
#[must_use]
pub fn edges(push: &InkEdges, normals: &Texels<'_>, (x, y): (i64, i64)) -> f64 {
    let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let reach = f64::from(push.reach);
    let normal = |dx: f64, dy: f64| normals.bilinear(middle + reach * DVec2::new(dx, dy)).xyz();
    let (mut across, mut down) = (DVec3::ZERO, DVec3::ZERO);
    for k in [-1.0, 0.0, 1.0_f64] {
        let weight = 2.0 - k.abs();
        across += weight * (normal(1.0, k) - normal(-1.0, k));
        down += weight * (normal(k, 1.0) - normal(k, -1.0));
    }
    let gradient = (across.length_squared() + down.length_squared()).sqrt() / 8.0;
    ((gradient - f64::from(push.threshold)) / f64::from(push.softness)).clamp(0.0, 1.0)
}

/// One pass of softening: colour with cover, and tone. First: from base colours, tones in w and
/// depths, along x; else from the first pass, along y.
#[must_use]
pub fn soften(
    push: &InkSoften,
    depth: Option<&[f32]>,
    (colours, tones): (&Texels<'_>, &Texels<'_>),
    (x, y): (i64, i64),
) -> (DVec4, f64) {
    let [w, h] = colours.size;
    let deviation = f64::from(push.deviation);
    let reach = ((2.5 * deviation).ceil() as i64).min(i64::from(INK_SOFTEN_REACH));
    let (mut colour, mut tone, mut total) = (DVec4::ZERO, 0.0, 0.0);
    for k in -reach..=reach {
        let (qx, qy) = if depth.is_some() {
            (x + k, y)
        } else {
            (x, y + k)
        };
        if qx < 0 || qy < 0 || qx >= w || qy >= h {
            continue;
        }
        let weight = (-0.5 * (k as f64 / deviation).powi(2)).exp();
        let (c, t) = (colours.fetch(qx, qy), tones.fetch(qx, qy));
        match depth {
            Some(depth) => {
                let covered = depth[(qy * w + qx) as usize] > 0.0;
                let covered = weight * f64::from(u8::from(covered));
                colour += covered * c.xyz().extend(1.0);
                tone += covered * t.w;
            }
            None => {
                colour += weight * c;
                tone += weight * t.x;
            }
        }
        total += weight;
    }
    (colour / total, tone / total)
}

fn lattice(x: i32, y: i32, seed: u32) -> f64 {
    unit_interval(pcg(x.cast_unsigned() ^ pcg(y.cast_unsigned() ^ pcg(seed))))
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// Smooth numbers in \[0,1) with a wavelength of 1: `value_noise` of `ink_noise.glsl`.
#[must_use]
pub fn value_noise(at: DVec2, seed: u32) -> f64 {
    let cell = at.floor();
    let f = at - cell;
    let f = f * f * (3.0 - 2.0 * f);
    let (x, y) = (cell.x as i32, cell.y as i32);
    let top = mix(lattice(x, y, seed), lattice(x + 1, y, seed), f.x);
    let bottom = mix(lattice(x, y + 1, seed), lattice(x + 1, y + 1, seed), f.x);
    mix(top, bottom, f.y)
}

/// Octaves of [`value_noise`].
#[must_use]
pub fn cloudy_noise(mut at: DVec2, seed: u32) -> f64 {
    let (mut sum, mut weight, mut total) = (0.0, 0.5, 0.0);
    for k in 0..INK_NOISE_OCTAVES {
        sum += weight * value_noise(at, seed.wrapping_add(k));
        total += weight;
        at *= 2.0;
        weight *= 0.5;
    }
    sum / total
}

/// Paint on a pixel, linear.
#[must_use]
pub fn wash(
    push: &InkWash,
    (colours, tones): (&Texels<'_>, &Texels<'_>),
    (x, y): (i64, i64),
) -> DVec3 {
    let cover = |at: DVec2| {
        let covered = colours.bilinear(at).w;
        DVec2::new(covered, tones.bilinear(at).x / covered.max(1e-3))
    };
    let layer = |inside: f64| {
        let lies = (inside / f64::from(push.feather) + 0.5).clamp(0.0, 1.0);
        let gathered = (-inside.max(0.0) / f64::from(push.edge_width)).exp();
        lies * (1.0 + f64::from(push.darkening) * gathered)
    };
    let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let on_paper = at / f64::from(push.factor);
    let noise = |length: f32, more: u32| {
        cloudy_noise(on_paper / f64::from(length), push.seed.wrapping_add(more)) - 0.5
    };
    let wander = DVec2::new(noise(INK_WOBBLE_LENGTH, 0), noise(INK_WOBBLE_LENGTH, 17));
    let at = at + 2.0 * f64::from(push.wobble) * wander;
    let here = cover(at);
    let across = cover(at + DVec2::X) - cover(at - DVec2::X);
    let down = cover(at + DVec2::Y) - cover(at - DVec2::Y);
    let slope = 0.5 * DVec2::new(across.x.hypot(down.x), across.y.hypot(down.y));
    let slope = slope.max(DVec2::splat(2e-3));
    let shape = (here.x - 0.5) / slope.x;
    let mut density = layer(shape);
    let settled = noise(INK_PIGMENT_LENGTH, 31);
    // An even tone is not painted over at once.
    let tone = here.y + 0.06 * settled;
    density += layer(((f64::from(push.middle) - tone) / slope.y).min(shape));
    density += layer(((f64::from(push.dark) - tone) / slope.y).min(shape));
    let grain = noise(INK_GRAIN_LENGTH, 47);
    let uneven = 2.0 * f64::from(push.pigment) * settled + 2.0 * f64::from(push.grain) * grain;
    density *= f64::from(push.density) * (1.0 + uneven).max(0.0);
    let paint = colours.bilinear(at);
    let through = (paint.xyz() / paint.w.max(1e-3))
        .clamp(DVec3::splat(2e-3), DVec3::splat(0.9))
        .map(f64::sqrt);
    DVec3::from(push.paper.map(f64::from)) * through.map(|v| v.powf(density))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_of_a_shadow_is_where_its_caster_ends_and_the_filter_is_wide() {
        // The left half of the map casts.
        let texels = 64;
        let map: Vec<f32> = (0..texels * texels)
            .map(|i| if i % texels < 32 { 0.8 } else { 0.0 })
            .collect();
        let hidden = |x: f64| sun_hidden(&map, (DVec2::new(x, 30.3), 0.5), 3.0, 0.01, texels);
        assert!((hidden(20.0) - 1.0).abs() < 1e-12);
        assert!(hidden(40.0).abs() < 1e-12);
        assert!((hidden(32.0) - 0.5).abs() < 1e-12);
        let mut last = 1.0;
        for k in 0..=160 {
            let now = hidden(28.0 + 0.05 * f64::from(k));
            assert!(
                now <= last + 1e-12 && last - now < 0.03,
                "{now} after {last}"
            );
            last = now;
        }
        // A surface does not hide itself: half the bias before and behind the caster.
        for depth in [0.795, 0.8, 0.805] {
            let own = sun_hidden(&map, (DVec2::new(10.0, 10.0), depth), 3.0, 0.01, texels);
            assert_eq!(own, 0.0, "{depth}");
        }
    }

    #[test]
    fn a_wrap_of_0_is_lamberts_cosine_and_of_1_goes_half_round() {
        let at = |degrees: f64, wrap: f64| {
            let (y, x) = degrees.to_radians().sin_cos();
            sun_share(DVec3::new(x, y, 0.0), DVec3::X, wrap)
        };
        assert!((at(60.0, 0.0) - 0.5).abs() < 1e-12);
        assert_eq!(at(120.0, 0.0), 0.0);
        assert!((at(90.0, 1.0) - 0.25).abs() < 1e-12);
        assert!(at(179.9, 1.0) < 1e-5 && at(0.0, 1.0) == 1.0);
    }

    #[test]
    fn opposite_normals_side_by_side_are_a_full_edge_and_equal_ones_none() {
        let half = |x: i64| {
            if x < 8 {
                [1.0, 0.0, 0.0, 1.0]
            } else {
                [-1.0, 0.0, 0.0, 1.0]
            }
        };
        let texels: Vec<[f32; 4]> = (0..256).map(|i| half(i % 16)).collect();
        let normals = Texels {
            size: [16, 16],
            texels: &texels,
        };
        let push = InkEdges {
            width: 16,
            height: 16,
            reach: 1.0,
            threshold: 0.5,
            softness: 0.4,
        };
        assert!((edges(&push, &normals, (7, 8)) - 1.0).abs() < 1e-12);
        assert_eq!(edges(&push, &normals, (3, 8)), 0.0);
    }

    #[test]
    fn a_layer_of_paint_is_darkest_at_its_edge_and_paper_stays_paper() {
        // A disc of tone 0.9: one layer.
        let size = 64_i64;
        let covered = |i: i64| {
            let (x, y) = ((i % size - 32) as f32, (i / size - 32) as f32);
            (0.5 + (20.0 - x.hypot(y)) / 8.0).clamp(0.0, 1.0)
        };
        let colours: Vec<[f32; 4]> = (0..size * size)
            .map(|i| [0.2, 0.4, 0.1, 1.0].map(|c| c * covered(i)))
            .collect();
        let tones: Vec<[f32; 4]> = (0..size * size).map(|i| [0.9 * covered(i); 4]).collect();
        let of = |texels| Texels {
            size: [size; 2],
            texels,
        };
        let push = InkWash {
            paper: [1.0; 3],
            width: 64,
            height: 64,
            factor: 1.0,
            feather: 1.0,
            darkening: 1.0,
            edge_width: 2.0,
            density: 0.5,
            middle: 0.6,
            dark: 0.3,
            ..InkWash::default()
        };
        let paint = |x| wash(&push, (&of(&colours), &of(&tones)), (x, 32));
        assert_eq!(paint(2), DVec3::ONE, "paper");
        let (middle, edge) = (paint(32), paint(13));
        assert!(
            edge.x < 0.95 * middle.x,
            "{edge} at the edge, {middle} within"
        );
        // Half a layer; two whole ones have the colour of the leaf.
        assert!((middle.x - 0.2_f64.powf(0.25)).abs() < 1e-3, "{middle}");
    }
}
