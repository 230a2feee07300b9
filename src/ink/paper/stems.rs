//! Which of the branches are drawn (Deussen and Strothotte 2000, section 3: up to the second
//! order).

use glam::Vec3;

use super::style::Stem;
use crate::ink::branches::Branches;
use crate::ink::branches::order::orders;
use crate::scene::{Geometry, Model};

/// Share of the height of all wood that trunk and boughs reach at least.
const REACH: f32 = 0.5;

/// What told which branches are drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Told {
    /// The generator, which knows the order of every branch.
    #[default]
    Generator,
    /// Tubes that stand in each other.
    Surface,
    /// The branches' radius: their order could not be told.
    Radius,
    /// Nothing: there are no branches.
    Nothing,
}

impl Told {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Generator => "order, as grown",
            Self::Surface => "order, told from their surface",
            Self::Radius => "radius, as their order cannot be told",
            Self::Nothing => "nothing, as there are none",
        }
    }
}

/// The order of every vertex of wood (parts that are no foliage), where the generator made all of it.
#[must_use]
pub fn known_orders(model: &Model, geometry: &Geometry, foliage: &[bool]) -> Option<Vec<u8>> {
    let mut out = vec![u8::MAX; geometry.positions.len()];
    let parts = geometry.parts.iter().enumerate();
    for (_, part) in parts.filter(|(i, _)| !foliage.get(*i).copied().unwrap_or(false)) {
        let primitive = &model.meshes[part.mesh].primitives[part.primitive];
        let orders = &primitive.botany.as_ref()?.branch_order;
        if orders.len() != part.vertex_count {
            return None;
        }
        out[part.vertices()].copy_from_slice(orders);
    }
    Some(out)
}

/// The triangles of `indices` that `stem` draws, and what told. `known` holds the order of every
/// vertex, where the generator made it.
#[must_use]
pub fn drawn_stems(
    positions: &[Vec3],
    indices: Vec<u32>,
    known: Option<Vec<u8>>,
    stem: &Stem,
) -> (Vec<u32>, Told) {
    let told = if known.is_some() {
        Told::Generator
    } else {
        Told::Surface
    };
    if indices.is_empty() {
        return (indices, Told::Nothing);
    }
    let Some(orders) = known.or_else(|| orders(positions, &indices)) else {
        return (thick_stems(positions, indices, stem.thinnest), Told::Radius);
    };
    let low = |t: &&[u32]| {
        t.iter()
            .all(|&v| u32::from(orders[v as usize]) <= stem.order)
    };
    let kept: Vec<u32> = indices
        .chunks_exact(3)
        .filter(low)
        .flatten()
        .copied()
        .collect();
    if told == Told::Surface && !holds_crown(positions, &indices, &kept, stem.order) {
        return (thick_stems(positions, indices, stem.thinnest), Told::Radius);
    }
    (kept, told)
}

/// Whether branches up to an order reach as far up as those of a tree do: trunk and boughs end in the
/// crown. Where they do not, what was taken for the trunk is a piece of it.
fn holds_crown(positions: &[Vec3], all: &[u32], kept: &[u32], order: u32) -> bool {
    let ends = |indices: &[u32]| {
        indices
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |e, &v| {
                let y = positions[v as usize].y;
                [e[0].min(y), e[1].max(y)]
            })
    };
    let ([low, high], [foot, top]) = (ends(all), ends(kept));
    log::debug!("branches up to order {order} reach from {foot} to {top} of {low} to {high}");
    top - low >= REACH * (high - low) && foot - low <= (1.0 - REACH) * (high - low)
}

/// The triangles of `indices` on branches of at least `thinnest` of the thickest one's radius.
/// Where the order of branches cannot be told their radius stands for it. 0 keeps all.
#[must_use]
pub fn thick_stems(positions: &[Vec3], indices: Vec<u32>, thinnest: f64) -> Vec<u32> {
    if thinnest <= 0.0 || indices.is_empty() {
        return indices;
    }
    let radius = Branches::new(positions, &indices).radius;
    let mut all: Vec<f32> = indices.iter().map(|&v| radius[v as usize]).collect();
    all.sort_by(f32::total_cmp);
    // Not the very largest: flares of roots are no measure.
    let thickest = all[(all.len() - 1) * 99 / 100];
    let least = thinnest as f32 * thickest;
    let thick = |t: &&[u32]| t.iter().any(|&v| radius[v as usize] >= least);
    indices
        .chunks_exact(3)
        .filter(thick)
        .flatten()
        .copied()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of eight sides along y.
    fn tube(radius: f32, x: f32) -> (Vec<Vec3>, Vec<u32>) {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for ring in 0..12_u32 {
            for side in 0..8_u32 {
                let (sin, cos) = (std::f32::consts::FRAC_PI_4 * side as f32).sin_cos();
                positions.push(Vec3::new(x + radius * cos, 0.1 * ring as f32, radius * sin));
                if ring > 0 {
                    let (a, b) = ((ring - 1) * 8 + side, (ring - 1) * 8 + (side + 1) % 8);
                    indices.extend([a, b, b + 8, a, b + 8, a + 8]);
                }
            }
        }
        (positions, indices)
    }

    #[test]
    fn thin_branches_go_and_the_trunk_stays() {
        let (mut positions, mut indices) = tube(0.2, 0.0);
        let trunk = indices.clone();
        let (thin, more) = tube(0.02, 3.0);
        let first = positions.len() as u32;
        positions.extend(thin);
        indices.extend(more.iter().map(|i| first + i));
        assert_eq!(thick_stems(&positions, indices.clone(), 0.5), trunk);
        assert_eq!(thick_stems(&positions, indices.clone(), 0.0), indices);
        assert_eq!(thick_stems(&positions, indices.clone(), 0.05), indices);
        assert!(thick_stems(&[], Vec::new(), 0.5).is_empty());
    }
}
