//! Which of the branches are drawn (Deussen and Strothotte 2000, section 3: up to the second
//! order).

use glam::Vec3;

use crate::ink::branches::Branches;

/// The triangles of `indices` on branches of at least `thinnest` of the thickest one's radius.
/// Models do not tell the order of their branches; their radius stands for it. 0 keeps all.
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
