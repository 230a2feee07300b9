//! A slice through the density field as a coloured image.

use glam::Vec3;

use super::image::Picture;
use super::subject::FieldGrid;
use crate::math::colour::heat;

/// Texels of the slice, across and down.
pub const EXTENT: [u32; 2] = [512, 512];

/// A rectangle through the middle of the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlicePlane {
    /// Top left corner, relative to the geometry's origin.
    pub corner: Vec3,
    /// From the left to the right edge.
    pub edge_u: Vec3,
    /// From the upper to the lower edge.
    pub edge_v: Vec3,
}

impl SlicePlane {
    /// The upright rectangle through the grid's centre whose horizontal edge is nearest to
    /// `right` (the camera's), covering the grid's box.
    #[must_use]
    pub fn facing(field: &FieldGrid<'_>, right: Vec3) -> Self {
        let cells = Vec3::from(field.nodes.map(|n| n.saturating_sub(1) as f32));
        let extent = cells * field.cell;
        let centre = field.min + 0.5 * extent;
        let u = Vec3::new(right.x, 0.0, right.z).normalize_or(Vec3::X);
        // Half-width at which the rectangle leaves the box.
        let reach = f32::min(
            0.5 * extent.x / u.x.abs().max(1e-6),
            0.5 * extent.z / u.z.abs().max(1e-6),
        );
        let half_u = u * reach;
        let half_v = Vec3::NEG_Y * 0.5 * extent.y;
        Self {
            corner: centre - half_u - half_v,
            edge_u: 2.0 * half_u,
            edge_v: 2.0 * half_v,
        }
    }
}

/// Trilinear interpolation of the field; 0 outside.
#[must_use]
pub fn interpolate(field: &FieldGrid<'_>, at: Vec3) -> f32 {
    let q = (at - field.min) / field.cell;
    let [nx, ny, nz] = field.nodes;
    let inside = |v: f32, n: usize| v >= 0.0 && v <= (n.max(1) - 1) as f32;
    if !(inside(q.x, nx) && inside(q.y, ny) && inside(q.z, nz)) {
        return 0.0;
    }
    let base = q.floor();
    let t = q - base;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "inside the grid"
    )]
    let [x, y, z] = [base.x as usize, base.y as usize, base.z as usize];
    let value = |dx: usize, dy: usize, dz: usize| {
        let (x, y, z) = (
            (x + dx).min(nx - 1),
            (y + dy).min(ny - 1),
            (z + dz).min(nz - 1),
        );
        field.values[(z * ny + y) * nx + x]
    };
    let along_x = |dy, dz| value(0, dy, dz) + (value(1, dy, dz) - value(0, dy, dz)) * t.x;
    let along_y = |dz| along_x(0, dz) + (along_x(1, dz) - along_x(0, dz)) * t.y;
    along_y(0) + (along_y(1) - along_y(0)) * t.z
}

/// The slice as an image of [`EXTENT`]: a heat map up to the field's largest value, transparent
/// where the density is 0, a pale line where it equals tau.
#[must_use]
pub fn picture(field: &FieldGrid<'_>, plane: &SlicePlane) -> Picture {
    let [width, height] = EXTENT;
    let largest = field.values.iter().copied().fold(1e-20, f32::max);
    let sample = |x: f32, y: f32| {
        let at =
            plane.corner + plane.edge_u * (x / width as f32) + plane.edge_v * (y / height as f32);
        interpolate(field, at)
    };
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let (fx, fy) = (x as f32 + 0.5, y as f32 + 0.5);
            let here = sample(fx, fy);
            let crosses = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
                .iter()
                .any(|(dx, dy)| (sample(fx + dx, fy + dy) < field.tau) != (here < field.tau));
            let color = if crosses {
                [1.0; 3]
            } else {
                heat(here / largest)
            };
            let alpha = if here > 0.0 || crosses { 255 } else { 0 };
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "between 0 and 255"
            )]
            rgba.extend(color.map(|c| (c * 255.0).round() as u8));
            rgba.push(alpha);
        }
    }
    Picture {
        width,
        height,
        rgba,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_reproduces_linear_fields() {
        let nodes = [3, 4, 5];
        let mut values = Vec::new();
        for z in 0..5 {
            for y in 0..4 {
                for x in 0..3 {
                    values.push(1.0 + x as f32 + 10.0 * y as f32 + 100.0 * z as f32);
                }
            }
        }
        let field = FieldGrid {
            min: Vec3::splat(-1.0),
            cell: 0.5,
            nodes,
            values: &values,
            tau: 1.0,
        };
        let v = interpolate(&field, Vec3::new(-0.25, -0.5, 0.75));
        assert!((v - (1.0 + 1.5 + 10.0 + 350.0)).abs() < 1e-3, "{v}");
        assert_eq!(interpolate(&field, Vec3::splat(9.0)), 0.0);
    }

    #[test]
    fn plane_stays_inside_the_grid() {
        let values = vec![0.0; 27];
        let field = FieldGrid {
            min: Vec3::ZERO,
            cell: 1.0,
            nodes: [3, 3, 3],
            values: &values,
            tau: 0.1,
        };
        let p = SlicePlane::facing(&field, Vec3::new(0.6, 0.2, 0.8));
        let centre = p.corner + 0.5 * (p.edge_u + p.edge_v);
        assert!(centre.distance(Vec3::ONE) < 1e-5);
        for c in [p.corner, p.corner + p.edge_u, p.corner + p.edge_v] {
            assert!(
                c.min_element() > -1e-4 && c.max_element() < 2.0 + 1e-4,
                "{c}"
            );
        }
    }
}
