//! Rank statistics and other summaries used by the measures.

use glam::Vec3;

use super::kd_tree::KdTree;

/// Quantile `p` in \[0,1\] with linear interpolation between order statistics; NaN when empty.
#[must_use]
pub fn quantile(values: &[f64], p: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    sorted[low] + (at - low as f64) * (sorted[high] - sorted[low])
}

/// Middle value.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Arithmetic mean; NaN when empty.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Ranks from 1, equal values sharing the mean of their ranks.
#[must_use]
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut out = vec![0.0; values.len()];
    let mut start = 0;
    while start < order.len() {
        let value = values[order[start]];
        let end = start + order[start..].partition_point(|&i| values[i] <= value);
        let rank = 0.5 * (start + 1 + end) as f64;
        for &i in &order[start..end] {
            out[i] = rank;
        }
        start = end;
    }
    out
}

/// Product-moment correlation; NaN when one side is constant.
#[must_use]
pub fn pearson(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "pairs");
    let (ma, mb) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        ab += (x - ma) * (y - mb);
        aa += (x - ma).powi(2);
        bb += (y - mb).powi(2);
    }
    ab / (aa * bb).sqrt()
}

/// Spearman's rank correlation with ties.
#[must_use]
pub fn spearman(a: &[f64], b: &[f64]) -> f64 {
    pearson(&ranks(a), &ranks(b))
}

/// Area under the receiver operating characteristic: the chance that a positive scores above a
/// negative, ties counting half (Mann and Whitney 1947). NaN when one class is empty.
#[must_use]
pub fn auc(scores: &[f64], positive: &[bool]) -> f64 {
    assert_eq!(scores.len(), positive.len(), "pairs");
    let count = positive.iter().filter(|&&p| p).count() as f64;
    let sum: f64 = ranks(scores)
        .iter()
        .zip(positive)
        .filter(|(_, p)| **p)
        .map(|(rank, _)| rank)
        .sum();
    let others = positive.len() as f64 - count;
    (sum - 0.5 * count * (count + 1.0)) / (count * others)
}

/// Angle between unit vectors in degrees, accurate for small ones.
#[must_use]
pub fn angle_degrees(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Roughness of unit normals in degrees: the mean angle between a normal and the mean of those at
/// the 12 nearest other points. `sample` indexes the points at which it is measured.
#[must_use]
pub fn roughness(positions: &[Vec3], normals: &[Vec3], sample: &[usize]) -> f64 {
    use rayon::prelude::*;
    const NEIGHBOURS: usize = 12;
    let tree = KdTree::new(positions);
    let angles: Vec<f64> = sample
        .par_iter()
        .map(|&i| {
            let sum: Vec3 = tree
                .nearest(positions[i], NEIGHBOURS + 1)
                .into_iter()
                .filter(|&j| j != i)
                .take(NEIGHBOURS)
                .map(|j| normals[j])
                .sum();
            angle_degrees(normals[i], sum)
        })
        .collect();
    mean(&angles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_share_ties() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [3.5, 1.0, 3.5, 2.0]);
    }

    #[test]
    fn spearman_sees_order_only() {
        let a: Vec<f64> = (0..50).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|x| (0.3 * x).exp()).collect();
        let c: Vec<f64> = a.iter().map(|x| -x.powi(3)).collect();
        assert!((spearman(&a, &b) - 1.0).abs() < 1e-12);
        assert!((spearman(&a, &c) + 1.0).abs() < 1e-12);
        // By hand: ranks of b are 2.5 2.5 1 4; 1 2 3 4 against them.
        let r = spearman(&[1.0, 2.0, 3.0, 4.0], &[5.0, 5.0, 0.0, 9.0]);
        assert!((r - 0.316_227_766).abs() < 1e-6, "{r}");
    }

    #[test]
    fn auc_counts_pairs() {
        let scores = [0.1, 0.4, 0.4, 0.8];
        assert_eq!(auc(&scores, &[false, false, true, true]), 0.875);
        assert_eq!(auc(&scores, &[true, true, false, false]), 0.125);
        assert!(auc(&scores, &[true; 4]).is_nan());
    }

    #[test]
    fn quantiles_interpolate() {
        let v = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(median(&v), 2.5);
        assert_eq!(quantile(&v, 1.0), 4.0);
        assert!((quantile(&v, 0.9) - 3.7).abs() < 1e-12);
    }

    #[test]
    fn roughness_is_nil_for_parallel_normals_and_large_for_random_ones() {
        let positions: Vec<Vec3> = (0..400)
            .map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0))
            .collect();
        let sample: Vec<usize> = (0..400).collect();
        assert!(roughness(&positions, &[Vec3::Z; 400], &sample) < 1e-4);
        let random: Vec<Vec3> = (0..400)
            .map(|i| {
                use crate::math::sampling::{uniform, uniform_sphere};
                uniform_sphere((uniform(1, 2 * i), uniform(1, 2 * i + 1)).into()).as_vec3()
            })
            .collect();
        let angle = roughness(&positions, &random, &sample);
        assert!((70.0..110.0).contains(&angle), "{angle}");
    }
}
