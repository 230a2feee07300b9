//! Directions, hashes and point sets for sampling. All are deterministic: seeds are arguments.

use std::f64::consts::PI;

use glam::{DMat3, DVec2, DVec3};

/// Integer hash with good avalanche (Jarzynski and Olano 2020, Hash Functions for GPU Rendering,
/// `pcg`). The shaders' `pcg` is the same function.
#[must_use]
pub const fn pcg(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The `index`-th number of the stream `seed`, uniform in \[0,1).
#[must_use]
pub fn uniform(seed: u32, index: u32) -> f64 {
    f64::from(pcg(index ^ pcg(seed))) / 4_294_967_296.0
}

/// 24 bits in \[0,1): the same number in f32 and f64. The shaders' `unit_interval`.
#[must_use]
pub fn unit_interval(bits: u32) -> f64 {
    f64::from(bits >> 8) / 16_777_216.0
}

/// Key of a path: what is sampled, the number of the sample, the seed. The shaders' `path_key`.
#[must_use]
pub const fn path_key(receiver: u32, path_sample: u32, seed: u32) -> u32 {
    pcg(path_sample ^ pcg(receiver ^ pcg(seed)))
}

/// Number `counter` of the path `key`. The shaders' `random`.
#[must_use]
pub fn random(key: u32, counter: u32) -> f64 {
    unit_interval(pcg(key ^ pcg(counter)))
}

/// Number `path_sample` of a sequence that fills the unit cube evenly (Roberts 2018: R3), shifted
/// by what is sampled. The shaders' `even_numbers`.
#[must_use]
pub fn even_numbers(receiver: u32, path_sample: u32, seed: u32) -> [f64; 3] {
    let shift = pcg(receiver ^ pcg(seed));
    let shifts = [shift, pcg(shift), pcg(shift.wrapping_add(1))];
    // 2^32 / g, / g^2 and / g^3 with g = 1.2207440846.
    let steps = [3_518_319_155_u32, 2_882_110_345, 2_360_945_575];
    std::array::from_fn(|k| {
        unit_interval(path_sample.wrapping_mul(steps[k]).wrapping_add(shifts[k]))
    })
}

/// Point `index` of `count` of the Fibonacci sphere: nearly equal areas, no clustering at the
/// poles (Swinbank and Purser 2006, Fibonacci grids). The pole of the set is +z.
#[must_use]
pub fn fibonacci_sphere(index: u32, count: u32) -> DVec3 {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let z = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(count);
    let (sin, cos) = (golden_angle * f64::from(index)).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

/// All `count` directions of [`fibonacci_sphere`].
#[must_use]
pub fn fibonacci_directions(count: u32) -> Vec<DVec3> {
    (0..count).map(|i| fibonacci_sphere(i, count)).collect()
}

/// Uniform direction on the sphere from two uniform numbers.
#[must_use]
pub fn uniform_sphere(u: DVec2) -> DVec3 {
    let z = 1.0 - 2.0 * u.x;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}

/// Cosine-distributed direction about +z from two uniform numbers (Malley's method).
#[must_use]
pub fn cosine_hemisphere(u: DVec2) -> DVec3 {
    let radius = u.x.sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    DVec3::new(radius * cos, radius * sin, (1.0 - u.x).max(0.0).sqrt())
}

/// Point `index` of a jittered `side` x `side` stratification of the unit square.
#[must_use]
pub fn stratified(index: u32, side: u32, seed: u32) -> DVec2 {
    let cell = DVec2::new(f64::from(index % side), f64::from(index / side));
    let jitter = DVec2::new(uniform(seed, 2 * index), uniform(seed, 2 * index + 1));
    (cell + jitter) / f64::from(side)
}

/// Point `index` of a sequence that fills the unit square evenly at every length (Roberts 2018,
/// The Unreasonable Effectiveness of Quasirandom Sequences: R2).
#[must_use]
pub fn r2(index: u32) -> DVec2 {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let step = DVec2::new(1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC));
    (0.5 + f64::from(index) * step).fract()
}

/// Two unit vectors that complete `z` to a right-handed frame (Duff et al. 2017, Building an
/// Orthonormal Basis, Revisited). Columns: x, y, z.
#[must_use]
pub fn frame(z: DVec3) -> DMat3 {
    let sign = 1.0_f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    DMat3::from_cols(
        DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
        DVec3::new(b, sign + z.y * z.y * a, -z.y),
        z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fibonacci_directions_are_unit_and_balanced() {
        for count in [6, 16, 32, 257] {
            let all = fibonacci_directions(count);
            assert!(all.iter().all(|d| (d.length() - 1.0).abs() < 1e-12));
            let mean = all.iter().sum::<DVec3>() / f64::from(count);
            assert!(mean.length() < 1.0 / f64::from(count), "{count}: {mean}");
        }
    }

    #[test]
    fn strata_integrate_like_the_measure() {
        let side = 32;
        let n = f64::from(side * side);
        let points: Vec<_> = (0..side * side).map(|i| stratified(i, side, 7)).collect();
        let cosine: f64 = points.iter().map(|&u| cosine_hemisphere(u).z).sum::<f64>() / n;
        assert!((cosine - 2.0 / 3.0).abs() < 2e-3, "mean cosine {cosine}");
        let second: f64 = points
            .iter()
            .map(|&u| uniform_sphere(u).x.powi(2))
            .sum::<f64>()
            / n;
        assert!((second - 1.0 / 3.0).abs() < 2e-3, "second moment {second}");
    }

    #[test]
    fn r2_integrates_better_than_chance() {
        let error = (0..100)
            .map(r2)
            .map(|u| (1.0 - (2.0 * u - 1.0).length_squared()).max(0.0).sqrt() / 100.0)
            .sum::<f64>()
            - PI / 6.0;
        assert!(
            error.abs() < 0.01,
            "a half ball over the square, off by {error}"
        );
    }

    #[test]
    fn frames_are_orthonormal_everywhere() {
        for z in fibonacci_directions(64)
            .into_iter()
            .chain([DVec3::Z, DVec3::NEG_Z])
        {
            let m = frame(z);
            let error = (m.transpose() * m - DMat3::IDENTITY).to_cols_array();
            assert!(error.iter().all(|e| e.abs() < 1e-12), "{z}");
            assert!(m.determinant() > 0.0);
        }
    }
}
