//! Parts of the picture by what may be seen in them, found on the host from the triangles' boxes.
//!
//! Shading a pixel that may show the model means fetching every sample of it, which costs more
//! than half of the whole pass. Most pixels of a picture show only ground and sky, and most of
//! those lie where no caster stands between ground and sun: each kind is drawn by a pipeline of
//! its own. All errors are on the safe side, so that no pixel depends on the division.

use glam::{DVec2, DVec3, Mat4, Vec2, Vec3};
use rayon::prelude::*;

use crate::abi::{self, RenderFrame};

/// Edge of the tiles that the picture is divided into, pixels.
const TILE: u32 = 16;
/// Cells across and down that the shadow map is divided into.
const SHADOW_CELLS: u32 = 128;
/// What is drawn is taken to reach so much farther, pixels or texels: rounding of the device's
/// arithmetic and the places of samples within a pixel.
const MARGIN: f32 = 2.0;
/// Triangles that one task looks at.
const TASK: usize = 4096;

/// Pixels from the first corner up to before the second: x, y, x, y.
pub(super) type Rectangle = [u32; 4];

/// The picture, divided: the rectangles do not overlap and cover all of it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Areas {
    /// The model may be seen here.
    pub(super) model: Vec<Rectangle>,
    /// Nothing but ground and sky, and the model's shadow may fall on the ground.
    pub(super) shadowed: Vec<Rectangle>,
    /// Nothing but sky and sunlit ground.
    pub(super) open: Vec<Rectangle>,
}

/// Cells of equal size over a picture or a map, each marked or not.
#[derive(Debug, Clone)]
struct Cells {
    across: [u32; 2],
    edge: f32,
    marked: Vec<bool>,
}

impl Cells {
    fn new(extent: [u32; 2], edge: u32) -> Self {
        let across = extent.map(|e| e.div_ceil(edge));
        Self {
            across,
            edge: edge as f32,
            marked: vec![false; (across[0] * across[1]) as usize],
        }
    }

    /// Columns and rows that a box meets: first and one past the last.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the number of cells"
    )]
    fn span(&self, min: Vec2, max: Vec2) -> [std::ops::Range<u32>; 2] {
        [0, 1].map(|k| {
            let end = self.across[k];
            let first = (min[k] / self.edge).floor().clamp(0.0, end as f32);
            let last = (max[k] / self.edge).floor().clamp(-1.0, end as f32 - 1.0);
            first as u32..(last + 1.0) as u32
        })
    }

    fn mark(&mut self, min: Vec2, max: Vec2) {
        let [columns, rows] = self.span(min, max);
        for row in rows {
            let at = (row * self.across[0]) as usize;
            self.marked[at + columns.start as usize..at + columns.end.max(columns.start) as usize]
                .fill(true);
        }
    }

    fn any(&self, min: Vec2, max: Vec2) -> bool {
        let [columns, rows] = self.span(min, max);
        rows.into_iter().any(|row| {
            let at = row * self.across[0];
            columns
                .clone()
                .any(|column| self.marked[(at + column) as usize])
        })
    }

    fn join(mut self, other: &Self) -> Self {
        for (a, b) in self.marked.iter_mut().zip(&other.marked) {
            *a |= b;
        }
        self
    }
}

/// A vertex in pixels or texels, and whether it lies surely before the near plane or surely
/// behind it.
#[derive(Debug, Clone, Copy)]
struct Projected {
    at: Vec2,
    visible: bool,
    behind: bool,
}

/// Cells that triangles may touch; a triangle through the near plane touches all.
fn covered(
    cells: &Cells,
    to_clip: &Mat4,
    extent: [u32; 2],
    (positions, indices): (&[Vec3], &[u32]),
) -> Cells {
    let scale = Vec2::from(extent.map(|e| 0.5 * e as f32));
    let projected: Vec<Projected> = positions
        .par_iter()
        .map(|p| {
            let clip = *to_clip * p.extend(1.0);
            Projected {
                at: (Vec2::new(clip.x, clip.y) / clip.w + 1.0) * scale,
                // Reversed depth: the near plane is where z = w.
                visible: clip.w > 0.0 && clip.z < clip.w * (1.0 - 1e-5),
                behind: clip.z > clip.w * (1.0 + 1e-5),
            }
        })
        .collect();
    let margin = Vec2::splat(MARGIN);
    indices
        .par_chunks(3 * TASK)
        .fold(
            || cells.clone(),
            |mut cells, chunk| {
                for triangle in chunk.chunks_exact(3) {
                    let [a, b, c] = [0, 1, 2].map(|k| projected[triangle[k] as usize]);
                    if a.visible && b.visible && c.visible {
                        let (min, max) = (a.at.min(b.at).min(c.at), a.at.max(b.at).max(c.at));
                        cells.mark(min - margin, max + margin);
                    } else if !(a.behind && b.behind && c.behind) {
                        cells.marked.fill(true);
                    }
                }
                cells
            },
        )
        .reduce(|| cells.clone(), |a, b| a.join(&b))
}

/// Cells of the shadow map that may hold a caster.
fn casters(frame: &RenderFrame, texels: u32, triangles: (&[Vec3], &[u32])) -> Cells {
    let cells = Cells::new([texels; 2], texels.div_ceil(SHADOW_CELLS));
    let to_sun = Mat4::from_cols_array_2d(&frame.relative_to_sun);
    covered(&cells, &to_sun, [texels; 2], triangles)
}

/// Whether the ground under a rectangle of the picture may lie in a shadow.
fn may_be_shadowed(
    frame: &RenderFrame,
    rectangle: Rectangle,
    casters: &Cells,
    texels: u32,
) -> bool {
    let wide = |v: [f32; 3]| Vec3::from(v).as_dvec3();
    let [x0, y0, x1, y1] = rectangle.map(f64::from);
    let pixel = DVec2::from(frame.pixel.map(f64::from));
    let rays = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|(x, y)| {
        let corner = DVec2::new(x, y) * pixel - 1.0;
        wide(frame.forward) + corner.x * wide(frame.right) - corner.y * wide(frame.up)
    });
    let height = f64::from(frame.ground_height) - f64::from(frame.eye[1]);
    if frame.ground_radius == 0.0 || height > 0.0 || rays.iter().all(|r| r.y >= 0.0) {
        return false;
    }
    // Through the horizon or close to it the ground runs away beyond what can be bounded.
    if height > -1e-9 || rays.iter().any(|r| r.y > -1e-4) {
        return true;
    }
    let to_sun = Mat4::from_cols_array_2d(&frame.relative_to_sun).as_dmat4();
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for ray in rays {
        let ground: DVec3 = wide(frame.eye) + ray * (height / ray.y);
        let at = to_sun.project_point3(ground).truncate();
        let at = (at + 1.0) * (0.5 * f64::from(texels));
        (min, max) = (min.min(at), max.max(at));
    }
    // The filter's places and the texels between which each of them lies.
    let reach = frame.shadow_radius * abi::GROUND_SPREAD * texels as f32 + 1.0 + MARGIN;
    casters.any(min.as_vec2() - reach, max.as_vec2() + reach)
}

impl Areas {
    /// Divides a picture of `size` pixels of triangles (positions and indices, three each) under
    /// a shadow map of `texels` on each side (`None`: there are no shadows).
    pub(super) fn new(
        frame: &RenderFrame,
        size: [u32; 2],
        texels: Option<u32>,
        triangles: (&[Vec3], &[u32]),
    ) -> Self {
        let to_clip = Mat4::from_cols_array_2d(&frame.relative_to_clip);
        let tiles = covered(&Cells::new(size, TILE), &to_clip, size, triangles);
        let casters = texels.map(|t| (casters(frame, t, triangles), t));
        let mut out = Self::default();
        let [across, down] = tiles.across;
        for row in 0..down {
            let mut column = 0;
            while column < across {
                let kind = |c: u32| -> u8 {
                    if tiles.marked[(row * across + c) as usize] {
                        return 0;
                    }
                    let rectangle = pixels([c, row, c + 1, row + 1], size);
                    let shadowed = casters
                        .as_ref()
                        .is_some_and(|(cells, t)| may_be_shadowed(frame, rectangle, cells, *t));
                    if shadowed { 1 } else { 2 }
                };
                let this = kind(column);
                let end = (column + 1..across)
                    .find(|&c| kind(c) != this)
                    .unwrap_or(across);
                let list = match this {
                    0 => &mut out.model,
                    1 => &mut out.shadowed,
                    _ => &mut out.open,
                };
                add(list, pixels([column, row, end, row + 1], size));
                column = end;
            }
        }
        out
    }

    /// One area in which anything may be seen.
    pub(super) fn whole(size: [u32; 2]) -> Self {
        Self {
            model: vec![[0, 0, size[0], size[1]]],
            ..Self::default()
        }
    }
}

/// Pixels of tiles, cut at the picture's edge.
fn pixels(tiles: Rectangle, [width, height]: [u32; 2]) -> Rectangle {
    let [x0, y0, x1, y1] = tiles.map(|t| t * TILE);
    [x0, y0, x1.min(width), y1.min(height)]
}

/// Adds a run of tiles to the rectangle right above it, if that is as wide.
fn add(list: &mut Vec<Rectangle>, [x0, y0, x1, y1]: Rectangle) {
    let above = |r: &&mut Rectangle| (r[0], r[2], r[3]) == (x0, x1, y0);
    match list.iter_mut().rev().find(above) {
        Some(r) => r[3] = y1,
        None => list.push([x0, y0, x1, y1]),
    }
}
