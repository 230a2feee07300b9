//! Eigenvectors of symmetric 3 x 3 matrices.

use glam::{DMat3, DVec3};

/// Sweeps of rotations; three are enough for f64, more change nothing.
const SWEEPS: usize = 8;

/// Eigenvalues, falling, with their unit eigenvectors, of a symmetric matrix: rotations of Jacobi
/// (1846). Entries that are no numbers give eigenvalues that are none.
#[must_use]
pub fn symmetric(matrix: DMat3) -> [(f64, DVec3); 3] {
    let mut m = matrix;
    let mut vectors = DMat3::IDENTITY;
    let size = matrix.x_axis.x.abs() + matrix.y_axis.y.abs() + matrix.z_axis.z.abs();
    for _ in 0..SWEEPS {
        let off = m.y_axis.x.abs() + m.z_axis.x.abs() + m.z_axis.y.abs();
        if off <= f64::EPSILON * size {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(q)[p];
            if off == 0.0 || !off.is_finite() {
                continue;
            }
            let theta = (m.col(q)[q] - m.col(p)[p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let mut rotation = DMat3::IDENTITY;
            rotation.col_mut(p)[p] = c;
            rotation.col_mut(q)[q] = c;
            rotation.col_mut(q)[p] = s;
            rotation.col_mut(p)[q] = -s;
            m = rotation.transpose() * m * rotation;
            vectors *= rotation;
        }
    }
    let mut out = [0, 1, 2].map(|k| (m.col(k)[k], vectors.col(k)));
    out.sort_by(|a, b| b.0.total_cmp(&a.0));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_those_the_matrix_was_made_of() {
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.3);
        let made = turn * DMat3::from_diagonal(DVec3::new(1.0, 5.0, -2.0)) * turn.transpose();
        let found = symmetric(made);
        for ((value, vector), (want, column)) in found.iter().zip([(5.0, 1), (1.0, 0), (-2.0, 2)]) {
            assert!((value - want).abs() < 1e-12, "{value} for {want}");
            assert!(vector.dot(turn.col(column)).abs() > 1.0 - 1e-12, "{vector}");
        }
        assert_eq!(symmetric(DMat3::ZERO)[0].0, 0.0);
    }
}
