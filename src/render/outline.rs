//! Leaf cards cut to what their texture shows.
//!
//! A card is a parallelogram of two triangles with four vertices of its own. Most of it is
//! transparent margin, and a fragment that alpha discards costs as much as one that stays. Its
//! four corners move onto the smallest quadrilateral around the leaf: same vertices, same
//! triangles, fewer fragments. Corners only move inside their card, so that every point shows the
//! texel that it showed before; attributes are interpolated as the card's triangles did.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::batch::Batch;
use super::subject::Subject;
use crate::scene::Wrap;

/// Points across a card, and cells across a mask, at which its alpha is looked at.
const GRID: usize = 128;
/// Directions in which the tightest quadrilateral's edges may stand.
const DIRECTIONS: usize = 32;
/// Different places of a texture that cards of one material may show; more are left as they are.
const SHAPES: usize = 64;
/// Share of the cutoff from which alpha counts as shown: multisampled edges fade out below it.
const FADED: f32 = 0.75;
/// Area of the quadrilateral, as a share of the card's, above which a card stays as it is.
const WORTHWHILE: f32 = 0.9;
/// How far a card's fourth corner may lie off the parallelogram, as a share of its diagonal.
const FLATNESS: f32 = 1e-3;

/// Mip levels of a texture: extent of the largest, RGBA8 bytes of each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texels<'a> {
    pub(super) extent: [u32; 2],
    pub(super) levels: &'a [Vec<u8>],
}

/// A vertex that moves to a point of one of its card's triangles.
#[derive(Debug, Clone, Copy)]
struct Move {
    vertex: u32,
    from: [u32; 3],
    weights: [f32; 3],
}

/// All moves of a subject.
#[derive(Debug, Clone, Default)]
pub(super) struct Outlines {
    moves: Vec<Move>,
}

impl Outlines {
    /// Cuts the cards of `batches`; `texels` finds a batch's texture, `coarsest` is the longest
    /// edge of the coarsest mip level whose shape is kept whole (0 = nothing is cut).
    pub(super) fn new<'a>(
        subject: &Subject<'_>,
        batches: &[Batch],
        coarsest: u32,
        texels: impl Fn(&str) -> Option<Texels<'a>>,
    ) -> Self {
        let mut out = Self::default();
        if coarsest == 0 {
            return out;
        }
        let g = subject.geometry;
        let mut uses = vec![0u8; g.positions.len()];
        for &i in &g.indices {
            uses[i as usize] = uses[i as usize].saturating_add(1);
        }
        for batch in batches.iter().filter(|b| b.cuts) {
            let Some(texels) = batch.texture.as_deref().and_then(&texels) else {
                continue;
            };
            let mask = Mask::new(texels, coarsest, batch);
            let mut shapes: HashMap<[u32; 6], Option<[Vec2; 4]>> = HashMap::new();
            for cluster in &batch.clusters {
                let range = cluster.indices.start as usize..cluster.indices.end as usize;
                let Some(card) = Card::of(&g.indices[range], &uses) else {
                    continue;
                };
                let uv = card.corners.map(|v| Vec2::from(g.texcoords[v as usize]));
                let at = card.corners.map(|v| g.positions[v as usize]);
                if !card.is_flat(at, uv) {
                    continue;
                }
                let key = [uv[0].x, uv[0].y, uv[1].x, uv[1].y, uv[3].x, uv[3].y].map(f32::to_bits);
                if shapes.len() >= SHAPES && !shapes.contains_key(&key) {
                    continue;
                }
                let shape = shapes
                    .entry(key)
                    .or_insert_with(|| mask.shape([uv[0], uv[1], uv[3]], batch));
                if let Some(shape) = shape {
                    card.cut(*shape, &mut out.moves);
                }
            }
        }
        out
    }

    /// An attribute after the moves.
    pub(super) fn apply<T: Copy>(&self, values: &[T], mix: fn([T; 3], [f32; 3]) -> T) -> Vec<T> {
        let mut out = values.to_vec();
        for m in &self.moves {
            out[m.vertex as usize] = mix(m.from.map(|v| values[v as usize]), m.weights);
        }
        out
    }
}

/// Weighted sum of positions.
pub(super) fn mix_points([a, b, c]: [Vec3; 3], w: [f32; 3]) -> Vec3 {
    a * w[0] + b * w[1] + c * w[2]
}

/// Weighted sum of unit vectors, of unit length again; the first where they cancel out.
pub(super) fn mix_normals(n: [Vec3; 3], w: [f32; 3]) -> Vec3 {
    mix_points(n, w).try_normalize().unwrap_or(n[0])
}

/// Weighted sum of `N` numbers.
pub(super) fn mix_arrays<const N: usize>(v: [[f32; N]; 3], w: [f32; 3]) -> [f32; N] {
    std::array::from_fn(|k| v[0][k] * w[0] + v[1][k] * w[1] + v[2][k] * w[2])
}

/// A parallelogram of two triangles: corners 0, 1, 2, 3 around it, the diagonal from 1 to 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Card {
    corners: [u32; 4],
}

impl Card {
    /// Six indices of which two are shared, by triangles that share no vertex with others.
    fn of(indices: &[u32], uses: &[u8]) -> Option<Self> {
        let [a, b, c, d, e, f] = <[u32; 6]>::try_from(indices).ok()?;
        let (first, second) = ([a, b, c], [d, e, f]);
        let apex = (0..3).find(|&i| !second.contains(&first[i]))?;
        let far = second.into_iter().find(|v| !first.contains(v))?;
        let corners = [
            first[apex],
            first[(apex + 1) % 3],
            far,
            first[(apex + 2) % 3],
        ];
        let own = [1, 2, 1, 2];
        let alone = (0..4).all(|i| uses[corners[i] as usize] == own[i]);
        // Both triangles turn the same way round.
        let at = second.iter().position(|&v| v == far)?;
        let turns = second[(at + 1) % 3] == corners[3] && second[(at + 2) % 3] == corners[1];
        (alone && turns).then_some(Self { corners })
    }

    fn is_flat(&self, at: [Vec3; 4], uv: [Vec2; 4]) -> bool {
        let off = (at[0] + at[2] - at[1] - at[3]).length();
        let off_uv = (uv[0] + uv[2] - uv[1] - uv[3]).length();
        off <= FLATNESS * (at[1] - at[3]).length() && off_uv <= FLATNESS * (uv[1] - uv[3]).length()
    }

    /// Moves the corners to `shape`, given along the card's edges 0-1 and 0-3.
    fn cut(&self, shape: [Vec2; 4], moves: &mut Vec<Move>) {
        let [near, one, far, three] = self.corners;
        for (vertex, at) in self.corners.into_iter().zip(shape) {
            let (from, weights) = if at.x + at.y <= 1.0 {
                ([near, one, three], [1.0 - at.x - at.y, at.x, at.y])
            } else {
                (
                    [far, three, one],
                    [at.x + at.y - 1.0, 1.0 - at.x, 1.0 - at.y],
                )
            };
            moves.push(Move {
                vertex,
                from,
                weights,
            });
        }
    }
}

/// Which cells of a texture show something at any level that counts.
struct Mask {
    shown: Vec<bool>,
}

impl Mask {
    fn new(texels: Texels<'_>, coarsest: u32, batch: &Batch) -> Self {
        let threshold = FADED * batch.material.cutoff / batch.material.base_color[3].max(1e-6);
        let mut shown = vec![false; GRID * GRID];
        let mut extent = texels.extent.map(|e| e as usize);
        for level in texels.levels {
            if extent[0].max(extent[1]) < coarsest as usize {
                break;
            }
            mark(&mut shown, level, extent, threshold, batch.wrap.0);
            extent = extent.map(|e| (e / 2).max(1));
        }
        Self { shown }
    }

    /// The tightest quadrilateral around what the card of these texture coordinates (corners 0, 1
    /// and 3) shows; none where that saves little or nothing is shown.
    fn shape(&self, [near, one, three]: [Vec2; 3], batch: &Batch) -> Option<[Vec2; 4]> {
        let (u, v) = (batch.material.texcoord_u, batch.material.texcoord_v);
        let mut reach = [f32::NEG_INFINITY; DIRECTIONS];
        let directions = directions();
        let half = 0.5 / GRID as f32;
        for y in 0..GRID {
            for x in 0..GRID {
                let p = Vec2::new(x as f32, y as f32) * (2.0 * half) + half;
                let uv = near + (one - near) * p.x + (three - near) * p.y;
                let cell = |row: [f32; 3], wrap| {
                    let at = row[0] * uv.x + row[1] * uv.y + row[2];
                    wrapped((at * GRID as f32).floor(), GRID, wrap)
                };
                let [wrap_u, wrap_v] = batch.wrap.0;
                if self.shown[cell(v, wrap_v) * GRID + cell(u, wrap_u)] {
                    for (r, d) in reach.iter_mut().zip(&directions) {
                        *r = r.max(d.dot(p) + 2.0 * half * (d.x.abs() + d.y.abs()));
                    }
                }
            }
        }
        if reach[0] == f32::NEG_INFINITY {
            return None;
        }
        // Not beyond the card.
        for (r, d) in reach.iter_mut().zip(&directions) {
            *r = r.min(d.x.max(0.0) + d.y.max(0.0));
        }
        tightest(&directions, &reach)
    }
}

fn directions() -> [Vec2; DIRECTIONS] {
    std::array::from_fn(|i| Vec2::from_angle(i as f32 * std::f32::consts::TAU / DIRECTIONS as f32))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "cells of a grid, brought into its range"
)]
fn wrapped(cell: f32, cells: usize, wrap: Wrap) -> usize {
    let n = cells as f32;
    let at = match wrap {
        Wrap::Repeat => cell.rem_euclid(n),
        Wrap::Clamp => cell,
        Wrap::Mirror => {
            let period = cell.rem_euclid(2.0 * n);
            period.min(2.0 * n - 1.0 - period)
        }
    };
    at.clamp(0.0, n - 1.0) as usize
}

/// Marks the cells in which a level's alpha reaches the threshold: texel by texel where texels
/// are finer than cells, else by bilinear interpolation.
fn mark(shown: &mut [bool], level: &[u8], [w, h]: [usize; 2], threshold: f32, wrap: [Wrap; 2]) {
    let alpha = |x: usize, y: usize| f32::from(level[4 * (y * w + x) + 3]) / 255.0;
    if w > GRID || h > GRID {
        for y in 0..h {
            for x in 0..w {
                if alpha(x, y) >= threshold {
                    shown[(y * GRID / h) * GRID + x * GRID / w] = true;
                }
            }
        }
        return;
    }
    let taps = |i: usize, texels: usize, wrap| {
        let at = (i as f32 + 0.5) * texels as f32 / GRID as f32 - 0.5;
        let first = at.floor();
        (
            wrapped(first, texels, wrap),
            wrapped(first + 1.0, texels, wrap),
            at - first,
        )
    };
    for y in 0..GRID {
        let (y0, y1, fy) = taps(y, h, wrap[1]);
        for x in 0..GRID {
            let (x0, x1, fx) = taps(x, w, wrap[0]);
            let top = alpha(x0, y0) * (1.0 - fx) + alpha(x1, y0) * fx;
            let bottom = alpha(x0, y1) * (1.0 - fx) + alpha(x1, y1) * fx;
            if top * (1.0 - fy) + bottom * fy >= threshold {
                shown[y * GRID + x] = true;
            }
        }
    }
}

/// The smallest quadrilateral with edges on four of the supporting lines `d . p = reach` and
/// corners inside the unit square, first corner nearest to the square's.
fn tightest(directions: &[Vec2; DIRECTIONS], reach: &[f32; DIRECTIONS]) -> Option<[Vec2; 4]> {
    let mut corner = [[None; DIRECTIONS]; DIRECTIONS];
    for a in 0..DIRECTIONS {
        for b in 0..DIRECTIONS {
            let (da, db) = (directions[a], directions[b]);
            let det = da.perp_dot(db);
            let inside = |p: &Vec2| p.min_element() > -1e-4 && p.max_element() < 1.0 + 1e-4;
            if det > 0.1 {
                let p = Vec2::new(
                    reach[a] * db.y - reach[b] * da.y,
                    reach[b] * da.x - reach[a] * db.x,
                ) / det;
                corner[a][b] = Some(p)
                    .filter(inside)
                    .map(|p| p.clamp(Vec2::ZERO, Vec2::ONE));
            }
        }
    }
    let mut best = (WORTHWHILE, None);
    for a in 0..DIRECTIONS {
        for b in a + 1..DIRECTIONS {
            let Some(ab) = corner[a][b] else { continue };
            for c in b + 1..DIRECTIONS {
                let Some(bc) = corner[b][c] else { continue };
                for (d, from_d) in corner.iter().enumerate().skip(c + 1) {
                    let (Some(cd), Some(da)) = (corner[c][d], from_d[a]) else {
                        continue;
                    };
                    let area = 0.5 * (cd - ab).perp_dot(da - bc);
                    if area < best.0 && area > 0.0 {
                        best = (area, Some([ab, bc, cd, da]));
                    }
                }
            }
        }
    }
    let mut shape = best.1?;
    let nearest = (0..4).min_by(|&i, &j| shape[i].length().total_cmp(&shape[j].length()))?;
    shape.rotate_left(nearest);
    Some(shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(points: &[Vec2]) -> [f32; DIRECTIONS] {
        directions().map(|d| points.iter().map(|p| d.dot(*p)).fold(f32::MIN, f32::max))
    }

    #[test]
    fn the_tightest_quadrilateral_holds_all_points_and_stays_on_the_card() {
        // A leaf along the diagonal.
        let points: Vec<Vec2> = (0..100)
            .map(|i| {
                let t = i as f32 * std::f32::consts::TAU / 100.0;
                let (along, across) = (0.5 * t.cos(), 0.15 * t.sin());
                Vec2::splat(0.5) + Vec2::new(along + across, along - across) * 0.7
            })
            .collect();
        let shape = tightest(&directions(), &reach(&points)).expect("half of the card is empty");
        let area = 0.5 * (shape[2] - shape[0]).perp_dot(shape[3] - shape[1]);
        assert!(
            area < 0.31,
            "{area}; upright it would be 0.53, the leaf has 0.23"
        );
        for (i, &corner) in shape.iter().enumerate() {
            let edge = shape[(i + 1) % 4] - corner;
            assert!(corner.min_element() >= 0.0 && corner.max_element() <= 1.0);
            for p in &points {
                assert!(
                    edge.perp_dot(*p - corner) > -1e-4,
                    "{p} is outside of edge {i}"
                );
            }
        }
    }

    #[test]
    fn a_full_card_stays_as_it_is() {
        let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        assert_eq!(tightest(&directions(), &reach(&corners)), None);
    }

    #[test]
    fn a_card_is_two_triangles_of_one_sense_without_neighbours() {
        let uses = [1, 2, 1, 2];
        let card = Card::of(&[0, 1, 3, 2, 3, 1], &uses).expect("a card");
        assert_eq!(card.corners, [0, 1, 2, 3]);
        assert_eq!(
            Card::of(&[0, 1, 3, 2, 1, 3], &uses),
            None,
            "one turned over"
        );
        assert_eq!(
            Card::of(&[0, 1, 3, 2, 3, 1], &[2, 2, 1, 2]),
            None,
            "a neighbour"
        );
        assert_eq!(
            Card::of(&[0, 1, 3, 0, 1, 3], &uses),
            None,
            "one triangle twice"
        );
        assert_eq!(Card::of(&[0, 1, 3], &uses), None, "one triangle");
    }

    #[test]
    fn moved_corners_lie_on_the_triangles_that_the_card_had() {
        // Not linear over the card: corner 2 stands out, so the diagonal matters.
        let values = [[0.0f32], [1.0], [5.0], [1.0]];
        let card = Card {
            corners: [0, 1, 2, 3],
        };
        let mut outlines = Outlines::default();
        let near = Vec2::new(0.25, 0.25);
        let shape = [
            near,
            Vec2::new(0.75, 0.0),
            Vec2::splat(0.75),
            Vec2::new(0.0, 0.5),
        ];
        card.cut(shape, &mut outlines.moves);
        let moved = outlines.apply(&values, mix_arrays);
        assert_eq!(moved, [[0.5], [0.75], [3.0], [0.5]]);
    }
}
