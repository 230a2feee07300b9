//! Twins of the kernels of `ink`: contours, their cleaning, silhouette coordinates, hatch
//! coordinates, the way of a leaf (Coconu, Deussen, Hege 2006).

use glam::{DVec2, DVec3};

use crate::abi::{
    INK_DEPTH_MAPPED, INK_LEVELS, INK_OBJECTS, INK_TILE, INK_WALK, InkClean, InkCluster,
    InkContour, InkLeaf, InkSilhouette,
};

/// Depth as contours compare it: `contour_depth` of `ink_contour.glsl`.
#[must_use]
pub fn contour_depth(depth: f64, push: &InkContour) -> f64 {
    let (near, far) = (f64::from(push.nearest), f64::from(push.farthest));
    if depth <= 0.0 {
        1e9
    } else if push.mapping == INK_DEPTH_MAPPED {
        far * (depth - near) / (depth * (far - near))
    } else {
        (depth - near) / (far - near)
    }
}

/// Style of a pixel by the first of its ids, 0 where nothing is: `style_of` of `ink_style.glsl`.
#[must_use]
pub fn style_of(id: f64) -> u32 {
    if id > 0.0 {
        (id - 1.0) as u32 / INK_OBJECTS
    } else {
        0
    }
}

/// What the contour of one pixel is made from.
#[derive(Debug, Clone, Copy)]
pub struct Pixels<'a> {
    /// Linear eye depths; 0 where nothing is.
    pub depth: &'a [f32],
    /// Object and cluster, each plus 1.
    pub ids: &'a [[f32; 2]],
    /// Projections of the clusters' normals.
    pub direction: &'a [[f32; 2]],
    /// Tones.
    pub tone: &'a [f32],
}

/// Equation 1: 0, 1/2 or 1 by the neighbours that lie farther. `margin` says how near any
/// difference came to the threshold: where it is tiny, rounding decides.
#[must_use]
pub fn contour(push: &InkContour, detail: bool, pixels: &Pixels<'_>, x: i64, y: i64) -> (f64, f64) {
    let (w, h) = (i64::from(push.width), i64::from(push.height));
    let at = |x: i64, y: i64| (y.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize;
    let depth = |x, y| contour_depth(f64::from(pixels.depth[at(x, y)]), push);
    let own = depth(x, y);
    if own >= 1e8 {
        return (0.0, f64::INFINITY);
    }
    let here = at(x, y);
    let leaf = pixels.ids[here][1] > 0.0;
    let mut threshold = f64::from(if leaf {
        push.threshold
    } else {
        push.threshold_wood
    });
    if detail && leaf {
        let e = DVec2::from(pixels.direction[here].map(f64::from));
        let towards = (1.0 - e.length_squared()).max(0.0).sqrt();
        threshold *= 1.0 + f64::from(push.detail) * towards.powf(f64::from(push.detail_power));
    }
    let mut farther: f64 = 0.0;
    let mut margin = f64::INFINITY;
    for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
        let over = depth(x + dx, y + dy) - own - threshold;
        farther += f64::from(u8::from(over > 0.0));
        margin = margin.min(over.abs());
    }
    ((0.5 * farther).min(1.0), margin)
}

/// A contour pixel stays if enough of its neighbours are contour.
#[must_use]
pub fn clean(push: &InkClean, contour: &[f32], x: i64, y: i64) -> f32 {
    let (w, h) = (i64::from(push.width), i64::from(push.height));
    let mut neighbours = 0;
    for (dy, dx) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dy, dx))) {
        let (qx, qy) = (x + dx, y + dy);
        let inside = qx >= 0 && qy >= 0 && qx < w && qy < h;
        if inside && (dx, dy) != (0, 0) && contour[(qy * w + qx) as usize] > 0.0 {
            neighbours += 1;
        }
    }
    if neighbours >= push.neighbours {
        contour[(y * w + x) as usize]
    } else {
        0.0
    }
}

/// Coordinates of a pixel in the band of strokes along its silhouette (u in repeats, v from 0 to
/// 1) and the channel of its tone (0 to 3, not rounded); none where no contour is in reach.
#[must_use]
pub fn silhouette(
    push: &InkSilhouette,
    pixels: &Pixels<'_>,
    lines: &[f32],
    clusters: &[InkCluster],
    x: i64,
    y: i64,
) -> Option<(DVec2, f64)> {
    let (w, h) = (i64::from(push.width), i64::from(push.height));
    let here = (y * w + x) as usize;
    let ids = pixels.ids[here];
    let e = DVec2::from(pixels.direction[here].map(f64::from));
    if ids[1] <= 0.0 || e.length() < 0.1 {
        return None;
    }
    let outward = e.normalize();
    let start = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let mut found = None;
    for step in (0..INK_WALK).take_while(|&s| s as f32 + 0.5 < push.reach) {
        let p = (start + f64::from(step) * outward).floor();
        if p.x < 0.0 || p.y < 0.0 || p.x >= w as f64 || p.y >= h as f64 {
            break;
        }
        let there = (p.y as i64 * w + p.x as i64) as usize;
        if lines[there] > 0.0 && pixels.ids[there][0].to_bits() == ids[0].to_bits() {
            found = Some(step);
            break;
        }
    }
    let cluster = clusters[ids[1] as usize - 1];
    let step = found.filter(|_| cluster.pixel_radius > 0.0)?;
    let up = DVec2::from(cluster.texture_up.map(f64::from));
    let o = DVec2::new(outward.x, -outward.y);
    let angle = up.perp_dot(o).atan2(up.dot(o));
    let turn = std::f64::consts::TAU;
    let around = turn * f64::from(push.aspect) * f64::from(cluster.pixel_radius)
        / f64::from(push.band_length);
    let repeats = (around + 0.5).floor().max(1.0);
    let v = (f64::from(step) + 0.5) / f64::from(push.reach);
    let shade = 3.0 * f64::from(pixels.tone[here]).clamp(0.0, 1.0);
    Some((DVec2::new(repeats * angle / turn, v), shade))
}

/// Hatch coordinates (not wrapped into their tile) and level: `hatch_coordinates` of
/// `ink_hatch.glsl`; equations 5 to 8.
#[must_use]
pub fn hatch(
    cluster: &InkCluster,
    pixel: DVec2,
    depth: f64,
    packing: (f64, f64),
) -> Option<(DVec2, f64)> {
    if cluster.pixel_radius <= 0.0 {
        return None;
    }
    let radius = f64::from(cluster.radius);
    let front = f64::from(cluster.front);
    let centre = DVec2::from(cluster.pixel.map(f64::from));
    let away = (pixel - centre) * DVec2::new(1.0, -1.0);
    let [a, b, c, d] = cluster.to_angles.map(f64::from);
    let per_pixel = (a * d - b * c).abs().sqrt();
    let offset = DVec2::new(a * away.x + b * away.y, c * away.x + d * away.y);
    let behind = ((depth - front) / radius).clamp(0.0, 1.0);
    let square = behind * behind;
    let (packing, steps) = packing;
    let packed = if steps > 0.0 {
        (steps * square).floor().min(steps) / steps
    } else {
        square
    };
    let f = 1.0 + packing * packed;
    let up = DVec2::from(cluster.texture_up.map(f64::from));
    // Q maps the direction of the texture to +v.
    let turned = DVec2::new(
        up.y * offset.x - up.x * offset.y,
        up.x * offset.x + up.y * offset.y,
    );
    let tiles = DVec2::from(cluster.tiles.map(f64::from));
    let reference = DVec2::from(cluster.reference.map(f64::from));
    let at = reference + f * tiles / std::f64::consts::PI * turned;
    let texels = f * tiles.y / std::f64::consts::PI * per_pixel * f64::from(INK_TILE);
    Some(octave(at, texels.max(1e-6).log2()))
}

/// Tiles twice as often until their finest level is seen at most twice as large: `hatch_octave` of
/// `ink_hatch.glsl`.
fn octave(at: DVec2, level: f64) -> (DVec2, f64) {
    let octave = (-1.0 - level).ceil().clamp(0.0, 12.0);
    (at * octave.exp2(), level + octave)
}

/// Level of hatching that is read.
#[must_use]
pub fn hatch_level(level: f64) -> f64 {
    level.clamp(0.0, f64::from(INK_LEVELS) - 1.0)
}

/// Where a leaf goes: `(1 - beta) P + beta (C + r n)`, and the cluster's normal n there.
#[must_use]
pub fn displaced(leaf: &InkLeaf, cluster: &InkCluster, beta: f64) -> (DVec3, DVec3) {
    let at = DVec3::from(leaf.centre.map(f64::from));
    let centre = DVec3::from(cluster.centre.map(f64::from));
    let radius = f64::from(cluster.radius);
    let away = at - centre;
    let outward = if away.length() > 1e-6 * radius {
        away.normalize()
    } else {
        DVec3::from(leaf.normal.map(f64::from))
    };
    (at.lerp(centre + radius * outward, beta), outward)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(width: u32, height: u32) -> InkContour {
        InkContour {
            width,
            height,
            threshold: 0.01,
            threshold_wood: 0.01,
            nearest: 1.0,
            farthest: 11.0,
            ..InkContour::default()
        }
    }

    /// Depths of a disc of radius `r` pixels at depth 2 before a wall at depth 5.
    fn disc(size: i64, r: f64) -> Vec<f32> {
        let middle = size as f64 / 2.0;
        let at = |i: i64| {
            let (x, y) = ((i % size) as f64 + 0.5, (i / size) as f64 + 0.5);
            if (x - middle).hypot(y - middle) <= r {
                2.0
            } else {
                5.0
            }
        };
        (0..size * size).map(at).collect()
    }

    fn mask(size: i64, depth: &[f32], signed: bool) -> Vec<f32> {
        let ids = vec![[1.0, 1.0]; depth.len()];
        let direction = vec![[0.0; 2]; depth.len()];
        let tone = vec![1.0; depth.len()];
        let mut turned: Vec<f32> = depth.to_vec();
        let pixels = Pixels {
            depth,
            ids: &ids,
            direction: &direction,
            tone: &tone,
        };
        let p = push(size as u32, size as u32);
        let one = |pixels: &Pixels<'_>, i: i64| contour(&p, false, pixels, i % size, i / size).0;
        let mut out: Vec<f32> = (0..size * size).map(|i| one(&pixels, i) as f32).collect();
        if !signed {
            // Differences without sign: nearer neighbours count too.
            turned.iter_mut().for_each(|d| *d = 12.0 - *d);
            let back = Pixels {
                depth: &turned,
                ..pixels
            };
            for (i, v) in (0..).zip(&mut out) {
                *v = v.max(one(&back, i) as f32);
            }
        }
        out
    }

    #[test]
    fn the_contour_of_a_disc_is_one_closed_thin_line_on_the_nearer_side() {
        // The spec's count: about 4 sqrt(2) R pixels.
        for (r, about) in [(20.0, 112.0), (60.0, 339.0)] {
            let size = 2 * r as i64 + 20;
            let depth = disc(size, r);
            let line = mask(size, &depth, true);
            let full: Vec<usize> = (0..line.len()).filter(|&i| line[i] == 1.0).collect();
            assert!(
                (full.len() as f64 - about).abs() < 0.06 * about,
                "R {r}: {}",
                full.len()
            );
            assert!(full.iter().all(|&i| depth[i] == 2.0), "on the disc");
            let neighbours = |&i: &usize| {
                let (x, y) = (i as i64 % size, i as i64 / size);
                (-1..=1)
                    .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
                    .filter(|&(dx, dy)| {
                        (dx, dy) != (0, 0) && line[((y + dy) * size + x + dx) as usize] == 1.0
                    })
                    .count()
            };
            let two = full.iter().filter(|i| neighbours(i) == 2).count();
            assert!(two as f64 > 0.9 * full.len() as f64, "R {r}: {two}");
            // Without the sign the line has two sides.
            let both = mask(size, &depth, false);
            let count = both.iter().filter(|v| **v == 1.0).count();
            assert!(count as f64 > 1.8 * full.len() as f64, "R {r}: {count}");
        }
    }

    #[test]
    fn cleaning_removes_dots_and_only_the_ends_of_lines() {
        let (w, h) = (16, 8);
        let p = InkClean {
            width: w,
            height: h,
            neighbours: 2,
            ..InkClean::default()
        };
        let mut line = vec![0.0_f32; (w * h) as usize];
        line[(6 * w + 3) as usize] = 1.0;
        for x in 2..12 {
            line[(2 * w + x) as usize] = 1.0;
        }
        let pass = |line: &[f32]| -> Vec<f32> {
            let one = |i: i64| clean(&p, line, i % i64::from(w), i / i64::from(w));
            (0..i64::from(w * h)).map(one).collect()
        };
        let count = |line: &[f32]| line.iter().filter(|v| **v > 0.0).count();
        let once = pass(&line);
        assert_eq!(count(&once), 8, "the dot and two ends");
        assert_eq!(count(&pass(&once)), 6, "a second pass would eat on");
    }

    #[test]
    fn the_mapping_is_equation_1_with_its_division() {
        let p = InkContour {
            mapping: INK_DEPTH_MAPPED,
            ..push(1, 1)
        };
        assert!(contour_depth(1.0, &p).abs() < 1e-12);
        assert!((contour_depth(11.0, &p) - 1.0).abs() < 1e-12);
        // The table of the spec: at z = 4 a threshold of 1000 / 65535 is a step of 0.235.
        let step = contour_depth(4.235, &p) - contour_depth(4.0, &p);
        assert!((step * 65535.0 - 1000.0).abs() < 3.0, "{}", step * 65535.0);
    }

    #[test]
    fn hatching_packs_towards_the_limb_as_the_sphere_does() {
        let cluster = InkCluster {
            radius: 1.0,
            pixel: [100.0, 100.0],
            pixel_radius: 50.0,
            front: 9.0,
            to_angles: [0.02, 0.0, 0.0, 0.02],
            texture_up: [0.0, 1.0],
            tiles: [1.0, 1.0],
            ..InkCluster::default()
        };
        let packing = std::f64::consts::FRAC_PI_2 - 1.0;
        let limb = hatch(&cluster, DVec2::new(150.0, 100.0), 10.0, (packing, 0.0));
        let plain = hatch(&cluster, DVec2::new(150.0, 100.0), 9.0, (packing, 0.0));
        let ratio = limb.unwrap().0.x / plain.unwrap().0.x;
        assert!(
            (ratio - std::f64::consts::FRAC_PI_2).abs() < 1e-6,
            "{ratio}"
        );
        let hidden = InkCluster {
            pixel_radius: 0.0,
            ..cluster
        };
        assert!(hatch(&hidden, DVec2::ZERO, 1.0, (0.0, 0.0)).is_none());
    }

    #[test]
    fn strokes_keep_their_size_when_the_eye_comes_nearer() {
        let at = DVec2::new(0.3, 0.7);
        assert_eq!(octave(at, 2.0), (at, 2.0), "levels of the tile are enough");
        assert_eq!(octave(at, -1.0), (at, -1.0));
        assert_eq!(octave(at, -1.5), (2.0 * at, -0.5));
        assert_eq!(octave(at, -4.0), (8.0 * at, -1.0));
    }

    #[test]
    fn a_leaf_in_the_middle_of_its_cluster_goes_along_its_own_normal() {
        let cluster = InkCluster {
            radius: 2.0,
            ..InkCluster::default()
        };
        let leaf = InkLeaf {
            normal: [0.0, 1.0, 0.0],
            ..InkLeaf::default()
        };
        let (place, normal) = displaced(&leaf, &cluster, 1.0);
        assert_eq!((place, normal), (DVec3::Y * 2.0, DVec3::Y));
        let (half, _) = displaced(&leaf, &cluster, 0.5);
        assert_eq!(half, DVec3::Y);
    }
}
